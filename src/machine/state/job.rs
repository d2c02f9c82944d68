//! The job: whether a print is under way, is paused or was ended, and its state during a pause.
//!
//! **In a print** is defined in one place, here. Three events begin a print: the first move that extrudes while x or y
//! move (a jog moves one or the other), M75, or an unknown command name (`START_PRINT ...`). It ends with M77, M524,
//! M104 S0, M81 or M84 for x, y or z outside of a pause, M110 of its host, or an end by the firmware. Unlike numbered
//! lines, all hosts and files have that in common.
//!
//! The phases:
//!
//! - None: after the start or an end. Motors lose power when idle, heaters go off when idle. A line has its effect;
//!   cold filament does not move, and a move that needs homing is refused.
//! - Printing: see above. Motors hold. Heaters go off when idle and come back before filament moves. A line has its
//!   effect; a line for a cold hotend or a lost position is kept, and the print is paused.
//! - Paused: by M25, M0, M1, M600, M601, M125, or a line that is held. Motors hold. Heaters go off after a time and
//!   come back before the print continues. A line has its effect: it jogs or heats. Axes that lose their power are
//!   homed before the print continues.
//! - Ended: by `Interrupt::EndJob`. Motors lose power when idle, heaters are off. A line moves and heats nothing until
//!   G28, M108 or M110.
//!
//! A pause ends with M24 or M602. If a line is held, M108 and M876 S end it too; if none is kept, the next line of its
//! [stream](super::paused_stream) that prints ends it. The held line gets no `ok` during the pause, and other hosts are
//! served.

use super::held_line::HeldLine;
use super::level::LevelFailure;
use super::program::Program;
use crate::connectors::{HEATERS, Heater};
use crate::fault::Fault;
use crate::gcode::Number;
use crate::machine::numbers::shortest_with;
use crate::settings::HomedAxis;
use crate::units::{Celsius, Mm};
use core::fmt;

/// Where the job stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    None,
    Printing,
    Paused { was_printing: bool },
    Ended { is_told: bool },
}

/// Why a job ends although the machine stays as it is: there is no damage that a reset would repair.
///
/// A command that finds such a reason [notes](Job::note_end) it and returns `Interrupt::EndJob`, at any depth of calls.
/// The dispatch handles all of them in one place (`print::job`). Hosts are asked to cancel, with words that make
/// none of them disconnect. Heaters go off, the program's state becomes a new one, and the old stream has no effect any
/// more.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum JobEnd {
    /// The user wished it (M524).
    Cancelled,
    /// A heater stopped rising below its target; in whole degrees Celsius.
    Unreachable { heater: Heater, at: i32, target: i32 },
    /// A heater that is waited for has no reading: its sensor broke while it was off, which is no fault.
    Unread { heater: Heater },
    /// A heater that is waited for has a reading that cannot be right, which is no fault as long as nothing heats.
    Refused { why: Fault },
    /// An axis was not homed: a print with a wrong origin would be worse than none.
    NotHomed { axis: HomedAxis, why: HomingFailure },
    /// The probe did not find the bed.
    ProbeFailed { why: ProbeFailure },
    /// The screws of z were not levelled.
    NotLevel(LevelFailure),
    /// A line decides which lines run, and the firmware runs them all.
    Conditional,
}

/// Why the probe did not find the bed. Places are z of the nozzle, heights those of the bed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum ProbeFailure {
    /// It cannot touch there.
    OutOfReach { at: [Mm; 2] },
    /// It has triggered before it moved down.
    Triggered,
    /// It has not triggered down to the floor.
    NotMet { floor: Mm, expected: Mm },
    /// The same with z not homed, where the bed was found before.
    NotWhereItWas { floor: Mm, expected: Mm },
    /// It has not triggered on this way down, with z not homed.
    NotFound { way: Mm },
    /// It still reads as triggered after it was taken in.
    NotTakenIn,
    /// It has triggered twice far above the bed.
    Early { height: Mm, expected: Mm },
    /// Its touches at a place differ too much.
    Spread { spread: Mm, tolerance: Mm },
}

