//! Where dimensions come from, and what would mend them: the words of pass 8.
//!
//! Only what is wrong is looked into: from the expression down to the names and literals that gave it its dimension.

use super::consistency::{Frame, Pass};
use super::dimension::{Dimension, in_unit};
use super::error::{DimensionError, Evidence, Side};
use super::ir::{ExprId, ExprKind};
use super::measure::PowerProblem;
use super::types::{Quantity, Slot};
use crate::base::{Label, Span};
use crate::math::Op;

/// How many names and literals are shown for one side.
const SHOWN_MAX: usize = 2;

/// How many expressions are looked through for them.
const LOOKED_THROUGH_MAX: usize = 400;

impl Pass<'_, '_> {
    /// Two sides that must be alike and are not.
    pub(super) fn report_unlike(
        &mut self,
        id: ExprId,
        op: Op,
        operands: [ExprId; 2],
        dimensions: [Dimension; 2],
        frame: Option<&Frame>,
    ) {
        let span = |id: ExprId| self.context.model.exprs[id].span;
        let mut sides = [0, 1].map(|k| Side { span: span(operands[k]), dimension: dimensions[k] });
        let mut operands = operands;
        if sides[1].span < sides[0].span {
            sides.reverse();
            operands.reverse();
        }
        let whole = span(id);
        let evidence = Evidence {
            origins: self.origins(&operands, frame),
            help: self.missing_factor(operands, sides.map(|side| side.dimension)),
        };
        let function = match op {
            Op::Min | Op::Max | Op::Mod | Op::Hypot | Op::Atan2 => {
                let text = self.context.sources.text(whole);
                Some(text.split('(').next().unwrap_or(op.name()).trim().to_string())
            }
            _ => None,
        };
        self.report(whole, DimensionError::Unlike { op, function, whole, sides, evidence });
    }

    /// A value that goes into something of another dimension.
    pub(super) fn report_slot(
        &mut self,
        value: ExprId,
        slot: Slot,
        needed: Dimension,
        found: Dimension,
        what: &str,
        frame: Option<&Frame>,
    ) {
        let at = self.context.model.exprs[value].span;
        let mut origins = self.origins(&[value], frame);
        if let Some(place) = slot.place.filter(|&place| origins.iter().all(|origin| origin.span != place)) {
            let unit = self.unit_text(place);
            let text = format!("declared in {unit}");
            origins.insert(0, Label { span: place, text });
        }
        let help = self.factor_for(value, needed, found);
        let (what, by_language) = (what.to_string(), slot.place.is_none());
        let found = Side { span: at, dimension: found };
        let evidence = Evidence { origins, help };
        self.report(at, DimensionError::Into { what, by_language, needed, found, evidence });
    }

    /// An argument that must be a pure number.
    pub(super) fn report_not_pure(
        &mut self,
        op: Op,
        operand: ExprId,
        found: Dimension,
        frame: Option<&Frame>,
    ) {
        let at = self.context.model.exprs[operand].span;
        let inverse = Dimension::ONE.over(found).unwrap_or(Dimension::ONE);
        let help = match found == Dimension::TIME {
            true => "multiply it by a rate, `2 [1/s]` or `2 [rad/s]`".to_string(),
            false => format!("divide it by a quantity in {found} first, or multiply it by one in {inverse}"),
        };
        let evidence = Evidence { origins: self.origins(&[operand], frame), help };
        let found = Side { span: at, dimension: found };
        self.report(at, DimensionError::NotPure { function: op.name(), found, evidence });
    }

    /// A power without a dimension.
    pub(super) fn report_power(
        &mut self,
        id: ExprId,
        [base, exponent]: [ExprId; 2],
        problem: PowerProblem,
        frame: Option<&Frame>,
    ) {
        let span = |id: ExprId| self.context.model.exprs[id].span;
        let (whole, at) = (span(id), span(exponent));
        let of_base = self.of(base, frame).dimension().unwrap_or(Dimension::ONE);
        let base_side = Side { span: span(base), dimension: of_base };
        let error = match problem {
            PowerProblem::Exponent(dimension) => {
                let help = format!("divide it by a quantity in {dimension} first");
                let evidence = Evidence { origins: self.origins(&[exponent], frame), help };
                DimensionError::Exponent { found: Side { span: at, dimension }, evidence }
            }
            PowerProblem::Changes | PowerProblem::Odd(_) => {
                let why = match problem {
                    PowerProblem::Odd(value) => format!("this is {value}"),
                    PowerProblem::Changes | PowerProblem::Exponent(_) | PowerProblem::TooLarge => {
                        "this changes during a run".to_string()
                    }
                };
                let help = format!("divide by a quantity in {of_base} first: `(x/x0)^n`");
                let evidence = Evidence { origins: self.origins(&[base], frame), help };
                DimensionError::Power { base: base_side, exponent: at, why, evidence }
            }
            PowerProblem::TooLarge => DimensionError::TooLarge { span: whole },
        };
        self.report(whole, error);
    }

    /// The unit in the brackets of a declaration.
    fn unit_text(&self, place: Span) -> String {
        self.context.sources.text(place).trim_matches(['[', ']']).trim().to_string()
    }

