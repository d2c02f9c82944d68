//! Settings: the machine as data. Values are range-checked where they enter, so the rooms that read them
//! need not ask.
//!
//! A setting is a field with a default, and a row ([`rows`]) in the same file. The row has its id in records, its key
//! in machine files, its unit, its range and its meaning. The record (`storage`) and the check of ranges go through the
//! rows. Other places that depend on a setting:
//!
//! - Field, default and row: here, or `accelerometer`, `axis`, `bed`, `belt`, `endstops`, `fan_plugs`, `job`, `pause`,
//!   `probe`, `safe_z_home`, `shaping`, `supply`, `drivers`, `thermal`, `wiring`. Checked by the compiler
//!   (`prototype`) and `tests/setting_rows.rs`.
//! - Range of a new kind of quantity: `ranges`. A limit that depends on other settings: `check`; on the board:
//!   `plugged`. Checked by `tests/setting_ranges.rs`.
//! - Command and M503: from the [line](mod@line) of the row, if its number is [`plain`]. A code with a condition is in
//!   `plain::CONDITIONS`, its rule in `machine/setup/rules.rs`. Otherwise a command in `machine/setup` (or `motors`),
//!   and the report in `machine/reports/settings_report.rs` and `machine/answers/setting.rs`. Checked by
//!   `every_setting.rs` and `legal_settings.rs`.
//! - Readers: `motion`, `driver`, `thermal` or `machine`, with their own tests.
//! - Time at which it takes effect: [`Settings::is_built_as`] for a setting that a board reads only when it starts.
//!   Checked by the compiler.
//! - Sum in RAM: `kept`, by `Hash`. Checked by the compiler.
//!
//! docs/how-to/setting.md has the steps, also for a new [`ShaperKind`].

mod accelerometer;
mod axis;
mod bed;
mod belt;
mod check;
mod corner;
mod drivers;
mod endstops;
mod fan_plugs;
mod field;
mod job;
mod kept;
pub mod line;
mod mesh;
mod motor_keys;
mod name;
mod pause;
pub mod plain;
mod plugged;
mod probe;
mod range;
pub mod ranges;
mod reach;
pub mod rows;
mod safe_z_home;
mod screws;
mod shaping;
mod spec;
mod supply;
pub mod table;
mod thermal;
mod wiring;

pub use accelerometer::AccelerometerSettings;
pub use axis::{Axes, AxisSettings, Cartesian, Homing};
pub use bed::{Bed, ZStore};
pub use belt::{Alignment, Belt, PHASES};
pub use check::SettingsError;
pub use corner::CornerRule;
pub use drivers::{DriverGroups, DriverSettings, OwnDriver};
pub use endstops::{AxisEnd, Endstop, HomedAxis};
pub use fan_plugs::{FanPlug, Tachometer};
pub use job::{JobSettings, OnFailure};
pub use kept::{Kept, sum};
pub use mesh::MeshSettings;
pub use name::MachineName;
pub use pause::Pause;
pub use plugged::{ConnectorError, Plugged};
pub use probe::{Probe, ProbeKind};
pub use range::Range;
pub use safe_z_home::SafeZHome;
pub use screws::{Screw, WholePlace};
pub use shaping::{Advance, Shaper, ShaperKind, Shapers};
pub use supply::Supply;
pub use thermal::{
    Bounds, Control, EXTRA_SENSORS, ExtraSensor, FanRole, FanSettings, Guards, HeaterModel, HeaterSettings, Heaters,
    Law, PLACES, Pid, Plausible, SHEETS, SensorSource, Sheet, ThermalSettings, Thermistor, part_fans,
};
pub use wiring::{EndstopPlug, MotorPlug, Wiring};

use crate::accelerometer::SensorAxis;
use crate::connectors::{ConnectorName, FANS, Heater, Output, Sensor};
use crate::kinematics::{Mechanism, Row, SCREWS, multiple};
use crate::motors::{MOTORS, Motor, MotorName, prototype};
use crate::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};
use corner::{Deviation, SquareCorner};
use field::{Field, Number, Value, places};
use serde::{Deserialize, Serialize};
use spec::Choice;

