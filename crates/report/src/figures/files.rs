//! Export of figures to files.
use std::io;
use std::str::FromStr;

use super::{Drawing, Medium};
use crate::presentation::Presentation;

/// File format of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FigureFormat {
    /// SVG, for browsers and drawing programs.
    #[default]
    Svg,
    /// PDF, for papers, with an embedded font.
    Pdf,
}

/// Error of an unknown file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("give `svg` or `pdf`")]
pub struct UnknownFormat;

impl FromStr for FigureFormat {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<FigureFormat, UnknownFormat> {
        match text {
            "svg" => Ok(FigureFormat::Svg),
            "pdf" => Ok(FigureFormat::Pdf),
            _ => Err(UnknownFormat),
        }
    }
}

/// Options of figures in files. The figures on the page of a report are always for a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Medium of the layout.
    pub medium: Medium,
    /// File formats, at least one.
    pub formats: Vec<FigureFormat>,
    /// Presentation of programs and times.
    pub presentation: Presentation,
}

impl Default for Figures {
    fn default() -> Figures {
        Figures {
            medium: Medium::default(),
            formats: vec![FigureFormat::default()],
            presentation: Presentation::default(),
        }
    }
}

impl Figures {
    /// Returns the names of the files of a figure.
    pub(crate) fn names(&self, figure: &Drawing) -> Vec<String> {
        let names = self.formats.iter().map(|format| match format {
            FigureFormat::Svg => format!("{}.svg", figure.name),
            FigureFormat::Pdf => format!("{}.pdf", figure.name),
        });
        names.collect()
    }

    /// Returns the names and contents of the files of a figure drawn for the same [`Medium`].
    ///
    /// # Errors
    ///
    /// Errors of [`Drawing::pdf`].
    pub fn files(&self, figure: &Drawing) -> io::Result<Vec<(String, Vec<u8>)>> {
        let contents = self.formats.iter().map(|format| match format {
            FigureFormat::Svg => Ok(figure.file().into_bytes()),
            FigureFormat::Pdf => figure.pdf(),
        });
        let names = self.names(figure).into_iter();
        names
            .zip(contents)
            .map(|(name, it)| Ok((name, it?)))
            .collect()
    }
}
