//! `stochc explain`.
use clap::Args;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use console::style;
use stochc_compiler::diagnostic::{Code, Severity};

use super::terminal::{
    WIDTH, output_has_colour, output_is_watched, output_width, print, print_drawn, wrapped,
};
use crate::exit::{Exit, Failure};
use crate::operations::codes::explain;

/// Arguments of `explain`.
#[derive(Debug, Args)]
pub struct ExplainArguments {
    /// Code of an error or a warning, such as `cycle` [default: list all codes]
    #[arg(value_parser = CodeParser, hide_possible_values = true)]
    code: Option<String>,
}

/// Prints the page about a diagnostic code, or the list of all codes.
pub fn run(options: &ExplainArguments) -> Result<Exit, Failure> {
    let width = output_width().min(WIDTH);
    match &options.code {
        None => print(&list(width))?,
        Some(name) => {
            let page = explain(&name.to_lowercase()).map_err(Failure::usage)?;
            if output_is_watched() {
                print_drawn(&rendered(page, width, output_has_colour()))?;
            } else {
                print(page)?;
            }
        }
    }
    Ok(Exit::Success)
}

/// Lists all codes by topic.
fn list(width: usize) -> String {
    let mut text = String::new();
    for (topic, codes) in Code::TOPICS {
        text += &format!("{topic}\n");
        for code in *codes {
            let warning = match code.severity() {
                Severity::Error => "",
                Severity::Warning => "warning: ",
            };
            let name = format!("  {:20} ", code.name());
            text += &wrapped(&format!("{warning}{}", code.meaning()), &name, width);
        }
        text += "\n";
    }
    text + "stochc explain CODE explains one of them.\n"
}

/// Renders a page for a terminal: wrapped text, and programs without code fences.
fn rendered(page: &str, width: usize, has_colour: bool) -> String {
    let (mut out, mut paragraph, mut in_program) = (String::new(), String::new(), false);
    let heading = |text: &str| style(text).bold().force_styling(has_colour).to_string() + "\n";
    for line in page.lines() {
        let is_fence = line.starts_with("```");
        if in_program && !is_fence {
            out += &format!("    {line}\n");
            continue;
        }
        if is_fence || line.is_empty() || line.starts_with(['#', '|', '-']) {
            if !paragraph.is_empty() {
                out += &wrapped(&paragraph, "", width);
                paragraph.clear();
            }
            match line.trim_start_matches('#').trim_start() {
                _ if is_fence => in_program = !in_program,
                "" => out.push('\n'),
                text if line.starts_with('#') => out += &heading(text),
                text if line.starts_with('-') => paragraph += text,
                text => out += &format!("{text}\n"),
            }
        } else {
            paragraph += &format!(" {line}");
        }
    }
    if !paragraph.is_empty() {
        out += &wrapped(&paragraph, "", width);
    }
    out
}

/// Parser that accepts any word as a code and offers all codes to the shell for completion.
#[derive(Clone)]
struct CodeParser;

impl TypedValueParser for CodeParser {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let codes = Code::ALL.iter();
        Some(Box::new(codes.map(|code| PossibleValue::new(code.name()))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_fit_a_terminal() {
        for code in Code::ALL {
            let text = rendered(code.page(), WIDTH, false);
            assert!(!text.contains("```"), "{code}");
            let mut lines = text.lines().filter(|line| !line.starts_with("    "));
            assert!(lines.all(|line| line.chars().count() <= WIDTH), "{text}");
        }
        let text = list(WIDTH);
        assert!(
            text.lines().all(|line| line.chars().count() <= WIDTH),
            "{text}"
        );
    }
}
