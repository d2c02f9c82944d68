//! Report: the results of a played trace.

use super::LOOK;
use super::watch::Watch;
use crate::contour::corner::{Corner, LEAST_LINE_MM};
use crate::contour::line_types::TypeErrors;
use crate::params::Params;
use crate::queries::shown;
use crate::routing::Machine;
use crate::steps::TICKS_PER_SECOND;
use serde::Serialize;
use std::collections::BTreeMap;

/// Number of listed corners.
const LISTED: usize = 20;

/// The results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The machine.
    pub machine: &'static str,
    /// Moving parts besides the tool.
    pub model: &'static str,
    /// Length of the trace.
    pub duration_s: f64,
    /// Number of its instants.
    pub events: usize,
    /// Errors of the tool.
    pub contour: ContourFigures,
    /// The same for each type of line, where the slicer's comments tell them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_type: Vec<TypeFigures>,
    /// Number of all corners of the line at which the tool was seen.
    pub corners_total: usize,
    /// Number of corners without results: between lines shorter than [`LEAST_LINE_MM`], or with the tool nowhere near.
    pub corners_unmatched: usize,
    /// The corners, worst first.
    pub corners: Vec<CornerFigures>,
    /// The tool at rest after the last step, minus the end of its line: to the right.
    pub end_off_x_um: f64,
    /// The same away from the front.
    pub end_off_y_um: f64,
    /// Lowest and highest tension of each span.
    #[serde(rename = "tension_N")]
    pub tension_n: BTreeMap<&'static str, [f64; 2]>,
    /// Number of times that a span became slack.
    pub slack_events: u32,
    /// The motors.
    pub motors: Vec<MotorFigures>,
    /// Largest residual of the commanded steps; 0 on machines without one.
    pub commanded_residual_mm: f64,
    /// Largest residual of the motors' real positions.
    pub residual_mm: f64,
    /// Largest torque with which the guides kept the bar square.
    #[serde(rename = "yaw_torque_Nm")]
    pub yaw_torque_nm: f64,
    /// Largest torque with which all motors together turned the frame, as \[H\] has it after equation 38.
    #[serde(rename = "frame_torque_Nm")]
    pub frame_torque_nm: f64,
    /// Largest displacement of a soft frame on the ground along x and y; none of a rigid one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_mm: Option<[f64; 2]>,
    /// Computing time.
    pub wall_time_s: f64,
    /// Speed relative to the real machine.
    pub times_real_time: f64,
}

/// Distances of the tool from its line, apart from touches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContourFigures {
    /// Largest.
    pub max_mm: f64,
    /// Root of the mean square over time.
    pub rms_mm: f64,
    /// Largest on the inside of corners.
    pub rounding_max_mm: f64,
    /// Largest on the outside of corners.
    pub overshoot_max_mm: f64,
    /// Largest distance from a corner at which the tool crossed its bisector, by equation 17 of Yin et al.; inside
    /// positive.
    pub bisector_max_mm: f64,
    /// Largest distance of the commanded places from the line: rounding to steps, and a shaper's.
    pub commanded_max_mm: f64,
    /// Root of the mean square of these.
    pub commanded_rms_mm: f64,
    /// How far the line itself may be from the planned one: 0 if the plan is known, a step if only steps are.
    pub line_share_mm: f64,
    /// Largest in touches of switches, until their stops have rung out: in no other figure. 0 without a touch, and if
    /// only steps are known: then touches are not told apart.
    pub touch_max_mm: f64,
}

/// Errors of the tool on lines of a type.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TypeFigures {
    /// The errors.
    #[serde(flatten)]
    pub errors: TypeErrors,
    /// Time of the tool on them, as far as it moved.
    pub seconds: f64,
    /// Time at which the largest occurred.
    pub time_s: f64,
}

/// A corner.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CornerFigures {
    /// Its place, from motor 1's axis.
    pub x_mm: f64,
    /// The same away from the front.
    pub y_mm: f64,
    /// Time at which the tool was sent there.
    pub time_s: f64,
    /// Turn of the line, positive to the left.
    pub turn_deg: f64,
    /// Largest error on its inside.
    pub rounding_mm: f64,
    /// Largest error on its outside.
    pub overshoot_mm: f64,
    /// Distance from it at which the tool crossed its bisector (equation 17 of Yin et al.), inside positive; none
    /// without a crossing.
    pub bisector_mm: Option<f64>,
}

