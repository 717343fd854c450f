//! Dimensions as the reference tells them, worked out a second time: by recursion over a tree, with exponents in sixtieths.

/// Exponents of m, kg and s, in sixtieths.
pub type Powers = [i64; 3];

/// A pure number.
pub const ONE: Powers = [0; 3];

/// What is known of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A name without a unit is in it, or a mistake.
    Free,
    /// Made of bare literals alone.
    Bare,
    /// It has written units.
    Written(Powers),
    /// It has what the language gives: `time`, values of functions.
    Implied(Powers),
}

/// An expression.
#[derive(Clone, Debug)]
pub enum Tree {
    /// A name or a literal, with what is known of it.
    Leaf(String, Kind),
    /// `-`, `abs`, `floor`: the dimension stays.
    Same(&'static str, Box<Tree>),
    /// `+`, `-`, `min`, `max`, `hypot`, `mod`: both sides alike.
    Alike(&'static str, Box<Tree>, Box<Tree>),
    /// `if a > b then c else d`.
    If([Box<Tree>; 4]),
    /// Product.
    Times(Box<Tree>, Box<Tree>),
    /// Quotient.
    Over(Box<Tree>, Box<Tree>),
    /// The power with this exponent, in sixtieths.
    Power(Box<Tree>, i64),
    /// `sin`, `exp`, `tanh`: of a pure number.
    Pure(&'static str, Box<Tree>),
    /// `atan2`: of two alike.
    Angle(Box<Tree>, Box<Tree>),
}

impl Tree {
    /// As text, every operation in parentheses.
    pub fn text(&self) -> String {
        match self {
            Tree::Leaf(text, _) => text.clone(),
            Tree::Same("-", a) => format!("(-({}))", a.text()),
            Tree::Same(f, a) | Tree::Pure(f, a) => format!("{f}({})", a.text()),
            Tree::Alike(op @ ("+" | "-"), a, b) => format!("({} {op} {})", a.text(), b.text()),
            Tree::Alike(f, a, b) => format!("{f}({}, {})", a.text(), b.text()),
            Tree::If([a, b, c, d]) => {
                format!("(if {} > {} then {} else {})", a.text(), b.text(), c.text(), d.text())
            }
            Tree::Times(a, b) => format!("({}*{})", a.text(), b.text()),
            Tree::Over(a, b) => format!("({}/({}))", a.text(), b.text()),
            Tree::Power(a, 30) => format!("sqrt({})", a.text()),
            Tree::Power(a, 20) => format!("cbrt({})", a.text()),
            Tree::Power(a, sixtieths) => format!("(({})^({sixtieths}/60))", a.text()),
            Tree::Angle(a, b) => format!("atan2({}, {})", a.text(), b.text()),
        }
    }

    /// What is known of it, and how many mistakes are in it.
    pub fn kind(&self) -> (Kind, usize) {
        match self {
            Tree::Leaf(_, kind) => (*kind, 0),
            Tree::Same(_, a) => a.kind(),
            Tree::Alike(_, a, b) => alike(a, b),
            Tree::If([a, b, c, d]) => {
                let ((_, in_condition), (kind, in_branches)) = (alike(a, b), alike(c, d));
                (kind, in_condition + in_branches)
            }
            Tree::Times(a, b) => product(a, b, 1),
            Tree::Over(a, b) => product(a, b, -1),
            Tree::Power(a, sixtieths) => {
                let (kind, mistakes) = a.kind();
                let scale = |powers: Powers| powers.map(|power| power * sixtieths / 60);
                let kind = match kind {
                    Kind::Written(powers) => Kind::Written(scale(powers)),
                    Kind::Implied(powers) => Kind::Implied(scale(powers)),
                    Kind::Free | Kind::Bare => kind,
                };
                (kind, mistakes)
            }
            Tree::Pure(_, a) => {
                let (kind, mistakes) = a.kind();
                let wrong = matches!(kind, Kind::Written(powers) if powers != ONE);
                (number(kind), mistakes + usize::from(wrong))
            }
            Tree::Angle(a, b) => {
                let (kind, mistakes) = alike(a, b);
                (number(kind), mistakes)
            }
        }
    }

    /// Whether every power can be written in sixtieths.
    pub fn is_exact(&self) -> bool {
        match self {
            Tree::Leaf(..) => true,
            Tree::Same(_, a) | Tree::Pure(_, a) => a.is_exact(),
            Tree::Alike(_, a, b) | Tree::Times(a, b) | Tree::Over(a, b) | Tree::Angle(a, b) => {
                a.is_exact() && b.is_exact()
            }
            Tree::If(parts) => parts.iter().all(|part| part.is_exact()),
            Tree::Power(a, sixtieths) => {
                let divides = |powers: Powers| powers.iter().all(|power| power * sixtieths % 60 == 0);
                a.is_exact() && !matches!(a.kind().0, Kind::Written(p) | Kind::Implied(p) if !divides(p))
            }
        }
    }
}

/// What a function gives whose value is a pure number.
fn number(argument: Kind) -> Kind {
    match argument {
        Kind::Bare => Kind::Bare,
        Kind::Free => Kind::Free,
        Kind::Implied(powers) if powers != ONE => Kind::Free,
        Kind::Implied(_) | Kind::Written(_) => Kind::Implied(ONE),
    }
}

fn alike(a: &Tree, b: &Tree) -> (Kind, usize) {
    let ((a, in_a), (b, in_b)) = (a.kind(), b.kind());
    let (kind, mistake) = match (a, b) {
        (Kind::Written(p), Kind::Written(q)) if p == q => (a, 0),
        (Kind::Written(p), Kind::Implied(q)) if p == q => (a, 0),
        (Kind::Implied(p), Kind::Written(q)) if p == q => (b, 0),
        (Kind::Implied(p), Kind::Implied(q)) => (if p == q { a } else { Kind::Free }, 0),
        (Kind::Written(_) | Kind::Implied(_), Kind::Written(_) | Kind::Implied(_)) => (Kind::Free, 1),
        (Kind::Written(_) | Kind::Implied(_), Kind::Free | Kind::Bare) => (a, 0),
        (Kind::Free | Kind::Bare, Kind::Written(_) | Kind::Implied(_)) => (b, 0),
        (Kind::Bare, Kind::Bare) => (Kind::Bare, 0),
        (Kind::Free, Kind::Free | Kind::Bare) | (Kind::Bare, Kind::Free) => (Kind::Free, 0),
    };
    (kind, in_a + in_b + mistake)
}

fn product(a: &Tree, b: &Tree, sign: i64) -> (Kind, usize) {
    let ((a, in_a), (b, in_b)) = (a.kind(), b.kind());
    let powers = |kind: Kind| match kind {
        Kind::Written(powers) | Kind::Implied(powers) => powers,
        Kind::Free | Kind::Bare => ONE,
    };
    let (p, q) = (powers(a), powers(b));
    let both = [0, 1, 2].map(|k| p[k] + sign * q[k]);
    let kind = match (a, b) {
        (Kind::Free, _) | (_, Kind::Free) => Kind::Free,
        (Kind::Bare, Kind::Bare) => Kind::Bare,
        (Kind::Written(_), _) | (_, Kind::Written(_)) => Kind::Written(both),
        (Kind::Implied(_) | Kind::Bare, Kind::Implied(_) | Kind::Bare) => Kind::Implied(both),
    };
    (kind, in_a + in_b)
}
