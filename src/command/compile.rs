//! `stochc compile`.
use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::Value;
use stochc_compiler::emit::{built_structure, structure_json, structure_stl, structure_text};
use stochc_compiler::{Checked, Program, Symbols};
use stochc_files::atomic::{Draft, Replaces};
use stochc_files::programs::is_executable;
use stochc_ir::emit::{graph_dot, graph_json, graph_text, table_json, table_text};
use stochc_ir::graph::EventGraph;
use stochc_ir::{Executable, Json};
use stochc_report::figures::structure;
use stochc_results::EnsembleProgram;

use super::firmware::{self, MemoryOptions};
use super::run_options::JsonOption;
use super::source_options::SourceOptions;
use super::terminal::{has_colour, message_width, print_with, warn_drawn};
use crate::diagnostics::drawn;
use crate::exit::{Exit, Failure};
use crate::operations::chosen_run::index;
use crate::operations::jani::to_jani;
use crate::operations::json::FORMAT;
use crate::operations::programs::{is_readable, nothing_to_run, verdict};
use crate::source_settings::UnusedValues;

/// Arguments of `compile`.
#[derive(Debug, Args)]
pub struct CompileArguments {
    /// Program to compile
    #[arg(value_name = "FILE")]
    file: String,
    /// Result to print
    #[arg(long, value_name = "STAGE", default_value = "table")]
    emit: EmittedStage,
    /// Output format. An executable is always JSON [default: text]
    #[arg(long, value_name = "FORMAT", conflicts_with = "json")]
    format: Option<EmittedFormat>,
    #[command(flatten)]
    output: JsonOption,
    /// Print only this program of the file. Needed for a picture if the file contains several programs
    #[arg(long, value_name = "NAME")]
    program: Option<String>,
    /// File for the output [default: print it], or folder for firmware
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    memory: MemoryOptions,
    #[command(flatten)]
    source: SourceOptions,
}

/// A stage of the compilation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EmittedStage {
    /// Structure: the blocks at the end of each phase
    Structure,
    /// Dependency graph: the events that each event waits for
    Graph,
    /// Event table of each block
    Table,
    /// Compiled programs in one file, which `simulate` runs without the source
    Executable,
    /// Firmware in C for the blocks of one program, in a folder
    Firmware,
    /// Rate model of one program as a Markov chain, for model checkers
    Jani,
}

/// An output format of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EmittedFormat {
    /// Text for the terminal
    Text,
    /// JSON
    Json,
    /// Dependency graph in the format of Graphviz
    Dot,
    /// Picture of the structure
    Svg,
    /// Surface of the final structure in millimetres, for CAD programs and 3D printers
    Stl,
}