/// Everything that makes one machine different from another.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Settings {
    /// Resolution, limits and length of every axis.
    pub axes: Axes<AxisSettings>,
    /// The least position of each axis.
    pub axis_min: Cartesian<Mm>,
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
    /// The largest jump in the speed of z at a corner, without what a mesh adds (M205 Z).
    pub z_jerk: MmPerSec,
    /// The largest jump in the extruder's speed at a corner (M205 E).
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
    /// The largest distance by which the chords of an arc may lie inside it.
    pub arc_tolerance: Mm,
    /// Seconds between two busy messages, 0 for none (M113).
    pub keepalive_s: u8,
    /// Milliseconds of silence in the middle of numbered lines after which the host gets a prompt; 0 for never.
    pub patience_ms: u16,
    /// The look-ahead takes another move while the moves before it last for less than this at their nominal speeds.
    pub lookahead_time: Seconds,
    /// Whether `ok` reports the line number and the free places, as Marlin's ADVANCED_OK.
    pub advanced_ok: bool,
    /// The configuration of the motor drivers, where they can be talked to.
    pub drivers: DriverGroups,
    /// The part of a move over which its speed holds at least, if it does not accelerate or brake all along
    /// (SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO).
    pub minimum_cruise_ratio: Ratio,
    /// The turn of each motor for a step of each axis. A machine keeps it from start to end.
    pub mechanism: Mechanism,
    /// The names of the motors: traces have a column for each. The list ends with the first empty one.
    pub motor_names: [MotorName; MOTORS],
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
    /// Where it can print. It is reported (M503, `corehbot config`); no move is limited by it.
    pub bed: Bed,
    /// The connector of the Z probe; without a connector there is none. It reads as a switch does: without
    /// `is_normally_open` it has triggered when it is open.
    pub probe_plug: EndstopPlug,
    /// The Z probe; without a kind its connector is only reported.
    pub probe: Probe,
    /// What a print does if an axis is not homed, or the probe does not find the bed.
    pub job: JobSettings,
    /// The connector of the filament sensor: filament presses its switch. M119 reports it, and nothing else asks for
    /// it.
    pub filament: EndstopPlug,
    /// The belt of x and y.
    pub belt: Belt,
    /// The machine's name for hosts and screens (M115).
    pub name: MachineName,
    /// The tool's and the heaters' part in a pause.
    pub pause: Pause,
    /// How the mesh of the bed is measured and used.
    pub mesh: MeshSettings,
    /// Screws of z, in the order of the motors that turn them.
    pub screws: [Screw; SCREWS],
    /// How each fan is connected.
    pub fans: [FanPlug; FANS],
    /// Pulses of a fan's tachometer in a turn.
    pub fan_pulses: u8,
    /// The accelerometer at the tool.
    pub accelerometer: AccelerometerSettings,
    /// Where its switch homes z, and how far z rises before.
    pub safe_z_home: SafeZHome,
    /// How the power supply is switched.
    pub supply: Supply,
}

