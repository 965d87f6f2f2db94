//! Options for the size and format of figures.
use clap::{Args, ValueEnum};
use stochc_report::figures::{FigureFormat, Figures, Medium};

/// Size and file formats of figures.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct FigureOptions {
    /// Make figures for print, with 7 pt type and this width, such as `89mm`. The width is 80 to 300 mm
    /// [default: figures for a screen]
    #[arg(long, value_name = "WIDTH")]
    figure_width: Option<Medium>,
    /// File format of the figures. Separate several formats by commas
    #[arg(
        long,
        value_name = "FORMAT",
        value_delimiter = ',',
        default_value = "svg"
    )]
    figure_format: Vec<FigureForm>,
}

/// A file format of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FigureForm {
    /// Format for browsers and drawing programs
    Svg,
    /// Format for papers, with embedded fonts
    Pdf,
}

impl FigureOptions {
    /// Returns the size and formats of figures that the options choose.
    pub fn figures(&self) -> Figures {
        let mut formats = Vec::new();
        for form in &self.figure_format {
            let format = match form {
                FigureForm::Svg => FigureFormat::Svg,
                FigureForm::Pdf => FigureFormat::Pdf,
            };
            if !formats.contains(&format) {
                formats.push(format);
            }
        }
        Figures {
            medium: self.figure_width.unwrap_or_default(),
            formats,
            ..Figures::default()
        }
    }
}
