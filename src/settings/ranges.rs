//! The ranges in which every setting must lie, by kind of quantity. Outside of them the planner's arithmetic or the
//! machine would not follow the number. They hold on every board. `plugged.rs` checks limits of one board, fields of
//! `BoardConnectors`.

use super::Range;
use crate::kinematics::MOST_MULTIPLE;
use crate::units::{
    Celsius, Feed, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepRate, StepsPerMm, Watts,
    WattsPerKelvin,
};

/// Resolution: from a full-step rack to 256 microsteps on a fine screw.
pub const STEPS_PER_MM: Range<StepsPerMm> =
    Range { least: StepsPerMm::const_from_int(1), most: StepsPerMm::const_from_int(25_600) };
/// Speed: a snail to six times the fastest printers.
pub const SPEED: Range<MmPerSec> = Range { least: MmPerSec::lit("0.01"), most: MmPerSec::const_from_int(3000) };
const _: () = assert!(SPEED.most.to_bits() >> MmPerSec::FRAC_NBITS < Feed::MAX.to_bits() >> Feed::FRAC_NBITS);
/// Acceleration: below 1 mm/s2 a move would take minutes to start.
pub const ACCELERATION: Range<MmPerSec2> =
    Range { least: MmPerSec2::const_from_int(1), most: MmPerSec2::const_from_int(100_000) };
/// Seconds between two busy messages; 0 is never. Hosts that wait for longer than a minute give up.
pub const KEEPALIVE_S: Range<u8> = Range { least: 0, most: 60 };
/// Travel of an axis.
pub const AXIS_LENGTH: Range<Mm> = Range { least: Mm::const_from_int(1), most: Mm::const_from_int(5000) };
/// Junction deviation and arc tolerance.
pub const TOLERANCE: Range<Mm> = Range { least: Mm::lit("0.001"), most: Mm::const_from_int(1) };
/// Silence of a host, in ms: no less than its USB adapter, its garbage collector and its disk may make any day.
pub const PATIENCE_MS: Range<u16> = Range { least: 100, most: 60_000 };
/// Back-off distance of an axis after the first approach to an endstop.
pub const BACK_OFF: Range<Mm> = Range { least: Mm::lit("0.1"), most: Mm::const_from_int(50) };
/// The largest distance of an endstop outside the reachable space: the largest back-off.
pub(super) const ENDSTOP_OUTSIDE: Mm = BACK_OFF.most;
/// The offset of z: a nozzle or a plate is thicker or thinner by less. More is another place of the switch.
pub const Z_OFFSET: Range<Mm> = Range { least: Mm::const_from_int(-5), most: Mm::const_from_int(5) };
/// Places that an axis may reach, on both sides of 0. Motors count their steps in 32 bits: at the finest resolution
/// times the largest number in a row, 5 m and a switch outside are 0.96 of 2^31 steps.
pub const PLACE: Range<Mm> = Range { least: Mm::const_from_int(-5000), most: Mm::const_from_int(5000) };
const _: () = assert!((5000 + 50) * 25_600 * (MOST_MULTIPLE as i64) < 1 << 31);
/// Where an endstop of any axis may sit.
pub const ENDSTOP_POSITION: Range<Mm> =
    Range { least: PLACE.least.saturating_sub(ENDSTOP_OUTSIDE), most: PLACE.most.saturating_add(ENDSTOP_OUTSIDE) };
