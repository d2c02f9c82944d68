//! Orders: the Console's commands to heaters and fans. They go through a queue, so that the control period gets each of
//! them whole.

use crate::connectors::Heater;
use crate::settings::{EXTRA_SENSORS, ExtraSensor, FanSettings, HeaterSettings, ThermalSettings};
use crate::units::Celsius;
use heapless::spsc::{Consumer, Producer, Queue};

/// Orders that may wait for the next control period, less one. When it is full, the sender keeps the latest order of
/// each kind (`machine::state::heat_orders`). So a complete set of settings, eleven orders, takes two periods.
const MOST: usize = 8;

/// Memory of the queue.
pub type OrderQueue = Queue<Order, MOST>;
/// The Console's end.
pub type Orders<'m> = Producer<'m, Order>;
/// The end of the control period.
pub type OrdersIn<'m> = Consumer<'m, Order>;

/// A command to heaters or fans.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order {
    /// A heater's target; 0 or less is off. A target beyond the heater's limit is set to the limit.
    Target(Heater, Celsius),
    /// Commanded speed of a fan with a commanded role: 0 to 65,535.
    Fan(u8, u16),
    /// Whether any motor has power.
    Motors(bool),
    /// Everything off, except fans that cool hot parts.
    Off,
    /// Tune a heater around this temperature, with so many cycles (M303).
    Tune(Heater, Celsius, u8),
    /// End a tuning, and a self-test without a result.
    StopTrials,
    /// Test that each heater warms its own sensor; targets wait until then.
    SelfTest,
    /// Other settings for a heater.
    Heater(Heater, HeaterSettings),
    /// A heater's power and movement when it is healthy, with 8 fractional bits, as stored; zeros begin to learn them.
    Baseline(Heater, [u16; 2]),
    /// Other settings for a fan.
    FanSettings(u8, FanSettings),
    /// All other settings, without heaters and fans.
    Common(Common),
}

/// Settings that belong to no heater and no fan.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub struct Common {
    /// The hotend's fan runs above this temperature.
    pub hotend_fan_above: Celsius,
    /// Run-on time of the controller fan in s.
    pub fan_run_on_s: u16,
    /// Heat that filament takes up, in J/(K mm).
    pub filament: crate::units::WattsPerKelvin,
    /// Sensors that may guard a heater.
    pub sensors: [ExtraSensor; EXTRA_SENSORS],
}

impl Common {
    /// These settings.
    #[must_use]
    pub const fn of(settings: &ThermalSettings) -> Self {
        let ThermalSettings { hotend_fan_above, fan_run_on_s, filament, sensors, .. } = *settings;
        Self { hotend_fan_above, fan_run_on_s, filament, sensors }
    }
}
