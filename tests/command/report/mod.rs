//! Tests reports of the command.
mod aggregates;
mod command;
mod figures;
mod maps;
mod page;
mod tables;
