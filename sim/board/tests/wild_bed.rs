//! A host says anything about the bed, and its probe breaks in any way. The nozzle never goes below the floor of a
//! touch, every line is answered once, heaters are off after an end, and positions are exact.

use crate::common::wild_bed as body;
use body::bed_gcode;

/// Machines, of two lives each; a soak has more (`COREHBOT_SOAK_SEEDS`, from `COREHBOT_BED_SEED`).
const SEEDS: u64 = 8;

/// Bytes of a seed (SplitMix64).
fn bytes(seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0xd134_2543_de82_ef95);
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as u8
    };
    (0..200).map(|_| next()).collect()
}

#[test]
fn nothing_that_is_said_breaks_the_bed_or_the_position() {
    let (from, seeds) = (number("COREHBOT_BED_SEED").unwrap_or(0), number("COREHBOT_SOAK_SEEDS").unwrap_or(SEEDS));
    for seed in from..from + seeds {
        println!("COREHBOT_BED_SEED={seed}");
        bed_gcode(&bytes(seed));
    }
}

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().map(|text| text.parse().unwrap())
}