/// A motor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MotorFigures {
    /// Its number.
    pub motor: u8,
    /// Largest torque.
    #[serde(rename = "torque_max_mNm")]
    pub torque_max_mnm: f64,
    /// Remaining part of the holding torque, of 1.
    pub margin: f64,
    /// Remaining part of the torque at its rotor's speed, of 1; none if motors are not rotors.
    pub margin_at_speed: Option<f64>,
    /// Number of slips by an electrical turn.
    pub slips: u32,
    /// Full steps by which it is off at the end.
    pub full_steps_off: f64,
}

impl Report {
    /// Results of a trace of this length, computed in this time.
    #[must_use]
    pub fn new(
        machine: Machine,
        model: &'static str,
        params: &Params,
        watch: &Watch,
        (duration_s, events): (f64, usize),
        wall_time_s: f64,
    ) -> Self {
        let names = machine.span_names().into_iter();
        let (mut corners, unseen): (Vec<Corner>, Vec<Corner>) =
            watch.contour.corners.iter().partition(|corner| corner.is_seen());
        corners.sort_by(|a, b| b.worst_mm().total_cmp(&a.worst_mm()));
        let worst = |error: fn(&Corner) -> f64| corners.iter().map(error).fold(0.0, f64::max);
        let contour = ContourFigures {
            max_mm: watch.contour.greatest_mm,
            rms_mm: watch.contour.rms_mm(),
            rounding_max_mm: worst(|corner| corner.rounding_mm),
            overshoot_max_mm: worst(|corner| corner.overshoot_mm),
            bisector_max_mm: corners
                .iter()
                .filter_map(|corner| corner.bisector_mm)
                .fold(0.0, |most: f64, mm| if mm.abs() > most.abs() { mm } else { most }),
            commanded_max_mm: watch.commanded.greatest_mm,
            commanded_rms_mm: watch.commanded.rms_mm(),
            line_share_mm: watch.line_share_mm,
            touch_max_mm: watch.contour.touch_mm,
        };
        let motor = |(motor, watch): (u8, &super::watch::MotorWatch)| MotorFigures {
            motor,
            torque_max_mnm: watch.greatest_force_n * params.radius_mm(machine.index_of(motor)),
            margin: 1.0 - watch.greatest_force_n / params.holding_force_n(machine.index_of(motor)),
            margin_at_speed: (watch.greatest_part_at_speed > 0.0).then_some(1.0 - watch.greatest_part_at_speed),
            slips: watch.slips,
            full_steps_off: 4.0 * watch.turns_off,
        };
        Self {
            machine: machine.key(),
            model,
            duration_s,
            events,
            contour,
            by_type: watch.contour.line_types.told().into_iter().map(TypeFigures::new).collect(),
            corners_total: corners.len(),
            corners_unmatched: watch.contour.without_lines + unseen.len(),
            corners: corners.iter().take(LISTED).map(figures).collect(),
            end_off_x_um: 1000.0 * watch.end_off_mm[0],
            end_off_y_um: 1000.0 * watch.end_off_mm[1],
            tension_n: names.zip(&watch.tensions_n).map(|(name, r)| (name, [r.least, r.greatest])).collect(),
            slack_events: watch.slack,
            motors: machine.motors().into_iter().zip(&watch.motors).map(motor).collect(),
            commanded_residual_mm: watch.commanded_residual_mm,
            residual_mm: watch.residual_mm,
            yaw_torque_nm: watch.yaw_torque_n_mm / 1000.0,
            frame_torque_nm: watch.motors_torque_n_mm / 1000.0,
            frame_mm: watch.frame_mm,
            wall_time_s,
            times_real_time: duration_s / wall_time_s.max(1e-9),
        }
    }
}

impl TypeFigures {
    fn new(errors: TypeErrors) -> Self {
        let seconds = (errors.samples * LOOK) as f64 / TICKS_PER_SECOND;
        Self { seconds, time_s: errors.tick as f64 / TICKS_PER_SECOND, errors }
    }
}

fn figures(corner: &Corner) -> CornerFigures {
    CornerFigures {
        x_mm: corner.at[0],
        y_mm: corner.at[1],
        time_s: corner.time_s(),
        turn_deg: corner.turn_rad.to_degrees(),
        rounding_mm: corner.rounding_mm,
        overshoot_mm: corner.overshoot_mm,
        bisector_mm: corner.bisector_mm,
    }
}

