//! For all readings and commands: no panic, no target above its limit, no power after a fault.

use crate::printer::{Printer, settings};
use crate::wild_heat::heat_orders;
use corehbot::connectors::{Heater, Output};
use corehbot::thermal::Order;
use corehbot::units::Celsius;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_wild_raises_a_target_or_heats_after_a_fault(data in proptest::collection::vec(any::<u8>(), 0..2000)) {
        heat_orders(&data);
    }

    // Readings that stay in place let heaters be on for long enough to be wrong.
    #[test]
    fn nothing_wild_heats_beyond_what_is_ordered(
        steps in proptest::collection::vec((0..2_u8, any::<u32>(), 0..7_u8, any::<[u8; 5]>(), 0..64_u8), 1..60),
    ) {
        let mut data = Vec::new();
        for (heater, target, order, rest, periods) in steps {
            // Up to 300 C.
            let target = (target % (300 << 20)).to_le_bytes();
            match order {
                0..=3 => data.extend([&[order, heater], target.as_slice()].concat()),
                4 => data.extend([[4, rest[0]], [rest[1], rest[2]]].concat()),
                _ => data.extend([order, rest[0]]),
            }
            if order == 3 {
                data.push(rest[0]);
            }
            // Some 25 C at both, with a little noise.
            for noise in [rest[1], rest[2], rest[3]] {
                data.extend((62_593 + u16::from(noise % 3)).to_le_bytes());
            }
            data.extend([0; 12]);
            data.extend([periods, if rest[4] < 8 { rest[4] } else { 0 }]);
        }
        heat_orders(&data);
    }
}

/// Reproducer: a target that waits for the end of a self-test stayed when the bed's readings began to flicker. These
/// bytes were found by the property above.
#[test]
fn a_target_that_a_self_test_holds_ends_when_heat_is_refused() {
    heat_orders(&[
        107, 188, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 238, 195, 143, 122, 192, 205, 97, 36, 141, 200, 180, 190,
        63, 160, 129, 50, 199, 140, 16, 4, 59, 107, 21, 89, 65, 47, 7, 1, 91, 150, 128, 178, 39, 69, 163, 36, 74, 14,
        5, 18, 161, 127, 74, 19, 65, 27, 247, 228, 219, 237, 24, 216, 178, 169, 119, 220, 210, 187, 226, 67, 215, 206,
        99, 59, 253, 24, 46, 51, 206, 11, 149, 150, 136, 199, 140, 84, 153, 128, 186, 37, 8, 129, 71, 41, 5, 74, 69,
        194, 231, 202, 209, 27, 253, 13, 254, 64, 110, 225, 179, 117, 39, 121, 209, 95, 55, 93, 135, 83, 223, 110, 29,
        121, 137, 200, 66, 167, 17, 156, 38, 205, 99, 98, 150, 211, 216, 165, 226, 112, 151, 85, 81, 42, 254, 8, 93,
    ]);
}

#[test]
fn wild_orders_leave_a_real_machine_below_its_limit() {
    let mut printer = Printer::new(&super::constants(), settings());
    for n in 0..20_i32 {
        printer.order(Order::Target(Heater::Hotend, Celsius::from_bits(n.wrapping_mul(0x0765_4321))));
        printer.run(30.0);
        assert!(printer.hotend() < 290.0 && printer.duty(Output::He2) == 0.0);
    }
}
