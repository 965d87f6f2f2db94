mod describe;
mod dimensionless;
mod scalars;
mod written;
