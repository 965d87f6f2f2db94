//! `stochc compile`.
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use stochc_compiler::emit::{graph_dot, graph_json, graph_text, table_json, table_text};
use stochc_compiler::{Checked, Program};

use super::check::verdict;
use super::terminal::{WIDTH, has_colour, print, warn};
use crate::cli::Exit;
use crate::findings;

/// What `compile` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// The program
    #[arg(value_name = "FILE")]
    file: String,
    /// The stage to show
    #[arg(long, value_name = "STAGE", default_value = "table")]
    emit: Stage,
    /// Its form; `dot` is for the graph only
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: Form,
}

/// A stage of the compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Stage {
    /// The syntax tree
    Ast,
    /// What waits for what
    Graph,
    /// What every block knows
    Table,
}

/// A form to show it in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// To read and to compare
    Text,
    /// To process
    Json,
    /// To draw, with Graphviz
    Dot,
}

/// Compiles a file and shows a stage.
pub fn run(options: &Options) -> Exit {
    if options.format == Form::Dot && options.emit != Stage::Graph {
        warn("error: `--format dot` is for `--emit graph` only\n");
        return Exit::Usage;
    }
    let checked = crate::check(&options.file);
    warn(&findings::show(
        &checked,
        findings::Format::Graphical,
        has_colour(),
        WIDTH,
    ));
    // The tree needs no more than a text that can be read.
    if checked.has_errors() {
        return verdict(&checked);
    }
    print(&emit(&checked, options.emit, options.format));
    Exit::Success
}

fn emit(checked: &Checked, stage: Stage, form: Form) -> String {
    let symbols = &checked.symbols;
    if stage == Stage::Ast {
        return match form {
            Form::Json => format!("{:#}\n", stochc_grammar::to_json(&checked.tree, symbols)),
            _ => stochc_grammar::print(&checked.tree, symbols),
        };
    }
    let complete: Vec<_> = (checked.programs.iter())
        .filter_map(|program| {
            let Program {
                plan,
                graph,
                order,
                tables,
                ..
            } = program;
            Some((plan, graph, order.as_ref()?, tables.as_ref()?))
        })
        .collect();
    if form == Form::Json {
        let values = complete
            .iter()
            .map(|(plan, graph, order, tables)| match stage {
                Stage::Table => table_json(tables),
                _ => graph_json(plan, graph, order, symbols),
            });
        let value: Value = json!({ "programs": values.collect::<Vec<_>>() });
        return format!("{value:#}\n");
    }
    let texts = complete
        .iter()
        .map(|(plan, graph, order, tables)| match (stage, form) {
            (Stage::Table, _) => table_text(tables),
            (_, Form::Dot) => graph_dot(plan, graph, order, symbols),
            _ => graph_text(plan, graph, order, symbols),
        });
    texts.collect::<Vec<_>>().join("\n")
}