/// Columns and rows of a mesh: a slope needs three, and the firmware has room for nine.
pub const MESH_POINTS: Range<u8> = Range { least: 3, most: 9 };
/// Height up to which a mesh fades: below 1 mm a bed that is out by 0.1 mm would show in each layer.
pub const MESH_FADE: Range<Mm> = Range { least: Mm::ONE, most: Mm::const_from_int(100) };
/// Height of a point of a mesh that a line sets: a bed that is farther out is no bed.
pub const MESH_HEIGHT: Range<Mm> = Range { least: Mm::const_from_int(-10), most: Mm::const_from_int(10) };
/// Places of screws of z, which may stand outside of what the tool reaches: those of an axis, in whole mm.
pub const SCREW_PLACE: Range<i16> = Range { least: -5000, most: 5000 };
/// Such a place that nothing has said.
pub const NOWHERE: i16 = SCREW_PLACE.most + 1;
/// Milliseconds between two motors of a belt that get power: the longest time is twice the largest age of a driver's
/// proof.
pub const SETTLING_MS: Range<u16> = Range { least: 0, most: 1000 };
/// The phase of a residual that is not known: phases are less than an electrical turn.
pub const NO_PHASE: u16 = 1024;
/// Phase of a residual: less than an electrical turn, or [`NO_PHASE`].
pub const PHASE: Range<u16> = Range { least: 0, most: NO_PHASE };
/// Preload of a belt: 50 um of residual, some 2 % of the torque of a motor of 0.4 N m
/// (docs/explanation/belt/alignment.md).
pub const PRELOAD: Range<Mm> = Range { least: Mm::lit("-0.05"), most: Mm::lit("0.05") };
/// Lift of z after a motor of the belt has failed.
pub const LIMP_LIFT: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };
/// Rise of z before homing: more is a way of its own, and no hop. Z of a place that is not known may have no room.
pub const Z_HOP: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };
/// Filament that a pause pulls back: bowden tubes need less than a tenth of it.
pub const PAUSE_RETRACT: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };
/// Lift of the tool in a pause.
pub const PAUSE_LIFT: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(200) };
/// Minutes of a pause until heaters go off.
pub const PAUSE_HEAT_MIN: Range<u8> = Range { least: 1, most: 240 };
/// Distance that a belt circulates after homing.
pub const HOMING_ADVANCE: Range<Mm> = Range { least: Mm::ZERO, most: Mm::const_from_int(100) };
/// Rate of a serial line, in baud: from a rate of every adapter to the highest that a USART at 45 MHz and its adapters
/// can keep.
pub const BAUD: Range<u32> = Range { least: 9600, most: 1_000_000 };
/// Steps a second of one motor. It is twenty times the rate of 300 mm/s at 80 steps/mm, and half of the 1 MHz at which
/// two pulses of a motor would touch.
pub const STEP_RATE: StepRate = StepRate::of_whole(500_000);
/// Run current in mA: below 100 a NEMA 17 hardly turns itself, and 1768 is the limit of sense resistors of 110 mOhm
/// (TMC2209 datasheet rev 1.09, section 9).
pub const CURRENT_MA: Range<u16> = Range { least: 100, most: 1700 };
/// StallGuard threshold of a single motor; 0 is the threshold of its group.
pub const OWN_STALL_THRESHOLD: Range<u8> = Range { least: 1, most: u8::MAX };
/// Hold current in percent of the run current.
pub const HOLD_PERCENT: Range<u8> = Range { least: 0, most: 100 };
/// Hold current of a single motor; 0 is that of its group.
pub const OWN_HOLD_PERCENT: Range<u8> = Range { least: 1, ..HOLD_PERCENT };
/// Frequency of an input shaper: below 10 Hz a shaper takes longer than the trajectory remembers, above 500 it takes
/// no more than a few steps.
pub const FREQUENCY: Range<Hertz> = Range { least: Hertz::const_from_int(10), most: Hertz::const_from_int(500) };
/// Length of the belts on both sides of the tool.
pub const BELT_SPAN: Range<Mm> = Range { least: Mm::const_from_int(100), most: Mm::const_from_int(10_000) };
/// Frequency at which the tool would ring on the motors alone; 0 for stiff ones.
pub const MOTOR_FREQUENCY: Range<Hertz> = Range { least: Hertz::ZERO, most: Hertz::const_from_int(2000) };
/// Damping of an axis, as a ratio; a frame has 0.02 to 0.2.
pub const DAMPING: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::lit("0.5") };
/// Minimum cruise ratio: with more than 0.9, short moves would take twice as long.
pub const CRUISE_RATIO: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::lit("0.9") };
/// Pressure advance: some 0.05 s with a direct drive, 1 s with a long tube.
pub const ADVANCE: Range<Seconds> = Range { least: Seconds::ZERO, most: Seconds::const_from_int(4) };
/// Window of the pressure advance. It is some milliseconds at least: the speed is averaged over it, and without a
/// window the advance would jump at every change of speed (`trajectory::taps`). A fifth of a second is more than the
/// delay of any shaper. Delays hold 1.67 s.
pub const ADVANCE_WINDOW: Range<Seconds> = Range { least: Seconds::lit("0.005"), most: Seconds::lit("0.2") };
/// Motion that waits in the look-ahead. With less than 0.5 s a host that pauses for a moment makes the tool stop; a
/// cancelled print continues for as long. Klipper's `buffer_time_high` is 2 s.
pub const LOOKAHEAD_TIME: Range<Seconds> = Range { least: Seconds::lit("0.5"), most: Seconds::const_from_int(60) };
/// Highest target of a hotend: up to the rating of platinum sensors and all-metal hotends.
pub const HOTEND: Range<Celsius> = Range { least: Celsius::const_from_int(30), most: Celsius::const_from_int(500) };
/// Highest target of a bed or a chamber: adhesives of mats and magnets end at 150 C.
pub const BED: Range<Celsius> = Range { least: Celsius::const_from_int(30), most: Celsius::const_from_int(150) };
/// Highest temperature at a second sensor of a heater: from a bed's plate to a hotend's cartridge.
pub const SECOND: Range<Celsius> = Range { least: Celsius::const_from_int(40), most: Celsius::const_from_int(500) };
/// Power of a heater; a household's socket has 2 kW at least.
pub const POWER: Range<Watts> = Range { least: Watts::const_from_int(1), most: Watts::const_from_int(2000) };
/// Highest duty, of 1.
pub const MAX_DUTY: Range<Ratio> = Range { least: Ratio::lit("0.05"), most: Ratio::ONE };
/// Period of a relay in ms: more, and the bed swings.
pub const RELAY_MS: Range<u16> = Range { least: 0, most: 5000 };
/// Heat capacity, from a nozzle alone to a chamber of steel.
pub const CAPACITY: Range<JoulesPerKelvin> =
    Range { least: JoulesPerKelvin::lit("0.5"), most: JoulesPerKelvin::const_from_int(50_000) };
