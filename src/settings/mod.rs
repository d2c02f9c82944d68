//! Settings: the machine as data. Values are range-checked where they enter, so the rooms that read them
//! need not ask.
//!
//! The places that know a setting, in the order in which a new one is added to them:
//!
//! | place | where | what holds it to that |
//! |---|---|---|
//! | field and default | here, or `axis`, `bed`, `belt`, `endstops`, `shaping`, `drivers`, `thermal`, `wiring` | compiler (`prototype`) |
//! | range, check | `ranges`, `check`; what a board must have for it, `plugged` | `tests/setting_ranges.rs` |
//! | record | `storage::record`, by serde: a changed shape makes another `FORMAT` | `src/storage/record/tests.rs` |
//! | machine file | keys with what they mean in `machine-file/src/form.rs` and its folder, read in `lib.rs` there, written in `written.rs`, shown in `examples/machines/prototype.toml`; `BLESS=1 cargo test -p corehbot-cli --test config` writes the schema | `boards/sim/tests/every_setting.rs` |
//! | command | letters in `gcode`, what they do in `machine/commands/settings/set.rs` (or `shaping`, `drivers`) | the same test; `boards/sim/tests/console/legal_settings.rs` |
//! | M503 | the words in `machine/reports/settings_report.rs` (`report_setting`, `report_settings`, `report_driver_settings`); a line of its own also in `machine/answers/setting.rs` | the same test |
//! | who reads it | `motion` (limits of a move by what it is for: `purpose` and `Limits` in `motion::planner`), `driver` or `machine` | its own tests; a limit of motion also in `tests/motion/model.rs` and, if a line may loosen it, `boards/sim/src/limits.rs` |
//! | whether it counts at once | a setting that a board reads only when it starts: [`Settings::is_built_as`] | compiler |
//! | its sum in RAM | `kept`, by `Hash` | compiler |
//! | documents | docs/reference/gcode.md, docs/reference/host-protocol.md, docs/reference/machines.md (what is plugged in where), CHANGELOG.md | review |
//!
//! A new [`ShaperKind`] comes last (records hold its number, so `FORMAT` stays), and its T is the next one: `tail` in
//! `cli/src/twin/compensate/gcode.rs` counts them. It is added to its impulses (`motion::trajectory::shaper`, at most `MOST_IMPULSES`), its number and names
//! (`gcode::shaping`), `kind_of` with M593's text (`machine/commands/shaping.rs`) and `name_of` (`machine/reports/settings_report.rs`),
//! which translate between kind and number, `KindToml` with its name in `written.rs` (the machine file), and the twin (`twin/src/shaping`). The compiler asks for impulses, `name_of` and `written.rs`, `boards/sim/tests/every_setting.rs` and `twin.rs` for the rest, and
//! `tests/motion/shapers.rs` for figures from the literature. By hand: `boards/sim/tests/shaping.rs`, which prints with each T,
//! `examples/shaping.gcode`, which has one of each, the table of the literature in the tests of `twin/src/shaping/shaper.rs`, `FREQUENCY` in `check` if it lasts longer than the others,
//! docs/explanation/shaping.md, docs/research/twin.md (what `twin resonance` suggests), M593 in docs/reference/gcode.md and docs/reference/host-protocol.md, the comment in `examples/machines/prototype.toml`.
//!
//! A new [`CornerRule`] or [`Thermistor`]: CONTRIBUTING.md lists where it is known.

mod axis;
mod bed;
mod belt;
mod check;
mod drivers;
mod endstops;
mod kept;
mod name;
mod pause;
mod plugged;
pub mod ranges;
mod shaping;
mod thermal;
mod wiring;

pub use axis::{Axes, AxisSettings, Cartesian, Homing};
pub use bed::Bed;
pub use belt::{Alignment, Belt, PHASES};
pub use check::SettingsError;
pub use drivers::{DriverGroups, DriverSettings};
pub use endstops::{AxisEnd, Endstop, HomedAxis};
pub use kept::{Kept, sum};
pub use name::MachineName;
pub use pause::Pause;
pub use plugged::{ConnectorError, Plugged};
pub use ranges::Range;
pub use shaping::{Advance, Shaper, ShaperKind, Shapers};
pub use thermal::{
    Bounds, Control, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Heaters, Pid, Plausible,
    ThermalSettings, Thermistor, part_fans,
};
pub use wiring::{EndstopPlug, MotorPlug, Wiring};