/// Compiles a file and prints the result of one stage.
pub fn run(options: &CompileArguments) -> Result<Exit, Failure> {
    let given = if options.output.json {
        Some(EmittedFormat::Json)
    } else {
        options.format
    };
    let is_executable_wanted = options.emit == EmittedStage::Executable;
    let form = given.unwrap_or(if is_executable_wanted {
        EmittedFormat::Json
    } else {
        EmittedFormat::Text
    });
    if is_executable_wanted && form == EmittedFormat::Text {
        return Err(Failure::usage(
            "`--emit executable` is JSON, and has no `--format text`",
        ));
    }
    let is_firmware_wanted = options.emit == EmittedStage::Firmware;
    if is_firmware_wanted && given.is_some() {
        return Err(Failure::usage("`--emit firmware` has no `--format`"));
    }
    let is_jani_wanted = options.emit == EmittedStage::Jani;
    if is_jani_wanted && given.is_some() {
        return Err(Failure::usage("`--emit jani` has no `--format`"));
    }
    options.memory.only_for_firmware(is_firmware_wanted)?;
    let picture = match form {
        EmittedFormat::Dot => Some(("dot", EmittedStage::Graph, "graph")),
        EmittedFormat::Svg => Some(("svg", EmittedStage::Structure, "structure")),
        EmittedFormat::Stl => Some(("stl", EmittedStage::Structure, "structure")),
        EmittedFormat::Text | EmittedFormat::Json => None,
    };
    if let Some((form, stage, name)) = picture
        && stage != options.emit
    {
        return Err(Failure::usage(format!(
            "`--format {form}` is for `--emit {name}` only"
        )));
    }
    is_readable(&options.file)?;
    let source = options.source.settings();
    let mut checked = crate::check_source(&options.file, &source);
    warn_drawn(&drawn(&checked, has_colour(), message_width()));
    if checked.has_errors() {
        return Ok(verdict(&checked));
    }
    UnusedValues::check_used_by(&source, &checked.programs)?;
    let stage = options.emit;
    let is_of_one = is_firmware_wanted || is_jani_wanted;
    if (stage == EmittedStage::Executable || is_of_one) && checked.programs.is_empty() {
        return Err(nothing_to_run(&options.file, &checked));
    }
    if is_of_one {
        only(&mut checked.programs, options.program.as_deref()).map_err(Failure::usage)?;
    }
    if is_firmware_wanted {
        let tables = checked.programs.first().and_then(|it| it.tables.as_ref());
        let Some(tables) = tables else {
            return Err(nothing_to_run(&options.file, &checked));
        };
        return firmware::write(tables, options.out.as_deref(), &options.memory);
    }
    if is_jani_wanted {
        let chain = chain(checked.programs.swap_remove(0))?;
        return put(options.out.as_deref(), Replaces::Nothing, |out| {
            serde_json::to_writer_pretty(&mut *out, &chain)?;
            writeln!(out)
        });
    }
    choose(&mut checked.programs, options.program.as_deref(), form).map_err(Failure::usage)?;
    // Only executables have a mark of stochc. The output of other stages never replaces a file.
    let replaces = match stage {
        EmittedStage::Executable => Replaces::Ours(is_executable),
        _ => Replaces::Nothing,
    };
    put(options.out.as_deref(), replaces, |out| {
        emit(checked, stage, form, out)
    })
}

/// Returns the rate model of a program as JANI.
fn chain(program: Program) -> Result<Value, Failure> {
    let name = program.plan.name.to_string();
    let claims = program.claims.clone();
    let executable = (program.into_executable())
        .ok_or_else(|| Failure::usage(format!("`{name}` cannot be executed")))?;
    let mut entry = EnsembleProgram::new(&name, Vec::new(), executable);
    entry.claims = claims;
    to_jani(&entry)
}

