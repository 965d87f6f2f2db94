mod bond;
mod contact;
mod medium;
mod sample;
