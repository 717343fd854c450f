//! Affine forms: a value as a sum of terms with constant factors, so that what is the same cancels, whoever wrote it.
//!
//! A term is a leaf or an operator over forms; forms and terms are hash-consed, so that equal values have equal names. The sign of a
//! form under `abs` or an even power is dropped. Every term has an interval that contains its values, from the intervals of
//! the leaves. What cancels is finite: a term that may be infinite stays. Sums of more than [`TERMS_MAX`] terms are terms.

use rustc_hash::FxHashMap;

use crate::calculus::graph::Node;
use crate::math::{Interval, Op};

/// How long a sum may grow before it counts as one term.
const TERMS_MAX: usize = 24;

/// Names a form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FormId(usize);

/// A constant and terms with their factors, none of which is 0, in the order of the terms.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Number of the term, factor.
    pub terms: Vec<(usize, f64)>,
    /// What is added.
    pub constant: f64,
}

impl Form {
    /// Its values, from those of its terms.
    fn interval(&self, of_term: impl Fn(usize) -> Interval) -> Interval {
        let terms = self.terms.iter().map(|&(term, factor)| scaled(of_term(term), factor));
        let sum = terms.reduce(|sum, term| Interval::eval(Op::Add, &[sum, term]));
        match sum {
            None => Interval::point(self.constant),
            Some(sum) if self.constant == 0.0 => sum,
            Some(sum) => Interval::eval(Op::Add, &[sum, Interval::point(self.constant)]),
        }
    }
}

/// The forms of one question while a leaf has only some of its values.
#[derive(Debug)]
pub struct Narrowed<'f> {
    forms: &'f Forms,
    terms: Vec<Interval>,
}

impl Narrowed<'_> {
    /// The values that a form can then have.
    pub fn interval(&self, id: FormId) -> Interval {
        self.forms.get(id).interval(|term| self.terms[term])
    }
}

/// What a term is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Term {
    /// A state, a rate, a column, the time, or a constant that is not finite.
    Leaf(Node),
    /// An operator.
    Apply(Op, Vec<FormId>),
}

/// All forms of one question.
#[derive(Debug, Default)]
pub struct Forms {
    terms: Vec<(Term, Interval)>,
    term_ids: FxHashMap<Term, usize>,
    forms: Vec<Form>,
    form_ids: FxHashMap<(Vec<(usize, u64)>, u64), FormId>,
}

impl Forms {
    /// A form by its name.
    pub fn get(&self, id: FormId) -> &Form {
        &self.forms[id.0]
    }

    /// A constant.
    pub fn constant(&mut self, value: f64) -> FormId {
        if value.is_finite() {
            return self.intern(Form { terms: Vec::new(), constant: value });
        }
        self.leaf(Node::Constant(value.to_bits()), Interval::point(value))
    }

    /// A leaf, with the values that it can have.
    pub fn leaf(&mut self, node: Node, interval: Interval) -> FormId {
        self.term(Term::Leaf(node), interval)
    }

    /// The leaf that a form is, if it is one with a factor: leaf, factor, constant.
    pub fn as_leaf(&self, id: FormId) -> Option<(Node, f64, f64)> {
        let Form { terms, constant } = self.get(id);
        let [(term, factor)] = terms.as_slice() else { return None };
        self.leaf_of(*term).map(|node| (node, *factor, *constant))
    }

    /// The values that a form can have.
    pub fn interval(&self, id: FormId) -> Interval {
        self.get(id).interval(|term| self.terms[term].1)
    }

