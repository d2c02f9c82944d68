//! The port answers each request as `embassy-usb` does, whose class CDC ACM it stands in for.

use crate::common::{Bench, CLOSE, LINE, OPEN, SET_ADDRESS, SET_CONFIGURATION, SET_LINE, clear_halt, halt};
use proptest::prelude::*;

/// Says the requests to both, and compares the answers.
fn compare(requests: &[([u8; 8], Vec<u8>)]) {
    let mut benches = [Bench::new(), Bench::of_embassy()];
    benches.iter_mut().for_each(Bench::reset);
    for (setup, data) in requests {
        let [ours, theirs] = &mut benches;
        assert_eq!(ours.request(*setup, data), theirs.request(*setup, data), "{setup:?} {data:?}");
    }
    let [ours, theirs] = benches.map(|bench| bench.breaches());
    assert_eq!(ours, theirs);
}

/// A request for a descriptor.
const fn descriptor(kind: u8, number: u8, length: u16) -> [u8; 8] {
    let [low, high] = length.to_le_bytes();
    [0x80, 6, number, kind, 0, 0, low, high]
}

#[test]
fn every_descriptor_is_the_same_at_every_length() {
    for kind in 0..=17 {
        for number in 0..5 {
            let lengths = [1, 2, 4, 8, 9, 18, 63, 64, 65, 70, 71, 127, 128, 255];
            compare(&lengths.map(|length| (descriptor(kind, number, length), Vec::new())));
        }
    }
}

/// A request with few bits set, as the defined ones have.
fn request() -> impl Strategy<Value = ([u8; 8], Vec<u8>)> {
    let known = prop_oneof![
        Just(SET_ADDRESS),
        Just(SET_CONFIGURATION),
        Just([0, 9, 0, 0, 0, 0, 0, 0]),
        Just(OPEN),
        Just(CLOSE),
        Just([0xA1, 0x21, 0, 0, 0, 0, 7, 0]),
        (0..5_u8).prop_map(|n| halt([0x81, 0x82, 1, 2, 0x8F][usize::from(n)])),
        (0..5_u8).prop_map(|n| clear_halt([0x81, 0x82, 1, 2, 0x8F][usize::from(n)])),
        (0..5_u8).prop_map(|n| [0x82, 0, 0, 0, [0x81, 0x82, 1, 2, 0x8F][usize::from(n)], 0, 2, 0]),
        (0..3_u8, 0..2_u8).prop_map(|(index, value)| [1, 11, value, 0, index, 0, 0, 0]),
    ];
    let target = prop_oneof![0..4_u8, 0x20..0x24_u8, 0x40..0x42_u8];
    let near = (any::<bool>(), target, 0..14_u8, 0..3_u8, 0..3_u8, 1..3_u8).prop_map(
        |(is_in, target, code, value, index, length)| {
            // What the host has in these bytes goes to the host alone.
            let length = if is_in { length } else { 0 };
            [target | u8::from(is_in) << 7, code, value, 0, index, 0, length, 0]
        },
    );
    let line = any::<[u8; 4]>().prop_map(|rate| {
        let mut data = LINE.to_vec();
        data[..4].copy_from_slice(&rate);
        (SET_LINE, data)
    });
    prop_oneof![known.prop_map(|setup| (setup, Vec::new())), near.prop_map(|setup| (setup, Vec::new())), line]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn requests_in_any_order_are_answered_the_same(requests in proptest::collection::vec(request(), 1..30)) {
        // One address, at the begin. A configuration before it and another address later are not specified (USB 2.0,
        // sections 9.4.7 and 9.4.6): ours ends a halt then, and stays configured.
        let mut all = vec![(SET_ADDRESS, Vec::new())];
        all.extend(requests.into_iter().filter(|(setup, _)| setup[1] != SET_ADDRESS[1]));
        compare(&all);
    }
}
