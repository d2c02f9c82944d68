//! Plant: the forces on all moving parts, for given commanded motor positions.
//!
//! Coordinates are changes from the start: x, y, z where belts lift the tool, idlers, a soft frame's, then motors.
//! Motors are either at their commanded positions (*held*), or rotors that their fields pull there. A segment's
//! stiffness follows from its free length at the commanded positions: motors change the amount of belt in a segment,
//! stretch does not. So stiffness is constant between two steps, and energy is conserved.

use super::external_forces::Outside;
use super::field::Field;
use super::frame::{Frame, FrameAxis, MM_PER_M};
use crate::model::SHORTEST_FREE_MM;
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::model::links::{Link, Links};
use crate::model::ways::Ways;
use crate::params::Params;
use crate::routing::{Machine, Place};

/// Time in which a holding brake or obstacle stops a moving part, in s: three of the longest steps. It is not shorter
/// than the longest step of a [live](crate::stepped_machine) machine, so that the integration stays stable.
pub(crate) const BRAKED_IN_S: f64 = 3.0 * LONGEST_STEP_S;

/// Moving parts besides the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// Idlers, each with its inertia.
    pub idlers: bool,
    /// Rotors, pulled by their fields.
    pub rotors: bool,
}

/// A link with the values that change at steps.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    /// Free length at the start, in mm.
    length_mm: f64,
    /// Its belt, in the order of the machine's belts.
    pub(super) belt: usize,
    /// Tensile stiffness of its belt and its tension at rest, in N.
    pub(super) ea_n: f64,
    pub(super) preload_n: f64,
    /// Its growth per millimetre of the tool in x, y and z.
    pub(super) grows: [f64; 3],
    /// Coordinates that stretch it, with their factors.
    pub(super) row: Vec<(usize, f64)>,
    /// The same for a radian of the bar's yaw.
    pub(super) yaw_mm: f64,
    /// Present value, in N/mm.
    pub(super) stiffness: f64,
}

/// Forces and masses.
#[derive(Clone, Debug)]
pub struct Plant {
    /// The machine's numbers.
    pub params: Params,
    /// Transmission from the tool to the motors.
    pub ways: Ways,
    start: Place,
    /// mm/s^2 per newton, of each moving coordinate.
    pub(super) mobility: Vec<f64>,
    /// Coordinates: x, y, z where belts lift the tool, idlers, frame, motors.
    count: usize,
    /// How many of them are the tool's.
    axes: usize,
    /// Mass in kg that moves along x, y and z.
    pub(super) masses_kg: [f64; 3],
    /// The frame, if it is soft.
    pub(super) frame: Option<Frame>,
    are_rotors: bool,
    pub(super) has_yawing_bar: bool,
    pub(super) fields: Vec<Field>,
    pub(super) springs: Vec<Spring>,
    /// Names of the spans, and the first spring of each.
    pub(super) spans: Vec<(&'static str, usize)>,
    /// Longest integration step under any condition, in s.
    most_step_s: f64,
    /// Longest step at the commanded positions, stable for all vibrations.
    longest_step_s: f64,
}

/// Longest integration step unless the caller asks for [another](Plant::in_steps_of), in s: an 80th of a period of the
/// fastest rotor mode. Undamped energy falls by 7e-7 in a second.
const LONGEST_STEP_S: f64 = 36e-6;

/// The same with idlers, which ring at 1.5 kHz in the middle of the machine.
const LONGEST_STEP_OF_IDLERS_S: f64 = 8e-6;

/// Maximum step in radians of the fastest vibration; the Runge-Kutta method is stable to 2.8.
const MOST_RADIANS: f64 = 0.5;

/// Maximum step in time constants of the belt's damping or of dry friction; the method is stable to 2.7.
const MOST_SETTLING: f64 = 1.5;

impl Plant {
    /// A machine at rest with its tool at `start`.
    #[must_use]
    pub fn new(machine: Machine, params: &Params, start: Place, detail: Detail) -> Self {
        let freedom = Freedom { idlers: detail.idlers, rotors: detail.rotors, yaw: false, free_motor: None };
        Self::of(Elastic::new(machine, params, start, freedom), params, start, detail)
    }