/// A length to a micrometre.
fn um(length: Mm) -> Number {
    shortest_with(length.into(), 10)
}

impl fmt::Display for ProbeFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OutOfReach { at: [x, y] } => put!(f, "the probe cannot touch at X{} Y{}", um(x), um(y)),
            Self::Triggered => put!(
                f,
                "the probe reads as triggered above the bed. Check that it is out, its wire, and the ! of \
                endstops.probe (M119)"
            ),
            Self::NotMet { floor, expected } => put!(
                f,
                "the probe did not trigger down to Z{}, expected at Z{}. Check its wire, and its offset (M851)",
                um(floor),
                um(expected)
            ),
            Self::NotWhereItWas { floor, expected } => put!(
                f,
                "the probe did not trigger down to Z{}, expected at Z{}. Check its wire. If the bed is lower now, send \
                M84 and home again",
                um(floor),
                um(expected)
            ),
            Self::NotFound { way } => {
                put!(f, "the probe did not trigger within {} mm. Check that it is out, and its wire", um(way))
            }
            Self::NotTakenIn => put!(
                f,
                "the probe's pin did not go in, or its alarm does not end. Check the pin, and the servo's wire (M280)"
            ),
            Self::Early { height, expected } => put!(
                f,
                "the probe triggered {} mm above the bed, expected at Z{}. Check what it met, its wire, and home Z again",
                um(height),
                um(expected)
            ),
            Self::Spread { spread, tolerance } => put!(
                f,
                "touches of the probe differ by {} mm, allowed are {} mm. Check that probe and bed sit firmly, or raise \
                probe.tolerance",
                um(spread),
                um(tolerance)
            ),
        }
    }
}

/// Why an axis was not homed; distances in whole mm.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum HomingFailure {
    /// The board has no such input: nothing would end the move.
    NotConnected,
    /// Z is homed at a place in x and y, and one of them is not homed.
    NeedsOthers,
    /// The probe cannot touch at this place.
    OutOfReach { at: [Mm; 2] },
    /// The nozzle cannot be at this place, where the switch homes z.
    NozzleOutOfReach { at: [Mm; 2] },
    /// The switch was not met on this way, which is longer than the axis.
    NotMet { way: i32 },
    /// The switch was still pressed after backing off so far.
    StillPressed { back_off: i32 },
}

impl HomingFailure {
    /// Whether it was known before anything moved.
    const fn is_refusal(self) -> bool {
        matches!(self, Self::NotConnected | Self::NeedsOthers | Self::OutOfReach { .. } | Self::NozzleOutOfReach { .. })
    }
}

impl JobEnd {
    /// Whether a line was refused before anything moved: without a print, that changes nothing.
    pub const fn is_refusal(self) -> bool {
        matches!(self, Self::NotHomed { why, .. } if why.is_refusal())
    }
}

impl fmt::Display for HomingFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotConnected => put!(f, "has no endstop on this board. Name its connector in the machine file"),
            Self::NeedsOthers => {
                put!(f, "is homed at a place in X and Y, and one of them is not homed. Home them too (G28)")
            }
            Self::OutOfReach { at: [x, y] } => {
                put!(f, "is homed by the probe, which cannot touch at X{} Y{}. Correct probe.home", um(*x), um(*y))
            }
            Self::NozzleOutOfReach { at: [x, y] } => {
                put!(f, "is homed at X{} Y{}, where the nozzle cannot be. Correct safe_z_home", um(*x), um(*y))
            }
            Self::NotMet { way } => {
                put!(f, "endstop was not met within {way} mm. Check its switch, its plug and its wire")
            }
            Self::StillPressed { back_off } => put!(
                f,
                "endstop was still pressed after backing off {back_off} mm. Check its switch, its wire, and that the \
                axis moves away from it"
            ),
        }
    }
}

