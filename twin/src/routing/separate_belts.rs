//! Own: machines with a belt of its own for each motor, from the motors' rows over x, y and z.
//!
//! Such a belt runs along the axes of its row. From a clamp it goes along the first axis to an end, which the row's
//! sign says. There a pulley on the part that carries this axis turns it along the next axis, and so on. At the last
//! end the motor sits. Then the belt runs back along the edges of the machine to the opposite corner, and by the same
//! ends of the other side to the other clamp. So a turn of the motor shortens one side by the tool's travel along the
//! row and lengthens the other one.
//!
//! | row | it is a belt of |
//! |---|---|
//! | one axis | a Cartesian machine |
//! | two axes | a CoreXY or CoreXZ |
//! | x, y and z | a CoreXYZ (Carlyle: two sets of orthogonal pulleys on each leg) |
//!
//! Carlyle gives no lengths. The run along the edges is an assumption: it lets motors and frame be anywhere outside.

use super::stop::{Along, Mark, Role, Side, Stop};
use super::{Belt, Runs};
use std::borrow::Cow;

/// Most motors.
pub const MOST_MOTORS: usize = 8;

/// A motor's travel for x, y and z: -1, 0 or 1 each.
pub type Row = [i8; 3];

/// Carlyle's belts D, C, B and A with the numbers of their motors, ascending: the slots of
/// `examples/machines/corexyz.toml`.
const COREXYZ: [(u8, Row); 4] = [(1, [-1, 1, 1]), (4, [-1, -1, 1]), (8, [1, -1, 1]), (11, [1, 1, 1])];

/// The number of a clamp.
const CLAMP: u8 = 0;

/// Idlers of the first belt have the numbers from 21 on, of the next one from 31 on.
const IDLERS: u8 = 20;

/// Names of both spans of each belt.
const SPANS: [[&str; 2]; MOST_MOTORS] = [
    ["1 out", "1 back"],
    ["2 out", "2 back"],
    ["3 out", "3 back"],
    ["4 out", "4 back"],
    ["5 out", "5 back"],
    ["6 out", "6 back"],
    ["7 out", "7 back"],
    ["8 out", "8 back"],
];

/// Names of the spans of a CoreXYZ, in the order of its belts.
const XYZ_SPANS: [[&str; 2]; 4] = [["D out", "D back"], ["C out", "C back"], ["B out", "B back"], ["A out", "A back"]];

/// A machine with a belt for each motor. Motors are numbered from 1 in the order of their rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Own {
    rows: [Row; MOST_MOTORS],
    count: usize,
    /// Whether a belt moves the bed in y, so that the bar stays.
    pub has_moving_bed: bool,
}

impl Own {
    /// The machine of these rows, if it has at most eight motors and their rows are of -1, 0 and 1, and not 0 alone.
    /// With `has_moving_bed` the bed moves in y. It also does where belts lift the tool and none of them moves it in y
    /// too.
    #[must_use]
    pub fn new(motors: &[Row], has_moving_bed: bool) -> Option<Self> {
        let mut rows = [[0; 3]; MOST_MOTORS];
        rows.get_mut(..motors.len())?.copy_from_slice(motors);
        if motors.iter().any(|row| *row == [0; 3] || row.iter().any(|entry| !(-1..=1).contains(entry))) {
            return None;
        }
        let lifts = motors.iter().any(|[_, _, z]| *z != 0);
        let carries_y = motors.iter().any(|[_, y, z]| *y != 0 && *z != 0);
        Some(Self { rows, count: motors.len(), has_moving_bed: has_moving_bed || lifts && !carries_y })
    }

    fn rows(&self) -> &[Row] {
        self.rows.get(..self.count).unwrap_or_default()
    }

    /// Whether a belt moves the tool in z.
    #[must_use]
    pub fn lifts(&self) -> bool {
        self.rows().iter().any(|[_, _, z]| *z != 0)
    }

    pub(super) fn belts(&self) -> Vec<Belt> {
        let alike = |row: &Row| self.rows().iter().filter(|other| *other == row || other.map(|e| -e) == *row).count();
        let mut belts = Vec::new();
        for ((index, row), spans) in (0_u8..).zip(self.rows()).zip(&SPANS) {
            let before = self.rows().iter().take(index.into()).any(|other| other == row || other.map(|e| -e) == *row);
            // Two belts along one axis run on both sides of what they move, one in its middle.
            let side = match (alike(row), before) {
                (0 | 1, _) => Mark::Middle,
                (_, false) => Mark::Low,
                (_, true) => Mark::High,
            };
            belts.push(belt(*row, Some(index + 1), IDLERS + 10 * index, side, spans));
        }
        belts
    }

    /// Patterns of the motors' travel that no place of the tool has: the rows that follow from others.
    pub(super) fn residuals(&self) -> Vec<Vec<f64>> {
        // Row reduction, with the unit matrix along: what becomes 0 names its combination.
        let unit = |i: usize| (0..self.count).map(|j| f64::from(u8::from(i == j))).collect::<Vec<_>>();
        let mut lines: Vec<([f64; 3], Vec<f64>)> =
            self.rows().iter().enumerate().map(|(i, row)| (row.map(f64::from), unit(i))).collect();
        let mut residuals = Vec::new();
        let mut pivots: Vec<(usize, [f64; 3], Vec<f64>)> = Vec::new();
        for (mut row, mut of) in lines.drain(..) {
            for (axis, pivot, its) in &pivots {
                let times = row[*axis] / pivot[*axis];
                row.iter_mut().zip(pivot).for_each(|(entry, other)| *entry -= times * other);
                of.iter_mut().zip(its).for_each(|(entry, other)| *entry -= times * other);
            }
            match row.iter().position(|entry| entry.abs() > 0.25) {
                Some(axis) => pivots.push((axis, row, of)),
                None => residuals.push(of),
            }
        }
        residuals
    }
}