    /// The values of all forms while a leaf has only those in `interval`.
    pub fn narrowed(&self, leaf: Node, interval: Interval) -> Narrowed<'_> {
        let mut terms: Vec<Interval> = Vec::with_capacity(self.terms.len());
        let mut operands: Vec<Interval> = Vec::new();
        for (term, known) in &self.terms {
            let value = match term {
                Term::Leaf(node) if *node == leaf => interval,
                Term::Leaf(_) => *known,
                Term::Apply(op, ids) => {
                    operands.clear();
                    operands.extend(ids.iter().map(|&id| self.get(id).interval(|term| terms[term])));
                    Interval::eval(*op, &operands)
                }
            };
            terms.push(value);
        }
        Narrowed { forms: self, terms }
    }

    /// Every form so far.
    pub fn all(&self) -> impl Iterator<Item = &Form> {
        self.forms.iter()
    }

    /// The leaf that a term is.
    pub fn leaf_of(&self, term: usize) -> Option<Node> {
        match &self.terms[term].0 {
            Term::Leaf(node) => Some(*node),
            Term::Apply(..) => None,
        }
    }

    /// An operator over forms.
    pub fn apply(&mut self, op: Op, operands: &[FormId]) -> FormId {
        if let Some(folded) = self.folded(op, operands) {
            return folded;
        }
        let linear = match (op, operands) {
            (Op::Neg, [a]) => Some(self.sum(*a, -1.0, None)),
            (Op::Add, [a, b]) => self.plus(*a, 1.0, *b),
            (Op::Sub, [a, b]) => self.plus(*a, -1.0, *b),
            (Op::Mul, [a, b]) => match (self.as_constant(*a), self.as_constant(*b)) {
                (Some(k), _) => Some(self.sum(*b, k, None)),
                (_, Some(k)) => Some(self.sum(*a, k, None)),
                (None, None) => None,
            },
            (Op::Div, [a, b]) => {
                self.as_constant(*b).filter(|k| *k != 0.0).map(|k| self.sum(*a, 1.0 / k, None))
            }
            (Op::Le | Op::Lt | Op::Eq | Op::Ne, [a, b]) => self.compared(op, *a, *b),
            _ => None,
        };
        linear.unwrap_or_else(|| self.opaque(op, operands))
    }

    /// `a + factor*b`; none if something cancels that may be infinite, or if it gets too long.
    pub fn plus(&mut self, a: FormId, factor: f64, b: FormId) -> Option<FormId> {
        let sum = self.sum(a, 1.0, Some((factor, b)));
        let lost = |id: FormId| {
            let kept = &self.get(sum).terms;
            self.get(id).terms.iter().any(|(term, _)| {
                !kept.iter().any(|(other, _)| other == term) && !self.terms[*term].1.is_finite()
            })
        };
        let too_long = self.get(sum).terms.len() > TERMS_MAX;
        (!too_long && !lost(a) && !lost(b)).then_some(sum)
    }

    /// The constant that a form is.
    pub fn as_constant(&self, id: FormId) -> Option<f64> {
        let form = self.get(id);
        form.terms.is_empty().then_some(form.constant)
    }

    /// The value of an operator over constants, if it is finite.
    fn folded(&mut self, op: Op, operands: &[FormId]) -> Option<FormId> {
        let mut values = [0.0; 3];
        for (value, operand) in values.iter_mut().zip(operands) {
            *value = self.as_constant(*operand)?;
        }
        let value = op.eval(values);
        value.is_finite().then(|| self.constant(value))
    }

    /// `scale*a`, or `scale*a + factor*b`.
    fn sum(&mut self, a: FormId, scale: f64, b: Option<(f64, FormId)>) -> FormId {
        let Form { terms, constant } = self.get(a).clone();
        let mut all: Vec<(usize, f64)> = terms.iter().map(|&(term, k)| (term, scale * k)).collect();
        let mut constant = scale * constant;
        if let Some((factor, b)) = b {
            let b = self.get(b);
            constant += factor * b.constant;
            for &(term, k) in &b.terms {
                match all.iter_mut().find(|(other, _)| *other == term) {
                    Some((_, sum)) => *sum += factor * k,
                    None => all.push((term, factor * k)),
                }
            }
        }
        all.retain(|(_, k)| *k != 0.0);
        all.sort_unstable_by_key(|(term, _)| *term);
        self.intern(Form { terms: all, constant })
    }

    /// A comparison of what differs by a constant, or by what is certainly of one sign; whether two are the same by their
    /// difference, which may be known where both are not.
    fn compared(&mut self, op: Op, a: FormId, b: FormId) -> Option<FormId> {
        let difference = self.plus(a, -1.0, b)?;
        let zero = Interval::ZERO;
        let truth = Interval::eval(op, &[self.interval(difference), zero]);
        if truth.is_true() || truth.is_false() {
            return Some(self.constant(truth.lo));
        }
        let zero = self.constant(0.0);
        matches!(op, Op::Eq | Op::Ne).then(|| self.opaque(op, &[difference, zero]))
    }

    fn opaque(&mut self, op: Op, operands: &[FormId]) -> FormId {
        let mut operands = operands.to_vec();
        let even = op == Op::Powi && self.as_constant(operands[1]).is_some_and(|n| n % 2.0 == 0.0);
        if op == Op::Abs || even {
            operands[0] = self.without_sign(operands[0]);
        }
        if matches!(
            op,
            Op::Add | Op::Mul | Op::Min | Op::Max | Op::Hypot | Op::And | Op::Or | Op::Eq | Op::Ne
        ) {
            operands.sort_unstable();
        }
        let intervals: Vec<Interval> = operands.iter().map(|&operand| self.interval(operand)).collect();
        self.term(Term::Apply(op, operands), Interval::eval(op, &intervals))
    }

    /// The form or its opposite, the same for both.
    fn without_sign(&mut self, id: FormId) -> FormId {
        let form = self.get(id);
        let leading = form.terms.first().map_or(form.constant, |(_, factor)| *factor);
        if leading < 0.0 { self.sum(id, -1.0, None) } else { id }
    }

    fn term(&mut self, term: Term, interval: Interval) -> FormId {
        let next = self.terms.len();
        let number = *self.term_ids.entry(term.clone()).or_insert(next);
        if number == next {
            self.terms.push((term, interval));
        }
        self.intern(Form { terms: vec![(number, 1.0)], constant: 0.0 })
    }

    fn intern(&mut self, form: Form) -> FormId {
        // -0 and 0 are one number here.
        let bits = |x: f64| (x + 0.0).to_bits();
        let key = (form.terms.iter().map(|&(term, k)| (term, bits(k))).collect(), bits(form.constant));
        let next = FormId(self.forms.len());
        let id = *self.form_ids.entry(key).or_insert(next);
        if id == next {
            self.forms.push(form);
        }
        id
    }
}

