//! Minimum of many numbers that change one at a time.
use serde::{Deserialize, Serialize};

/// Tournament tree of numbers in places from 0.
///
/// # Source
///
/// D. E. Knuth, The Art of Computer Programming 3 (1973), section 5.2.3.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Tournament {
    /// The second half are the numbers. Entry i before it is the minimum of entries 2 i and 2 i +
    /// 1.
    winners: Vec<u128>,
}

/// Value of an empty place.
pub(super) const NONE: u128 = u128::MAX;

impl Tournament {
    /// Returns the number in a place.
    pub fn get(&self, place: usize) -> u128 {
        let number = self.winners.get(self.places() + place);
        number.copied().unwrap_or(NONE)
    }

    /// Puts a number, or [`NONE`], into a place.
    pub fn set(&mut self, place: usize, number: u128) {
        if place >= self.places() {
            self.grow(place + 1);
        }
        let mut at = self.places() + place;
        self.winners[at] = number;
        while at > 1 {
            // Unpredictable, therefore without a branch.
            let is_other = self.winners[at ^ 1] < self.winners[at];
            let winner = self.winners[at ^ usize::from(is_other)];
            at /= 2;
            if self.winners[at] == winner {
                break;
            }
            self.winners[at] = winner;
        }
    }

    /// Returns the minimum.
    pub fn first(&self) -> u128 {
        self.winners.get(1).copied().unwrap_or(NONE)
    }

    /// Returns the minimum without place `first`, which must hold the overall minimum.
    pub fn second(&self, first: usize) -> u128 {
        // The second has lost directly to the first.
        let mut at = self.places() + first;
        let mut second = NONE;
        while at > 1 {
            second = second.min(self.winners[at ^ 1]);
            at /= 2;
        }
        second
    }

    fn places(&self) -> usize {
        self.winners.len() / 2
    }

    #[cold]
    fn grow(&mut self, places: usize) {
        let numbers = self.winners.split_off(self.places());
        let places = places.next_power_of_two();
        self.winners = vec![NONE; 2 * places];
        self.winners[places..][..numbers.len()].copy_from_slice(&numbers);
        for at in (1..places).rev() {
            self.winners[at] = self.winners[2 * at].min(self.winners[2 * at + 1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_least_two_are_those_of_a_sorted_list(
            changes in prop::collection::vec((0usize..70, prop::option::of(0u128..50)), 0..300),
        ) {
            let (mut tournament, mut plain) = (Tournament::default(), vec![NONE; 70]);
            for (place, number) in changes {
                // All numbers are distinct.
                let number = number.map_or(NONE, |number| number << 32 | place as u128);
                tournament.set(place, number);
                plain[place] = number;
                let mut sorted = plain.clone();
                sorted.sort_unstable();
                prop_assert_eq!(tournament.first(), sorted[0]);
                if sorted[0] != NONE {
                    prop_assert_eq!(tournament.second(sorted[0] as u32 as usize), sorted[1]);
                }
                prop_assert_eq!(tournament.get(place), number);
            }
        }
    }
}
