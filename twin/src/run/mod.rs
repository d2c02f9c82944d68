//! Run: plays a trace on the plant and reports on it.
//!
//! [`Run`] moves the motors as the trace says and integrates the motion in between. Ten thousand times a second, which
//! is 90 times a period of the faster axis, it looks at the tool's place and the loads of belts and motors ([`watch`]).
//! [`series`] has these over time, and [`report`] is the output for people and programs.

pub mod report;
pub mod series;
pub mod watch;

use crate::contour::error::{ContourError, Window};
use crate::contour::line_types::LineTypes;
use crate::contour::pace::{Pace, Places};
use crate::contour::path::{PathBuilder, Vertex};
use crate::contour::plan::PlanBuilder;
use crate::contour::touches::{RING_OUT, Touches};
use crate::dynamics::plant::{Detail, Plant};
use crate::dynamics::state::State;
use crate::geometry::{Workspace, workspace};
use crate::model::elastic::{Elastic, Freedom};
use crate::model::ways::residual_mm as residual_steps;
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::modes::modes;
use crate::steps::drive::{Drive, NoColumn, drives};
use crate::steps::{StepTrace, TICKS_PER_SECOND};
use watch::{Errors, Watch};

/// Ticks between two looks.
const LOOK: u64 = 1000;

/// Events between two progress calls.
const TOLD: usize = 4096;

/// Ticks that cost as much as an event: an integration step.
const STEP: f64 = 360.0;

/// Longest time for which the tool may take to come to rest at the end, in s, and how often this is checked.
const SETTLING_S: f64 = 5.0;
const CHECKED_S: f64 = 0.01;

/// Why a trace cannot be played.
#[derive(Clone, Debug, PartialEq)]
pub enum RunError {
    /// It has no column for a motor.
    NoColumn(NoColumn),
    /// The path leaves the reach of the machine.
    OutOfReach {
        /// Extent of the path.
        path: Workspace,
        /// The reach.
        reach: Workspace,
    },
    /// Numbers diverged after this many s: no machine has these parameters.
    Diverged(f64),
    /// It was interrupted.
    Interrupted,
}

impl std::fmt::Display for RunError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoColumn(error) => error.fmt(f),
            Self::OutOfReach { path, reach } => {
                write!(f, "the path takes {path} mm; the tool reaches {reach}")
            }
            Self::Diverged(seconds) => write!(f, "the machine's numbers grow beyond bounds after {seconds:.3} s"),
            Self::Interrupted => f.write_str("interrupted"),
        }
    }
}

impl std::error::Error for RunError {}

/// A trace on a plant.
#[derive(Debug)]
pub struct Run<'t> {
    trace: &'t StepTrace,
    drives: Vec<Drive>,
    plant: Plant,
    state: State,
    watch: Watch,
    window: Window,
    tick: u64,
    next_look: u64,
}

impl<'t> Run<'t> {
    /// A machine at rest with its tool at `start`, before a trace.
    ///
    /// # Errors
    /// The trace is of another kind of machine, or leaves its reach.
    pub fn new(
        machine: Machine,
        params: &Params,
        start: Place,
        detail: Detail,
        trace: &'t StepTrace,
    ) -> Result<Self, RunError> {
        let plant = Plant::new(machine, params, start, detail);
        let drives = drives(trace, &plant.ways, params).map_err(RunError::NoColumn)?;
        let line = Line::new(machine, &plant, &drives, trace);
        let reach = workspace(machine, params);
        if !reach.bears(&line.taken) {
            return Err(RunError::OutOfReach { path: line.taken, reach });
        }
        let window = window(machine, params, start, detail);
        let residual_mm = line.residual_mm;
        let watch = Watch::new(machine, &plant, line.errors(window).apart_from(Touches::of(trace)), residual_mm);
        let state = State::at_rest(&plant);
        Ok(Self { trace, drives, plant, state, watch, window, tick: 0, next_look: 0 })
    }

