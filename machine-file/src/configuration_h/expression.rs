//! Expressions of the preprocessor, as far as settings use them: numbers, names, arithmetic, comparisons, `&&`, `||`,
//! `!`, and Marlin's macros (`Marlin/src/core/macros.h`: ENABLED, DISABLED, ANY, ALL, NONE, EITHER, BOTH).

/// Names, for expressions.
pub(super) trait Names {
    /// The number of a name, if it is known.
    fn number(&self, name: &str, depth: usize) -> Option<Number>;
    /// Whether it is defined.
    fn is_defined(&self, name: &str) -> Option<bool>;
    /// Whether it is defined and switched on: it has no value, or 1, or true.
    fn is_enabled(&self, name: &str) -> Option<bool>;
    /// A macro of Marlin that asks for the driver of an axis.
    fn is_of_driver(&self, macro_name: &str, axis: &str) -> Option<bool>;
}

/// Names that lead to names deeper than this are taken for a loop.
const DEEPEST: usize = 40;

/// The value of an expression; `None` if something in it is not known.
pub(super) fn value(text: &str, names: &dyn Names, depth: usize) -> Option<Number> {
    if depth > DEEPEST {
        return None;
    }
    let mut parser = Parser { rest: text.trim(), names, depth, levels: 0 };
    let value = parser.any()?;
    parser.rest.trim().is_empty().then_some(value)?
}

/// A number of C: a quotient of two whole ones is whole.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Number {
    pub value: f64,
    pub is_whole: bool,
}

impl Number {
    pub fn whole(value: f64) -> Self {
        Self { value, is_whole: true }
    }

    fn truth(is: bool) -> Self {
        Self::whole(if is { 1.0 } else { 0.0 })
    }

    pub fn is_true(self) -> bool {
        self.value != 0.0
    }

    fn with(self, other: Self, value: f64) -> Self {
        Self { value, is_whole: self.is_whole && other.is_whole }
    }

    pub fn over(self, other: Self) -> Option<Self> {
        let quotient = (other.value != 0.0).then(|| self.with(other, self.value / other.value))?;
        Some(if quotient.is_whole { Self::whole(quotient.value.trunc()) } else { quotient })
    }
}

/// A known number, or none; the outer `Option` of the parser is for text that is no expression.
type Known = Option<Number>;

struct Parser<'t> {
    rest: &'t str,
    names: &'t dyn Names,
    depth: usize,
    levels: usize,
}

impl<'t> Parser<'t> {
    fn eat(&mut self, sign: &str) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(sign) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn any(&mut self) -> Option<Known> {
        let mut left = self.all()?;
        while self.eat("||") {
            let right = self.all()?;
            left = match (left, right) {
                (Some(a), _) | (_, Some(a)) if a.is_true() => Some(Number::truth(true)),
                (Some(_), Some(_)) => Some(Number::truth(false)),
                _ => None,
            };
        }
        Some(left)
    }

    fn all(&mut self) -> Option<Known> {
        let mut left = self.comparison()?;
        while self.eat("&&") {
            let right = self.comparison()?;
            left = match (left, right) {
                (Some(a), _) | (_, Some(a)) if !a.is_true() => Some(Number::truth(false)),
                (Some(_), Some(_)) => Some(Number::truth(true)),
                _ => None,
            };
        }
        Some(left)
    }

    fn comparison(&mut self) -> Option<Known> {
        let left = self.sum()?;
        type Compare = fn(f64, f64) -> bool;
        const SIGNS: [(&str, Compare); 6] = [
            ("==", |a, b| a == b),
            ("!=", |a, b| a != b),
            ("<=", |a, b| a <= b),
            (">=", |a, b| a >= b),
            ("<", |a, b| a < b),
            (">", |a, b| a > b),
        ];
        for (sign, compare) in SIGNS {
            if self.eat(sign) {
                let right = self.sum()?;
                return Some(left.zip(right).map(|(a, b)| Number::truth(compare(a.value, b.value))));
            }
        }
        Some(left)
    }

