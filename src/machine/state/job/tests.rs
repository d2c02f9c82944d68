//! What ends a job stands in the reference in the words that the user reads.

extern crate std;

use super::*;
use std::string::ToString;
use std::vec;
use std::vec::Vec;

/// The ends that a job can have, with some figures.
fn ends() -> Vec<JobEnd> {
    let (heater, axis) = (Heater::Hotend, HomedAxis::Z);
    let (near, far) = (Mm::lit("1"), Mm::lit("7"));
    let homing = [
        HomingFailure::NotConnected,
        HomingFailure::NeedsOthers,
        HomingFailure::NotMet { way: 300 },
        HomingFailure::StillPressed { back_off: 5 },
    ];
    let probing = [
        ProbeFailure::Triggered,
        ProbeFailure::NotMet { floor: near, expected: far },
        ProbeFailure::NotFound { way: far },
        ProbeFailure::NotTakenIn,
        ProbeFailure::Early { height: far, expected: near },
        ProbeFailure::Spread { spread: far, tolerance: near },
    ];
    let levelling = [LevelFailure::NotNearer { was: near, now: far }, LevelFailure::TooFar { now: far }];
    let others = [
        JobEnd::Unreachable { heater, at: 150, target: 200 },
        JobEnd::Unread { heater },
        JobEnd::Refused { why: Fault::plain(crate::fault::Cause::TooCold) },
        JobEnd::Refused { why: Fault::plain(crate::fault::Cause::TooHot) },
        JobEnd::Cancelled,
        JobEnd::Conditional,
    ];
    let homing = homing.map(|why| JobEnd::NotHomed { axis, why });
    let probing = probing.map(|why| JobEnd::ProbeFailed { why });
    let levelling = levelling.map(JobEnd::NotLevel);
    [&homing[..], &probing, &levelling, &others].concat()
}

#[test]
fn each_end_has_one_row_of_the_reference_and_each_row_an_end() {
    let document = include_str!("../../../../docs/reference/errors.md");
    let (_, part) = document.split_once("\n## Jobs that end\n").unwrap();
    let (part, _) = part.split_once("\n## ").unwrap();
    let rows: Vec<_> = part.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect();
    let mut met = vec![0; rows.len()];
    for end in ends() {
        let told = end.to_string();
        let of: Vec<_> = (0..rows.len()).filter(|row| told.contains(rows[*row])).collect();
        assert_eq!(of.len(), 1, "{told}: {rows:?}");
        met[of[0]] += 1;
    }
    assert!(met.iter().all(|count| *count > 0), "{rows:?}: {met:?}");
}
