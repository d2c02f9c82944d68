//! Expressions of the preprocessor, as far as settings use them: numbers, names, arithmetic, comparisons, `&&`, `||`,
//! `!`, and Marlin's macros (`Marlin/src/core/macros.h`: ENABLED, DISABLED, ANY, ALL, NONE, EITHER, BOTH).

/// Names, for expressions.
pub(super) trait Names {
    /// The number of a name, if it is known.
    fn number(&self, name: &str, depth: usize) -> Option<f64>;
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
pub(super) fn value(text: &str, names: &dyn Names, depth: usize) -> Option<f64> {
    if depth > DEEPEST {
        return None;
    }
    let mut parser = Parser { rest: text.trim(), names, depth, levels: 0 };
    let value = parser.any()?;
    parser.rest.trim().is_empty().then_some(value)?
}

/// A known number, or none; the outer `Option` of the parser is for text that is no expression.
type Known = Option<f64>;

struct Parser<'t> {
    rest: &'t str,
    names: &'t dyn Names,
    depth: usize,
    levels: usize,
}

fn truth(is: bool) -> f64 {
    if is { 1.0 } else { 0.0 }
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
                (Some(a), _) | (_, Some(a)) if a != 0.0 => Some(1.0),
                (Some(_), Some(_)) => Some(0.0),
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
                (Some(a), _) | (_, Some(a)) if a == 0.0 => Some(0.0),
                (Some(_), Some(_)) => Some(1.0),
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
                return Some(left.zip(right).map(|(a, b)| truth(compare(a, b))));
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
            left = left.zip(right).map(|(a, b)| a + sign * b);
        }
    }

    fn product(&mut self) -> Option<Known> {
        let mut left = self.unary()?;
        loop {
            if self.eat("*") {
                let right = self.unary()?;
                left = left.zip(right).map(|(a, b)| a * b);
            } else if self.eat("/") {
                let right = self.unary()?;
                left = left.zip(right).filter(|(_, b)| *b != 0.0).map(|(a, b)| a / b);
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
            self.unary()?.map(|a| truth(a == 0.0))
        } else if self.eat("-") {
            self.unary()?.map(|a| -a)
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
            return Some(Some(truth(word == "true")));
        }
        if word == "defined" && !self.rest.trim_start().starts_with('(') {
            let name = self.atom_name()?;
            return Some(self.names.is_defined(name).map(truth));
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
        is.map(truth)
    }
}

/// A number with the suffixes of C.
fn number(word: &str) -> Option<f64> {
    if let Some(digits) = word.strip_prefix("0x").or_else(|| word.strip_prefix("0X")) {
        return i64::from_str_radix(digits, 16).ok().map(|number| number as f64);
    }
    let plain = word.trim_end_matches(['f', 'F', 'u', 'U', 'l', 'L']);
    plain.parse().ok().filter(|number: &f64| number.is_finite())
}
