//! `stochc check --fix`.
use stochc_files::programs::STDIN_NAME;
use stochc_text::{counted, visible};

use super::super::terminal::{has_colour, message_width, print, warn, warn_drawn};
use super::arguments::CheckArguments;
use crate::SourceSettings;
use crate::diagnostics::{Format, drawn};
use crate::exit::{Exit, Failure};
use crate::fix::{FixedFile, fix};
use crate::operations::programs::verdict;

/// Applies the safe fixes of a file and prints them as a diff. Returns the exit status if `check`
/// has nothing more to do.
///
/// Standard input cannot be changed. The fixed source is printed instead, and also returned in
/// `text`.
pub fn run(
    file: &str,
    options: &CheckArguments,
    source: &SourceSettings,
    exit: &mut Exit,
    text: &mut Option<Vec<u8>>,
) -> Result<Option<Exit>, Failure> {
    // The check that follows reports files that cannot be read.
    let Ok(fixed) = fix(file, source) else {
        return Ok(None);
    };
    let shown = visible(file);
    let alone = options.format() == Format::Graphical;
    if file == STDIN_NAME && !options.dry_run {
        print(&String::from_utf8_lossy(&fixed.new))?;
        warn(&match fixed.changes {
            0 => String::new(),
            changes => format!("{shown}: {} made\n", counted(changes, "change")),
        });
        *text = Some(fixed.new);
        return Ok(None);
    }
    let diff = fixed.diff();
    // The diff goes to standard output only if there is no other output.
    if alone {
        print(&diff)?;
    } else {
        // This diff is not meant for `patch`, so line ends do not matter.
        warn(&diff.replace("\r\n", "\n"));
    }
    let changes = counted(fixed.changes, "change");
    if options.dry_run {
        warn(&format!("{shown}: {changes} to make\n"));
        if !alone {
            return Ok(None);
        }
        let remaining = fixed.after.as_ref().unwrap_or(&fixed.before);
        warn_drawn(&drawn(remaining, has_colour(), message_width()));
        return Ok(Some(verdict(&fixed.before)));
    }
    if fixed.changes == 0 {
        return Ok(None);
    }
    match write(&fixed) {
        Ok(()) => warn(&format!("{shown}: {changes} made\n")),
        Err(reason) => {
            warn(&format!("error: `{shown}` is left as it is: {reason}\n"));
            *exit = exit.or_worse(Exit::Usage);
        }
    }
    Ok(None)
}

fn write(fixed: &FixedFile) -> Result<(), String> {
    match fixed.write() {
        Ok(true) => Ok(()),
        Ok(false) => Err("it has changed while it was checked; try again".to_owned()),
        Err(error) => Err(error.to_string()),
    }
}