use crate::kinematics::{Mechanism, multiple};
use crate::motors::Motor;
use crate::units::{Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm};
use serde::{Deserialize, Serialize};

/// What limits the speed in a corner; a rule has one value so far. `motion::planner::junction` has the law. A machine file chooses a rule by its key
/// (`corner` in `machine-file/src/lib.rs`), a line by its letter in M205 (`machine/commands/settings/set.rs`). A new one comes last,
/// as records hold its number.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub enum CornerRule {
    /// Junction deviation: how far an arc that rounds the corner may leave it.
    JunctionDeviation(Mm),
    /// Square-corner velocity: the speed through a corner of 90 degrees.
    SquareCorner(MmPerSec),
}

impl CornerRule {
    /// Every rule, with a usual value.
    pub fn all() -> impl Iterator<Item = Self> {
        let usual = Self::JunctionDeviation(const { Mm::lit("0.013") });
        core::iter::successors(Some(usual), |rule| rule.next())
    }

    /// The rule after this one. Without a wildcard: a new rule is linked in here, and tests go through all of them.
    const fn next(self) -> Option<Self> {
        match self {
            Self::JunctionDeviation(_) => Some(Self::SquareCorner(MmPerSec::const_from_int(5))),
            Self::SquareCorner(_) => None,
        }
    }
}

/// Everything that makes one machine different from another.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Settings {
    /// Resolution, limits and length of every axis.
    pub axes: Axes<AxisSettings>,
    /// Speed limit of a belt motor, in mm of belt a second.
    pub motor_max_speed: MmPerSec,
    /// Acceleration limit of a belt motor, in mm of belt a second squared.
    pub motor_max_acceleration: MmPerSec2,
    /// Acceleration of moves that print (M204 P).
    pub print_acceleration: MmPerSec2,
    /// Acceleration of moves of the extruder alone (M204 R).
    pub retract_acceleration: MmPerSec2,
    /// Acceleration of moves that do not print (M204 T).
    pub travel_acceleration: MmPerSec2,
    /// Speed limit in corners (M205 J or X, Y).
    pub corner: CornerRule,
    /// The jump in the extruder's speed that a corner may ask for (M205 E).
    pub extruder_jerk: MmPerSec,
    /// Least commanded speed of a printing move (M205 S).
    pub min_feed: MmPerSec,
    /// Least commanded speed of a travelling move (M205 T).
    pub min_travel: MmPerSec,
    /// Input shapers of x and y (M593).
    pub shapers: Shapers,
    /// Pressure advance (M900, M572).
    pub advance: Advance,
    /// How each axis finds its endstop.
    pub homing: Cartesian<Homing>,
    /// Whether moves are kept inside the reachable space (M211).
    pub soft_endstops: bool,
    /// How far the chords of an arc may lie inside it.
    pub arc_tolerance: Mm,
    /// Seconds between two busy messages, 0 for none (M113).
    pub keepalive_s: u8,
    /// Milliseconds of silence in the middle of numbered lines after which the host is prompted to go on; 0 for
    /// never.
    pub patience_ms: u16,
    /// The look-ahead takes another move as long as what waits before it lasts for less than this at its nominal speeds.
    pub lookahead_time: Seconds,
    /// Whether `ok` tells the line number and what is free, as Marlin's ADVANCED_OK.
    pub advanced_ok: bool,
    /// The configuration of the motor drivers, where they can be talked to.
    pub drivers: DriverGroups,
    /// The part of a move over which its speed holds at least, if it does not accelerate or brake all along
    /// (SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO).
    pub minimum_cruise_ratio: Ratio,
    /// How far each motor turns for a step of each axis. A machine keeps it from start to end.
    pub mechanism: Mechanism,
    /// Whether moves of an axis that was not homed are refused.
    pub require_homing: bool,
    /// Heaters and fans.
    pub thermal: ThermalSettings,
    /// Where motors and switches are plugged in.
    pub wiring: Wiring,
    /// Where the switch of each axis sits.
    pub endstops: Cartesian<Endstop>,
    /// The order in which G28 homes the axes.
    pub homing_order: [HomedAxis; 3],
    /// Rate of the serial lines on headers, in baud. USB has none.
    pub baud: u32,
    /// Where it can print. Told to people (M503, `corehbot config`); no move is held to it.
    pub bed: Bed,
    /// Where the Z probe is plugged in; without a connector there is none. It reads as a switch does: without
    /// `is_normally_open` it has triggered when its input is high. Nothing probes by it.
    pub probe: EndstopPlug,
    /// What ties the motors of x and y together.
    pub belt: Belt,
    /// What hosts and screens call the machine (M115).
    pub name: MachineName,
    /// What a pause does with the tool and the heat.
    pub pause: Pause,
}

