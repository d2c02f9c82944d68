//! M915: aligns the motors of one belt, or checks them.

use super::belt_check::{align_belt, examine_belt};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Verdict, Words};
use crate::machine::apart::apart;
use core::pin::pin;

pub(in crate::machine) const ENTRY: Entry = Entry::m("Motors and drivers", &[915])
    .grammar(&Grammar::numbers(b""))
    .judge(|_, text| if is_foreign(text) { Verdict::Unknown } else { Verdict::InOrder })
    .does("D, R", "aligns the motors of a belt; D diagnoses, R repairs ([belt](../explanation/belt/alignment.md))")
    .examples(&[("M915 D", &["echo:nothing to compare with: align the belt motors first (M915)"])]);

/// RepRapFirmware's is another command; it has these words in addition to its axes, and a number at its R. D and R are
/// two things at once.
fn is_foreign(text: &[u8]) -> bool {
    let words = || Words::new(text);
    let has = |letter| words().any(|word| word.letter == letter);
    let has_number = |letter| words().filter(|word| word.letter == letter).last().is_some_and(|it| it.number.is_some());
    words().any(|word| b"PSFHT".contains(&word.letter))
        || has_number(b'D')
        || has_number(b'R')
        || has(b'D') && has(b'R')
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { notices, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let repairs = command.has(b'R');
    if repairs || command.has(b'D') {
        apart(pin!(examine_belt(main_loop, notices, repairs))).await
    } else {
        align_belt(main_loop, notices).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_belt_is_aligned_and_looked_at() {
        for text in ["", " D", " R", " X Y", "D;P"] {
            assert!(!is_foreign(text.as_bytes()), "{text}");
        }
        // Of another firmware, or two things at once.
        for text in [" D R", " R1", " D0", " X S3", " R F0", " H200 T1"] {
            assert!(is_foreign(text.as_bytes()), "{text}");
        }
    }
}