    /// Measures the tool's errors from the line of another trace: the original of this one, or one along the same line.
    /// The timing may differ: [`Pace`] gives the intended time of each place.
    ///
    /// # Errors
    /// The other trace is of another kind of machine.
    pub fn against(mut self, meant: &StepTrace) -> Result<Self, RunError> {
        let meant_drives = drives(meant, &self.plant.ways, &self.plant.params).map_err(RunError::NoColumn)?;
        let machine = self.watch.machine();
        let line = Line::new(machine, &self.plant, &meant_drives, meant);
        let own = Line::new(machine, &self.plant, &self.drives, self.trace);
        let pace = Pace::new(&own.places, &line.places);
        let errors = line.errors(self.window).apart_from(Touches::of(self.trace));
        self.watch.contour = errors.tool.at_pace(pace.clone());
        self.watch.commanded = errors.commanded.at_pace(pace);
        self.watch.line_share_mm = errors.line_share_mm;
        Ok(self)
    }

    /// Integrates in steps shorter by this factor.
    #[must_use]
    pub fn refined(mut self, times: f64) -> Self {
        self.state.refinement = times;
        self
    }

    /// Plays the whole trace and lets the machine ring out. `go_on` gets the computed part of the work, of 1, and
    /// returns whether to continue.
    ///
    /// # Errors
    /// `go_on` ended it.
    pub fn play(mut self, mut go_on: impl FnMut(f64) -> bool) -> Result<Watch, RunError> {
        // At rest nothing is computed, so a long pause costs as much as ringing out.
        let work = |gap: u64| 1.0 + gap.min(RING_OUT) as f64 / STEP;
        let whole: f64 = self.trace.events.iter().map(|event| work(event.gap.into())).sum();
        let mut done = 0.0;
        for (index, (tick, counts)) in self.trace.counted().enumerate() {
            if index % TOLD == 0 && !go_on(done / whole) {
                return Err(RunError::Interrupted);
            }
            done += work(tick - self.tick);
            if index % TOLD == 0 && !self.state.is_finite() {
                return Err(RunError::Diverged(self.tick as f64 / TICKS_PER_SECOND));
            }
            self.advance(tick);
            let mut has_stepped = false;
            for motor in 0..self.drives.len() {
                let to = self.drives.get(motor).map_or(0.0, |drive| sent(drive, &counts, self.trace.step_mm));
                has_stepped |= self.state.step(&self.plant, motor, to);
            }
            if has_stepped {
                self.plant.send(&self.state.sent_mm);
            }
        }
        self.advance(self.tick + RING_OUT);
        self.settle();
        if self.state.is_finite() { Ok(self.watch) } else { Err(RunError::Diverged(self.trace.duration_s())) }
    }

    /// Waits until the tool is at rest, and notes where. Errors of the line are no longer counted.
    fn settle(&mut self) {
        for _ in 0..(SETTLING_S / CHECKED_S) as u32 {
            if watch::is_at_rest(&self.plant, &mut self.state) {
                break;
            }
            self.state.advance(&self.plant, CHECKED_S);
        }
        let start = self.plant.start();
        let end = self.watch.contour.vertices.last().map_or([start.x, start.y], |end| end.at);
        let moved = |axis: usize| self.state.at.get(axis).copied().unwrap_or(0.0);
        self.watch.end_off_mm = [start.x + moved(0) - end[0], start.y + moved(1) - end[1]];
    }

    /// Advances to a time, with a look at regular ticks.
    fn advance(&mut self, tick: u64) {
        while self.tick < tick {
            let until = tick.min(self.next_look);
            self.state.advance(&self.plant, (until - self.tick) as f64 / TICKS_PER_SECOND);
            self.tick = until;
            if until == self.next_look {
                self.next_look += LOOK;
                let is_at_rest = self.watch.look(until, &self.plant, &mut self.state);
                if is_at_rest && tick > self.next_look {
                    // Nothing will happen before the next step.
                    self.next_look = tick;
                    self.tick = tick;
                }
            }
        }
    }
}

