//! Settings that earlier firmware has kept in a log.

use crate::cuts::cut_everywhere;
use crate::earlier::EarlierPages;
use crate::nor::{Nor, TEARS, Tear};
use crate::{newest, now, save, variant, with};
use corehbot::port::Storage as _;
use corehbot::settings::Settings;
use corehbot::storage;

/// What an image of earlier firmware has written in the emulator, from the begin of sector 1 on: M500 after M113 S7, S8
/// and S9.
const BY_AN_IMAGE: &[u8] = include_bytes!("../log_of_earlier_image.bin");

/// A save as earlier firmware did it.
fn save_earlier(flash: Nor, settings: &Settings) -> (bool, Nor) {
    let mut pages = EarlierPages::new(flash);
    let is_saved = now(storage::save(&mut pages, settings)).is_ok();
    (is_saved, pages.into_flash())
}

/// Logs of all fillings, whose newest settings lie in this sector or that, and what is stored there.
pub fn logs() -> Vec<(Nor, Settings)> {
    let mut flash = Nor::blank();
    let logs = (0..90).map(|n| {
        let (is_saved, whole) = save_earlier(flash.clone(), &variant(n));
        assert!(is_saved, "save {n}");
        flash = whole.revived();
        (flash.clone(), variant(n))
    });
    logs.collect()
}

#[test]
fn what_a_log_holds_is_found_and_saved_over() {
    let mut erased = [0; 2];
    for (n, (log, settings)) in logs().into_iter().enumerate() {
        let (found, log) = newest(log);
        assert!(found == Some(settings) && log.operations == 0, "log {n}");
        let (is_saved, flash) = save(log, &variant(500));
        assert!(is_saved && flash.erases.len() == 1);
        erased[usize::from(flash.erases[0] == 0x8000)] += 1;
        let (found, flash) = newest(flash.revived());
        assert_eq!(found, Some(variant(500)));
        // The sector of the log is the next.
        let (is_saved, flash) = save(flash.revived(), &variant(501));
        assert!(is_saved && newest(flash.revived()).0 == Some(variant(501)), "log {n}");
    }
    println!("sectors erased first: {erased:?}");
    assert!(erased.iter().all(|count| *count > 10));
}

#[test]
fn the_log_of_an_image_is_found() {
    let mut flash = Nor::blank();
    flash.cells[0x4000..][..BY_AN_IMAGE.len()].copy_from_slice(BY_AN_IMAGE);
    let (found, flash) = newest(flash);
    assert_eq!(found.map(|settings| settings.keepalive_s), Some(9));
    assert!(save(flash, &variant(1)).0);
}

/// The first and the second save after an update, the second of which erases the log.
#[test]
fn a_cut_in_the_saves_that_leave_a_log_behind_keeps_the_old_or_the_new() {
    for (log, _) in logs().into_iter().skip(3).step_by(41) {
        let (_, flash) = save(log.clone(), &variant(500));
        let is_erase = |left| left == flash.erased_at;
        let found = cut_everywhere(&log, &variant(500), is_erase);
        let next = cut_everywhere(&flash.clone().revived(), &variant(501), is_erase);
        println!("{found:?} {next:?}");
        assert!(found[0] > 1000 && next[0] > 1000);
    }
}

/// A cut under earlier firmware, also while its log went round and in ways that it did not survive itself; then the
/// update, without a start of the earlier one in between.
#[test]
fn what_a_cut_has_left_of_a_log_is_the_old_or_the_new() {
    let mut flash = Nor::blank();
    let (mut rounds, mut found) = (0, [0; 2]);
    for n in 0..90 {
        let (_, whole) = save_earlier(flash.clone(), &variant(n));
        let goes_round = !whole.erases.is_empty();
        rounds += usize::from(goes_round);
        let erase = whole.erased_at;
        let step = if goes_round { 4 } else { 83 };
        for left in
            (0..whole.operations).filter(|left| goes_round && *left == erase || left % step == usize::from(n) % step)
        {
            let tears =
                if goes_round && left == erase { TEARS.to_vec() } else { vec![TEARS[left / step % TEARS.len()]] };
            for tear in tears {
                let (_, cut) = save_earlier(flash.cut(left, tear), &variant(n));
                let (kept, cut) = newest(cut.revived());
                let old = n.checked_sub(1).map(variant);
                assert!(kept == old || kept == Some(variant(n)), "save {n}, {left} {tear:?}");
                found[usize::from(kept != old)] += 1;
                let (_, erased) = save(cut.cut(32 / 4, Tear::Anything), &variant(500));
                let (still, erased) = newest(erased.revived());
                assert_eq!(still, kept, "save {n}, {left} {tear:?}, then in an erase");
                let (is_saved, saved) = save(erased.revived(), &variant(501));
                assert!(is_saved && newest(saved.revived()).0 == Some(variant(501)));
            }
        }
        flash = whole.revived();
    }
    println!("{rounds} rounds, old and new after the cut {found:?}");
    assert!(rounds >= 3 && found[0] > 700);
}

/// Where slot B was in earlier firmware still: at 1024.
#[test]
fn a_record_in_the_earlier_place_is_found() {
    let (_, flash) = with(Nor::blank(), |memory| now(storage::save(memory, &variant(3))));
    let mut record = [0; 1024];
    let (_, _) = with(flash, |memory| {
        for (i, page) in record.chunks_mut(32).enumerate() {
            now(memory.read(32 * i as u32, page)).unwrap();
        }
    });
    let mut pages = EarlierPages::new(Nor::blank());
    for (i, page) in record.chunks(32).enumerate() {
        now(pages.write(1024 + 32 * i as u32, page)).unwrap();
    }
    let (found, flash) = newest(pages.into_flash());
    assert_eq!(found, Some(variant(3)));
    let (is_saved, flash) = save(flash, &variant(4));
    assert!(is_saved && flash.erases == [0x8000] && newest(flash.revived()).0 == Some(variant(4)));
}
