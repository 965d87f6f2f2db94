//! The figures of a report.
mod entries;
mod means;
mod origins;
mod survival;
mod sweep;
mod waits;

pub(super) use entries::entries;
pub(super) use means::means;
pub(super) use origins::origins;
pub(super) use survival::{Curve, survival};
pub(super) use sweep::sweep;
pub(super) use waits::{SHOWN, waits};

/// Of every figure.
const WIDTH: f64 = 760.0;

/// A name that fits into `letters`, its middle left out.
fn short(name: &str, letters: usize) -> String {
    let signs: Vec<char> = crate::figures::visible(name).chars().collect();
    if signs.len() <= letters {
        return signs.into_iter().collect();
    }
    let half = letters.saturating_sub(1) / 2;
    let (head, tail) = (&signs[..letters - 1 - half], &signs[signs.len() - half..]);
    head.iter().chain(&['…']).chain(tail).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn long_names_keep_both_ends() {
        assert_eq!(super::short("abcdefghij", 5), "ab…ij");
        assert_eq!(super::short("abcde", 5), "abcde");
    }
}
