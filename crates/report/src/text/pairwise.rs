//! Sentences about the test of two programs.
use stochc_experiments::PairwiseResult;
use stochc_experiments::statistics::{Difference, Longer, SIGNIFICANT, Test};
use stochc_text::number;

/// Returns a sentence about the result of testing two programs for a difference in time.
///
/// `pairs` is the number of pairs that were tested together.
pub fn sentence(names: [&str; 2], verdict: &PairwiseResult, unit: &str, pairs: usize) -> String {
    let [first, second] = names;
    let found = match verdict {
        PairwiseResult::Same => return format!("{first} and {second} are the same runs."),
        PairwiseResult::Repeated => {
            return format!("{first} and {second} repeat the runs of another pair.");
        }
        PairwiseResult::Equal => {
            return format!(
                "{first} and {second} are the same runs: every run takes the same time."
            );
        }
        PairwiseResult::Unknown => {
            return format!(
                "{first} and {second}: not compared; there are too few runs, or no spread."
            );
        }
        PairwiseResult::Known(found) => found,
    };
    let conclusion = match found.longer {
        Longer::First => format!("{first} takes longer"),
        Longer::Second => format!("{second} takes longer"),
        Longer::NotSignificant => "not significant".to_owned(),
    };
    let needed = match (found.longer, found.runs_for_5_percent) {
        (Longer::NotSignificant, Some(runs)) => format!(
            " A difference of 5~% would need {}~runs of each (power 80~%).",
            number(runs as f64)
        ),
        _ => String::new(),
    };
    format!(
        "{first}~- {second}: {}~±~{}~{unit}, {}, {}: {conclusion}.{needed}",
        number(found.difference),
        number(found.half_width),
        p_values(found, pairs),
        method(found, unit),
    )
}

/// Returns the p-value as text, such as `p = 0.03`. For several pairs, the corrected p-value
/// follows.
fn p_values(found: &Difference, pairs: usize) -> String {
    let text = |p: f64| match probability(p) {
        p if p.starts_with('<') => format!("p~{}", p.replace(' ', "~")),
        p => format!("p~=~{p}"),
    };
    match pairs {
        0 | 1 => text(found.p),
        _ => format!(
            "{} (of~{pairs} pairs {})",
            text(found.p),
            text(found.p_holm)
        ),
    }
}

/// Returns the name of the statistical test.
pub fn method(found: &Difference, unit: &str) -> String {
    let test = match found.test {
        Test::Paired { pairs } => format!("paired t test of {pairs} runs"),
        Test::Welch { .. } => "Welch's t test".to_owned(),
    };
    match found.horizon {
        Some(horizon) => format!("{test}, times to {} {unit}", number(horizon)),
        None => test,
    }
}

/// Returns a probability as text. Rounding never moves the probability across [`SIGNIFICANT`].
pub fn probability(p: f64) -> String {
    // Values that would round to the limit get more digits.
    if (0.0495..SIGNIFICANT).contains(&p) {
        let digits = (4..).map(|digits| format!("{p:.digits$}"));
        let mut below =
            digits.filter(|text| text.parse().is_ok_and(|text: f64| text < SIGNIFICANT));
        return below.next().expect("enough digits give the exact value");
    }
    match p {
        p if p < 1e-4 => "< 0.0001".to_owned(),
        p if p < 0.01 => format!("{p:.4}"),
        p if p < 0.1 => format!("{p:.3}"),
        p => format!("{p:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::probability;

    #[test]
    fn p_values_below_the_limit_are_printed_below_it() {
        for (p, expected) in [
            (0.0497, "0.0497"),
            (0.04999, "0.04999"),
            (0.05, "0.050"),
            (0.0503, "0.050"),
            (0.0494, "0.049"),
            (0.00004, "< 0.0001"),
            (0.5, "0.50"),
        ] {
            assert_eq!(probability(p), expected);
        }
    }
}