impl Settings {
    const PROTOTYPE: Self = {
        let axes = Axes {
            x: AxisSettings::belt(Mm::const_from_int(390)),
            y: AxisSettings::belt(Mm::lit("417.6")),
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
        let (width, depth) = (axes.x.length, axes.y.length);
        Self {
            axes,
            axis_min: Cartesian { x: Mm::ZERO, y: Mm::ZERO, z: Mm::ZERO },
            motor_max_speed: MmPerSec::const_from_int(450),
            motor_max_acceleration: MmPerSec2::const_from_int(7500),
            print_acceleration: MmPerSec2::const_from_int(3000),
            retract_acceleration: MmPerSec2::const_from_int(3000),
            travel_acceleration: MmPerSec2::const_from_int(5000),
            corner: CornerRule::JunctionDeviation(Mm::lit("0.013")),
            z_jerk: ranges::SPEED.most,
            extruder_jerk: MmPerSec::const_from_int(5),
            min_feed: MmPerSec::ZERO,
            min_travel: MmPerSec::ZERO,
            shapers: Shapers::prototype(),
            advance: Advance::prototype(),
            homing: Cartesian { x: Homing::belt(), y: Homing::belt(), z: Homing::screw() },
            soft_endstops: true,
            arc_tolerance: Mm::lit("0.005"),
            keepalive_s: 2,
            patience_ms: 500,
            lookahead_time: Seconds::const_from_int(2),
            advanced_ok: false,
            drivers: DriverGroups::prototype(),
            minimum_cruise_ratio: Ratio::lit("0.5"),
            mechanism: Mechanism::corehbot(),
            motor_names: prototype::NAMES,
            require_homing: false,
            thermal: ThermalSettings::prototype(),
            wiring: Wiring::prototype(),
            endstops: Cartesian { x: Endstop::at_zero(), y: Endstop::at_zero(), z: Endstop::at_zero() },
            homing_order: HomedAxis::ALL,
            baud: 250_000,
            bed: Bed { width, depth, left: Mm::ZERO, front: Mm::ZERO, z_offset: Mm::ZERO },
            probe_plug: EndstopPlug::NONE,
            probe: Probe::prototype(),
            job: JobSettings::prototype(),
            filament: EndstopPlug::NONE,
            belt: Belt::prototype(),
            name: MachineName::lit("CoreH-bot prototype"),
            pause: Pause::prototype(),
            mesh: MeshSettings::prototype(),
            screws: Screw::prototype(),
            fans: [FanPlug::PLAIN; FANS],
            fan_pulses: fan_plugs::USUAL_PULSES,
            accelerometer: AccelerometerSettings::prototype(),
            safe_z_home: SafeZHome::prototype(),
            supply: Supply::prototype(),
        }
    };

    /// The prototype of the CoreH-bot paper with an 80 mm head. It has belts of 20 teeth and 2 mm pitch on 200-step
    /// motors at 16 microsteps (80 steps/mm), two M12x4 ball screws (800 steps/mm), and a geared extruder. The
    /// reachable space is W - e = 470 - 80 mm by the y range of equation 20.
    ///
    /// A constant: made at run time it would take 1.7 kB of flash, and 14 kB more to read its decimals.
    #[must_use]
    pub const fn prototype() -> Self {
        Self::PROTOTYPE
    }

    /// Whether both have the same motors, plugs and serial lines, which a board reads when it starts.
    #[must_use]
    pub fn is_built_as(&self, other: &Self) -> bool {
        // All of them by name: a new setting needs a decision here whether a board reads it only when it starts.
        let Self {
            mechanism,
            wiring,
            baud,
            probe_plug,
            filament,
            probe:
                Probe {
                    kind,
                    offset: _,
                    fast: _,
                    slow: _,
                    samples: _,
                    tolerance: _,
                    retries: _,
                    clearance: _,
                    deploy_clearance: _,
                    travel: _,
                    homes_z: _,
                    home: _,
                    quiet: _,
                    bed_heater_off: _,
                },
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
            axis_min: _,
            motor_max_speed: _,
            motor_max_acceleration: _,
            print_acceleration: _,
            retract_acceleration: _,
            travel_acceleration: _,
            corner: _,
            z_jerk: _,
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
            motor_names: _,
            name: _,
            pause: _,
            job: _,
            mesh: _,
            screws: _,
            fans,
            fan_pulses: _,
            accelerometer: _,
            safe_z_home: _,
            supply,
        } = *self;
        mechanism == other.mechanism
            && wiring == other.wiring
            && baud == other.baud
            && probe_plug == other.probe_plug
            && kind == other.probe.kind
            && filament == other.filament
            && fans == other.fans
            && supply == other.supply
            && is_closed == other.belt.is_closed
    }

    /// Whether G28 homes z by the probe.
    #[must_use]
    pub const fn homes_z_by_probe(&self) -> bool {
        self.probe.homes_z && self.probe.is_fitted()
    }

    /// What the program counts more than the machine after homing: x, y, z.
    #[must_use]
    pub const fn home_offsets(&self) -> [Mm; 3] {
        let Cartesian { x, y, z } = self.homing;
        [x.offset, y.offset, z.offset]
    }

    /// The name of a motor in its machine file, for people.
    #[must_use]
    pub fn name_of(&self, motor: Motor) -> MotorName {
        self.motor_names.get(motor.index()).copied().unwrap_or(MotorName::NONE)
    }

    /// Every motor that the machine has a name for, with its name.
    pub fn motors(&self) -> impl Iterator<Item = (Motor, MotorName)> {
        Motor::ALL.into_iter().zip(self.motor_names).take_while(|(_, name)| !name.is_none())
    }

    /// The motors that turn a screw of z each, in their order: they move z and nothing else.
    #[must_use]
    #[inline(never)]
    pub fn screw_motors(&self) -> heapless::Vec<Motor, SCREWS> {
        let is_screw = |row: &[i8; 4]| matches!(row, [0, 0, z, 0] if *z != 0);
        self.mechanism.motors().filter(|(_, row)| is_screw(row)).map(|(motor, _)| motor).take(SCREWS).collect()
    }

    /// Resolution of a motor, in its own steps: the resolution of the axes that it moves, or of the extruder if it
    /// moves none, times the number of its row.
    #[must_use]
    pub fn steps_per_mm(&self, motor: Motor) -> StepsPerMm {
        let axis = self.mechanism.axis_of(motor).and_then(|axis| self.axes.get(axis)).unwrap_or(&self.axes.e);
        let times = self.mechanism.rows.get(motor.index()).map_or(1, |row| multiple(*row)).max(1);
        axis.steps_per_mm.saturating_mul_int(times.unsigned_abs().into())
    }

    /// The resolution of an axis in steps of the motor with the most steps, which limits its speed.
    #[must_use]
    pub fn finest(&self, axis: usize) -> StepsPerMm {
        let steps_per_mm = self.axes.get(axis).map_or(StepsPerMm::MAX, |axis| axis.steps_per_mm);
        steps_per_mm.saturating_mul_int(self.mechanism.most_times(axis).max(1).unsigned_abs().into())
    }
}

// The types of fields: a setting of a new type needs its type here.
places! {
    choices:
        HomedAxis(HomedAxis), AxisEnd(AxisEnd), OnFailure(OnFailure), Tachometer(Tachometer), ShaperKind(ShaperKind),
        ProbeKind(ProbeKind), Alignment(Alignment), Control(Control), FanRole(FanRole), SensorAxis(SensorAxis),
        Accelerometer(Option<crate::accelerometer::SensorKind>), Output(Output), Sensor(Sensor),
        SensorSource(SensorSource), Guarded(Option<Heater>);
    numbers:
        U8(u8), U16(u16), U32(u32), I16(i16), Switch(bool), Mm(Mm), MmPerSec(MmPerSec), MmPerSec2(MmPerSec2),
        StepsPerMm(StepsPerMm), Hertz(Hertz), Seconds(Seconds), Ratio(Ratio), Celsius(Celsius), Watts(Watts),
        JoulesPerKelvin(JoulesPerKelvin), WattsPerKelvin(WattsPerKelvin), MaybeMm(Option<Mm>),
        MaybeSeconds(Option<Seconds>), Thermistor(Thermistor), MotorRow(Row);
    names: MachineName, MotorName, MotorPlug, EndstopPlug, ConnectorName;
    others: Deviation, SquareCorner;
}

/// Rows of [`Settings`] itself.
mod top {
    use super::corner::{Deviation, SquareCorner};
    use super::rows::{Spec, ValueKind, rows};
    use super::{MachineName, ranges};

