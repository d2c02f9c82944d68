//! Settings that are absurd (F20, F87) or change while a heater is on (F40 is in `thermal::scrub`).

use super::{break_it, constants, is_off, printing};
use crate::printer::{Printer, settings};
use corehbot::connectors::{Heater, Output};
use corehbot::settings::{Control, Pid};
use corehbot::thermal::Order;
use corehbot::units::{JoulesPerKelvin, Ratio};
use corehbot_rig::plant::{HeaterFault, Plant, SensorFault};

#[test]
fn f20_absurd_gains_heat_no_further_than_the_limit() {
    for gain in [Ratio::ZERO, Ratio::MAX] {
        let mut settings = settings();
        let hotend = settings.heater_mut(Heater::Hotend);
        (hotend.control, hotend.pid) = (Control::Pid, Pid { p: gain, i: gain, d: gain });
        let mut printer = Printer::with(Plant::hot(&constants(), 200.0, 25.0), settings);
        printer.set(Heater::Hotend, 215.0);
        let mut hottest = 0.0_f64;
        for _ in 0..10_000 {
            printer.period();
            assert!((0.0..=1.0).contains(&printer.duty(Output::He0)));
            hottest = hottest.max(printer.hotend());
        }
        println!("gains of {gain}: {hottest:.0} C at most, {:?}", printer.fault());
        assert!(hottest < 320.0);
    }
}

#[test]
fn a_heater_that_is_hung_elsewhere_goes_off() {
    let mut printer = printing();
    let mut moved = *settings().heater(Heater::Hotend);
    moved.output = Output::He1;
    printer.order(Order::Heater(Heater::Hotend, moved));
    printer.period();
    assert_eq!(printer.duty(Output::He0), 0.0);
    assert_eq!(printer.status.heat().target(Heater::Hotend).to_num::<i32>(), 0);
}

#[test]
fn other_gains_change_nothing_else() {
    let mut printer = printing();
    let mut tuned = *settings().heater(Heater::Hotend);
    tuned.pid.p = Ratio::lit("30");
    printer.order(Order::Heater(Heater::Hotend, tuned));
    printer.run(60.0);
    assert_eq!(printer.fault(), None);
    assert!((printer.hotend() - 215.0).abs() < 1.0, "{}", printer.hotend());
}

/// Reproducer: settings that came again and again (M301, M306) restarted every guard, so that none ever found a fault.
#[test]
fn settings_that_keep_coming_hold_up_no_guard() {
    for (is_frozen, celsius) in [(false, 20.0), (false, 215.0), (true, 215.0)] {
        let mut printer = Printer::with(Plant::hot(&constants(), celsius, 25.0), settings());
        printer.set(Heater::Hotend, 215.0);
        printer.run(if celsius > 200.0 { 60.0 } else { 1.0 });
        break_it(&printer, |faults| {
            if is_frozen {
                faults.hotend_sensor = SensorFault::Frozen;
            } else {
                faults.hotend_heater = HeaterFault::OPEN;
            }
        });
        let mut changed = *settings().heater(Heater::Hotend);
        for second in 0..60_u8 {
            let turn = second % 2;
            (changed.pid.p, changed.model.capacity) =
                (Ratio::from_num(20 + turn), JoulesPerKelvin::from_num(11 + turn));
            printer.order(Order::Heater(Heater::Hotend, changed));
            // To detect a frozen sensor the guards need another power now and then.
            printer.set(Heater::Hotend, if second % 4 < 2 { 215.0 } else { 225.0 });
            printer.run(1.0);
        }
        println!("settings every second, from {celsius} C: {:?}", printer.fault());
        assert!(printer.fault().is_some() && is_off(&printer));
    }
}

#[test]
fn an_output_that_the_board_does_not_offer_does_not_heat() {
    let mut settings = settings();
    settings.heater_mut(Heater::Hotend).output = Output::He2;
    let mut printer = Printer::new(&constants(), settings);
    printer.set(Heater::Hotend, 215.0);
    printer.run(10.0);
    assert!(is_off(&printer) && printer.duty(Output::He2) == 0.0);
}
