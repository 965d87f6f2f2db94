//! Summary of a check without errors, as text.
use stochc_compiler::diagnostic::Diagnostic;
use stochc_compiler::{Checked, Program};
use stochc_text::counted;

/// Returns text lines about program `number`: its size, its number of warnings and the result of
/// its proof.
pub fn status_lines(checked: &Checked, number: usize) -> String {
    let program = &checked.programs[number];
    let proof = match checked.proof(number) {
        Some(proof) => proof.to_string(),
        None => "not proved: chance decides what an aggregate builds\n".to_owned(),
    };
    let warnings = warnings(checked, |it| it.programs.contains(&number));
    let warnings = warnings.map_or_else(String::new, |it| format!(", {it}"));
    let mut lines = format!("{}: {}{warnings}\n", program.plan.name, size(program));
    for line in proof.lines() {
        lines += &format!("  {line}\n");
    }
    lines
}

/// Returns the number of warnings that `part` selects, as text. Returns `None` if it selects none.
pub fn warnings(checked: &Checked, part: impl Fn(&Diagnostic) -> bool) -> Option<String> {
    let reported = checked.diagnostics.iter().filter(|it| part(it)).count();
    let allowed = checked.allowed.iter();
    let allowed = allowed.filter(|it| part(&it.diagnostic)).count();
    match (reported, allowed) {
        (0, 0) => None,
        (reported, 0) => Some(counted(reported, "warning")),
        (0, allowed) => Some(format!("{} allowed", counted(allowed, "warning"))),
        (reported, allowed) => Some(format!(
            "{}, {allowed} allowed",
            counted(reported, "warning")
        )),
    }
}

/// Returns the size of a program as text, such as `13 captures in 1 phase`.
fn size(program: &Program) -> String {
    let plan = &program.plan;
    if let Some(size) = plan.aggregate {
        let free = program.scene.as_ref().map_or(0, |scene| scene.free.count);
        return format!("an aggregate of {size} of {free} free blocks");
    }
    let pre_attached = plan.pre_attached();
    let (captures, releases) = plan.counts();
    let phases = plan
        .phases
        .iter()
        .filter(|phase| !phase.pre_attached)
        .count();
    let mut size = counted(captures - pre_attached, "capture");
    if releases > 0 {
        size = format!("{size} and {}", counted(releases, "release"));
    }
    size = format!("{size} in {}", counted(phases, "phase"));
    match pre_attached {
        0 => size,
        blocks => format!("{}, {size}", counted(blocks, "pre-attached block")),
    }
}
