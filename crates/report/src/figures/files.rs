//! Figures as files.
use std::io;
use std::str::FromStr;

use super::{Drawing, Medium};
use crate::presentation::Presentation;

/// A form of a figure in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FigureFormat {
    /// For browsers and drawing programs.
    #[default]
    Svg,
    /// For papers, with its font.
    Pdf,
}

impl FromStr for FigureFormat {
    type Err = String;

    fn from_str(text: &str) -> Result<FigureFormat, String> {
        match text {
            "svg" => Ok(FigureFormat::Svg),
            "pdf" => Ok(FigureFormat::Pdf),
            _ => Err("give `svg` or `pdf`".to_owned()),
        }
    }
}

/// What figures in files are like; those on the page of a report are for a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// What they are laid out for.
    pub medium: Medium,
    /// The forms in which each is written, one at least.
    pub formats: Vec<FigureFormat>,
    /// How they show programs and times.
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
    /// The names of the files of a figure.
    pub(crate) fn names(&self, figure: &Drawing) -> Vec<String> {
        let names = self.formats.iter().map(|format| match format {
            FigureFormat::Svg => format!("{}.svg", figure.name),
            FigureFormat::Pdf => format!("{}.pdf", figure.name),
        });
        names.collect()
    }

    /// The files of a figure that was drawn for the same [`Medium`]: names and contents.
    ///
    /// # Errors
    /// Those of [`Drawing::pdf`].
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