/// Time window of the tool on its line: a compliant machine lags and rings like its slowest axis there.
fn window(machine: Machine, params: &Params, start: Place, detail: Detail) -> Window {
    let freedom = Freedom { rotors: detail.rotors, ..Freedom::default() };
    let modes = modes(&Elastic::new(machine, params, start, freedom)).unwrap_or_default();
    let slowest = modes.first().map_or(f64::INFINITY, |mode| mode.frequency_hz);
    Window::of_hz(if slowest.is_finite() { slowest } else { 0.0 })
}

/// The commanded line of a trace.
struct Line {
    path: Vec<Vertex>,
    /// Commanded places over time.
    places: Vec<Vertex>,
    /// The part of the reach that it uses.
    taken: Workspace,
    /// Largest residual of the trace's steps.
    residual_mm: f64,
    /// How far the line itself may be from the planned one.
    share_mm: f64,
    /// Types of its parts.
    types: LineTypes,
}

impl Line {
    /// Errors of the tool and of commanded places from it.
    fn errors(self, window: Window) -> Errors {
        let tool = ContourError::new(self.path, &self.places, window);
        Errors { commanded: tool.clone(), tool: tool.of_types(self.types), line_share_mm: self.share_mm }
    }

    fn new(machine: Machine, plant: &Plant, drives: &[Drive], trace: &StepTrace) -> Self {
        let start = plant.start();
        let mut path = PathBuilder::new([start.x, start.y], trace.step_mm);
        let mut plan = PlanBuilder::new([start.x, start.y], &trace.plan, trace.step_mm);
        let mut places = Places::default();
        let mut taken = Workspace { x: [start.x; 2], y: [start.y; 2], z: [start.z; 2] };
        let mut residual_mm = 0.0_f64;
        let mut before = None;
        for (tick, counts) in trace.counted() {
            let sent = sent_mm(drives, &counts, trace.step_mm);
            if before.as_ref() == Some(&sent) {
                continue;
            }
            let [x, y, z] = plant.ways.tool(&sent);
            let at = [start.x + x, start.y + y];
            taken.x = [taken.x[0].min(at[0]), taken.x[1].max(at[0])];
            taken.y = [taken.y[0].min(at[1]), taken.y[1].max(at[1])];
            taken.z = [taken.z[0].min(start.z + z), taken.z[1].max(start.z + z)];
            match trace.plan.is_empty() {
                true => path.add(at, tick),
                false => plan.add(at, tick),
            }
            places.add(at, tick);
            // In whole steps, so that a residual of zero is exactly 0.
            let steps = sent_mm(drives, &counts, 1.0);
            let strain = residual_steps(machine, &steps).unwrap_or(0.0).abs() * trace.step_mm;
            residual_mm = residual_mm.max(strain);
            before = Some(sent);
        }
        let (path, share_mm, of_lines) = match trace.plan.is_empty() {
            true => (path.finish(), trace.step_mm, Vec::new()),
            false => {
                let (line, types) = plan.finish();
                (line, 0.0, types)
            }
        };
        let types = LineTypes::new(trace.line_types.clone(), of_lines);
        Self { path, places: places.finish(), taken, residual_mm, share_mm, types }
    }
}

/// Commanded position of a motor for these counts, in mm of belt.
fn sent(drive: &Drive, counts: &[i64; 8], step_mm: f64) -> f64 {
    let count = counts.get(drive.column).copied().unwrap_or(0);
    (count * i64::from(drive.sense)) as f64 * step_mm / f64::from(drive.multiple) * drive.axis_step
}

/// Commanded positions of all motors.
fn sent_mm(drives: &[Drive], counts: &[i64; 8], step_mm: f64) -> Vec<f64> {
    drives.iter().map(|drive| sent(drive, counts, step_mm)).collect()
}
