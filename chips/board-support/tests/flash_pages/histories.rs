//! Thousands of saves, cuts and tears one after the other.

use crate::nor::{Nor, TEARS, Tear};
use crate::random::Random;
use crate::{newest, save, variant};
use corehbot::settings::Settings;
use corehbot::storage;

/// Operations of a save, and some more: a cut behind them does not come.
const OPERATIONS: usize = 230;

/// Saves with cuts in them, in several runs of the firmware. The result must be the settings of the last complete save,
/// or of one that was cut since.
fn follow(mut flash: Nor, mut may_be: Vec<Option<Settings>>, random: &mut Random, tears: &[Tear]) -> [usize; 2] {
    let mut counts = [0; 2];
    for _ in 0..12 {
        (flash.left, flash.tear) = match random.below(3) {
            0 => (usize::MAX, Tear::Not),
            // The begin of a save, where the erase is.
            1 => (random.below(20), random.choose(tears)),
            _ => (random.below(OPERATIONS), random.choose(tears)),
        };
        // One or two saves in this run.
        let (done, cut) = crate::with(flash, |memory| {
            (0..=random.below(2)).all(|_| {
                let wanted = variant(random.below(6000) as u16);
                may_be.push(Some(wanted));
                let is_saved = crate::now(storage::save(memory, &wanted)).is_ok();
                if is_saved {
                    may_be = vec![Some(wanted)];
                }
                is_saved
            })
        });
        counts[usize::from(done)] += 1;
        let (found, revived) = newest(cut.revived());
        assert!(may_be.contains(&found), "{counts:?} {random:?}");
        flash = revived.revived();
    }
    counts
}

fn follow_many(seeds: std::ops::Range<u32>, tears: &[Tear], begin: impl Fn(&mut Random) -> (Nor, Option<Settings>)) {
    let mut sums = [0; 2];
    for seed in seeds.clone() {
        let mut random = Random(seed);
        let (flash, old) = begin(&mut random);
        let counts = follow(flash, vec![old], &mut random, tears);
        sums = [sums[0] + counts[0], sums[1] + counts[1]];
    }
    println!("{} histories: runs with a cut and without {sums:?}", seeds.len());
    assert!(sums.iter().all(|sum| *sum > 2 * seeds.len()));
}

#[test]
fn the_last_or_a_cut_save_is_there_whatever_was_cut() {
    follow_many(0..1200, &TEARS, |random| match random.below(3) {
        0 => (Nor::blank(), None),
        1 => (Nor::code(), None),
        _ => (save(Nor::blank(), &variant(7)).1.revived(), Some(variant(7))),
    });
}

/// Cells that a cut has left between one and zero read as this or that.
#[test]
fn cells_that_nobody_can_be_sure_of_endanger_nothing() {
    follow_many(2000..2800, &[Tear::Unsure], |_| (Nor::blank(), None));
}
