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

#[test]
fn wild_orders_leave_a_real_machine_below_its_limit() {
    let mut printer = Printer::new(&super::constants(), settings());
    for n in 0..20_i32 {
        printer.order(Order::Target(Heater::Hotend, Celsius::from_bits(n.wrapping_mul(0x0765_4321))));
        printer.run(30.0);
        assert!(printer.hotend() < 290.0 && printer.duty(Output::He2) == 0.0);
    }
}