    /// The names and literals that gave expressions their dimensions, and the calls around them.
    fn origins(&self, roots: &[ExprId], frame: Option<&Frame>) -> Vec<Label> {
        let mut origins: Vec<Label> = Vec::new();
        for &root in roots {
            let mut shown = 0;
            let mut work = vec![root];
            for _ in 0..LOOKED_THROUGH_MAX {
                let Some(id) = work.pop() else { break };
                let Some(label) = self.origin(id, frame, &mut work) else { continue };
                let itself = roots.iter().any(|&root| self.context.model.exprs[root].span == label.span);
                if shown < SHOWN_MAX && !itself && origins.iter().all(|other| other.span != label.span) {
                    origins.push(label);
                    shown += 1;
                }
            }
        }
        let calls = std::iter::successors(frame, |frame| frame.around);
        let mut calls = calls.map(|frame| self.context.model.exprs[frame.call].span);
        let (inner, outer) = (calls.next(), calls.last());
        let calls = inner.into_iter().chain(outer);
        origins.extend(calls.map(|span| Label { span, text: "called here".to_string() }));
        origins
    }

    /// What gave an expression its dimension; where that are its operands, they are left to be looked at.
    fn origin(&self, id: ExprId, frame: Option<&Frame>, work: &mut Vec<ExprId>) -> Option<Label> {
        let dimension = self.of(id, frame).dimension()?;
        let expr = &self.context.model.exprs[id];
        let name = self.context.sources.text(expr.span);
        let label = |span: Span, text: String| Some(Label { span, text });
        match &expr.kind {
            ExprKind::Time => label(expr.span, "`time` is in s".to_string()),
            ExprKind::Local(number) => match (self.context.quantities.get(id), frame) {
                (Some(Quantity::Declared { place, .. }), _) => {
                    label(place, format!("`{name}` is declared in {}", self.unit_text(place)))
                }
                (_, Some(frame)) => {
                    let span = self.context.model.exprs[*frame.args.get(*number)?].span;
                    label(span, format!("`{name}` is {} in this call", in_unit(dimension)))
                }
                (_, None) => None,
            },
            ExprKind::Number(_) => match self.context.quantities.get(id)? {
                Quantity::Declared { place, .. }
                    if expr.span.start <= place.start && place.end <= expr.span.end =>
                {
                    label(place, in_unit(dimension))
                }
                quantity => self.declared(name, quantity, dimension),
            },
            ExprKind::Rate(..) => {
                let name = name.trim_end_matches('\'').trim_end();
                self.declared(name, self.context.member_quantity(id), dimension)
            }
            ExprKind::State(..) | ExprKind::Discrete(..) | ExprKind::AgentParam(..) | ExprKind::Let(..) => {
                self.declared(name, self.context.member_quantity(id), dimension)
            }
            ExprKind::Apply(op, operands) => {
                let first = usize::from(*op == Op::Select);
                work.extend(operands[first..].iter().rev());
                None
            }
            ExprKind::Aggregate { term, .. } => {
                work.extend(term);
                None
            }
            ExprKind::Call(function, args) => {
                match self.context.signatures[function.index()].result.place {
                    Some(place) => {
                        return label(place, format!("its value is declared in {}", self.unit_text(place)));
                    }
                    None => work.extend(args.iter().rev()),
                }
                None
            }
            _ => None,
        }
    }

    fn declared(&self, name: &str, quantity: Quantity, dimension: Dimension) -> Option<Label> {
        match quantity {
            Quantity::Unchecked => None,
            Quantity::Declared { place, .. } => {
                let text = format!("`{name}` is declared in {}", self.unit_text(place));
                Some(Label { span: place, text })
            }
            Quantity::As(value) | Quantity::Of(value) => {
                let span = self.context.model.exprs[value].span;
                Some(Label { span, text: format!("`{name}` is {}", in_unit(dimension)) })
            }
        }
    }

    /// What would make two sides alike: a unit for a bare number, or a factor.
    fn missing_factor(&self, [a, b]: [ExprId; 2], [of_a, of_b]: [Dimension; 2]) -> String {
        if let Some(help) = self.bare_factor(a, of_b, of_a).or_else(|| self.bare_factor(b, of_a, of_b)) {
            return help;
        }
        factor_text(of_a, of_b)
    }

    fn factor_for(&self, value: ExprId, needed: Dimension, found: Dimension) -> String {
        self.bare_factor(value, needed, found).unwrap_or_else(|| factor_text(needed, found))
    }

    /// A unit for the bare number that a product begins with.
    fn bare_factor(&self, id: ExprId, needed: Dimension, found: Dimension) -> Option<String> {
        let mut at = id;
        let mut in_product = false;
        while let ExprKind::Apply(op @ (Op::Neg | Op::Mul | Op::Div), operands) =
            &self.context.model.exprs[at].kind
        {
            in_product |= *op != Op::Neg;
            at = operands[0];
        }
        let missing = needed.over(found).filter(|missing| in_product && missing.is_whole())?;
        let number = self.context.sources.text(self.context.model.exprs[at].span);
        self.context.facts[at.index()].bare.then(|| {
            format!(
                "a bare number in a product has no unit: with `{number} [{missing}]` this is {}",
                in_unit(needed)
            )
        })
    }
}

/// Which factor two sides differ by.
fn factor_text(needed: Dimension, found: Dimension) -> String {
    let words = "what is declared without a unit is not checked";
    match needed.over(found) {
        Some(missing) => format!("they differ by a factor in {missing}; {words}"),
        None => words.to_string(),
    }
}
