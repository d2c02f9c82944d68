//! Whatever is measured and whatever is asked for: no panic, no target above its limit, no power after a fault.

use crate::printer::{Printer, settings};
use corehbot::connectors::{HEATERS, Heater, OUTPUTS, Output, OutputSet, Sensor};
use corehbot::port::ThermalPort;
use corehbot::settings::{Guards, HeaterModel, HeaterSettings, Pid, ThermalSettings, Thermistor};
use corehbot::status::Status;
use corehbot::thermal::{Order, OrderQueue, ThermalControl};
use corehbot::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, Watts, WattsPerKelvin};
use proptest::prelude::*;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// A port that reads what it is told to.
#[derive(Default)]
struct Wild {
    samples: RefCell<[Option<u16>; 3]>,
    duties: Cell<[u16; OUTPUTS]>,
}

struct WildPort(Rc<Wild>);

impl ThermalPort for WildPort {
    fn sample(&mut self, sensor: Sensor) -> Option<u16> {
        self.0.samples.borrow()[match sensor {
            Sensor::Hotend0 => 0,
            Sensor::Bed => 1,
            _ => 2,
        }]
    }

    fn outputs(&self) -> OutputSet {
        OutputSet(0x1F)
    }

    fn heat(&mut self, duties: &[u16; OUTPUTS]) {
        self.0.duties.set(*duties);
    }

    fn fans(&self) -> usize {
        6
    }
}

fn any_heater_settings() -> impl Strategy<Value = HeaterSettings> {
    let bits = any::<[u32; 12]>();
    (bits, any::<i32>(), any::<u16>(), any::<u8>(), any::<bool>()).prop_map(|(b, most, period_ms, lost_s, is_pid)| {
        let base = *settings().heater(Heater::Hotend);
        HeaterSettings {
            thermistor: Thermistor::Beta { ohms: b[0], beta: period_ms },
            most: Celsius::from_bits(most),
            power: Watts::from_bits(b[1]),
            max_duty: Ratio::from_bits(b[2]),
            period_ms,
            control: if is_pid { corehbot::settings::Control::Pid } else { corehbot::settings::Control::Model },
            model: HeaterModel {
                capacity: JoulesPerKelvin::from_bits(b[3]),
                loss: WattsPerKelvin::from_bits(b[4]),
                fan_loss: WattsPerKelvin::from_bits(b[5]),
                heater_lag: Seconds::from_bits(b[6]),
                sensor_lag: Seconds::from_bits(b[7]),
            },
            pid: Pid { p: Ratio::from_bits(b[8]), i: Ratio::from_bits(b[9]), d: Ratio::from_bits(b[10]) },
            guards: Guards { heating: Ratio::from_bits(b[11]), lost_s, ..base.guards },
            ..base
        }
    })
}

fn any_order() -> impl Strategy<Value = Order> {
    let heater = (0..HEATERS).prop_map(|n| Heater::ALL[n]);
    let celsius = any::<i32>().prop_map(Celsius::from_bits);
    prop_oneof![
        (heater.clone(), celsius.clone()).prop_map(|(heater, target)| Order::Target(heater, target)),
        (heater.clone(), celsius, any::<u8>()).prop_map(|(heater, target, n)| Order::Tune(heater, target, n)),
        (any::<u8>(), any::<u16>()).prop_map(|(fan, speed)| Order::Fan(fan, speed)),
        any::<bool>().prop_map(Order::Motors),
        Just(Order::Off),
        Just(Order::StopTuning),
        (heater, any_heater_settings()).prop_map(|(heater, settings)| Order::Heater(heater, settings)),
    ]
}

fn limits(settings: &ThermalSettings) -> [Celsius; HEATERS] {
    Heater::ALL.map(|heater| settings.heater(heater).most)
}

proptest! {
    #[test]
    fn nothing_wild_raises_a_target_or_heats_after_a_fault(
        steps in proptest::collection::vec((any_order(), any::<[Option<u16>; 3]>(), 1..40_usize, any::<u32>()), 1..40),
    ) {
        let wild = Rc::new(Wild::default());
        let queue: &'static mut OrderQueue = Box::leak(Box::new(OrderQueue::new()));
        let (mut orders, orders_in) = queue.split();
        let status: &'static Status = Box::leak(Box::new(Status::new()));
        let mut limits = limits(&settings());
        let mut control = ThermalControl::new(&settings(), orders_in, status, WildPort(wild.clone()), crate::printer::Nobody);
        for (order, samples, periods, um) in steps {
            if let Order::Heater(heater, settings) = order {
                limits[heater as usize] = settings.most;
            }
            orders.enqueue(order).unwrap();
            *wild.samples.borrow_mut() = samples;
            status.heat().set_extruded_um(um);
            status.heat().set_filament_ahead([um, um.rotate_left(7)]);
            for _ in 0..periods {
                status.heat().beat_of_console();
                status.heat().beat_of_generator();
                status.count_look();
                control.period();
                for heater in Heater::ALL {
                    let target = status.heat().target(heater);
                    prop_assert!(target <= limits[heater as usize].max(Celsius::ZERO), "{heater:?} at {target}");
                }
                if status.fault().is_set() {
                    prop_assert_eq!(wild.duties.get(), [0; OUTPUTS]);
                }
            }
        }
    }
}

#[test]
fn wild_orders_leave_a_real_machine_below_its_limit() {
    let mut printer = Printer::new(&crate::constants(), settings());
    for n in 0..20_i32 {
        printer.order(Order::Target(Heater::Hotend, Celsius::from_bits(n.wrapping_mul(0x0765_4321))));
        printer.run(30.0);
        assert!(printer.hotend() < 290.0 && printer.duty(Output::He2) == 0.0);
    }
}
