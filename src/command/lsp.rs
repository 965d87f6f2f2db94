//! `stochc lsp`.
use clap::Args;

use crate::exit::{Exit, Failure};

/// What `lsp` is given.
#[derive(Debug, Args)]
pub struct LspArguments {
    /// Speak over the standard input and output, as always
    #[arg(long, hide = true)]
    stdio: bool,
}

/// Serves an editor until it says goodbye.
pub fn run(_: &LspArguments) -> Result<Exit, Failure> {
    let served = stochc_lsp::serve(std::io::stdin(), std::io::stdout().lock());
    let served =
        served.map_err(|error| Failure::usage(format!("cannot listen to the editor: {error}")))?;
    // The protocol: 0 after `shutdown`, else 1.
    Ok(if served {
        Exit::Success
    } else {
        Exit::InvalidProgram
    })
}