    fn sum(&mut self) -> Option<Known> {
        let mut left = self.product()?;
        loop {
            let sign = if self.eat("+") {
                1.0
            } else if self.eat("-") {
                -1.0
            } else {
                return Some(left);
            };
            let right = self.product()?;
            left = left.zip(right).map(|(a, b)| a.with(b, a.value + sign * b.value));
        }
    }

    fn product(&mut self) -> Option<Known> {
        let mut left = self.unary()?;
        loop {
            if self.eat("*") {
                let right = self.unary()?;
                left = left.zip(right).map(|(a, b)| a.with(b, a.value * b.value));
            } else if self.eat("/") {
                let right = self.unary()?;
                left = left.zip(right).and_then(|(a, b)| a.over(b));
            } else {
                return Some(left);
            }
        }
    }

    fn unary(&mut self) -> Option<Known> {
        self.levels += 1;
        if self.levels > DEEPEST {
            return None;
        }
        self.rest = self.rest.trim_start();
        let value = if self.rest.starts_with('!') && !self.rest.starts_with("!=") {
            self.rest = &self.rest[1..];
            self.unary()?.map(|a| Number::truth(!a.is_true()))
        } else if self.eat("-") {
            self.unary()?.map(|a| Number { value: -a.value, ..a })
        } else if self.eat("+") {
            self.unary()?
        } else if self.eat("(") {
            let inner = self.any()?;
            self.eat(")").then_some(inner)?
        } else {
            self.atom()?
        };
        self.levels -= 1;
        Some(value)
    }

    fn atom(&mut self) -> Option<Known> {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '.';
        let end = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        if word.is_empty() {
            return None;
        }
        self.rest = rest;
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
            return number(word).map(Some);
        }
        if word == "true" || word == "false" {
            return Some(Some(Number::truth(word == "true")));
        }
        if word == "defined" && !self.rest.trim_start().starts_with('(') {
            let name = self.atom_name()?;
            return Some(self.names.is_defined(name).map(Number::truth));
        }
        if self.eat("(") {
            let end = self.rest.find(')')?;
            let (inner, rest) = self.rest.split_at(end);
            self.rest = &rest[1..];
            return Some(self.of_macro(word, inner));
        }
        Some(self.names.number(word, self.depth + 1))
    }

    fn atom_name(&mut self) -> Option<&'t str> {
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!name.is_empty()).then_some(name)
    }

    fn of_macro(&self, name: &str, inner: &str) -> Known {
        let each = |is: &dyn Fn(&str) -> Option<bool>| inner.split(',').map(|name| is(name.trim())).collect::<Vec<_>>();
        let enabled = || each(&|name| self.names.is_enabled(name));
        let any = |all: Vec<Option<bool>>| match all {
            all if all.contains(&Some(true)) => Some(true),
            all if all.contains(&None) => None,
            _ => Some(false),
        };
        let all = |all: Vec<Option<bool>>| any(all.into_iter().map(|is| is.map(|is| !is)).collect()).map(|is| !is);
        let is = match name {
            "ENABLED" | "ALL" | "BOTH" => all(enabled()),
            "DISABLED" | "NONE" => any(enabled()).map(|is| !is),
            "ANY" | "EITHER" => any(enabled()),
            "defined" => self.names.is_defined(inner.trim()),
            _ => self.names.is_of_driver(name, inner.trim()),
        };
        is.map(Number::truth)
    }
}

/// A number with the suffixes of C.
fn number(word: &str) -> Option<Number> {
    if let Some(digits) = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")) {
        return i64::from_str_radix(digits, 16).ok().map(|number| Number::whole(number as f64));
    }
    let plain = word.trim_end_matches(['f', 'F', 'u', 'U', 'l', 'L']);
    let is_whole = word.trim_end_matches(['u', 'U', 'l', 'L']).chars().all(|c| c.is_ascii_digit());
    let value = plain.parse().ok().filter(|number: &f64| number.is_finite())?;
    Some(Number { value, is_whole })
}
