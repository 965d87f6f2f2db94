//! Evaluates arithmetic expressions.
use stochc_grammar::tree::{Expr, ExprKind, Function, Name, Operator};
use stochc_ir::Face;

use super::expander::Expander;
use super::scope::BoundValue;
use crate::diagnostic::{Code, Diagnostic};
use crate::names::ValueKind;

impl Expander<'_, '_> {
    /// Returns the number or the face that an expression stands for. Returns
    /// [`BoundValue::Unknown`] and reports an error if it has no value.
    pub(super) fn evaluate_any(&mut self, expr: &Expr) -> BoundValue {
        let face = match &expr.kind {
            ExprKind::Name(symbol) => {
                let name = Name {
                    symbol: *symbol,
                    span: expr.span,
                };
                match self.value(name) {
                    Some(BoundValue::Face(face)) => Some(face),
                    _ => {
                        let number = self.evaluate(expr);
                        return number.map_or(BoundValue::Unknown, BoundValue::Number);
                    }
                }
            }
            ExprKind::Face(face) => Some(*face),
            ExprKind::Call(function, arguments) if function.takes_face() => {
                let face = arguments.first().and_then(|it| self.evaluate_face(it));
                face.and_then(|face| self.face_of(*function, face, expr))
            }
            _ => {
                let number = self.evaluate(expr);
                return number.map_or(BoundValue::Unknown, BoundValue::Number);
            }
        };
        face.map_or(BoundValue::Unknown, BoundValue::Face)
    }

    /// Returns the face that an expression stands for. Returns `None` and reports an error if it
    /// stands for something else.
    fn evaluate_face(&mut self, expr: &Expr) -> Option<Face> {
        match self.evaluate_any(expr) {
            BoundValue::Face(face) => Some(face),
            BoundValue::Unknown => None,
            value => {
                self.wrong_expr(expr, value, ValueKind::Face);
                None
            }
        }
    }

    /// Returns the result of a function of faces. Reports an error if there is none.
    fn face_of(&mut self, function: Function, face: Face, expr: &Expr) -> Option<Face> {
        let result = function.apply_to_face(face);
        if result.is_none() {
            let title = format!("`{}` of `{face}` does not exist", function.word());
            let diagnostic = Diagnostic::new(Code::WrongValue, title)
                .label(
                    self.location(expr.span),
                    format!("the face is `{face}` here"),
                )
                .help("use a horizontal face: north, south, east or west");
            self.diagnostics.push(self.in_instance(diagnostic));
        }
        result
    }

    /// Reports an expression without a name whose kind is not the required one.
    fn wrong_expr(&mut self, expr: &Expr, value: BoundValue, needed: ValueKind) {
        let given = value.kind().map_or("something else", ValueKind::noun);
        let title = format!("expected {}, found {given}", needed.noun());
        let help = match needed {
            ValueKind::Face => "write up, down, north, south, east or west",
            _ => "write a whole number, or the name of a number",
        };
        let diagnostic = Diagnostic::new(Code::WrongKind, title)
            .label(self.location(expr.span), format!("this is {given}"))
            .help(help);
        self.diagnostics.push(self.in_instance(diagnostic));
    }

    /// Returns the value of an expression. Returns `None` and reports an error if it has no value.
    pub fn evaluate(&mut self, expr: &Expr) -> Option<i64> {
        match &expr.kind {
            ExprKind::Int(value) => Some(*value),
            ExprKind::Face(face) => {
                self.wrong_expr(expr, BoundValue::Face(*face), ValueKind::Number);
                None
            }
            ExprKind::Call(function, _) if function.takes_face() => {
                let value = self.evaluate_any(expr);
                if value != BoundValue::Unknown {
                    self.wrong_expr(expr, value, ValueKind::Number);
                }
                None
            }
            ExprKind::Name(symbol) => {
                let name = Name {
                    symbol: *symbol,
                    span: expr.span,
                };
                match self.value(name) {
                    Some(BoundValue::Number(value)) => return Some(value),
                    Some(BoundValue::Unknown) => {}
                    Some(value) => self.wrong_kind(name, value, ValueKind::Number),
                    None => self.unknown_number(name.symbol, name.span),
                }
                None
            }
            ExprKind::Negate(inner) => {
                let value = self.evaluate(inner)?;
                self.in_range(value.checked_neg(), expr)
            }
            ExprKind::Call(function, arguments) => {
                self.operation();
                let values: Vec<_> = arguments.iter().map(|it| self.evaluate(it)).collect();
                let values: Option<Vec<i64>> = values.into_iter().collect();
                self.in_range(function.apply(&values?), expr)
            }
            ExprKind::Not(inner) => {
                let value = self.evaluate(inner)?;
                Some((value == 0).into())
            }
            ExprKind::Binary(operator, sides) => {
                self.operation();
                let left = self.evaluate(&sides.0);
                // The right side of `n > 0 and 6 / n > 1` is evaluated only if `n` is not 0.
                match (operator, left) {
                    (Operator::And, Some(0)) => return left,
                    (Operator::Or, Some(1)) => return left,
                    _ => {}
                }
                let right = self.evaluate(&sides.1);
                let (left, right) = (left?, right?);
                if matches!(operator, Operator::Divide | Operator::Remainder) && right == 0 {
                    let divisor = self.location(sides.1.span);
                    let (title, help) = match sides.1.kind {
                        ExprKind::Name(symbol) => {
                            let name = self.symbols.word(symbol);
                            let help = format!(
                                "start the range of `{name}` at 1, or divide by `({name} + 1)`"
                            );
                            (format!("division by zero when `{name}` is 0"), help)
                        }
                        _ => (
                            "division by zero".to_owned(),
                            "divide by another number".to_owned(),
                        ),
                    };
                    let diagnostic = Diagnostic::new(Code::Arithmetic, title)
                        .label(divisor, "the divisor is 0")
                        .help(help);
                    self.diagnostics.push(diagnostic);
                    return None;
                }
                self.in_range(operator.apply(left, right), expr)
            }
        }
    }

    /// Counts an operation. Eight operations count as one statement.
    fn operation(&mut self) {
        const OF_A_STEP: usize = 8;
        self.operations += 1;
        if self.operations == OF_A_STEP {
            self.operations = 0;
            self.steps = self.steps.saturating_add(1);
        }
    }

    fn in_range(&mut self, value: Option<i64>, expr: &Expr) -> Option<i64> {
        if value.is_none() {
            let diagnostic =
                Diagnostic::new(Code::Arithmetic, "the result does not fit in 64 bits")
                    .label(self.location(expr.span), "too large or too small")
                    .help("use smaller numbers");
            self.diagnostics.push(diagnostic);
        }
        value
    }
}
