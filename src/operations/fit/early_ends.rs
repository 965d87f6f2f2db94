//! Reasons why simulated runs end before their times are known.
use stochc_experiments::OutcomeCounts;

/// Returns the most frequent reason why runs or attempts at phases ended early, with a way out.
/// Returns `None` if none ended early.
pub(super) fn reason<'a>(ends: impl Iterator<Item = &'a OutcomeCounts>) -> Option<&'static str> {
    let [mut timed_out, mut censored, mut broken, mut invalid] = [0; 4];
    for it in ends {
        timed_out += it.timed_out;
        censored += it.censored;
        broken += it.broken;
        invalid += it.invalid;
    }
    let reasons = [
        (
            invalid,
            "their physics fails; narrow the ranges, or raise `--substeps`",
        ),
        (
            broken,
            "a bond breaks; narrow the ranges, or raise `bond.strength`",
        ),
        (
            timed_out,
            "a phase reaches its `timeout`; raise it, or narrow the ranges",
        ),
        (
            censored,
            "they reach `--max-ticks`; raise it, or narrow the ranges",
        ),
    ];
    let reasons = reasons.into_iter().filter(|(ends, _)| *ends > 0);
    Some(reasons.max_by_key(|(ends, _)| *ends)?.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_frequent_reason_is_named() {
        let none = OutcomeCounts {
            completed: 9,
            ..OutcomeCounts::default()
        };
        assert_eq!(reason([none].iter()), None);
        let some = OutcomeCounts {
            timed_out: 2,
            censored: 3,
            ..none
        };
        let other = OutcomeCounts {
            broken: 4,
            timed_out: 3,
            ..none
        };
        let named = |ends: &[OutcomeCounts]| reason(ends.iter()).unwrap();
        assert!(named(&[some]).contains("`--max-ticks`"));
        assert!(named(&[some, other]).contains("`timeout`"));
        assert!(named(&[other]).contains("`bond.strength`"));
    }
}