impl Settings {
    /// The prototype of the CoreH-bot paper with an 80 mm head: belts of 20 teeth and 2 mm pitch on
    /// 200-step motors at 16 microsteps (80 steps/mm), two M12x4 ball screws (800 steps/mm), and a geared
    /// extruder. The reachable space is W - e = 470 - 80 mm by the y range of equation 20.
    ///
    /// Decimals stand in `const` blocks: read at run time they would take 14 kB of flash.
    #[must_use]
    pub const fn prototype() -> Self {
        let axes = Axes {
            x: AxisSettings::belt(Mm::const_from_int(390)),
            y: AxisSettings::belt(const { Mm::lit("417.6") }),
            z: AxisSettings {
                steps_per_mm: StepsPerMm::const_from_int(800),
                max_speed: MmPerSec::const_from_int(20),
                max_acceleration: MmPerSec2::const_from_int(200),
                length: Mm::const_from_int(335),
            },
            e: AxisSettings {
                steps_per_mm: StepsPerMm::const_from_int(400),
                max_speed: MmPerSec::const_from_int(80),
                max_acceleration: MmPerSec2::const_from_int(5000),
                length: Mm::const_from_int(1000),
            },
        };
        Self {
            axes,
            motor_max_speed: MmPerSec::const_from_int(450),
            motor_max_acceleration: MmPerSec2::const_from_int(7500),
            print_acceleration: MmPerSec2::const_from_int(3000),
            retract_acceleration: MmPerSec2::const_from_int(3000),
            travel_acceleration: MmPerSec2::const_from_int(5000),
            corner: CornerRule::JunctionDeviation(const { Mm::lit("0.013") }),
            extruder_jerk: MmPerSec::const_from_int(5),
            min_feed: MmPerSec::ZERO,
            min_travel: MmPerSec::ZERO,
            shapers: Shapers::prototype(),
            advance: Advance::prototype(),
            homing: Cartesian { x: Homing::belt(), y: Homing::belt(), z: Homing::screw() },
            soft_endstops: true,
            arc_tolerance: const { Mm::lit("0.005") },
            keepalive_s: 2,
            patience_ms: 500,
            lookahead_time: Seconds::const_from_int(2),
            advanced_ok: false,
            drivers: DriverGroups::prototype(),
            minimum_cruise_ratio: const { Ratio::lit("0.5") },
            mechanism: Mechanism::corehbot(),
            require_homing: false,
            thermal: ThermalSettings::prototype(),
            wiring: Wiring::prototype(),
            endstops: Cartesian { x: Endstop::at_zero(), y: Endstop::at_zero(), z: Endstop::at_zero() },
            homing_order: HomedAxis::ALL,
            baud: 250_000,
            bed: Bed::of_reach(&axes),
            probe: EndstopPlug::NONE,
            belt: Belt::prototype(),
            name: const { MachineName::lit("CoreH-bot prototype") },
            pause: Pause::prototype(),
        }
    }