    /// The same with rotors, and with these idlers alone: the stops by their indices.
    #[must_use]
    pub fn with_idlers(machine: Machine, params: &Params, start: Place, stops: &[usize]) -> Self {
        let links = Links::spans_between(machine, params, start, stops);
        let elastic = Elastic::of(links, machine, params, start, Freedom { rotors: true, ..Freedom::default() });
        Self::of(elastic, params, start, Detail { idlers: false, rotors: true })
    }

    fn of(elastic: Elastic, params: &Params, start: Place, detail: Detail) -> Self {
        let machine = elastic.machine;
        let ways = Ways::new(machine, params);
        let are = |wanted: fn(&Coordinate) -> bool| elastic.links.coordinates.iter().copied().filter(wanted);
        let idlers = are(|c| matches!(c, Coordinate::Idler(_)));
        let frame = are(|c| matches!(c, Coordinate::Frame(_)));
        let motors = ways.motors.iter().map(|number| Coordinate::Motor(*number));
        let axes = machine.axes();
        let tool = Coordinate::TOOL.into_iter().take(axes);
        let order: Vec<Coordinate> = tool.chain(idlers).chain(frame).chain(motors).collect();
        let index = |c: &Coordinate| elastic.links.index(*c);
        let entry = |link: &Link, c: &Coordinate| index(c).and_then(|i| link.row.get(i)).copied().unwrap_or(0.0);
        let moving = order.len() - if detail.rotors { 0 } else { ways.motors.len() };
        let masses = order.iter().take(moving).filter_map(index).map(|i| elastic.mass[(i, i)]);
        let spring = |link: &Link| Spring {
            length_mm: link.length_mm,
            belt: link.belt,
            ea_n: params.belt_ea_n.of(link.belt),
            preload_n: params.preload_n.of(link.belt),
            grows: Coordinate::TOOL.map(|axis| entry(link, &axis)),
            row: order.iter().enumerate().map(|(i, c)| (i, entry(link, c))).filter(|(_, v)| v.abs() > 0.5).collect(),
            yaw_mm: entry(link, &Coordinate::Yaw),
            stiffness: link.stiffness(params),
        };
        let mut spans: Vec<(&'static str, usize)> = Vec::new();
        for (i, link) in elastic.links.links.iter().enumerate() {
            if spans.last().is_none_or(|(name, _)| *name != link.span) {
                spans.push((link.span, i));
            }
        }
        let mut plant = Self {
            params: params.clone(),
            axes,
            masses_kg: machine.masses_kg(params),
            frame: Frame::new(machine, params),
            fields: (0..ways.motors.len()).map(|motor| Field::of(params, motor)).collect(),
            start,
            mobility: masses.map(|kg| MM_PER_M / kg).collect(),
            count: order.len(),
            are_rotors: detail.rotors,
            springs: elastic.links.links.iter().map(spring).collect(),
            spans,
            most_step_s: if detail.idlers { LONGEST_STEP_OF_IDLERS_S } else { LONGEST_STEP_S },
            longest_step_s: LONGEST_STEP_S,
            ways,
            has_yawing_bar: machine.has_yawing_bar(),
        };
        plant.send(&vec![0.0; plant.ways.motors.len()]);
        plant
    }

    /// The same, integrated in steps of at most this many s; vibrations may require shorter ones.
    #[must_use]
    pub fn in_steps_of(mut self, seconds: f64) -> Self {
        self.most_step_s = seconds;
        self.longest_step_s = self.stable_step_s();
        self
    }

    /// Number of all coordinates.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// How many coordinates are the tool's: x, y and maybe z.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.axes
    }

    /// Number of moving coordinates.
    #[must_use]
    pub const fn moving(&self) -> usize {
        self.mobility.len()
    }

    /// Index of the first motor coordinate.
    #[must_use]
    pub const fn first_motor(&self) -> usize {
        self.count - self.ways.motors.len()
    }

    /// Index of the first coordinate of a soft frame.
    pub(super) fn first_frame(&self) -> usize {
        self.first_motor() - self.frame.map_or(0, |frame| frame.0.len())
    }

    /// Displacement of a soft frame on the ground along x and y, in mm; of others 0.
    #[must_use]
    pub fn frame_mm(&self, at: &[f64]) -> [f64; 2] {
        let first = self.first_frame();
        [0, 1].map(|axis| at.get(first + axis).copied().filter(|_| self.frame.is_some()).unwrap_or(0.0))
    }