/// A multiple of an interval; an end at zero stays at zero.
fn scaled(interval: Interval, factor: f64) -> Interval {
    if factor == 1.0 {
        return interval;
    }
    if factor == -1.0 {
        return interval.neg();
    }
    let product = Interval::eval(Op::Mul, &[interval, Interval::point(factor)]);
    let (low, high) = if factor > 0.0 { (interval.lo, interval.hi) } else { (interval.hi, interval.lo) };
    let lo = if low == 0.0 { 0.0 } else { product.lo };
    let hi = if high == 0.0 { 0.0 } else { product.hi };
    Interval::new(lo, hi)
}

#[cfg(test)]
mod tests {
    use super::{Forms, Interval, Node, Op};

    const REAL: Interval = Interval { lo: -1e300, hi: 1e300 };

    fn state(forms: &mut Forms, column: u32) -> super::FormId {
        forms.leaf(Node::State { slot: 0, column }, REAL)
    }

    #[test]
    fn what_is_the_same_cancels() {
        let mut forms = Forms::default();
        let (x, y) = (state(&mut forms, 0), state(&mut forms, 1));
        let (two, half) = (forms.constant(2.0), forms.constant(0.5));
        let double = forms.apply(Op::Mul, &[two, x]);
        let same = forms.apply(Op::Mul, &[half, double]);
        assert_eq!(same, x);
        let sum = forms.apply(Op::Add, &[x, y]);
        let rest = forms.apply(Op::Sub, &[sum, x]);
        assert_eq!(rest, y);
        let nothing = forms.apply(Op::Sub, &[rest, y]);
        assert_eq!(forms.as_constant(nothing), Some(0.0));
        let (there, back) = (forms.apply(Op::Sub, &[x, y]), forms.apply(Op::Sub, &[y, x]));
        assert_eq!(forms.apply(Op::Powi, &[there, two]), forms.apply(Op::Powi, &[back, two]));
        assert_eq!(forms.apply(Op::Abs, &[there]), forms.apply(Op::Abs, &[back]));
        let equal = forms.apply(Op::Le, &[same, x]);
        assert_eq!(forms.as_constant(equal), Some(1.0));
    }

    #[test]
    fn what_may_be_infinite_does_not_cancel() {
        let mut forms = Forms::default();
        let gap = forms.leaf(Node::State { slot: 0, column: 0 }, Interval::new(0.0, f64::INFINITY));
        let difference = forms.apply(Op::Sub, &[gap, gap]);
        assert_eq!(forms.as_constant(difference), None);
        assert!(forms.interval(difference).is_whole());
        let infinite = forms.constant(f64::INFINITY);
        let difference = forms.apply(Op::Sub, &[infinite, infinite]);
        assert!(forms.interval(difference).is_whole());
    }

    #[test]
    fn squares_are_not_negative() {
        let mut forms = Forms::default();
        let (x, two) = (state(&mut forms, 0), forms.constant(2.0));
        let square = forms.apply(Op::Powi, &[x, two]);
        let double = forms.apply(Op::Mul, &[two, square]);
        let sum = forms.apply(Op::Add, &[double, square]);
        assert_eq!(forms.interval(sum).lo, 0.0);
        let zero = forms.constant(0.0);
        let below = forms.apply(Op::Lt, &[sum, zero]);
        assert_eq!(forms.as_constant(below), Some(0.0));
        let negative = forms.apply(Op::Neg, &[sum]);
        assert_eq!(forms.interval(negative).hi, 0.0);
    }
}