/// Losses, from a hotend with a sock to a chamber with its door open.
pub const LOSS: Range<WattsPerKelvin> =
    Range { least: WattsPerKelvin::lit("0.001"), most: WattsPerKelvin::const_from_int(100) };
/// Lags: the observer runs 50 times a second, and a lag of more than minutes is not useful.
pub const LAG: Range<Seconds> = Range { least: Seconds::lit("0.1"), most: Seconds::const_from_int(120) };
/// Growth of a PTC heater's resistance for each K: metals have up to 0.0045 (nickel 0.006), copper 0.0039.
pub const PTC: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::lit("0.01") };
/// Gains of PID.
pub const GAIN: Range<Ratio> = Range { least: Ratio::ZERO, most: Ratio::const_from_int(20_000) };
/// The part of its heat that has to be found again: less than 0.2 finds no loose cartridge, more than 0.6 alarms at 20
/// V.
pub const HEATING: Range<Ratio> = Range { least: Ratio::lit("0.2"), most: Ratio::lit("0.6") };
/// A temperature that is lost: Prusa's 15 C and Marlin's 4 C are in it.
pub const LOST: Range<Celsius> = Range { least: Celsius::const_from_int(3), most: Celsius::const_from_int(20) };
/// The time that it may be lost for, in s: Prusa's 80 s is not.
pub const LOST_S: Range<u8> = Range { least: 2, most: 45 };
/// Rise while off.
pub const OFF_RISE: Range<Celsius> = Range { least: Celsius::const_from_int(3), most: Celsius::const_from_int(15) };
/// Above the target without power.
pub const OVERSHOOT: Range<Celsius> = Range { least: Celsius::const_from_int(5), most: Celsius::const_from_int(30) };
/// Resistance of an NTC at 25 C, in Ohm.
pub const OHMS: Range<u32> = Range { least: 1000, most: 2_000_000 };
/// B of an NTC, in K.
pub const BETA: Range<u16> = Range { least: 2000, most: 6000 };
/// Least temperature at which filament moves; 0 for any, as Marlin's M302 S0.
pub const MIN_EXTRUDE: Range<Celsius> = Range { least: Celsius::ZERO, most: Celsius::const_from_int(400) };
/// From here on a hotend's cold end needs air: PLA softens at 55 to 60 C.
pub const COLD_END: Range<Celsius> = Range { least: Celsius::const_from_int(30), most: Celsius::const_from_int(60) };
/// Run-on time of a controller's fan, in s.
pub const RUN_ON_S: Range<u16> = Range { least: 0, most: 3600 };
/// Idle minutes until heaters go off.
pub const IDLE_MIN: Range<u8> = Range { least: 1, most: 240 };
/// Heat that filament takes, in J/(K mm): from 1.75 mm to 3 mm, and a half more.
pub const FILAMENT: Range<WattsPerKelvin> =
    Range { least: WattsPerKelvin::lit("0.001"), most: WattsPerKelvin::lit("0.05") };
