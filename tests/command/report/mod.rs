//! Reports that the command writes.
mod aggregates;
mod command;
mod figures;
mod maps;
mod page;
mod tables;
