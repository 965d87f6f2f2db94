//! `stochc compile`.
use std::fmt::Display;
use std::io::{self, Write};

use clap::{Args, ValueEnum};
use stochc_compiler::emit::{
    graph_dot, graph_json, graph_text, structure_json, structure_svg, structure_text, table_json,
    table_text,
};
use stochc_compiler::{Checked, Program, Symbols};
use stochc_grammar::{Json, to_json};

use super::check::verdict;
use super::levels::LevelOptions;
use super::terminal::{has_colour, message_width, print_with, usage, warn};
use crate::cli::Exit;
use crate::files::programs::refusal;
use crate::findings::drawn;

/// What `compile` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Program to compile
    #[arg(value_name = "FILE")]
    file: String,
    /// Stage to print
    #[arg(long, value_name = "STAGE", default_value = "table")]
    emit: Stage,
    /// Output format; `dot` for the graph only, `svg` for the structure only
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: Form,
    #[command(flatten)]
    levels: LevelOptions,
}

/// A stage of the compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Stage {
    /// The syntax tree
    Ast,
    /// The blocks that stand at the end of each phase
    Structure,
    /// The dependency graph: which event waits for which
    Graph,
    /// The event table of each block
    Table,
}

/// A form to show it in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// For people
    Text,
    /// For programs
    Json,
    /// The graph, for Graphviz
    Dot,
    /// A picture of the structure
    Svg,
}

/// Compiles a file and shows a stage.
pub fn run(options: &Options) -> Exit {
    let only = match options.format {
        Form::Dot => Some(("dot", Stage::Graph, "graph")),
        Form::Svg => Some(("svg", Stage::Structure, "structure")),
        Form::Text | Form::Json => None,
    };
    if let Some((form, stage, name)) = only
        && stage != options.emit
    {
        warn(&format!(
            "error: `--format {form}` is for `--emit {name}` only\n"
        ));
        return Exit::Usage;
    }
    if let Some(reason) = refusal(&options.file) {
        return usage(&reason);
    }
    let checked = crate::check_with(&options.file, &options.levels.levels);
    warn(&drawn(&checked, has_colour(), message_width()));
    if checked.has_errors() {
        return verdict(&checked);
    }
    print_with(|out| emit(&checked, options.emit, options.format, out));
    Exit::Success
}

fn emit(checked: &Checked, stage: Stage, form: Form, out: &mut dyn Write) -> io::Result<()> {
    let symbols = &checked.symbols;
    let programs = &checked.programs;
    if form == Form::Json {
        let document = match stage {
            Stage::Ast => to_json(&checked.tree, symbols),
            _ => {
                let programs = move || {
                    programs
                        .iter()
                        .filter_map(move |it| json(it, stage, symbols))
                };
                Json::object([("programs", Json::list(programs))])
            }
        };
        serde_json::to_writer_pretty(&mut *out, &document)?;
        return writeln!(out);
    }
    if stage == Stage::Ast {
        return write!(out, "{}", stochc_grammar::print(&checked.tree, symbols));
    }
    let texts = programs
        .iter()
        .filter_map(|program| text(program, stage, form, symbols));
    for (i, text) in texts.enumerate() {
        write!(out, "{}{text}", if i == 0 { "" } else { "\n" })?;
    }
    Ok(())
}

/// A stage of one program as JSON; `None` if the program did not come that far.
fn json<'a>(program: &'a Program, stage: Stage, symbols: &'a Symbols) -> Option<Json<'a>> {
    let Program {
        plan,
        layout,
        graph,
        order,
        tables,
        ..
    } = program;
    Some(match stage {
        Stage::Structure => structure_json(plan, layout, symbols),
        Stage::Graph => graph_json(plan, graph, order.as_ref()?, symbols),
        Stage::Table | Stage::Ast => table_json(tables.as_ref()?),
    })
}

/// A stage of one program as text; `None` if the program did not come that far.
fn text<'a>(
    program: &'a Program,
    stage: Stage,
    form: Form,
    symbols: &'a Symbols,
) -> Option<Box<dyn Display + 'a>> {
    let Program {
        plan,
        layout,
        graph,
        order,
        tables,
        ..
    } = program;
    Some(match (stage, form) {
        (Stage::Structure, Form::Svg) => Box::new(structure_svg(plan, layout, symbols)?),
        (Stage::Structure, _) => Box::new(structure_text(plan, layout)),
        (Stage::Graph, Form::Dot) => Box::new(graph_dot(plan, graph, order.as_ref()?, symbols)),
        (Stage::Graph, _) => Box::new(graph_text(plan, graph, order.as_ref()?, symbols)),
        (Stage::Table | Stage::Ast, _) => Box::new(table_text(tables.as_ref()?)),
    })
}