    /// Whether the frame is soft.
    #[must_use]
    pub const fn has_soft_frame(&self) -> bool {
        self.frame.is_some()
    }

    /// The frame along an axis of the tool, if it is soft.
    fn frame_under(&self, coordinate: usize) -> Option<&FrameAxis> {
        self.frame.as_ref()?.0.get(coordinate)
    }

    /// Whether motors are rotors in their fields.
    #[must_use]
    pub const fn are_rotors(&self) -> bool {
        self.are_rotors
    }

    /// Names of the spans.
    pub fn span_names(&self) -> impl Iterator<Item = &'static str> {
        self.spans.iter().map(|(name, _)| *name)
    }

    /// The tool's start.
    #[must_use]
    pub const fn start(&self) -> Place {
        self.start
    }

    /// Sets the free lengths for commanded motor positions.
    pub fn send(&mut self, sent_mm: &[f64]) {
        let [x, y, z] = self.ways.tool(sent_mm);
        for spring in &mut self.springs {
            let [along_x, along_y, up] = spring.grows;
            let length = spring.length_mm + along_x * x + along_y * y + up * z;
            spring.stiffness = spring.ea_n / length.max(SHORTEST_FREE_MM);
        }
        self.longest_step_s = self.stable_step_s();
    }

    /// Longest step of an integration, in s.
    #[must_use]
    pub const fn longest_step_s(&self) -> f64 {
        self.longest_step_s
    }

    /// A stable step for all vibrations. The square of the highest angular frequency is at most the largest row sum of
    /// stiffness over mass (Gershgorin).
    fn stable_step_s(&self) -> f64 {
        let mut fastest = 0.0_f64;
        for (coordinate, mobility) in self.mobility.iter().enumerate() {
            let motor = coordinate.checked_sub(self.first_motor()).filter(|_| self.are_rotors);
            let mut sum = motor.map_or(0.0, |motor| self.field(motor).stiffness);
            for spring in &self.springs {
                let own: f64 = spring.row.iter().filter(|(i, _)| *i == coordinate).map(|(_, c)| c.abs()).sum();
                if own > 0.0 {
                    sum += own * spring.stiffness * spring.row.iter().map(|(_, c)| c.abs()).sum::<f64>();
                }
            }
            fastest = fastest.max(sum * mobility);
            if let Some(frame) = self.frame_under(coordinate) {
                // The frame gives way to the same springs, and to the ground's.
                fastest = fastest.max(sum * mobility + (2.0 * sum + frame.stiffness) * frame.mobility);
            }
        }
        let settling = MOST_SETTLING / (self.params.belt_damping_s * fastest).max(self.rubs()).max(f64::MIN_POSITIVE);
        self.most_step_s.min(MOST_RADIANS / fastest.sqrt().max(f64::MIN_POSITIVE)).min(settling)
    }

    /// Effect of a held motor's step on all speeds: the belt's damping passes the sudden turn on as an impulse.
    pub fn strike(&self, coordinate: usize, step_mm: f64, at: &[f64], speeds: &mut [f64]) {
        for spring in &self.springs {
            if self.tension(spring, at) <= 0.0 {
                continue;
            }
            let stretch: f64 = spring.row.iter().filter(|(i, _)| *i == coordinate).map(|(_, c)| c * step_mm).sum();
            let set_fan = self.params.belt_damping_s * spring.stiffness * stretch;
            for (i, c) in &spring.row {
                if let (Some(speed), Some(mobility)) = (speeds.get_mut(*i), self.mobility.get(*i)) {
                    *speed -= c * set_fan * mobility;
                }
                if let Some(moved) = self.frame_under(*i).map(|frame| c * set_fan * frame.mobility) {
                    for (coordinate, moved) in [(*i, -moved), (self.first_frame() + i, moved)] {
                        if let Some(speed) = speeds.get_mut(coordinate) {
                            *speed += moved;
                        }
                    }
                }
            }
        }
    }

    /// Elastic tension of a spring; 0 where it is slack.
    pub(super) fn tension(&self, spring: &Spring, at: &[f64]) -> f64 {
        (spring.preload_n + spring.stiffness * sum(&spring.row, at)).max(0.0)
    }

