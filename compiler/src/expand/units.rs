//! Converts quantities of a syntax tree to SI units.
use stochc_grammar::tree::Quantity;
use stochc_ir::scene::units::{self, Dimension};

pub fn to_si(quantity: &Quantity) -> (f64, Dimension) {
    let factors = quantity.unit.iter();
    let factors = factors.map(|factor| (factor.symbol.as_str(), factor.power));
    units::to_si(quantity.value, factors)
}
