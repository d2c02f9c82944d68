//! A cut in each operation of a save.

use crate::nor::{Nor, TEARS, Tear};
use crate::{newest, now, save, variant, with};
use corehbot::port::Storage as _;
use corehbot::settings::Settings;
use corehbot::storage::STRIDE;

/// Cuts a save of `settings` in every operation, in all ways. Afterwards the settings are the old or the new ones, and
/// can be saved over; that save is cut as well where `again` says so. Returns how often the old and how often the new
/// ones were found.
pub fn cut_everywhere(flash: &Nor, settings: &Settings, again: impl Fn(usize) -> bool) -> [usize; 2] {
    let (old, _) = newest(flash.clone());
    let (_, whole) = save(flash.clone(), settings);
    let mut found = [0; 2];
    for left in 0..whole.operations {
        for tear in TEARS {
            let (is_saved, cut) = save(flash.cut(left, tear), settings);
            assert!(!is_saved, "{left} {tear:?}");
            let (kept, cut) = newest(cut.revived());
            assert!(kept == old || kept == Some(*settings), "{left} {tear:?}: neither old nor new");
            found[usize::from(kept != old)] += 1;
            if again(left) {
                cut_again(&cut, settings, kept.as_ref(), left);
            }
            let (is_saved, cut) = save(cut, settings);
            assert!(is_saved && newest(cut).0 == Some(*settings), "{left} {tear:?}: saving again");
        }
    }
    found
}

/// Cuts the start-up and save after a cut, in the operations around the erase and in some others.
fn cut_again(flash: &Nor, settings: &Settings, old: Option<&Settings>, first: usize) {
    let (_, whole) = save(flash.clone(), settings);
    let about = whole.erased_at.saturating_sub(3)..whole.erased_at + 8;
    for left in about.chain((0..whole.operations).skip(first % 29).step_by(29)).filter(|left| *left < whole.operations)
    {
        for tear in TEARS {
            let (_, cut) = save(flash.cut(left, tear), settings);
            let (kept, _) = newest(cut.revived());
            assert!(kept.as_ref() == old || kept.as_ref() == Some(settings), "{first}, then {left} {tear:?}");
        }
    }
}

#[test]
fn a_cut_in_any_operation_leaves_the_old_or_the_new() {
    let mut flash = Nor::blank();
    for n in 0..4 {
        let (_, whole) = save(flash.clone(), &variant(n));
        let found = cut_everywhere(&flash, &variant(n), |_| false);
        println!("save {n}: {} operations, {} erases, {found:?}", whole.operations, whole.erases.len());
        // The last word of all decides.
        assert_eq!(found, [TEARS.len() * whole.operations, 0]);
        flash = whole.revived();
    }
}

#[test]
fn cuts_may_follow_each_other_in_any_two_saves() {
    let (_, flash) = save(Nor::blank(), &variant(1));
    let (_, flash) = save(flash.revived(), &variant(2));
    let (_, whole) = save(flash.clone().revived(), &variant(3));
    let erase = whole.erased_at;
    let found = cut_everywhere(&flash.revived(), &variant(3), |left| left.abs_diff(erase) < 8 || left % 17 == 0);
    println!("{found:?}");
    assert!(found[0] > 1000 && found[1] == 0);
}

/// Reproducer: a sector was taken for blank if its first and its last byte were, and for the one in use if its first
/// was as before. Both copies could be lost.
#[test]
fn an_erase_that_leaves_something_in_between_endangers_nothing() {
    let mut flash = Nor::blank();
    for n in 0..40 {
        let (_, whole) = save(flash.clone(), &variant(n));
        for tear in [Tear::SecondHalf, Tear::Ends, Tear::Nearly, Tear::Anything] {
            let (is_saved, cut) = save(flash.cut(whole.erased_at, tear), &variant(n));
            let (kept, cut) = newest(cut.revived());
            assert!(!is_saved && kept == n.checked_sub(1).map(variant), "save {n} {tear:?}");
            let (is_saved, cut) = save(cut.revived(), &variant(n));
            assert!(is_saved && newest(cut.revived()).0 == Some(variant(n)), "save {n} {tear:?}");
        }
        flash = whole.revived();
    }
}

/// Not even the record of before, which may read as whole.
#[test]
fn what_an_erase_has_left_that_was_cut_is_not_looked_at() {
    let (_, flash) = save(Nor::blank(), &variant(1));
    let (_, flash) = save(flash.revived(), &variant(2));
    let (_, whole) = save(flash.clone().revived(), &variant(3));
    assert_eq!(whole.erases, [0x4000]);
    for tear in TEARS.into_iter().chain([Tear::Unsure]) {
        let (_, cut) = save(flash.cut(whole.erased_at, tear), &variant(3));
        with(cut.revived(), |memory| {
            for at in (0..STRIDE).step_by(32) {
                let mut page = [0; 32];
                now(memory.read(at, &mut page)).unwrap();
                assert_eq!(page, [0xFF; 32], "{tear:?} {at}");
            }
        });
    }
}

/// A cut in the last word of a save: the next start may take the word as written or not. If it does, that save holds
/// the newest settings, and the next save erases the sector of the other settings. The uncertain word has to be certain
/// by then.
#[test]
fn a_record_that_may_be_seen_or_not_is_seen_for_good_before_the_other_is_erased() {
    let (_, flash) = save(Nor::blank(), &variant(1));
    let (_, whole) = save(flash.clone().revived(), &variant(2));
    let (_, mut flash) = save(flash.cut(whole.operations - 1, Tear::Unsure), &variant(2));
    let (_, next) = save(flash.clone().revived(), &variant(3));
    let mut counts = [0; 2];
    for _ in 0..60 {
        // Continues with the results of the previous run.
        let (_, again) = newest(flash.revived());
        flash = again.revived();
        let (_, cut) = save(flash.cut(next.erased_at.max(12), Tear::Anything), &variant(3));
        let is_seen = cut.erases == [0x4000];
        counts[usize::from(is_seen)] += 1;
        let mut read = cut.revived();
        for _ in 0..20 {
            let (found, same) = newest(read);
            assert!(found == Some(variant(2)) || !is_seen && found == Some(variant(1)), "{is_seen}");
            read = same;
        }
    }
    println!("not seen and seen {counts:?}");
    assert!(counts.iter().all(|count| *count > 5));
}