    /// Whether both are put together alike: motors, plugs and serial lines, which a board looks at when it starts.
    #[must_use]
    pub fn is_built_as(&self, other: &Self) -> bool {
        // All of them by name: whoever adds one says here whether a board reads it only when it starts.
        let Self {
            mechanism,
            wiring,
            baud,
            probe,
            belt:
                Belt {
                    is_closed,
                    settling_ms: _,
                    max_speed: _,
                    max_acceleration: _,
                    homing_advance: _,
                    alignment: _,
                    preload: _,
                    phases: _,
                    limp_lift: _,
                },
            axes: _,
            motor_max_speed: _,
            motor_max_acceleration: _,
            print_acceleration: _,
            retract_acceleration: _,
            travel_acceleration: _,
            corner: _,
            extruder_jerk: _,
            min_feed: _,
            min_travel: _,
            shapers: _,
            advance: _,
            homing: _,
            soft_endstops: _,
            arc_tolerance: _,
            keepalive_s: _,
            patience_ms: _,
            lookahead_time: _,
            advanced_ok: _,
            drivers: _,
            minimum_cruise_ratio: _,
            require_homing: _,
            thermal: _,
            endstops: _,
            homing_order: _,
            bed: _,
            name: _,
            pause: _,
        } = *self;
        mechanism == other.mechanism
            && wiring == other.wiring
            && baud == other.baud
            && probe == other.probe
            && is_closed == other.belt.is_closed
    }

    /// Resolution of a motor, in its own steps: that of the axes that it moves, or of the extruder if it moves none, times the number of
    /// its row.
    #[must_use]
    pub fn steps_per_mm(&self, motor: Motor) -> StepsPerMm {
        let Axes { x, y, z, e } = self.axes;
        let axis = match self.mechanism.axis_of(motor) {
            Some(0) => x,
            Some(1) => y,
            Some(2) => z,
            _ => e,
        };
        let times = self.mechanism.rows.get(motor as usize).map_or(1, |row| multiple(*row)).max(1);
        axis.steps_per_mm.saturating_mul_int(times.unsigned_abs().into())
    }

    /// The resolution of an axis in steps of the motor that makes the most: what limits its speed.
    #[must_use]
    pub fn finest(&self, axis: usize) -> StepsPerMm {
        let steps_per_mm = self.axes.to_array().get(axis).map_or(StepsPerMm::MAX, |axis| axis.steps_per_mm);
        steps_per_mm.saturating_mul_int(self.mechanism.most_times(axis).max(1).unsigned_abs().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::DeserializeOwned;

    /// Whether a type has so many variants: decoders know each of them by its number. Zeros are whatever is in it.
    fn has_variants<T: DeserializeOwned>(count: usize) -> bool {
        let decodes = |number: usize| {
            let mut bytes = [0; 64];
            bytes[0] = number as u8;
            postcard::take_from_bytes::<T>(&bytes).is_ok()
        };
        decodes(count - 1) && !decodes(count)
    }

    #[test]
    fn a_board_starts_anew_for_other_motors_plugs_lines_or_belts_and_for_nothing_else() {
        let made = Settings::prototype();
        let is_built_alike = |change: fn(&mut Settings)| {
            let mut other = made;
            change(&mut other);
            assert_ne!(other, made);
            made.is_built_as(&other)
        };
        let building: [fn(&mut Settings); 5] = [
            |s| s.mechanism.rows.reverse(),
            |s| s.wiring.motors[0].is_reversed ^= true,
            |s| s.baud = 9600,
            |s| s.probe.is_normally_open ^= true,
            |s| s.belt.is_closed ^= true,
        ];
        assert_eq!(building.map(is_built_alike), [false; 5]);
        let others: [fn(&mut Settings); 4] = [
            |s| s.axes.x.length = Mm::ZERO,
            |s| s.belt.settling_ms = 200,
            |s| s.advanced_ok ^= true,
            |s| s.endstops.x.end = AxisEnd::Max,
        ];
        assert_eq!(others.map(is_built_alike), [true; 4]);
        assert!(made.is_built_as(&made));
    }

    /// Tests that go through `all` look at every variant.
    #[test]
    fn no_variant_is_left_out() {
        assert!(has_variants::<CornerRule>(CornerRule::all().count()), "CornerRule::next");
        assert!(has_variants::<ShaperKind>(ShaperKind::all().count()), "ShaperKind::next");
        assert!(has_variants::<Thermistor>(Thermistor::all().count()), "Thermistor::next");
    }
}
