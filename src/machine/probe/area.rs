//! The part of the bed that a mesh covers, and how many points it gets: all of it, or what a print needs.

use crate::settings::Range;
use crate::surface::MOST_POINTS;
use crate::units::Mm;

/// Least points a side, and least on the shorter side if the longer one has more than [`MANY`]: a spline needs its
/// neighbours. The numbers are Klipper's (bed_mesh.py, `set_adaptive_mesh`).
pub(in crate::machine) const LEAST_POINTS: usize = 3;
const LEAST_BESIDE_MANY: usize = 4;
const MANY: usize = 6;

/// A grid of points.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Area {
    /// From the first to the last column.
    pub x: Range<Mm>,
    /// From the first to the last row.
    pub y: Range<Mm>,
    /// Columns and rows.
    pub points: [usize; 2],
}

impl Area {
    /// The part of it that objects need, with a margin around them. A side gets points in proportion to its length.
    pub fn around(&self, objects: [Range<Mm>; 2], margin: Mm) -> Self {
        let side = |whole: Range<Mm>, object: Range<Mm>| {
            let (least, most) = (object.least.saturating_sub(margin), object.most.saturating_add(margin));
            Range { least: whole.clamp(least), most: whole.clamp(most) }
        };
        let [object_x, object_y] = objects;
        let (x, y) = (side(self.x, object_x), side(self.y, object_y));
        let [columns, rows] = self.points;
        let (columns, rows) = (share(columns, x, self.x), share(rows, y, self.y));
        let points = match (columns > MANY, rows > MANY) {
            (true, false) => [columns, rows.max(LEAST_BESIDE_MANY)],
            (false, true) => [columns.max(LEAST_BESIDE_MANY), rows],
            _ => [columns, rows],
        };
        Self { x, y, points: points.map(|points| points.min(MOST_POINTS)) }
    }

    /// The place of a point.
    pub fn at(&self, column: usize, row: usize) -> [Mm; 2] {
        let [columns, rows] = self.points;
        [of(self.x, column, columns), of(self.y, row, rows)]
    }
}

/// Points of a part of a side that has `points` in all.
fn share(points: usize, part: Range<Mm>, whole: Range<Mm>) -> usize {
    let [part, whole] = [part, whole].map(|side| side.most.saturating_sub(side.least).to_bits().max(0));
    // A length of 5 m has 45 bits.
    let share = (points as i64 * part + whole - 1) / whole.max(1);
    usize::try_from(share).unwrap_or_default().clamp(LEAST_POINTS, MOST_POINTS)
}

/// The place of a point on a side.
fn of(side: Range<Mm>, number: usize, points: usize) -> Mm {
    if number + 1 >= points {
        return side.most;
    }
    let way = side.most.saturating_sub(side.least);
    let cells = points.saturating_sub(1).max(1) as i64;
    side.least.saturating_add(Mm::from_bits(way.to_bits() / cells * (number as i64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn side(least: i64, most: i64) -> Range<Mm> {
        Range { least: Mm::const_from_int(least), most: Mm::const_from_int(most) }
    }

    fn whole(points: usize) -> Area {
        Area { x: side(10, 420), y: side(10, 390), points: [points; 2] }
    }

    const MARGIN: Mm = Mm::const_from_int(5);

    #[test]
    fn p14_an_adaptive_mesh_has_points_for_its_share_of_the_bed() {
        let part = whole(7).around([side(150, 230), side(180, 215)], MARGIN);
        assert_eq!(part, Area { x: side(145, 235), y: side(175, 220), points: [3, 3] });
        let long = whole(9).around([side(20, 410), side(180, 200)], MARGIN);
        assert_eq!(long, Area { x: side(15, 415), y: side(175, 205), points: [9, 4] });
        let deep = whole(9).around([side(180, 200), side(20, 380)], MARGIN);
        assert_eq!(deep.points, [4, 9]);
        assert_eq!(whole(5).around([side(0, 500), side(0, 500)], MARGIN), whole(5));
    }

    #[test]
    fn objects_outside_of_the_mesh_are_taken_to_its_border() {
        let outside = whole(7).around([side(400, 500), side(-50, 0)], MARGIN);
        assert_eq!((outside.x, outside.y), (side(395, 420), side(10, 10)));
    }

    #[test]
    fn the_points_reach_from_border_to_border() {
        let area = whole(4);
        assert_eq!(area.at(0, 0), [10, 10].map(Mm::const_from_int));
        assert_eq!(area.at(3, 3), [420, 390].map(Mm::const_from_int));
        let [x, _] = area.at(1, 0);
        assert!(x.saturating_sub(Mm::lit("146.666666")).saturating_abs() < Mm::lit("0.00001"));
    }
}
