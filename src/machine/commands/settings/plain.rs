//! Plain settings: the numbers that rows of `crate::settings` have a letter for.

use crate::gcode::{Number, PlainWords};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::setting::Setting;
use crate::machine::main_loop::settings::LiveSettings;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::settings::plain::Word;
use crate::settings::ranges;
use crate::settings::rows::{Legal, Value};

/// All values of a line if each is legal, otherwise none; without values a report.
pub(super) fn set_plain(
    words: &PlainWords,
    s: &mut LiveSettings<'_>,
    modal: &Modal,
    clamps: &mut Clamps,
) -> Answer<'static> {
    let PlainWords { code, numbers } = words;
    if numbers.iter().all(Option::is_none) {
        return Answer::Setting(Setting::Plain(*code));
    }
    let fastest = [0, 1, 2, 3].map(|axis| ranges::STEP_RATE / s.finest(axis));
    let legal = |Word { key, .. }| {
        let part = usize::from(key.part);
        let legal = key.row.legal(part);
        match fastest.get(part) {
            // A motor steps only so fast.
            Some(fastest) if *code == 203 => Legal { most: legal.most.min(fastest.to_bits().into()), ..legal },
            _ => legal,
        }
    };
    s.set_plain(*code, &mut |word, field| {
        let Some(Some(number)) = numbers.get(word.place) else { return true };
        let old = if let Value::Number(old) = field.get() { Some(old) } else { None };
        let legal = legal(word);
        let is_zero = *number == Number::ZERO && legal.holds(0);
        let wanted = if is_zero { Some(0) } else { clamps.setting(modal, word, *number, legal, old) };
        wanted.is_some_and(|bits| field.set(&Value::Number(bits)))
    });
    Answer::Nothing
}
