//! Export of figures to files.
use std::io;
use std::str::FromStr;

use super::{Drawing, Medium};
use crate::presentation::Presentation;

/// File format of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FigureFormat {
    /// SVG, for browsers and drawing applications.
    #[default]
    Svg,
    /// PDF with an embedded font, for papers.
    Pdf,
}

/// Error of parsing a file format.
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

/// Options for figures in files. Figures on the page of a report are always laid out for a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Medium that figures are laid out for.
    pub medium: Medium,
    /// File formats, at least one.
    pub formats: Vec<FigureFormat>,
    /// Names of programs and unit of times.
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

    /// Returns the name and content of each file of a figure. The figure must be drawn for the
    /// [`Medium`] of these options.
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
