//! What planning anew gains, as text.
use stochc_ensemble::Time;
use stochc_ensemble::statistics::Longer;

use super::comparison::{in_ticks, ticks};
use crate::replanning::Replanning;
use crate::text::{TextColumn, TextTable, paragraph};

/// A column for each program; `width` is that of the terminal, in characters.
pub fn replanning_to_text(results: &[Replanning], width: usize) -> String {
    let labels = [
        "Runs",
        "Plans made",
        "Completed as they are",
        "Completed with plans",
        "Mean as they are",
        "Mean with plans",
        "Gained",
    ];
    let mean = |time: &Option<Time>| {
        time.as_ref()
            .map_or("-".to_owned(), |time| in_ticks(time, ""))
    };
    let completed =
        |time: &Option<Time>| time.as_ref().map_or(0, |time| time.completed).to_string();
    let columns = results.iter().map(|it| {
        let gained = it.difference.as_ref().map_or("-".to_owned(), |it| {
            format!("{} ± {}", ticks(it.difference), ticks(it.half_width))
        });
        TextColumn::figures(
            it.program.clone(),
            vec![
                it.runs.to_string(),
                it.plans.to_string(),
                completed(&it.plain),
                completed(&it.replanned),
                mean(&it.plain),
                mean(&it.replanned),
                gained,
            ],
        )
    });
    let table = TextTable {
        labels: labels.map(str::to_owned).to_vec(),
        columns: columns.collect(),
        ..TextTable::default()
    };
    let mut text = table.text(width, false);
    text.push('\n');
    for it in results {
        text += &paragraph(&sentence(it), width);
    }
    text += &paragraph(
        "Times in ticks; ± is half of a 95 % interval, of the mean of the differences run by run. Planning takes no time of the \
         robots, and after each plan the free blocks begin at rest again, at places of their own.",
        width,
    );
    text
}

fn sentence(it: &Replanning) -> String {
    let what = match it.difference.as_ref().map(|it| it.longer) {
        _ if it.plans == 0 && it.not_planned == 0 => {
            return format!(
                "{}: no run waited for {} ticks, so that nothing was planned anew.",
                it.program, it.after
            );
        }
        _ if it.plans == 0 => "nothing was planned anew",
        // A plan that does less proves nothing.
        _ if it.releases > 0 => {
            "whether planning the rest anew pays is not said, because a plan captures nothing that the program lets go again,"
        }
        Some(Longer::First) => "planning the rest anew pays",
        Some(Longer::Second) => "planning the rest anew costs time",
        Some(Longer::NotSignificant) | None => "the difference is not significant",
    };
    let left = match it.not_planned {
        0 => String::new(),
        1 => "; the rest of one run could not be planned, and it went on as it was".to_owned(),
        count => format!(
            "; the rest of {count} runs could not be planned, and they went on as they were"
        ),
    };
    format!(
        "{}: {what} after {} ticks in which nothing docks{left}.",
        it.program, it.after
    )
}
