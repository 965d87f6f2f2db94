//! Builds trees of integer arithmetic and conditions from flat lists of terms and operators.
use pest::iterators::{Pair, Pairs};
use stochc_ir::Face;

use super::parser::Parser;
use super::spans::span_of;
use super::{MAX_DEPTH, MAX_TERMS, Rule};
use crate::error::SyntaxErrorKind;
use crate::tree::{Expr, ExprKind, Function, Operator, Subscript};

impl Parser<'_, '_> {
    pub fn expr(&mut self, pair: Pair<'_, Rule>, base: usize) -> Expr {
        // Terms have a byte each at least, with an operator between them.
        if pair.as_str().len() > 2 * MAX_TERMS {
            let terms = pair.clone().into_inner().flatten();
            let is_term =
                |pair: &Pair<'_, Rule>| matches!(pair.as_rule(), Rule::integer | Rule::name);
            if terms.filter(is_term).count() > MAX_TERMS {
                let span = span_of(&pair, base);
                self.error(SyntaxErrorKind::TooManyTerms, span);
                return Expr {
                    kind: ExprKind::Int(0),
                    span,
                };
            }
        }
        self.expr_at(pair, base, 0)
    }

    /// Builds a `condition`.
    pub fn condition(&mut self, pair: Pair<'_, Rule>, base: usize) -> Expr {
        let condition = self.expr(pair, base);
        self.check_types(&condition, true);
        condition
    }

    /// Reports each number where a condition is required, and each condition where a number is
    /// required.
    fn check_types(&mut self, expr: &Expr, requires_condition: bool) {
        if expr.is_condition() != requires_condition {
            return self.error(
                if requires_condition {
                    SyntaxErrorKind::NumberAsCondition
                } else {
                    SyntaxErrorKind::ConditionAsNumber
                },
                expr.span,
            );
        }
        match &expr.kind {
            // The arguments of a function cannot contain conditions.
            ExprKind::Int(_) | ExprKind::Name(_) | ExprKind::Face(_) | ExprKind::Call(..) => {}
            ExprKind::Negate(inner) => self.check_types(inner, false),
            ExprKind::Not(inner) => self.check_types(inner, true),
            ExprKind::Binary(operator, sides) => {
                self.check_types(&sides.0, operator.joins_conditions());
                self.check_types(&sides.1, operator.joins_conditions());
            }
        }
    }

    fn expr_at(&mut self, pair: Pair<'_, Rule>, base: usize, depth: usize) -> Expr {
        let span = span_of(&pair, base);
        if depth > MAX_DEPTH {
            self.error(SyntaxErrorKind::TooDeep, span);
            return Expr {
                kind: ExprKind::Int(0),
                span,
            };
        }
        // Operators wait on a stack until one of lower precedence comes.
        let mut operands: Vec<Expr> = Vec::new();
        let mut waiting: Vec<Operator> = Vec::new();
        let mut pairs = pair.into_inner();
        while let Some(operand) = self.operand(&mut pairs, base, depth) {
            operands.push(operand);
            let Some(pair) = pairs.next() else { break };
            let operator = operator(pair.as_str());
            while waiting
                .last()
                .is_some_and(|last| last.precedence() >= operator.precedence())
            {
                reduce(&mut operands, &mut waiting);
            }
            waiting.push(operator);
        }
        while !waiting.is_empty() {
            reduce(&mut operands, &mut waiting);
        }
        operands.pop().unwrap_or(Expr {
            kind: ExprKind::Int(0),
            span,
        })
    }

