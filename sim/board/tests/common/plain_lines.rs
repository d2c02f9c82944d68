//! A line for each plain setting, from its row.

use corehbot::settings::Settings;
use corehbot::settings::plain::CODES;
use corehbot::settings::rows::Value;
use std::collections::BTreeMap;

/// The lines of plain settings by their keys. Each sets a legal value that the prototype does not have: half of its
/// own, or a quarter of the greatest.
pub fn plain_lines() -> BTreeMap<String, String> {
    let mut lines = BTreeMap::new();
    for code in CODES {
        Settings::prototype().visit_code(*code, &mut |word, field| {
            let legal = word.key.row.legal(word.key.part.into());
            let now = if let Value::Number(now) = field.get() { now } else { legal.least };
            let half = legal.least + (now - legal.least) / 2;
            let other = if half == now { now + 1 + (legal.most - now) / 4 } else { half };
            let number = other as f64 / (1_u64 << word.line.bits) as f64;
            lines.insert(word.key.to_string(), format!("M{code} {}{number}", word.letter()));
        });
    }
    lines
}