/// A fan's kick in ms.
pub const KICK_MS: Range<u16> = Range { least: 0, most: 5000 };
/// Distance of a probe from the nozzle in x or y: Marlin's limit (M851.cpp).
pub const PROBE_OFFSET: Range<Mm> = Range { least: Mm::const_from_int(-50), most: Mm::const_from_int(50) };
/// The same in z.
pub const PROBE_OFFSET_Z: Range<Mm> = Range { least: Mm::const_from_int(-20), most: Mm::const_from_int(20) };
/// Speed of a touch. A clone of a BLTouch gives a pulse of 5 ms, and the probe is read at each step event. At 0.5 mm/s
/// z with 400 steps/mm makes an event each 5 ms. At 20 mm/s the tool stops hard.
pub const PROBE_SPEED: Range<MmPerSec> = Range { least: MmPerSec::lit("0.5"), most: MmPerSec::const_from_int(20) };
/// Touches at a place.
pub const PROBE_SAMPLES: Range<u8> = Range { least: 1, most: 9 };
/// Repetitions of them.
pub const PROBE_RETRIES: Range<u8> = Range { least: 0, most: 9 };
/// Difference of touches at a place: no step of any screw is smaller than the least.
pub const PROBE_TOLERANCE: Range<Mm> = Range { least: Mm::lit("0.001"), most: Mm::const_from_int(1) };
/// Distance of a probe from the bed. The pin of a BLTouch is out by 5 mm or more.
pub const PROBE_CLEARANCE: Range<Mm> = Range { least: Mm::const_from_int(1), most: Mm::const_from_int(50) };
/// Rest before a touch, in s.
pub const PROBE_QUIET: Range<Seconds> = Range { least: Seconds::ZERO, most: Seconds::const_from_int(2) };
/// Microsteps: MRES has every power of two in it (section 5.5.1).
pub const MICROSTEPS: Range<u16> = Range { least: 1, most: 256 };
/// Samples of an accelerometer in a second: at the least, resonances up to 150 Hz are still measured well; the most of
/// an ADXL345.
pub const SAMPLES: Range<u16> = Range { least: 400, most: 3200 };
