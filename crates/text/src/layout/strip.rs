//! Small plots of a share over time for a terminal.
use crate::visible;

/// A share that decreases from 1, with the range of known times.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Name of the plot.
    pub name: String,
    /// Times of decreases, with the share after each, in order.
    pub steps: Vec<(f64, f64)>,
    /// Last known time.
    pub last: f64,
}

impl Strip {
    fn at(&self, time: f64) -> Option<f64> {
        let passed = self.steps.partition_point(|step| step.0 <= time);
        let share = passed.checked_sub(1).map_or(1.0, |i| self.steps[i].1);
        // A share of 0 stays 0.
        (time <= self.last || share == 0.0).then_some(share)
    }
}

/// Blocks by eighths of the height.
const EIGHTHS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// Draws shares one below the other over a common time axis, in `width` columns. Unknown times are
/// shown as `?`. Returns no text without shares.
///
/// `unit` is the unit of the times.
pub fn strips(strips: &[Strip], width: usize, unit: &str) -> String {
    /// Columns of the axis at the left.
    const AXIS: usize = 6;
    let end = strips.iter().map(|strip| strip.last).fold(0.0, f64::max);
    if strips.is_empty() || end <= 0.0 {
        return String::new();
    }
    let height = if strips.len() == 1 { 5 } else { 3 };
    let columns = width.saturating_sub(AXIS + 1).clamp(10, 72);
    let mut out = String::new();
    for strip in strips {
        let name = visible(&strip.name);
        out += &format!("{name}: runs that are not complete yet\n");
        let shares: Vec<_> = (0..columns)
            .map(|i| strip.at(end * (i as f64 + 0.5) / columns as f64))
            .collect();
        for row in 0..height {
            let label = match row {
                0 => "100 %",
                _ if row == height - 1 => "  0 %",
                _ => "",
            };
            let mut line = format!("{label:>5} ");
            for share in &shares {
                line.push(match share {
                    Some(share) => sign(*share, height - 1 - row, height),
                    None if row == height - 1 => '?',
                    None => ' ',
                });
            }
            out += line.trim_end();
            out.push('\n');
        }
    }
    let last = format!("{} {unit}", crate::number(end));
    let room = columns.saturating_sub(1);
    out += &format!("{:AXIS$}0{last:>room$}\n", "");
    out
}

/// Returns the character of a share in row `row`, counted from below, of `height` rows.
fn sign(share: f64, row: usize, height: usize) -> char {
    let eighths = (share * (8 * height) as f64).round() as usize;
    // A positive share is always visible.
    let eighths = if share > 0.0 { eighths.max(1) } else { 0 };
    EIGHTHS[eighths.saturating_sub(8 * row).min(8)]
}

#[cfg(test)]
mod tests {
    use insta::assert_snapshot;

    use super::*;

    fn strip(name: &str, steps: &[(f64, f64)], last: f64) -> Strip {
        Strip {
            name: name.into(),
            steps: steps.to_vec(),
            last,
        }
    }

    #[test]
    fn one_strip_has_five_lines() {
        let falls = strip(
            "tower",
            &[(250.0, 0.5), (500.0, 0.25), (750.0, 0.0)],
            1000.0,
        );
        assert_snapshot!(strips(&[falls], 27, "ticks"));
    }

    #[test]
    fn two_strips_share_an_axis_and_tell_what_is_unknown() {
        let all = strip("all", &[(100.0, 0.5), (200.0, 0.0)], 200.0);
        let censored = strip("censored", &[(100.0, 0.9)], 400.0);
        let short = strip("short", &[(100.0, 0.9)], 200.0);
        assert_snapshot!(strips(&[all, censored, short], 27, "ticks"));
    }

    #[test]
    fn nothing_to_draw_is_no_text() {
        assert_eq!(strips(&[], 80, "ticks"), "");
        assert_eq!(strips(&[strip("none", &[], 0.0)], 80, "ticks"), "");
    }
}