/// Prints a result, or writes it to a file.
fn put(
    path: Option<&Path>,
    replaces: Replaces,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<Exit, Failure> {
    let Some(path) = path else {
        print_with(write)?;
        return Ok(Exit::Success);
    };
    let written = Draft::new(path, replaces).and_then(|mut file| {
        write(&mut file)?;
        file.keep()
    });
    match written {
        Ok(()) => Ok(Exit::Success),
        Err(error) => Err(Failure::not_written(path, error)),
    }
}

/// Error message if a picture of an aggregate is requested.
const NO_PICTURE: &str = "an aggregate has no picture, because it grows at random";

/// Keeps only the programs to print. A picture shows one program, which must not be an aggregate.
fn choose(
    programs: &mut Vec<Program>,
    name: Option<&str>,
    form: EmittedFormat,
) -> Result<(), String> {
    if name.is_some() {
        only(programs, name)?;
    }
    let is_of_one = matches!(form, EmittedFormat::Svg | EmittedFormat::Stl);
    if !is_of_one || programs.is_empty() {
        return Ok(());
    }
    programs.retain(|program| program.plan.aggregate.is_none());
    match programs.len() {
        0 => Err(NO_PICTURE.to_owned()),
        1 => Ok(()),
        _ => only(programs, None)
            .map_err(|error| format!("a picture is of one program, and {error}")),
    }
}

/// Keeps only the program with this name. Without a name, checks that there is only one program.
fn only(programs: &mut Vec<Program>, name: Option<&str>) -> Result<(), String> {
    let names: Vec<_> = programs.iter().map(|it| &*it.plan.name).collect();
    let chosen = index(&names, name, "file")?;
    *programs = vec![programs.swap_remove(chosen)];
    Ok(())
}

fn emit(
    checked: Checked,
    stage: EmittedStage,
    form: EmittedFormat,
    out: &mut dyn Write,
) -> io::Result<()> {
    if stage == EmittedStage::Executable {
        let programs = checked.programs.into_iter();
        let programs: Vec<_> = programs.filter_map(Program::into_executable).collect();
        return Executable::write_all(&programs, out);
    }
    let symbols = &checked.symbols;
    let graph = |program: &Program| (stage == EmittedStage::Graph).then(|| program.event_graph());
    let programs = checked.programs.iter().map(|it| (it, graph(it)));
    let programs: Vec<_> = programs.collect();
    if form == EmittedFormat::Json {
        let programs = || {
            let programs = programs.iter();
            programs.filter_map(|(program, graph)| json(program, graph.as_ref(), stage, symbols))
        };
        return document(Json::list(programs), out);
    }
    let texts = programs
        .iter()
        .filter_map(|(program, graph)| text(program, graph.as_ref(), stage, form, symbols));
    for (i, text) in texts.enumerate() {
        write!(out, "{}{text}", if i == 0 { "" } else { "\n" })?;
    }
    Ok(())
}

/// Writes a JSON document piece by piece, so that the whole document is never in memory.
fn document(programs: Json<'_>, out: &mut dyn Write) -> io::Result<()> {
    let document = Json::object([("format", FORMAT.into()), ("programs", programs)]);
    serde_json::to_writer_pretty(&mut *out, &document)?;
    writeln!(out)
}

/// Returns a stage of one program as JSON. Returns `None` if errors prevent this stage.
fn json<'a>(
    program: &'a Program,
    graph: Option<&'a EventGraph>,
    stage: EmittedStage,
    symbols: &'a Symbols,
) -> Option<Json<'a>> {
    let tables = program.tables.as_ref();
    Some(match stage {
        EmittedStage::Structure => structure_json(&program.plan, &program.layout, symbols),
        EmittedStage::Graph => graph_json(graph?, tables?),
        EmittedStage::Table
        | EmittedStage::Executable
        | EmittedStage::Firmware
        | EmittedStage::Jani => table_json(tables?),
    })
}

/// Returns a stage of one program as text. Returns `None` if errors prevent this stage.
fn text<'a>(
    program: &'a Program,
    graph: Option<&'a EventGraph>,
    stage: EmittedStage,
    form: EmittedFormat,
    symbols: &'a Symbols,
) -> Option<Box<dyn Display + 'a>> {
    let (plan, layout, tables) = (&program.plan, &program.layout, program.tables.as_ref());
    Some(match (stage, form) {
        (EmittedStage::Structure, EmittedFormat::Svg) => {
            let built = built_structure(plan, layout, symbols)?;
            Box::new(structure(&built).file())
        }
        (EmittedStage::Structure, EmittedFormat::Stl) => {
            let millimetres = program.scene.as_ref()?.block.side * 1000.0;
            Box::new(structure_stl(plan, layout, millimetres))
        }
        (EmittedStage::Structure, _) => Box::new(structure_text(plan, layout)),
        (EmittedStage::Graph, EmittedFormat::Dot) => Box::new(graph_dot(graph?, tables?)),
        (EmittedStage::Graph, _) => Box::new(graph_text(graph?, tables?)),
        (
            EmittedStage::Table
            | EmittedStage::Executable
            | EmittedStage::Firmware
            | EmittedStage::Jani,
            _,
        ) => Box::new(table_text(tables?)),
    })
}
