//! The request in a line of G-code, as a type that cannot hold nonsense.

use super::number::Number;
use super::parts::{
    ArcShape, Audience, AxisFlags, AxisWords, Flaw, Form, MachineRecord, ModelWords, ParkWords, Plane, VelocityWords,
};
use crate::connectors::Heater;

/// A command; every variant is answered with one `ok`. Lengths are in the units that G20/G21 chose.
///
/// A new one is read by `parse`, `m_codes` or `named`. It does not compile before `machine::commands::immediate` has an
/// arm for it and `tests/support/print.rs` its printed form. `tests/gcode.rs` then asks for its letters in `grammar`
/// (without a row any text is taken) and its code in `CODES`. `boards/sim/tests/commands/table.rs` asks for a row with
/// its answer. By hand: remove a code from `quiet` if it was ignored before; add it to `machine::main_loop::halted` if
/// a host may send it to a stopped machine; docs/reference/gcode.md (`tests/reference.rs` asks for its row),
/// docs/reference/host-protocol.md, CHANGELOG.md.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Command<'a> {
    /// G0, G1: straight move.
    Line {
        /// Whether it was G0 (a travel move by intent).
        rapid: bool,
        /// The target.
        to: AxisWords,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G0, G1 with C: straight move in which a closed belt circulates.
    Circulate {
        /// The target.
        to: AxisWords,
        /// C: the target of the belt, in mm of belt.
        belt: Number,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G2, G3: arc or helix.
    Arc {
        /// G2 runs clockwise, G3 counter-clockwise.
        clockwise: bool,
        /// The target.
        to: AxisWords,
        /// F, per minute.
        feed: Option<Number>,
        /// I, J, K or R.
        shape: ArcShape,
        /// P: total number of turns, at least 1 (RS-274/NGC section 3.5.3).
        turns: u16,
        /// Most decimals of its coordinates as they are written, up to 5: places that differ by less than the last may
        /// be one.
        decimals: u8,
    },
    /// G4: wait this many milliseconds after the motion so far.
    Dwell {
        /// S and P summed, in ms.
        ms: u32,
    },
    /// G10: pull the filament back, and lift the tool.
    Retract,
    /// G11: undo G10.
    Recover,
    /// M207: settings of G10, or report.
    RetractSettings {
        /// S: length of filament.
        length: Option<Number>,
        /// F, per minute.
        feed: Option<Number>,
        /// Z: lift.
        lift: Option<Number>,
    },
    /// M208: the additional amounts of G11, or report.
    RecoverSettings {
        /// S: filament that is pushed in addition.
        extra: Option<Number>,
        /// F, per minute.
        feed: Option<Number>,
    },
    /// G17, G18, G19: the plane of arcs.
    Plane(Plane),
    /// G20: lengths are inches.
    Inches,
    /// G21: lengths are millimetres.
    Millimetres,
    /// G28: home the named axes, all if none is named.
    Home(AxisFlags),
    /// G90: positions are absolute.
    Absolute,
    /// G91: positions are relative, E too.
    Relative,
    /// G92: the present position is called this from now on; all zero if no axis is named.
    SetPosition(AxisWords),
    /// M0, M1, M600, M601: pause the print and wait for the user.
    AwaitUser {
        /// S and P summed, in ms, after which it continues by itself; 0 is never.
        ms: u32,
        /// Whether the filament is to be changed in the pause (M600).
        filament: bool,
        /// Where the tool waits.
        park: ParkWords,
    },
    /// M25, M125: pause the print.
    Pause {
        /// Whether the tool is parked even if nothing is printed (M125).
        parks: bool,
        /// Where the tool waits.
        park: ParkWords,
    },
    /// M24, M602: continue the print. A wait for the user is ended on the receive path.
    Resume,
    /// M75: a print begins.
    BeginJob,
    /// M77: it ends.
    EndJob,
    /// M524: it is cancelled. The receive path acts on it.
    Cancel,
    /// M876: an answer to a question. It is taken on the receive path.
    Answer,
    /// M28: the following lines are a file for a card; there is no card.
    BeginUpload(&'a [u8]),
    /// M29: that was all of it.
    EndUpload,
    /// M73: progress of the print, in percent, and the remaining minutes.
    Progress {
        /// P.
        percent: Option<Number>,
        /// R.
        minutes: Option<Number>,
    },
    /// M111: debug flags; bit 3 is a dry run, in which no filament moves.
    Debug(Option<Number>),
    /// M17: power the motors of the named axes, all if none is named.
    EnableMotors(AxisFlags),
    /// M18, M84: unpower the motors of the named axes, all if none is named.
    DisableMotors(AxisFlags),
    /// M18 S, M84 S: seconds without motion after which motors lose power; 0 is never.
    IdleTimeout {
        /// The time in s.
        seconds: u32,
    },
    /// M82: E is absolute.
    AbsoluteExtrusion,
    /// M83: E is relative.
    RelativeExtrusion,
    /// M92: steps a millimetre.
    StepsPerMm(AxisWords),
    /// M105: report temperatures.
    ReportTemperatures,
    /// M108: end the present wait.
    Continue,
    /// M110: set or, without a number, report the line number. The protocol room acts on it.
    LineNumber,
    /// M112: stop everything until M999 or a reset.
    EmergencyStop,
    /// M113: seconds between busy messages, or report them.
    Keepalive(Option<Number>),
    /// M114: report the position; with R the real one, counted from emitted steps.
    ReportPosition {
        /// Whether R was given.
        real: bool,
    },
    /// M115: report the firmware.
    ReportFirmware,
    /// M117: a message for a display that is not there.
    Message,
    /// M118: a message for the host.
    Tell {
        /// Its form.
        form: Form,
        /// The receivers.
        to: Audience,
        /// The message as it came.
        text: &'a [u8],
    },
    /// M119: report the endstops.
    ReportEndstops,
    /// M122: report the state of the machine's parts.
    Diagnose,
    /// M154: report the real position every given number of seconds.
    AutoPosition(Option<Number>),
    /// M155: report temperatures every given number of seconds.
    AutoReport(Option<Number>),
    /// M201: acceleration limits, units/s2.
    MaxAcceleration(AxisWords),
    /// M203: speed limits, units/s.
    MaxSpeed(AxisWords),
    /// M204: accelerations of printing, retracting and travelling moves, units/s2.
    Acceleration {
        /// P, or S.
        print: Option<Number>,
        /// R.
        retract: Option<Number>,
        /// T, or S.
        travel: Option<Number>,
    },
    /// M205: corner speeds and least feeds.
    Corners {
        /// J: junction deviation in units.
        deviation: Option<Number>,
        /// X, Y, Z, E: the speed jump allowed in a corner, units/s.
        jerk: AxisWords,
        /// S: least speed of a printing move, units/s.
        min_feed: Option<Number>,
        /// T: least speed of a travelling move, units/s.
        min_travel: Option<Number>,
        /// B: least time of a segment in us, which this firmware does not know.
        min_segment: Option<Number>,
    },
    /// M211: keep moves inside the reachable space, or report.
    SoftEndstops(Option<bool>),
    /// M220: feed override in percent, or report.
    FeedPercent(Option<Number>),
    /// M220 B: remember the feed override.
    BackUpFeedPercent,
    /// M220 R: go back to the remembered feed override.
    RestoreFeedPercent,
    /// M221: flow override in percent, or report.
    FlowPercent(Option<Number>),
    /// M400: wait until all motion is done.
    Finish,
    /// M410: stop the motion now and drop all queued moves.
    QuickStop,
    /// M420: report on bed levelling; there is none.
    ReportLevelling,
    /// M486 S: the object that the following lines belong to; none if negative.
    Object(Number),
    /// M486 P, U, C and EXCLUDE_OBJECT: leave an object out, which this firmware cannot.
    CancelObject,
    /// M500: keep the settings in storage.
    SaveSettings,
    /// M501: take the settings that are in storage.
    LoadSettings,
    /// M502: take the settings that the machine was made with.
    DefaultSettings,
    /// M503: report the settings as G-code.
    ReportSettings {
        /// S0: as lines that can be sent back unchanged, and nothing else.
        for_replay: bool,
    },
    /// M504: look whether the settings in storage are whole.
    CheckStorage,
    /// M569: stealthChop or spreadCycle for the named axes, all if none is named; or report.
    Stealth {
        /// S: whether it is stealthChop.
        on: Option<bool>,
        /// The axes.
        axes: AxisFlags,
    },
    /// M906: run current in mA, or report.
    DriverCurrent(AxisWords),
    /// M913: speed above which spreadCycle replaces stealthChop, units/s, or report.
    HybridThreshold(AxisWords),
    /// M914: StallGuard threshold, or report.
    StallThreshold(AxisWords),
    /// M915: align the motors of one belt, or check them.
    AlignBelt {
        /// D: report changes since they were aligned.
        diagnoses: bool,
        /// R: the same, and set it right.
        repairs: bool,
    },
    /// M593: the input shapers of the named axes, both if none is named, or report.
    Shaper {
        /// X and Y.
        axes: AxisFlags,
        /// F, in Hz; 0 is off.
        frequency: Option<Number>,
        /// D: a ratio.
        damping: Option<Number>,
        /// T: which shaper.
        kind: Option<Number>,
    },
    /// M900, M572, SET_PRESSURE_ADVANCE: pressure advance, or report.
    Advance {
        /// K or S, in s.
        time: Option<Number>,
        /// W: the time over which the speed is averaged, in s.
        window: Option<Number>,
    },
    /// SET_VELOCITY_LIMIT: acceleration, corner speed and the part of a move over which its speed holds at least, or
    /// report.
    VelocityLimit(VelocityWords<'a>),
    /// T0: choose the only tool.
    Tool,
    /// M104, M140, M141: set the target of a heater; no effect without S or R.
    HeaterTarget {
        /// Which heater.
        heater: Heater,
        /// S or R, in degrees Celsius.
        target: Option<Number>,
    },
    /// M109, M190, M191: the same, and wait for the target; no effect without S or R.
    HeaterWait {
        /// Which heater.
        heater: Heater,
        /// S or R, in degrees Celsius.
        target: Option<Number>,
        /// Whether to wait while it cools, too (R).
        cools: bool,
    },
    /// M116: wait for all heaters that are on.
    AwaitHeaters,
    /// M106, M107: set the speed of a fan, in its turn among the moves.
    FanSpeed {
        /// P: which fan; 255 for one that no machine has.
        fan: u8,
        /// S, of 255; 0 for M107.
        speed: Number,
    },
    /// M301, M304: the gains of a heater's PID controller, or report.
    Pid {
        /// Which heater.
        heater: Heater,
        /// P, I, D.
        gains: [Option<Number>; 3],
    },
    /// M303, M306 T: find out how a heater behaves.
    TuneHeater {
        /// E: 0 the hotend, -1 the bed, -2 the chamber; `None` for another number.
        heater: Option<Heater>,
        /// S, in degrees Celsius.
        target: Option<Number>,
        /// C: swings.
        cycles: Option<Number>,
        /// U: whether to use the result.
        applies: bool,
    },
    /// SELF_TEST: find out whether each heater warms its own sensor.
    SelfTest,
    /// MACHINE_GET, MACHINE_PUT, MACHINE_STORE: the machine, as a record in pieces.
    MachineRecord(MachineRecord<'a>),
    /// M302: the temperature below which no filament moves, or report.
    ColdExtrusion {
        /// S, in degrees Celsius.
        least: Option<Number>,
        /// P: whether filament may move at any temperature.
        allow: Option<bool>,
    },
    /// M306: the model of a heater, or report.
    HeaterModel {
        /// E, as for M303.
        heater: Option<Heater>,
        /// Whether there is an E.
        is_named: bool,
        /// Its numbers.
        words: ModelWords,
    },
    /// M710: the fan of the controller, or report.
    ControllerFan {
        /// S, of 255.
        speed: Option<Number>,
        /// D: the run-on time in s.
        run_on: Option<Number>,
        /// R: as the machine was made.
        resets: bool,
        /// I or A; this firmware has neither.
        other: Option<u8>,
    },
    /// M81: everything off that can be switched off.
    PowerOff,
    /// M413: recovery from a loss of power, which this firmware cannot; or report.
    PowerLossRecovery(Option<bool>),
    /// M622, M623, `if`, `while` and the like: which lines run depends on it, and this firmware runs them all.
    Conditional,
    /// G29, Prusa's G80 and their relatives: a command for a probe with which nothing is measured.
    Probing,
    /// A command that hosts and slicers send and that needs no answer but `ok`.
    Silent,
    /// M999: restart after a stop. The receive path acts on it if the machine is halted.
    Restart,
    /// A known command on a line that is not in order.
    Malformed(Flaw<'a>),
    /// Anything else, as it came.
    Unknown(&'a [u8]),
}
