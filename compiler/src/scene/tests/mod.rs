mod describe;
mod groups;
mod scalars;
mod written;
