//! A model's text as HTML, with what the words are marked: comments, strings, numbers, units, keywords, and in `run { }` the names of
//! settings, which are names elsewhere.

use super::modes_svg::escaped;
use crate::model::SETTINGS;
use crate::syntax::keywords;

/// The text in a `pre`.
pub(super) fn highlighted(text: &str) -> String {
    let keywords = keywords();
    let mut html = String::from("<pre>");
    let mut rest = text;
    let mut before = Class::Other;
    let mut place = Place::Elsewhere;
    while !rest.is_empty() {
        let (length, class) = token(rest, before, &keywords);
        let (part, behind) = rest.split_at(length);
        let class = place.class(part, class);
        match class.mark() {
            Some(mark) => html += &format!("<span class=\"{mark}\">{}</span>", escaped(part)),
            None => html += &escaped(part),
        }
        if !matches!(class, Class::Space | Class::Comment) {
            before = class;
            place = place.after(part, class);
        }
        rest = behind;
    }
    html + "</pre>"
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Comment,
    Text,
    Number,
    Unit,
    Keyword,
    /// `real`, `int`, `bool`: a unit may follow.
    Type,
    /// A name, or what stands for one.
    Name,
    Space,
    Other,
}

/// Where the text is, as to `run { }`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Elsewhere,
    /// Behind `run`.
    Head,
    /// In its braces, where a value must follow: behind an operator, a setting, an open bracket.
    Value,
    /// In its braces, where all is said, so that a setting may follow.
    Setting,
}

impl Place {
    /// What a word is here that is a name elsewhere.
    fn class(self, part: &str, class: Class) -> Class {
        match (self, class) {
            (Place::Setting, Class::Name) if SETTINGS.contains(&part) => Class::Keyword,
            _ => class,
        }
    }

    /// The place behind this part.
    fn after(self, part: &str, class: Class) -> Place {
        match (self, part) {
            (Place::Elsewhere, "run") if class == Class::Keyword => Place::Head,
            (Place::Head, "{") => Place::Setting,
            (Place::Elsewhere | Place::Head, _) | (_, "}") => Place::Elsewhere,
            (_, ")" | "]" | "'") => Place::Setting,
            _ if matches!(class, Class::Text | Class::Number | Class::Unit | Class::Name) => Place::Setting,
            _ => Place::Value,
        }
    }
}

impl Class {
    fn mark(self) -> Option<&'static str> {
        match self {
            Class::Comment => Some("c"),
            Class::Text => Some("s"),
            Class::Number => Some("n"),
            Class::Unit => Some("u"),
            Class::Keyword | Class::Type => Some("k"),
            Class::Name | Class::Space | Class::Other => None,
        }
    }
}

/// The length of what comes first, and what it is; `before` is what stood before it.
fn token(text: &str, before: Class, keywords: &[String]) -> (usize, Class) {
    let length = |fits: &dyn Fn(char) -> bool| text.find(|c| !fits(c)).unwrap_or(text.len());
    let first = text.chars().next().unwrap_or(' ');
    if text.starts_with("//") {
        return (text.find('\n').unwrap_or(text.len()), Class::Comment);
    }
    if first == '"' {
        return (text[1..].find(['"', '\n']).map_or(text.len(), |end| end + 2), Class::Text);
    }
    if first == '[' && matches!(before, Class::Number | Class::Type) {
        return (text.find([']', '\n']).map_or(text.len(), |end| end + 1), Class::Unit);
    }
    if first.is_whitespace() {
        return (length(&char::is_whitespace), Class::Space);
    }
    if first.is_ascii_digit() {
        let mantissa = length(&|c| c.is_ascii_digit() || c == '.');
        let exponent = text[mantissa..].strip_prefix(['e', 'E']).map_or(0, |tail| {
            let signed = tail.strip_prefix(['+', '-']).unwrap_or(tail);
            let digits = signed.find(|c: char| !c.is_ascii_digit()).unwrap_or(signed.len());
            if digits == 0 { 0 } else { 1 + tail.len() - signed.len() + digits }
        });
        return (mantissa + exponent, Class::Number);
    }
    if first.is_alphabetic() || first == '_' {
        let end = length(&|c| c.is_alphanumeric() || c == '_');
        let class = match &text[..end] {
            "real" | "int" | "bool" => Class::Type,
            word if keywords.iter().any(|keyword| keyword == word) => Class::Keyword,
            _ => Class::Name,
        };
        return (end, class);
    }
    (first.len_utf8(), Class::Other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_marked_as_what_they_are() {
        let html = highlighted("when x <= 2.5e-3 [m] // \"so\"\nparam v: real [m/s] = cars[1] \"a // b\"");
        assert_eq!(
            html,
            "<pre><span class=\"k\">when</span> x &lt;= <span class=\"n\">2.5e-3</span> <span class=\"u\">[m]</span> \
             <span class=\"c\">// &quot;so&quot;</span>\n<span class=\"k\">param</span> v: <span class=\"k\">real</span> \
             <span class=\"u\">[m/s]</span> = cars[<span class=\"n\">1</span>] <span class=\"s\">&quot;a // b&quot;</span></pre>"
        );
    }

    /// The words of a text that are marked as keywords, with the bytes at which they stand.
    fn marked(text: &str) -> Vec<(usize, String)> {
        let (mut found, mut at) = (Vec::new(), 0);
        for (k, part) in highlighted(text).split("<span class=\"").enumerate() {
            let (class, rest) = if k == 0 { ("", part) } else { part.split_once("\">").unwrap() };
            let (inside, behind) = rest.split_once("</span>").unwrap_or(("", rest));
            if class == "k" {
                found.push((at, inside.to_string()));
            }
            let plain = |text: &str| {
                text.replace("<pre>", "")
                    .replace("</pre>", "")
                    .replace("&quot;", "\"")
                    .replace("&gt;", ">")
                    .replace("&lt;", "<")
            };
            at += plain(inside).len() + plain(behind).len();
        }
        found
    }

    #[test]
    fn settings_are_marked_where_they_are_settings() {
        for setting in SETTINGS {
            let text = format!("run {{ until 2 [s]  {setting} 1 }}");
            assert!(marked(&text).contains(&(19, setting.to_string())), "{text}: {:?}", marked(&text));
        }
        let text = "agent seed { state seed, gamma = 1  flow { seed' = gamma } }
system { engine = seed(seed = 2) }
run { // seed
  seed seed*seed  tolerance (gamma)  events to \"seed\"
  record engine.seed, seed every seed to \"e\"  gamma engine [s]  engine fast threads -gamma
  stop when seed >= gamma or engine.seed' < seed // gamma
  backend gamma
}
param gamma = seed";
        let settings = marked(text).into_iter().filter(|(_, word)| {
            SETTINGS.contains(&word.as_str()) && !["record", "stop"].contains(&word.as_str())
        });
        let behind = [
            "seed seed*",
            "tolerance (",
            "events to",
            "gamma engine",
            "engine fast",
            "threads -",
            "backend gamma",
        ];
        let wanted = behind.map(|place| {
            let word = place.split(' ').next().unwrap();
            (text.find(place).unwrap(), word.to_string())
        });
        assert_eq!(settings.collect::<Vec<_>>(), wanted);
    }

    #[test]
    fn nothing_is_lost() {
        for text in ["\"open", "x[", "2e", "2e+", "é // ü", "1 [m", "é\"ü\nx"] {
            let html = highlighted(text);
            let parts: String =
                html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect();
            assert_eq!(parts.replace("&quot;", "\""), text);
        }
    }
}
