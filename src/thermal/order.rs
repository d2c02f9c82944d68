//! Orders: what the Console asks of the heaters and fans. They go through a queue, so that the control period finds each of
//! them whole.

use crate::connectors::Heater;
use crate::settings::{FanSettings, HeaterSettings, ThermalSettings};
use crate::units::Celsius;
use heapless::spsc::{Consumer, Producer, Queue};

/// Orders that may wait. All settings anew are eleven.
const MOST: usize = 16;

/// Memory of the queue.
pub type OrderQueue = Queue<Order, MOST>;
/// The Console's end.
pub type Orders<'m> = Producer<'m, Order>;
/// The end of the control period.
pub type OrdersIn<'m> = Consumer<'m, Order>;

/// What is asked for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order {
    /// A heater's target; 0 or less is off. A target beyond the heater's limit is brought to it.
    Target(Heater, Celsius),
    /// How fast a fan is to run, if nothing else decides on it: 0 to 65,535.
    Fan(u8, u16),
    /// Whether any motor has power.
    Motors(bool),
    /// Everything off, fans too, but for those that cool what is hot.
    Off,
    /// Find out how a heater behaves, around this temperature and in so many cycles (M303).
    Tune(Heater, Celsius, u8),
    /// End that.
    StopTuning,
    /// Find out whether each heater warms its own sensor; targets wait until that is known.
    SelfTest,
    /// Other settings for a heater.
    Heater(Heater, HeaterSettings),
    /// Other settings for a fan.
    FanSettings(u8, FanSettings),
    /// All other settings; heaters and fans in them do not count.
    Common(Common),
}

/// Settings that belong to no heater and no fan.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub struct Common {
    /// The hotend's fan runs above this temperature.
    pub hotend_fan_above: Celsius,
    /// Seconds that the controller's fan goes on for.
    pub fan_run_on_s: u16,
    /// Heat that a mm of filament takes up for each K, in J/(K mm).
    pub filament: crate::units::WattsPerKelvin,
}

impl Common {
    /// The part of the settings.
    #[must_use]
    pub const fn of(settings: &ThermalSettings) -> Self {
        let ThermalSettings { hotend_fan_above, fan_run_on_s, filament, .. } = *settings;
        Self { hotend_fan_above, fan_run_on_s, filament }
    }
}
