//! `stochc lsp`.
use clap::Args;

use crate::exit::{Exit, Failure};

/// Arguments of `lsp`.
#[derive(Debug, Args)]
pub struct LspArguments {
    /// Use standard input and output (always on; accepted for editors)
    #[arg(long, hide = true)]
    stdio: bool,
}

/// Serves an editor as a language server until the editor ends the connection.
pub fn run(_: &LspArguments) -> Result<Exit, Failure> {
    let served = stochc_lsp::serve(std::io::stdin(), std::io::stdout().lock());
    let served =
        served.map_err(|error| Failure::usage(format!("cannot listen to the editor: {error}")))?;
    // The protocol requires status 0 after a `shutdown` request, otherwise 1.
    Ok(if served {
        Exit::Success
    } else {
        Exit::InvalidProgram
    })
}