    /// Builds one term with the signs before it.
    fn operand(&mut self, pairs: &mut Pairs<'_, Rule>, base: usize, depth: usize) -> Option<Expr> {
        let (mut negative, mut negated) = (false, false);
        let (mut first, mut open) = (None, None);
        loop {
            let pair = pairs.next()?;
            let mut span = span_of(&pair, base);
            let first = *first.get_or_insert(span);
            let kind = match pair.as_rule() {
                Rule::minus => {
                    negative = !negative;
                    continue;
                }
                Rule::kw_not => {
                    negated = true;
                    continue;
                }
                Rule::paren_open => {
                    open = Some(span);
                    continue;
                }
                Rule::integer => ExprKind::Int(self.integer(pair.as_str(), span)),
                Rule::name => {
                    let is_arguments = |next: &Pair<'_, Rule>| next.as_rule() == Rule::arguments;
                    match pairs.peek().filter(is_arguments) {
                        None => match Face::from_word(pair.as_str()) {
                            Some(face) => ExprKind::Face(face),
                            None => ExprKind::Name(self.name(&pair, base).symbol),
                        },
                        Some(arguments) => {
                            pairs.next();
                            span = span.to(span_of(&arguments, base));
                            self.call(&pair, arguments, base, depth)
                        }
                    }
                }
                _ => {
                    let inside = self.expr_at(pair, base, depth + 1);
                    let close = pairs.next().map(|close| span_of(&close, base));
                    span = match (&inside.kind, open.zip(close)) {
                        // The span of a name is its own position.
                        (ExprKind::Name(_), _) | (_, None) => inside.span,
                        (_, Some((open, close))) => open.to(close),
                    };
                    inside.kind
                }
            };
            let plain = Expr { kind, span };
            return Some(if negated {
                Expr {
                    kind: ExprKind::Not(Box::new(plain)),
                    span: first.to(span),
                }
            } else if negative {
                let kind = match plain.kind {
                    ExprKind::Int(value) => ExprKind::Int(-value),
                    _ => ExprKind::Negate(Box::new(plain)),
                };
                Expr {
                    kind,
                    span: first.to(span),
                }
            } else {
                plain
            });
        }
    }

    /// Builds a function with its `arguments`.
    fn call(
        &mut self,
        name: &Pair<'_, Rule>,
        arguments: Pair<'_, Rule>,
        base: usize,
        depth: usize,
    ) -> ExprKind {
        let is_expr = |pair: &Pair<'_, Rule>| pair.as_rule() == Rule::expr;
        let arguments: Vec<Expr> = (arguments.into_inner().filter(is_expr))
            .map(|argument| self.expr_at(argument, base, depth + 1))
            .collect();
        let word = name.as_str();
        let function = Function::ALL.into_iter().find(|it| it.word() == word);
        match function.filter(|it| !it.is_unary() || arguments.len() == 1) {
            Some(function) => ExprKind::Call(function, arguments),
            None => {
                let word = word.to_owned();
                self.error(SyntaxErrorKind::WrongFunction { word }, span_of(name, base));
                ExprKind::Int(0)
            }
        }
    }

    fn integer(&mut self, digits: &str, span: crate::Span) -> i64 {
        digits.parse().unwrap_or_else(|_| {
            self.error(SyntaxErrorKind::NumberTooLarge, span);
            0
        })
    }

    /// Builds a subscript from a `range` or an `expr`.
    pub fn entry(&mut self, pair: Pair<'_, Rule>, base: usize) -> Subscript {
        if pair.as_rule() == Rule::range {
            let (first, last) = self.range(pair, base);
            Subscript::Range(first, last)
        } else {
            Subscript::One(self.expr(pair, base))
        }
    }

    pub fn range(&mut self, pair: Pair<'_, Rule>, base: usize) -> (Expr, Expr) {
        let ends: Vec<Expr> = pair
            .into_inner()
            .filter(|pair| pair.as_rule() == Rule::expr)
            .map(|pair| self.expr(pair, base))
            .collect();
        two(ends)
    }
}

/// Returns two expressions. The grammar guarantees that there are two.
pub fn two(exprs: Vec<Expr>) -> (Expr, Expr) {
    let mut exprs = exprs.into_iter();
    let mut next = || {
        exprs.next().unwrap_or(Expr {
            kind: ExprKind::Int(0),
            span: crate::Span::default(),
        })
    };
    (next(), next())
}

fn operator(sign: &str) -> Operator {
    match sign {
        "+" => Operator::Add,
        "-" => Operator::Subtract,
        "*" => Operator::Multiply,
        "/" => Operator::Divide,
        "%" => Operator::Remainder,
        "==" => Operator::Equal,
        "!=" => Operator::NotEqual,
        "<" => Operator::Less,
        "<=" => Operator::LessOrEqual,
        ">" => Operator::Greater,
        ">=" => Operator::GreaterOrEqual,
        "and" => Operator::And,
        _ => Operator::Or,
    }
}

fn reduce(operands: &mut Vec<Expr>, waiting: &mut Vec<Operator>) {
    if let (Some(operator), Some(right), Some(left)) =
        (waiting.pop(), operands.pop(), operands.pop())
    {
        let span = left.span.to(right.span);
        let kind = ExprKind::Binary(operator, Box::new((left, right)));
        operands.push(Expr { kind, span });
    }
}
