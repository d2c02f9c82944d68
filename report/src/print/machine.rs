//! The machine as a chart needs it: rows of motors, limits, shapers at the start, and the taps of shapers over time.

use corehbot::motion::{Taps, advance_window, taps};
use corehbot::motors::MotorName;
use corehbot::settings::rows::Choice;
use corehbot::settings::{AxisSettings, HomedAxis, Settings, Shaper, ShaperKind};
use corehbot::units::{Mm, Seconds, TICKS_PER_SECOND};
use corehbot_sim::moves::ShaperChange;
use serde::Serialize;

/// Everything that makes motors' speeds and the tool's path of moves.
#[derive(Serialize)]
pub struct MachineData {
    axes: [AxisData; 4],
    motors: Vec<MotorRow>,
    /// Of x and y, at the start.
    shaper: [ShaperData; 2],
    pressure_advance: AdvanceData,
    /// The path of the tool is late by this after the planned moves.
    delay_s: f64,
    minimum_cruise_ratio: f64,
    motor_max_speed_mm_s: f64,
    motor_max_acceleration_mm_s2: f64,
}

#[derive(Serialize)]
struct AxisData {
    name: &'static str,
    steps_per_mm: f64,
    max_speed_mm_s: f64,
    max_acceleration_mm_s2: f64,
    /// Reachable space in mm; `None` for the filament.
    reach_mm: Option<[f64; 2]>,
}

#[derive(Serialize)]
struct MotorRow {
    name: MotorName,
    /// How many times the motor steps for a step of x, y, z and e.
    row: [i8; 4],
    /// Its steps for a mm of x, y, z and e.
    steps_per_mm: [f64; 4],
}

#[derive(Serialize)]
struct ShaperData {
    #[serde(rename = "type")]
    kind: &'static str,
    hz: f64,
    damping: f64,
}

/// What an axis follows from a time on.
#[derive(Serialize)]
pub struct ShaperSince {
    time_s: f64,
    /// 0 is x, 1 is y.
    axis: usize,
    /// Delay in s and weight of each copy of the motion.
    taps: Vec<[f64; 2]>,
}

impl ShaperSince {
    /// A change of a shaper.
    pub fn new(change: &ShaperChange) -> Self {
        let time_s = change.tick as f64 / f64::from(TICKS_PER_SECOND);
        Self { time_s, axis: change.axis, taps: pairs(&change.taps) }
    }
}

#[derive(Serialize)]
struct AdvanceData {
    time_s: f64,
    window_s: f64,
}

impl MachineData {
    /// The machine of these settings.
    pub fn new(s: &Settings) -> Self {
        let axes = s.axes.to_array();
        let steps = axes.map(|axis| axis.steps_per_mm.to_num::<f64>());
        let window = (s.advance.time > Seconds::ZERO).then(|| advance_window(s));
        let taps = taps(&s.shapers, window);
        let fitted = s.mechanism.fitted();
        let rows = s.mechanism.motors().filter(|(motor, _)| fitted.has(*motor));
        let delay = |taps: &Taps| pairs(taps).iter().map(|[delay, weight]| delay * weight).sum::<f64>();
        Self {
            axes: std::array::from_fn(|i| AxisData::new(i, &axes[i], s)),
            motors: rows
                .map(|(motor, row)| MotorRow {
                    name: s.name_of(motor),
                    row,
                    steps_per_mm: std::array::from_fn(|i| f64::from(row[i]) * steps[i]),
                })
                .collect(),
            shaper: [ShaperData::new(&s.shapers.x), ShaperData::new(&s.shapers.y)],
            pressure_advance: AdvanceData {
                time_s: s.advance.time.to_num(),
                window_s: window.unwrap_or_default().to_num(),
            },
            delay_s: delay(&taps[0]),
            minimum_cruise_ratio: s.minimum_cruise_ratio.to_num(),
            motor_max_speed_mm_s: s.motor_max_speed.to_num(),
            motor_max_acceleration_mm_s2: s.motor_max_acceleration.to_num(),
        }
    }
}

impl AxisData {
    fn new(index: usize, axis: &AxisSettings, s: &Settings) -> Self {
        let homed = [HomedAxis::X, HomedAxis::Y, HomedAxis::Z];
        Self {
            name: ["x", "y", "z", "e"][index],
            steps_per_mm: axis.steps_per_mm.to_num(),
            max_speed_mm_s: axis.max_speed.to_num(),
            max_acceleration_mm_s2: axis.max_acceleration.to_num(),
            reach_mm: homed.get(index).map(|axis| {
                let reach = s.reach(*axis);
                [reach.least, reach.most].map(Mm::to_num)
            }),
        }
    }
}

impl ShaperData {
    fn new(shaper: &Shaper) -> Self {
        Self {
            kind: ShaperKind::ALL.iter().find(|(kind, _)| *kind == shaper.kind).map_or("", |(_, name)| name),
            hz: shaper.frequency.to_num(),
            damping: shaper.damping.to_num(),
        }
    }
}

/// Delay in s and weight of each tap.
fn pairs(taps: &Taps) -> Vec<[f64; 2]> {
    let seconds = |delay: u32| f64::from(delay) / (256.0 * f64::from(TICKS_PER_SECOND));
    taps.iter().map(|tap| [seconds(tap.delay), f64::from(tap.weight)]).collect()
}
