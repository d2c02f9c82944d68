//! The heat that a page shows: temperatures, duties and waits over the time since the printer was switched on.
//!
//! Time advances while the printer waits for a temperature and motion time stands still, so each bin has both.

use super::tenth;
use crate::heat_log::{HeatBin, HeatLog, HeaterBin, Range};
use corehbot::connectors::{FANS, Heater};
use corehbot::settings::{FanRole, ThermalSettings};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::host::HeatWait;
use serde::Serialize;

/// Everything of a machine that has heaters.
#[derive(Serialize)]
pub struct HeatData {
    bin_s: f64,
    /// When the last bin ends.
    end_s: f64,
    /// Motion time in s at the end of each bin.
    motion: Vec<f64>,
    heaters: Vec<HeaterData>,
    /// The fans that ran.
    fans: Vec<FanData>,
    waits: Vec<WaitData>,
}

#[derive(Serialize)]
struct HeaterData {
    name: &'static str,
    /// Least and greatest temperature of each bin in C.
    low: Vec<Option<f64>>,
    high: Vec<Option<f64>>,
    /// Greatest target in C; 0 is off.
    target: Vec<f64>,
    duty: DutyData,
}

#[derive(Serialize)]
struct FanData {
    name: String,
    duty: DutyData,
}

/// Mean and greatest duty of each bin in percent.
#[derive(Serialize)]
struct DutyData {
    mean: Vec<f64>,
    high: Vec<f64>,
}

/// From when to when a command waited, in s.
#[derive(Serialize)]
struct WaitData {
    command: String,
    begin: f64,
    end: f64,
}

impl HeatData {
    /// The content of `log`; `None` on a machine without heaters.
    pub fn new(log: &HeatLog, waits: &[HeatWait], thermal: &ThermalSettings) -> Option<Self> {
        let bins = log.bins();
        let fitted = |heater: &Heater| bins.last().is_some_and(|bin| bin.heaters[*heater as usize].is_some());
        let heaters: Vec<_> = Heater::ALL.into_iter().filter(fitted).map(|h| HeaterData::new(h, bins)).collect();
        (!heaters.is_empty()).then(|| Self {
            bin_s: seconds(log.bin_ticks()),
            end_s: seconds(log.end()),
            motion: bins.iter().map(|bin| seconds(bin.tick)).collect(),
            heaters,
            fans: (0..FANS).filter_map(|fan| FanData::new(fan, bins, thermal)).collect(),
            waits: waits.iter().map(WaitData::new).collect(),
        })
    }
}

impl HeaterData {
    fn new(heater: Heater, bins: &[HeatBin]) -> Self {
        let bins: Vec<&HeaterBin> = bins.iter().filter_map(|bin| bin.heaters[heater as usize].as_ref()).collect();
        let measured = |value: fn(&Range) -> f32| {
            let known = |bin: &&HeaterBin| bin.measured.mean().map(|_| tenth(value(&bin.measured).into()));
            bins.iter().map(known).collect()
        };
        Self {
            name: heater.name(),
            low: measured(|range| range.low),
            high: measured(|range| range.high),
            target: bins.iter().map(|bin| tenth(bin.target.high.into())).collect(),
            duty: DutyData::new(bins.iter().map(|bin| &bin.duty)),
        }
    }
}

impl FanData {
    fn new(fan: usize, bins: &[HeatBin], thermal: &ThermalSettings) -> Option<Self> {
        let role = match thermal.fans.get(fan)?.role {
            FanRole::Commanded => "",
            FanRole::Hotend => " (hotend)",
            FanRole::Controller => " (controller)",
            FanRole::Part => " (part)",
        };
        let duty = DutyData::new(bins.iter().map(|bin| &bin.fans[fan]));
        duty.high.iter().any(|high| *high > 0.0).then(|| Self { name: format!("fan {fan}{role}"), duty })
    }
}

impl DutyData {
    fn new<'b>(bins: impl Iterator<Item = &'b Range> + Clone) -> Self {
        Self {
            mean: bins.clone().map(|range| tenth(range.mean().unwrap_or_default())).collect(),
            high: bins.map(|range| tenth(range.high.into())).collect(),
        }
    }
}

impl WaitData {
    fn new(wait: &HeatWait) -> Self {
        let [begin, end] = wait.time.map(seconds);
        Self { command: wait.command.clone(), begin, end }
    }
}

fn seconds(ticks: u64) -> f64 {
    (ticks as f64 / f64::from(TICKS_PER_SECOND) * 1000.0).round() / 1000.0
}