    rows! {
        for machine in |s, _| Some(s), named &[""];

        /// The name that hosts, screens and reports show: up to 24 letters, digits, blanks and + - . , / ( ) & # '.
        1 "name" = &mut machine.name, "", [Spec::text(MachineName::LONGEST, ValueKind::Name)];
        /// Speed limit of one belt motor, in mm of belt. A diagonal asks 1.41 times the tool's speed of two motors.
        2 "motor_max_speed" = &mut machine.motor_max_speed, "mm/s", [ranges::SPEED.spec()];
        /// Acceleration limit of one belt motor, in mm of belt.
        3 "motor_max_acceleration" = &mut machine.motor_max_acceleration, "mm/s2", [ranges::ACCELERATION.spec()];
        /// Acceleration of moves that print.
        4 "print_acceleration" = &mut machine.print_acceleration, "mm/s2", [ranges::ACCELERATION.spec()], "M204" "P/S";
        /// Acceleration of moves of the extruder alone.
        5 "retract_acceleration" = &mut machine.retract_acceleration, "mm/s2",
            [ranges::ACCELERATION.spec()], "M204" "R";
        /// Acceleration of moves that do not print.
        6 "travel_acceleration" = &mut machine.travel_acceleration, "mm/s2",
            [ranges::ACCELERATION.spec()], "M204" "T/S";
        /// The part of a move over which its speed holds at least, unless it accelerates or brakes all along
        /// (SET_VELOCITY_LIMIT MINIMUM_CRUISE_RATIO).
        7 "minimum_cruise_ratio" = &mut machine.minimum_cruise_ratio, "", [ranges::CRUISE_RATIO.spec()];
        /// The jump in the extruder's speed that a corner may ask for.
        8 "extruder_jerk" = &mut machine.extruder_jerk, "mm/s", [ranges::SPEED.spec()], "M205" "E";
        /// Least commanded speed of printing moves; 0 is none.
        9 "min_feed" = &mut machine.min_feed, "mm/s", [ranges::SPEED.spec().from_zero()], "M205" "S";
        /// Least commanded speed of other moves; 0 is none.
        10 "min_travel" = &mut machine.min_travel, "mm/s", [ranges::SPEED.spec().from_zero()], "M205" "T";
        /// Whether moves are kept inside the reachable space (M211).
        11 "soft_endstops" = &mut machine.soft_endstops, "", [Spec::SWITCH];
        /// Whether moves of an axis that was not homed are refused. Otherwise the host is told of them once.
        12 "require_homing" = &mut machine.require_homing, "", [Spec::SWITCH];
        /// How far the chords of an arc may lie inside it.
        13 "arc_tolerance" = &mut machine.arc_tolerance, "mm", [ranges::TOLERANCE.spec()];
        /// Time between two busy messages; 0 is none.
        14 "keepalive_s" = &mut machine.keepalive_s, "s", [ranges::KEEPALIVE_S.spec()], "M113" "S";
        /// Silence in the middle of numbered lines after which the host is asked to go on; 0 is never.
        15 "patience_ms" = &mut machine.patience_ms, "ms", [ranges::PATIENCE_MS.spec().or_zero()];
        /// Motion at nominal speed that waits in the look-ahead before a line is answered.
        16 "lookahead_time" = &mut machine.lookahead_time, "s", [ranges::LOOKAHEAD_TIME.spec()];
        /// Whether ok tells the line number, free moves and free lines (ok N12 P100 B9), as Marlin's ADVANCED_OK.
        17 "advanced_ok" = &mut machine.advanced_ok, "", [Spec::SWITCH];
        /// Rate of the serial lines on the board's headers; USB has none. It counts after a reset.
        18 "baud" = &mut machine.baud, "baud", [ranges::BAUD.spec()];
        /// Speed in corners by junction deviation: how far an arc that rounds the corner may leave it (M205 J).
        19 "corner.junction_deviation" = Deviation(&mut machine.corner), "mm", [ranges::TOLERANCE.spec()];
        /// Speed in corners by the speed through a right angle (M205 X).
        99 "corner.square_corner" = SquareCorner(&mut machine.corner), "mm/s", [ranges::SPEED.spec()];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::de::DeserializeOwned;

    /// Whether a type has `count` variants: decoders know each of them by its number. Zeros decode to any type.
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
        let building: [fn(&mut Settings); 7] = [
            |s| s.mechanism.rows.reverse(),
            |s| s.wiring.motors[0].is_reversed ^= true,
            |s| s.baud = 9600,
            |s| s.probe_plug.is_normally_open ^= true,
            |s| s.probe.kind = ProbeKind::Switch,
            |s| s.filament.is_normally_open ^= true,
            |s| s.belt.is_closed ^= true,
        ];
        assert_eq!(building.map(is_built_alike), [false; 7]);
        let others: [fn(&mut Settings); 4] = [
            |s| s.axes.x.length = Mm::ZERO,
            |s| s.belt.settling_ms = 200,
            |s| s.advanced_ok ^= true,
            |s| s.endstops.x.end = AxisEnd::Max,
        ];
        assert_eq!(others.map(is_built_alike), [true; 4]);
        assert!(made.is_built_as(&made));
    }

    /// Tests that go through `all` cover every variant.
    #[test]
    fn no_variant_is_left_out() {
        assert!(has_variants::<CornerRule>(CornerRule::all().count()), "CornerRule::next");
        assert!(has_variants::<ShaperKind>(ShaperKind::all().count()), "ShaperKind::ALL");
    }
}
