//! Tests of the command `report`.
mod aggregates;
mod command;
mod figures;
mod maps;
mod page;
mod tables;
