//! Models of any size, each of a shape that makes one pass of the compiler work hard.

use std::fmt::Write as _;

/// A way to be large.
pub struct Shape {
    /// What the command line calls it.
    pub name: &'static str,
    /// Before the parts.
    head: &'static str,
    /// Part number k.
    part: fn(&mut String, usize),
    /// After the parts.
    tail: &'static str,
}

impl Shape {
    /// A model with so many parts.
    pub fn with_parts(&self, parts: usize) -> String {
        self.written(|_, k| k < parts)
    }

    /// A model of about so many bytes.
    pub fn with_bytes(&self, bytes: usize) -> String {
        self.written(|text, _| text.len() < bytes)
    }

    fn written(&self, more: impl Fn(&str, usize) -> bool) -> String {
        let mut text = self.head.to_string();
        let mut k = 0;
        while more(&text, k) {
            (self.part)(&mut text, k);
            k += 1;
        }
        text.push_str(self.tail);
        text
    }
}

/// Writes to a text, which cannot fail.
macro_rules! put {
    ($text:expr, $($words:tt)*) => {{
        let _ = writeln!($text, $($words)*);
    }};
}

/// All shapes. The models are right unless the name says otherwise.
pub const SHAPES: [Shape; 24] = [
    Shape { name: "types", head: "", part: agent_type, tail: "run { until 1 }\n" },
    Shape { name: "params", head: "param p0 = 1\n", part: param, tail: "run { until 1 }\n" },
    Shape { name: "lets", head: "let p0 = 1\n", part: file_let, tail: "run { until 1 }\n" },
    Shape {
        name: "agent_lets",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n  let p0 = x\n",
        part: agent_let,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "lets_backwards",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n",
        part: let_of_next,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape { name: "functions", head: "fn f0(x: real) = x\n", part: function, tail: "run { until 1 }\n" },
    Shape {
        name: "functions_doubling",
        head: "fn f0(x: real) = x\n",
        part: doubling,
        tail: "agent A { state x = 0  flow { x' = f9(x) } }\nrun { until 1 }\n",
    },
    Shape {
        name: "sum",
        head: "agent A {\n  state x = 0\n  flow { x' = 1\n",
        part: term,
        tail: "} }\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "product",
        head: "agent A {\n  state x = 0\n  flow { x' = 1\n",
        part: factor,
        tail: "} }\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "kinks",
        head: "agent A {\n  state x = 0\n  flow { x' = 1\n",
        part: kink,
        tail: "} }\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "kinks_nested",
        head: "agent A {\n  state x = 0\n  let p0 = x\n",
        part: nested_kink,
        tail: "  flow { x' = p9 } }\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "states",
        head: "agent A {\n",
        part: state,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "states_coupled",
        head: "agent A {\n  state x0 = 0\n  flow { x0' = 0 }\n",
        part: coupled_state,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "transitions",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n",
        part: transition,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "modes",
        head: "agent A {\n  state x = 0\n  initial mode First { flow { x' = 1 } }\n",
        part: mode,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "instances",
        head: "agent A(v: real) { state x = 0  flow { x' = v } }\nsystem {\n",
        part: instance,
        tail: "}\nrun { until 1 }\n",
    },
    Shape {
        name: "guard",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n  when x > 9\n",
        part: comparison,
        tail: "{ x := 0 } }\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "actions",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n",
        part: action,
        tail: "}\nsystem { a = A() }\nrun { until 1 }\n",
    },
    Shape {
        name: "records",
        head: "agent A {\n  state x = 0\n  flow { x' = 1 }\n}\nsystem { a = A[100]() }\nrun { until 1 record a\n",
        part: record,
        tail: "to \"a.csv\" }\n",
    },
    Shape { name: "comments", head: "", part: comment, tail: "run { until 1 }\n" },
    Shape {
        name: "interactions",
        head: "agent A { state x = 0  flow { x' = 1 } }\nsystem { a = A[2]() }\n",
        part: interaction,
        tail: "run { until 1 }\n",
    },
    Shape { name: "wrong_names", head: "", part: wrong_name, tail: "run { until 1 }\n" },
    Shape { name: "wrong_twins", head: "", part: wrong_twin, tail: "run { until 1 }\n" },
    Shape { name: "wrong_line", head: "agent A { state x = 0  flow { x' = 1", part: wrong_line, tail: "} }" },
];

fn agent_type(text: &mut String, k: usize) {
    put!(text, "agent Car{k}(v: real, w: real = 2) {{");
    put!(text, "  state x = 0, y = v\n  discrete n: int = 0\n  let far = x^2 + y^2");
    put!(
        text,
        "  initial mode Out {{ flow {{ x' = v  y' = w*cos(x) }}  when far > {k} -> Back {{ n := n + 1 }} }}"
    );
    put!(text, "  mode Back {{ flow {{ x' = -v  y' = -y }}  when x <= 0 -> Out }}\n}}");
}

fn param(text: &mut String, k: usize) {
    put!(text, "param p{} = 0.5*p{k} + {k}", k + 1);
}

fn file_let(text: &mut String, k: usize) {
    put!(text, "let p{} = 0.5*p{k} + {k}", k + 1);
}

fn agent_let(text: &mut String, k: usize) {
    put!(text, "  let p{} = 0.5*p{k} + x", k + 1);
}

fn let_of_next(text: &mut String, k: usize) {
    // Ten in a chain, so that nothing is defined through too many others.
    for k in 10 * k..10 * k + 9 {
        put!(text, "  let p{k} = 0.5*p{} + x", k + 1);
    }
    put!(text, "  let p{} = x", 10 * k + 9);
}

fn function(text: &mut String, k: usize) {
    put!(text, "fn f{}(x: real) = 0.5*f{k}(x) + {k}", k + 1);
}

fn doubling(text: &mut String, k: usize) {
    put!(text, "fn f{}(x: real) = f{k}(x + {k}) + f{k}(x - {k})", k + 1);
}

fn term(text: &mut String, k: usize) {
    put!(text, "+ 0.{k}*sin(x)");
}

fn factor(text: &mut String, k: usize) {
    put!(text, "*(x - {k})");
}

fn kink(text: &mut String, k: usize) {
    put!(text, "+ abs(x - {k})");
}

fn nested_kink(text: &mut String, k: usize) {
    put!(text, "  let p{} = abs(p{k} - {k})", k + 1);
}

fn state(text: &mut String, k: usize) {
    put!(text, "  state x{k} = {k}\n  flow {{ x{k}' = -x{k} }}");
}

fn coupled_state(text: &mut String, k: usize) {
    put!(text, "  state x{} = 0\n  flow {{ x{}' = x{k}*x0 - x{} }}", k + 1, k + 1, k + 1);
}

fn transition(text: &mut String, k: usize) {
    put!(text, "  t{k}: when x >= {k}.5 {{ x := x + {k} }}");
}

fn mode(text: &mut String, k: usize) {
    put!(text, "  mode M{k} {{ flow {{ x' = {k} }}  when x > {k} -> First }}");
}

fn instance(text: &mut String, k: usize) {
    put!(text, "  a{k} = A(v = {k})");
}

fn comparison(text: &mut String, k: usize) {
    put!(text, "or x > {k} and x < {k}.5");
}

fn action(text: &mut String, k: usize) {
    put!(
        text,
        "  when x > {k} {{ if x > {k}.5 {{ x := {k} }} else if x > 0 {{ x := 1 }} else {{ x := 0 }} }}"
    );
}

fn record(text: &mut String, k: usize) {
    put!(text, ", a[{}].x", k % 100);
}

fn comment(text: &mut String, k: usize) {
    put!(text, "// Line {k} of a long story.");
}

fn interaction(text: &mut String, k: usize) {
    put!(text, "interaction I{k}(a: A, b: A) {{ let d = a.x - b.x  when d^2 >= {k} {{ a.x := d }} }}");
}

fn wrong_name(text: &mut String, k: usize) {
    put!(text, "let value{k} = valve{k} + 1");
}

fn wrong_twin(text: &mut String, k: usize) {
    put!(text, "param p = {k}");
}

fn wrong_line(text: &mut String, k: usize) {
    let _ = write!(text, " + unknown{}", k % 100);
}