    /// Pull of a spring: its tension, and its damping unless it is slack. Stretch and rate are summed in one pass,
    /// since this is the innermost loop.
    fn pull_of(&self, spring: &Spring, at: &[f64], speeds: &[f64]) -> f64 {
        let (mut stretch, mut rate) = (0.0, 0.0);
        for (i, c) in &spring.row {
            stretch += c * at.get(*i).copied().unwrap_or(0.0);
            rate += c * speeds.get(*i).copied().unwrap_or(0.0);
        }
        let tension = spring.preload_n + spring.stiffness * stretch;
        if tension <= 0.0 {
            return 0.0;
        }
        tension + self.params.belt_damping_s * spring.stiffness * rate
    }

    /// Accelerations of all moving parts, for commanded motor positions and outside actions.
    pub fn accelerate(
        &self,
        at: &[f64],
        speeds: &[f64],
        sent_mm: &[f64],
        outside: &Outside,
        accelerations: &mut [f64],
    ) {
        accelerations.fill(0.0);
        // Loose pulleys give way first. Spans to them have no damping: they are not stretched as fast as they seem.
        let slipped = self.slipped(at, &outside.screws);
        for spring in &self.springs {
            let tension = if !outside.screws.is_empty() && self.is_loose(spring, &outside.screws) {
                self.tension(spring, slipped.as_ref().map_or(at, |slipped| &slipped.at))
            } else {
                self.pull_of(spring, at, speeds)
            };
            for (i, c) in &spring.row {
                if let Some(force) = accelerations.get_mut(*i) {
                    *force -= c * tension;
                }
            }
        }
        self.rub(speeds, accelerations);
        for (force, push) in accelerations.iter_mut().zip(outside.push_n) {
            *force += push;
        }
        if self.are_rotors {
            self.pull(at, speeds, sent_mm, outside, accelerations);
            self.brake(self.first_motor(), speeds, &outside.brakes_n, accelerations);
        }
        self.brake(self.axes, speeds, &outside.idler_brakes_n, accelerations);
        if outside.obstacle_n > 0.0 {
            self.obstruct(speeds, outside.obstacle_n, accelerations);
        }
        let first = self.first_frame();
        let [places, speeds] = [at, speeds].map(|all| all.get(first..).unwrap_or_default());
        let frame = self.frame.map(|frame| frame.accelerations(places, speeds, accelerations, outside.push_n));
        for (acceleration, mobility) in accelerations.iter_mut().zip(&self.mobility) {
            *acceleration *= mobility;
        }
        for (axis, moves) in frame.into_iter().flatten().enumerate() {
            for (coordinate, added) in [(axis, -moves), (first + axis, moves)] {
                if let Some(acceleration) = accelerations.get_mut(coordinate) {
                    *acceleration += added;
                }
            }
        }
    }

    /// Fields, detents and friction of the rotors.
    fn pull(&self, at: &[f64], speeds: &[f64], sent_mm: &[f64], outside: &Outside, forces: &mut [f64]) {
        let first = self.first_motor();
        let rotors = at.iter().zip(speeds).skip(first).zip(forces.iter_mut().skip(first));
        for (motor, ((((at, speed), force), sent), field)) in rotors.zip(sent_mm).zip(&self.fields).enumerate() {
            let pull =
                outside.strength(motor) * field.holding_n(*at, *sent) + field.detent_n(at - outside.zero_mm(motor));
            *force += pull - field.damping * speed;
        }
    }

    pub(super) fn field(&self, motor: usize) -> Field {
        self.fields.get(motor).copied().unwrap_or_default()
    }

    /// Force of field and detent on a rotor, in N at the belt.
    #[must_use]
    pub fn field_n(&self, motor: usize, at_mm: f64, sent_mm: f64) -> f64 {
        let field = self.field(motor);
        field.holding_n(at_mm, sent_mm) + field.detent_n(at_mm)
    }
}

/// Sum of a row's coordinates; missing ones (speeds of held parts) are 0.
pub(super) fn sum(row: &[(usize, f64)], of: &[f64]) -> f64 {
    row.iter().map(|(i, c)| c * of.get(*i).copied().unwrap_or(0.0)).sum()
}