/// The belts of a CoreXYZ with this many motors: A, B, C and maybe D.
pub(super) fn corexyz(motors: usize) -> Vec<Belt> {
    let idlers = COREXYZ.len().saturating_sub(motors);
    let belt = |(index, ((number, row), spans)): (u8, (&(u8, Row), &'static [&'static str; 2]))| {
        let motor = Some(*number).filter(|_| usize::from(index) >= idlers);
        belt(*row, motor, IDLERS + 10 * index, Mark::Middle, spans)
    };
    (0..).zip(COREXYZ.iter().zip(&XYZ_SPANS)).map(belt).collect()
}

/// The belt of a row, over an idler in the place of its motor if it has none. Idlers are numbered from behind `idlers`
/// on. `side` is where the belt runs along axes that it does not move.
fn belt(row: Row, motor: Option<u8>, idlers: u8, side: Mark, spans: &'static [&'static str; 2]) -> Belt {
    let axes: Vec<usize> = (0..3).filter(|axis| row.get(*axis).is_some_and(|entry| *entry != 0)).collect();
    let sign = |axis: usize| f64::from(row.get(axis).copied().unwrap_or(0));
    let end =
        |axis: usize, towards: f64| Along::at_mark(if sign(axis) * towards > 0.0 { Mark::High } else { Mark::Low });
    // A stop behind `bent` of the axes on one side.
    let stop = |bent: usize, towards: f64, role: Role| {
        let along = |axis: usize| match axes.iter().position(|a| *a == axis) {
            // It rides on the parts that carry what it moves.
            None if axes.first().is_some_and(|first| axis > *first) => Along::at_mark(Mark::Tool),
            None => Along::at_mark(side),
            Some(place) if place < bent => end(axis, towards),
            Some(0) if role == Role::Clamp => Along::new(Mark::Tool, 0.0, sign(axis) * towards),
            Some(_) => Along::at_mark(Mark::Tool),
        };
        Stop { number: CLAMP, x: along(0), y: along(1), z: along(2), role }
    };
    let idler = Role::Idler(Side::Inside);
    let mut stops = vec![stop(0, 1.0, Role::Clamp)];
    stops.extend((1..axes.len()).map(|bent| stop(bent, 1.0, idler)));
    let mut corner = stop(axes.len(), 1.0, idler);
    stops.push(Stop { role: if motor.is_some() { Role::Motor } else { idler }, ..corner });
    // Along the edges, the last axis first.
    for axis in axes.iter().rev() {
        let other = end(*axis, -1.0);
        match axis {
            0 => corner.x = other,
            1 => corner.y = other,
            _ => corner.z = other,
        }
        stops.push(corner);
    }
    stops.extend((1..axes.len()).rev().map(|bent| stop(bent, -1.0, idler)));
    stops.push(stop(0, -1.0, Role::Clamp));
    for (number, stop) in (idlers..).zip(&mut stops) {
        stop.number = match stop.role {
            Role::Clamp => CLAMP,
            Role::Motor => motor.unwrap_or(number),
            Role::Idler(_) => number,
        };
    }
    // Without a motor all of it is one span.
    let spans: &'static [&'static str] = if motor.is_none() { &spans[..1] } else { spans };
    Belt { stops: Cow::Owned(stops), spans, runs: Runs::Upright }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_are_what_no_tool_follows() {
        let of = |rows: &[Row]| Own::new(rows, false).unwrap().residuals();
        assert_eq!(of(&[[1, 0, 0], [0, 1, 0]]), Vec::<Vec<f64>>::new());
        // Two motors of one axis, the second mounted the other way.
        assert_eq!(of(&[[1, 0, 0], [0, 1, 0], [0, -1, 0]]), [[0.0, 1.0, 1.0]]);
        // A - B + C - D of a CoreXYZ, as Carlyle's table has them.
        assert_eq!(of(&[[1, 1, 1], [1, -1, 1], [-1, -1, 1], [-1, 1, 1]]), [[-1.0, 1.0, -1.0, 1.0]]);
    }

    #[test]
    fn a_bed_moves_where_no_belt_carries_y_up() {
        let of = |rows: &[Row], bed| Own::new(rows, bed).map(|own| own.has_moving_bed);
        assert_eq!(of(&[[1, 0, 1], [1, 0, -1], [0, 1, 0]], false), Some(true));
        assert_eq!(of(&[[1, 0, 0], [0, 1, 0]], false), Some(false));
        assert_eq!(of(&[[1, 0, 0], [0, 1, 0]], true), Some(true));
        assert_eq!(of(&[[1, 1, 1], [1, -1, 1], [-1, -1, 1]], false), Some(false));
        assert_eq!((of(&[[2, 0, 0]], false), of(&[[0, 0, 0]], false)), (None, None));
    }
}