impl fmt::Display for JobEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => put!(f, "its user cancelled it"),
            Self::Unreachable { heater, at, target } => put!(
                f,
                "{} stays at {at} C and does not reach {target} C. Choose a lower target, or check its heater, its \
                supply and draughts",
                heater.name()
            ),
            Self::Unread { heater } => {
                put!(f, "{} has no reading. Check its sensor, its plug and its wire", heater.name())
            }
            Self::Refused { why } => write!(f, "{why}"),
            Self::NotHomed { axis, why } => put!(f, "homing failed: {} {why}", axis.letter()),
            Self::ProbeFailed { why } => put!(f, "probing failed: {why}"),
            Self::NotLevel(why) => write!(f, "{why}"),
            Self::Conditional => put!(
                f,
                "a line decides which lines run, and this firmware cannot skip lines. Slice for Marlin, or remove it"
            ),
        }
    }
}

/// The state of the print that a pause keeps.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct Break {
    /// The state of the program.
    pub program: Program,
    /// Which axes were homed.
    pub homed: [bool; 3],
    /// Filament that is pushed in before the print continues (M600 L).
    pub load: Mm,
}

/// The job.
#[derive(Debug)]
pub(in crate::machine) struct Job {
    phase: Phase,
    /// The host of the print.
    host: usize,
    /// A name that was unknown may have been meant to home: an axis that never was is not where it seems to be.
    must_be_homed: bool,
    /// Axes that have lost their place since it began: their motors lost power. They are homed before it goes on.
    lost: [bool; 3],
    /// Where the last move that printed ended.
    printed_at: Option<[Mm; 4]>,
    paused: Option<Break>,
    /// The heater targets before the pause, or before the heaters switched off in the print.
    targets: Option<[Celsius; HEATERS]>,
    line: HeldLine,
    is_cancelled: bool,
    /// Why the present command has the job end.
    end: JobEnd,
}

/// The axes that are in one of two sets.
pub(in crate::machine) fn any_of([x, y, z]: [bool; 3], [of_x, of_y, of_z]: [bool; 3]) -> [bool; 3] {
    [x || of_x, y || of_y, z || of_z]
}

impl Job {
    pub const fn new() -> Self {
        Self {
            phase: Phase::None,
            host: 0,
            must_be_homed: false,
            lost: [false; 3],
            printed_at: None,
            paused: None,
            targets: None,
            line: HeldLine::new(),
            is_cancelled: false,
            end: JobEnd::Cancelled,
        }
    }

    /// The present command has the job end for that reason, and returns `Interrupt::EndJob`.
    pub const fn note_end(&mut self, why: JobEnd) {
        self.end = why;
    }

    /// Why it does.
    pub const fn why_it_ends(&self) -> JobEnd {
        self.end
    }

    /// A print begins, of that host.
    pub fn begin(&mut self, host: usize) {
        if !self.is_under_way() {
            *self = Self { phase: Phase::Printing, host, must_be_homed: self.must_be_homed, ..Self::new() };
        }
    }

    /// A name is unknown that may have been meant to home and to heat.
    pub fn begin_by_unknown_name(&mut self, host: usize) {
        if !self.is_under_way() {
            self.begin(host);
            self.must_be_homed = true;
        }
    }

    /// The print is over, as it should be. The Console answers a held line.
    pub const fn end(&mut self) {
        *self = Self { line: self.line, ..Self::new() };
    }

    /// The print was ended for that reason; its stream may still come.
    pub const fn end_early(&mut self, why: JobEnd) {
        self.end();
        (self.phase, self.end) = (Phase::Ended { is_told: false }, why);
    }

    /// A host that continues after its print was ended knows of the end.
    pub const fn forgive(&mut self) {
        if self.is_ended() {
            self.phase = Phase::None;
        }
    }

    /// The print was ended, and no line has said since then that there is another.
    pub const fn is_ended(&self) -> bool {
        matches!(self.phase, Phase::Ended { .. })
    }

    /// Whether the host needs the message of it.
    pub const fn tell_of_end(&mut self) -> bool {
        let is_new = matches!(self.phase, Phase::Ended { is_told: false });
        if is_new {
            self.phase = Phase::Ended { is_told: true };
        }
        is_new
    }

