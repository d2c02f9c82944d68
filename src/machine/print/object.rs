//! M486, EXCLUDE_OBJECT: the object that the following lines belong to. None is left out.

use super::{Answer, Entry, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Verdict, Words, skip_blanks};

/// With S a number, with A a name, with T a count; the other letters cancel. Without a grammar: a name has any letters.
pub(in crate::machine) const ENTRY: Entry = Entry::m("Jobs, pauses and waits", &[486])
    .judge(|_, text| match Words::new(text).next() {
        Some(word) if matches!(word.letter, b'S' | b'P' | b'C' | b'U') => Verdict::InOrder,
        _ => Verdict::Silent,
    })
    .does("S T A, P U C", "object of the following lines; leaving one out (P, U, C) is refused")
    .examples(&[
        ("M486 T3", &[]),
        ("M486 S1", &[]),
        ("M486 ACube (1)*", &[]),
        ("M486 S-1", &[]),
        ("M486 P1", &["echo:this firmware cannot leave out objects, ignored"]),
    ]);

/// Without a name it asks which objects are left out, with RESET=1 for none of them.
pub(in crate::machine) const EXCLUDE: Entry = Entry::name("Accepted silently", &["EXCLUDE_OBJECT"])
    .silently("lists skipped objects: none; with NAME= or CURRENT= it is refused")
    .judge(|_, text| {
        let asks = skip_blanks(text).get(..5).is_none_or(|word| !matches!(word, b"NAME=" | b"CURRE"));
        if asks { Verdict::Silent } else { Verdict::InOrder }
    })
    .examples(&[("EXCLUDE_OBJECT NAME=cube", &["echo:this firmware cannot leave out objects, ignored"])]);

pub(in crate::machine) fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'a>,
) -> Answer<'a> {
    match command.words().next() {
        Some(word) if command.code() == 486 && word.letter == b'S' => {
            let object = word.number.unwrap_or_default().to_thousandths().div_euclid(1000) as i32;
            main_loop.status.print_progress.set_object(object);
            Answer::Nothing
        }
        _ => Answer::Line(packed!("echo:this firmware cannot leave out objects, ignored")),
    }
}
