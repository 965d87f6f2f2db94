mod contact;
mod medium;
mod sample;