    /// A print is under way and is not paused.
    pub const fn is_printing(&self) -> bool {
        matches!(self.phase, Phase::Printing)
    }

    /// A pause is active, in a print or not.
    pub const fn is_paused(&self) -> bool {
        matches!(self.phase, Phase::Paused { .. })
    }

    /// Whether it is, paused or not.
    pub const fn is_under_way(&self) -> bool {
        self.is_printing() || self.is_paused()
    }

    /// Whether it is the host's own.
    pub const fn is_of(&self, host: usize) -> bool {
        self.host == host
    }

    /// Axes lose their place now, if it is under way.
    pub fn note_lost(&mut self, axes: [bool; 3]) {
        if self.is_under_way() {
            self.lost = any_of(self.lost, axes);
        }
    }

    /// The axes that must be homed before it goes on with a line that moves these. One that was never homed counts if
    /// it `is_required`.
    pub fn to_home(&self, moves: [bool; 3], is_required: bool) -> [bool; 3] {
        if is_required || self.must_be_homed { any_of(self.lost, moves) } else { self.lost }
    }

    /// A move that prints ends there.
    pub const fn note_printed(&mut self, position: [Mm; 4]) {
        self.printed_at = Some(position);
    }

    /// Where the last one ended, if any was.
    pub const fn printed_at(&self) -> Option<[Mm; 4]> {
        self.printed_at
    }

    /// It is paused; heaters were kept at `targets`.
    pub fn pause(&mut self, host: usize, paused: Break, targets: [Celsius; HEATERS]) {
        let was_printing = self.is_printing();
        if !was_printing {
            self.host = host;
        }
        self.phase = Phase::Paused { was_printing };
        self.paused = Some(paused);
        self.remember_targets(targets);
    }

    /// The state that the pause keeps, which a later line may change.
    pub const fn paused_mut(&mut self) -> Option<&mut Break> {
        self.paused.as_mut()
    }

    /// The print continues.
    pub const fn go_on(&mut self) {
        if let Phase::Paused { was_printing } = self.phase {
            self.phase = if was_printing { Phase::Printing } else { Phase::None };
        }
        (self.paused, self.targets, self.lost) = (None, None, [false; 3]);
    }

    /// Stores the heater targets for the end of the pause, unless they are stored already.
    pub fn remember_targets(&mut self, targets: [Celsius; HEATERS]) {
        if targets.iter().any(|target| *target > Celsius::ZERO) {
            self.targets.get_or_insert(targets);
        }
    }

    /// The same, if it has to be restored.
    pub const fn targets(&self) -> Option<[Celsius; HEATERS]> {
        self.targets
    }

    /// They are restored.
    pub const fn forget_targets(&mut self) {
        self.targets = None;
    }

    /// A line chooses a target. In a pause, a target that is warm enough to print with is restored at its end; any
    /// other counts for the time of the pause only.
    pub fn note_target(&mut self, heater: Heater, target: Celsius, least: Celsius) {
        let is_enough = target > Celsius::ZERO && target >= least;
        if self.is_paused() && is_enough {
            self.targets.get_or_insert([Celsius::ZERO; HEATERS])[heater as usize] = target;
        } else if let Some(targets) = self.targets.as_mut().filter(|_| is_enough) {
            targets[heater as usize] = target;
        }
    }

    /// The line that is held without `ok`.
    pub const fn line(&self) -> &HeldLine {
        &self.line
    }

    /// The same: it is kept, answered or taken up. Only a print that begins forgets it by itself.
    pub const fn line_mut(&mut self) -> &mut HeldLine {
        &mut self.line
    }

    /// M524 has arrived.
    pub const fn note_cancel(&mut self) {
        self.is_cancelled = true;
    }

    /// Whether it has, and is not acted on yet.
    pub const fn is_cancelled(&self) -> bool {
        self.is_cancelled
    }

    /// Whether it has.
    pub const fn take_cancel(&mut self) -> bool {
        core::mem::replace(&mut self.is_cancelled, false)
    }
}

#[cfg(test)]
mod tests;