impl Report {
    /// A line for each type of line.
    fn write_types(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.by_type.is_empty() {
            return Ok(());
        }
        let (rms, mostly, max) = ("RMS um", "99.9 % um", "max um");
        writeln!(f, "  {:<22} {:>10} {rms:>8} {mostly:>10} {max:>8}", "by type of line", "time")?;
        for TypeFigures { errors, seconds, time_s } in &self.by_type {
            let TypeErrors { name, rms_um, mostly_um, max_um, x_mm, y_mm, .. } = errors;
            write!(f, "    {name:<20} {seconds:>8.1} s {rms_um:>8.1} {mostly_um:>10.1} {max_um:>8.1}")?;
            writeln!(f, " at ({x_mm:.2}, {y_mm:.2}), {time_s:.3} s")?;
        }
        Ok(())
    }
}

/// Number of corners shown to people.
const SHOWN: usize = 8;

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = Machine::ALL.into_iter().find(|m| m.key() == self.machine).map_or(self.machine, Machine::name);
        let Self { model, duration_s, events, wall_time_s, times_real_time, .. } = self;
        writeln!(f, "{name}, {model}: {duration_s:.2} s, {events} instants of steps")?;
        writeln!(f, "  computed in {wall_time_s:.2} s, {times_real_time:.1} times as fast as the machine")?;
        let ContourFigures { max_mm, rms_mm, rounding_max_mm, overshoot_max_mm, bisector_max_mm, .. } = self.contour;
        writeln!(f, "  contour error   max {max_mm:.4} mm, RMS {rms_mm:.4} mm")?;
        let ContourFigures { commanded_max_mm, commanded_rms_mm, line_share_mm, touch_max_mm, .. } = self.contour;
        if touch_max_mm > 0.0 {
            writeln!(
                f,
                "  in touches      max {touch_max_mm:.4} mm: stops at switches ring; not in the other figures"
            )?;
        }
        self.write_types(f)?;
        write!(f, "  commanded       max {commanded_max_mm:.4} mm, RMS {commanded_rms_mm:.4} mm off the ")?;
        match line_share_mm {
            0.0 => writeln!(f, "planned line: rounding to steps, and shaping")?,
            _ => writeln!(f, "line, which is drawn through the steps and may be {line_share_mm:.4} mm off the plan")?,
        }
        writeln!(
            f,
            "  at {} corners   inside {rounding_max_mm:.4} mm, outside {overshoot_max_mm:.4}, on the bisector {bisector_max_mm:.4}",
            self.corners_total
        )?;
        if self.corners_unmatched > 0 {
            write!(f, "  {} more corners could not be matched: ", self.corners_unmatched)?;
            writeln!(f, "their lines are shorter than {LEAST_LINE_MM} mm, or the tool was nowhere near")?;
        }
        for c in self.corners.iter().take(SHOWN) {
            let (x, y, turn, time) = (c.x_mm, c.y_mm, c.turn_deg, c.time_s);
            write!(f, "    ({x:.2}, {y:.2}) at {time:.3} s, turning {turn:.0} degrees: ")?;
            write!(f, "inside {:.4}, outside {:.4} mm", c.rounding_mm, c.overshoot_mm)?;
            writeln!(f, "{}", c.bisector_mm.map_or(String::new(), |mm| format!(", on the bisector {mm:.4}")))?;
        }
        let [x, y] = [self.end_off_x_um, self.end_off_y_um].map(|um| shown(um, 2));
        writeln!(f, "  at the end      the tool rests {x} um in x and {y} um in y off the end of its line")?;
        for (span, [least, greatest]) in &self.tension_n {
            writeln!(f, "  span {span:<8} {least:>7.2} to {greatest:.2} N")?;
        }
        if self.slack_events > 0 {
            writeln!(f, "  a span became slack {} times", self.slack_events)?;
        }
        for motor in &self.motors {
            let MotorFigures { motor, torque_max_mnm, margin, margin_at_speed, slips, full_steps_off } = motor;
            write!(f, "  motor {motor:<7} {torque_max_mnm:>7.1} mN m at most, {:.0} % left", 100.0 * margin)?;
            if let Some(margin) = margin_at_speed {
                write!(f, ", {:.0} % at its speed", 100.0 * margin)?;
            }
            if *slips > 0 {
                write!(f, "; slipped {slips} times, {full_steps_off} full steps off")?;
            }
            writeln!(f)?;
        }
        writeln!(f, "  belt residual   {:.4} mm commanded, {:.4} mm", self.commanded_residual_mm, self.residual_mm)?;
        writeln!(f, "  yaw torque      {:.3} N m at most", self.yaw_torque_nm)?;
        writeln!(f, "  torque of all motors on the frame  {:.4} N m at most", self.frame_torque_nm)?;
        if let Some([x, y]) = self.frame_mm {
            writeln!(f, "  frame moves by  {x:.4} mm in x, {y:.4} mm in y at most, under the tool's errors above")?;
        }
        Ok(())
    }
}
