//! The note of the last self-test.

use crate::nor::{Nor, TEARS};
use crate::{newest, now, save, variant, with};
use corehbot::storage::{belt_loads, note_belt_loads, note_passed_test, passed_test};

fn note(flash: Nor, tested: u32) -> (bool, Nor) {
    let (result, flash) = with(flash, |memory| now(note_passed_test(memory, tested)));
    (result.is_ok(), flash)
}

fn noted(flash: Nor) -> (Option<u32>, Nor) {
    with(flash, |memory| now(passed_test(memory)).unwrap())
}

#[test]
fn a_note_survives_saves_and_erases_nothing_that_counts() {
    let (is_noted, flash) = note(Nor::blank(), 1);
    assert!(is_noted && flash.erases == [0x8000], "there was no slot to put it in");
    let mut flash = flash.revived();
    for n in 0..8 {
        let (is_saved, saved) = save(flash, &variant(n));
        assert!(is_saved);
        let (found, saved) = noted(saved.revived());
        assert_eq!(found, Some(u32::from(n) + 1), "after save {n}");
        let (is_noted, next) = note(saved, u32::from(n) + 2);
        assert!(is_noted && next.erases.is_empty());
        let (settings, next) = newest(next.revived());
        assert_eq!(settings, Some(variant(n)));
        flash = next.revived();
    }
}

#[test]
fn a_note_that_is_there_is_not_written_again_and_too_many_are_refused() {
    let (_, flash) = save(Nor::blank(), &variant(1));
    let (_, flash) = note(flash.revived(), 5);
    let (is_noted, mut flash) = note(flash.revived(), 5);
    assert!(is_noted && flash.operations == 0);
    let mut count = 1;
    while let (true, next) = note(flash.clone().revived(), 100 + count) {
        (flash, count) = (next, count + 1);
    }
    assert_eq!((count, noted(flash.clone()).0), (64, Some(163)));
    // The second save from here erases that sector again.
    let (_, flash) = save(flash.revived(), &variant(2));
    let (_, flash) = save(flash.revived(), &variant(3));
    let (is_noted, flash) = note(flash.revived(), 999);
    let (found, flash) = noted(flash.revived());
    assert!(is_noted && found == Some(999) && newest(flash).0 == Some(variant(3)));
}

/// A note is the old or the new one, or missing; settings stay unchanged.
#[test]
fn a_cut_leaves_no_note_that_was_not_written() {
    let (_, flash) = save(Nor::blank(), &variant(1));
    let (_, flash) = note(flash.revived(), 11);
    let flash = flash.revived();
    let (_, whole) = note(flash.clone(), 12);
    for left in 0..whole.operations {
        for tear in TEARS {
            let (_, cut) = note(flash.cut(left, tear), 12);
            let (found, cut) = noted(cut.revived());
            assert!(matches!(found, None | Some(11 | 12)), "{left} {tear:?}: {found:?}");
            let (settings, cut) = newest(cut.revived());
            assert_eq!(settings, Some(variant(1)));
            let (is_noted, cut) = note(cut.revived(), 13);
            assert!(is_noted && noted(cut.revived()).0 == Some(13), "{left} {tear:?}");
        }
    }
    // A save that erases its sector again.
    let (_, whole) = save(flash.clone(), &variant(2));
    let mut counts = [0; 2];
    for left in 0..whole.operations {
        for tear in TEARS {
            let (_, cut) = save(flash.cut(left, tear), &variant(2));
            let (found, cut) = noted(cut.revived());
            assert!(matches!(found, None | Some(11)), "{left} {tear:?}: {found:?}");
            counts[usize::from(found.is_some())] += 1;
            assert!(matches!(newest(cut.revived()).0, Some(s) if s == variant(1) || s == variant(2)));
        }
    }
    println!("lost and kept {counts:?}");
    // Those about the erase: both marks made zero, the erase, the note and the mark.
    assert!(counts[0] <= (8 + 1 + 8 + 4) * TEARS.len() && counts[1] > 100 * TEARS.len());
}

/// The load of belt motors is noted at any time, too: it erases no slot, and both notes stay.
#[test]
fn the_load_of_belt_motors_stands_beside_the_self_test() {
    let (is_saved, flash) = save(Nor::blank(), &variant(3));
    assert!(is_saved);
    let (_, flash) = note(flash.revived(), 5);
    let (result, flash) = with(flash.revived(), |memory| now(note_belt_loads(memory, [150, 60_000])));
    assert!(result.is_ok() && flash.erases.is_empty());
    let (loads, flash) = with(flash.revived(), |memory| now(belt_loads(memory)).unwrap());
    assert_eq!(loads, [150, 60_000]);
    let (tested, flash) = noted(flash);
    let (settings, _) = newest(flash.revived());
    assert_eq!((tested, settings), (Some(5), Some(variant(3))));
}
