//! What came of ensembles, as one page to read and a folder of figures and tables.
//!
//! The road: [`Input`]s, which somebody has read from results folders, become *subjects*
//! (`subject.rs`: a program of a folder with its runs), each event of a run gets its moments and
//! the run the chain that decided it (`chain.rs`); `waits.rs`, `contrast.rs` and `sweep.rs` sum them
//! up; `picture/` and `data.rs` write them down; `page.rs` puts the page together. All of it is a
//! pure function of the inputs. `docs/report.md` says what each figure shows.
mod chain;
mod contrast;
mod data;
mod events;
mod html;
mod page;
mod picture;
mod shell;
mod story;
mod subject;
mod sweep;
mod waits;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

use crate::ensemble::Clock;
use crate::figures::Drawing;

pub(crate) use shell::file as shell_file;
pub use subject::Input;

/// The first line of every report, by which one is told from other people's files.
pub const MARK: &str = "<!DOCTYPE html><!-- stochc report -->";

/// A report, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The page, in HTML: complete in itself, and without any script.
    pub page: String,
    /// Figures (SVG) and their data (CSV), by the name of the file.
    pub files: Vec<(String, String)>,
}

/// What a report needs to know about the place that it is written to.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The name of the folder of figures and tables, which is beside the page.
    pub folder: &'a str,
    /// The address of the replay of a run as seen from the page, from the numbers of its folder, of
    /// its program in there, and its own; `None`: there is none.
    pub replay: &'a dyn Fn(usize, usize, u64) -> Option<String>,
}

/// A relative path as an address: what would end or change it is written in hexadecimal.
pub fn address(path: &str) -> String {
    const KEPT: &AsciiSet = &NON_ALPHANUMERIC
        .remove(b'/')
        .remove(b'-')
        .remove(b'_')
        .remove(b'.')
        .remove(b'~');
    utf8_percent_encode(path, KEPT).to_string()
}

/// Draws up the report of one or several results folders.
pub fn report(inputs: &[Input], surroundings: &Surroundings) -> Report {
    let subjects = subject::subjects(inputs);
    let clock = Clock::of(subjects.iter().map(|subject| subject.program));
    let waits: Vec<_> = subjects.iter().map(waits::waits).collect();
    let contrasts = contrast::contrasts(&subjects, clock);
    let sweeps = sweep::sweeps(inputs, &subjects, clock);
    let mut files = data::files(&subjects, &waits, &contrasts, &sweeps, clock);
    let parts = page::Parts {
        inputs,
        subjects: &subjects,
        clock,
        waits: &waits,
        contrasts: &contrasts,
        sweeps: &sweeps,
        surroundings,
    };
    let mut drawings: Vec<Drawing> = Vec::new();
    let page = page::page(&parts, &mut drawings);
    files.extend(
        drawings
            .iter()
            .map(|it| (format!("{}.svg", it.name), it.file())),
    );
    files.sort();
    Report { page, files }
}
