mod describe;
mod groups;
mod scalars;
