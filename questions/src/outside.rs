//! Outside: types for the lines of a file that names none, by where they lie in their layer.
//!
//! A layer is drawn in cells of 0.1 mm, each line 0.5 mm wide, so that a seam closes. Cells without a line belong to
//! areas. The area around the part is open. So is one in which a square of 10 mm fits, which is a hole. Others are gaps
//! of an infill. A line is outside if at least half of it is within 0.4 mm of an open area. So the wall of a narrow
//! hole counts as inside, and so does a part within its skirt that is less than 10 mm away from it.

use corehbot_sim::slicer::UNNAMED;
use corehbot_twin::steps::{LineType, Planned};
use std::ops::Range;

/// Cells in a mm.
const CELLS: f64 = 10.0;

/// Cells on either side of a line's middle that belong to it: 0.2 mm.
const HALF_LINE: i64 = 2;

/// So far an open area may be from a line's middle, in cells. The first is 3 cells away; from the next line inwards,
/// which is 0.25 mm further at least, it is 5.
const REACH: f64 = 4.0;

/// From the middle of an open area to the next line, in cells: 5 mm.
const OPEN: u8 = 50;

/// Cells around a layer.
const MARGIN: i64 = 8;

/// A layer of more cells stays without types: 0.4 m square.
const MOST: usize = 4000 * 4000;

/// Two heights of one layer differ by less, in mm.
const SAME: f64 = 0.005;

/// A line of a layer: its move, and both its ends in mm.
type Line = (usize, [[f64; 2]; 2]);

/// Gives the printed lines types by their places, if the file names none; `rises` are the ways of the moves along z.
pub fn name_by_place(plan: &mut [Planned], rises: &[f64], types: &mut Vec<LineType>) {
    let is_plain = |planned: &Planned| planned.line_type == UNNAMED;
    let has_names = plan.iter().any(|planned| {
        !is_plain(planned) && types.get(usize::from(planned.line_type)).is_some_and(|named| named.is_printed)
    });
    if has_names || !plan.iter().any(is_plain) {
        return;
    }
    let outside = types.len() as u16;
    let named = |name: &str| LineType { name: name.to_owned(), is_printed: true };
    types.extend(["Outside", "Inside"].map(named));
    for layer in layers(plan, rises) {
        let lines = &layer;
        let Some(grid) = Grid::of(lines) else { continue };
        for (index, ends) in lines {
            if let Some(planned) = plan.get_mut(*index) {
                planned.line_type = if grid.is_outside(*ends) { outside } else { outside + 1 };
            }
        }
    }
}

/// The printed lines, layer by layer.
fn layers(plan: &[Planned], rises: &[f64]) -> Vec<Vec<Line>> {
    let mut layers: Vec<Vec<Line>> = Vec::new();
    let (mut at, mut z, mut drawn) = ([0.0; 2], 0.0_f64, f64::NEG_INFINITY);
    for (index, (planned, rise)) in plan.iter().zip(rises).enumerate() {
        let [x, y] = planned.way_mm;
        let to = [at[0] + x, at[1] + y];
        z += rise;
        if planned.line_type == UNNAMED && planned.way_mm != [0.0; 2] {
            if (z - drawn).abs() >= SAME {
                layers.push(Vec::new());
                drawn = z;
            }
            if let Some(layer) = layers.last_mut() {
                layer.push((index, [at, to]));
            }
        }
        at = to;
    }
    layers
}

/// What a cell is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Cell {
    /// Not looked at.
    Empty,
    /// Part of a line.
    Line,
    /// In an area that is too small.
    Gap,
    /// In an open area.
    Open,
}

/// The cells of a layer.
struct Grid {
    from: [i64; 2],
    size: [i64; 2],
    cells: Vec<Cell>,
}

impl Grid {
    /// Draws a layer; `None` if it is too large or has no lines.
    fn of(lines: &[Line]) -> Option<Self> {
        let ends = || lines.iter().flat_map(|(_, ends)| ends.iter().map(|end| end.map(cell)));
        let range = |axis: usize| -> Option<Range<i64>> {
            let along = || ends().filter_map(move |end| end.get(axis).copied());
            Some(along().min()? - MARGIN..along().max()? + MARGIN + 1)
        };
        let [x, y] = [range(0)?, range(1)?];
        let size = [x.end - x.start, y.end - y.start];
        let count = usize::try_from(size[0] * size[1]).ok().filter(|count| *count <= MOST)?;
        let mut grid = Self { from: [x.start, y.start], size, cells: vec![Cell::Empty; count] };
        for (_, ends) in lines {
            along(*ends, |at| {
                for (dx, dy) in square(HALF_LINE) {
                    grid.set([cell(at[0]) + dx, cell(at[1]) + dy], Cell::Line);
                }
            });
        }
        grid.find_areas();
        Some(grid)
    }

    /// Divides the empty cells into areas, and says of each whether it is open.
    fn find_areas(&mut self) {
        let distances = self.distances();
        for begin in 0..self.cells.len() {
            if self.cells.get(begin) != Some(&Cell::Empty) {
                continue;
            }
            let (mut area, mut next) = (vec![begin], 0);
            self.mark(&[begin], Cell::Gap);
            while let Some(place) = area.get(next).copied() {
                next += 1;
                let width = self.size[0];
                let (x, y) = (place as i64 % width, place as i64 / width);
                for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                    let beside = [self.from[0] + x + dx, self.from[1] + y + dy];
                    if self.get(beside) == Some(Cell::Empty) {
                        self.set(beside, Cell::Gap);
                        area.extend(self.place(beside));
                    }
                }
            }
            // The one around the part begins in the corner.
            let is_wide = || area.iter().any(|place| distances.get(*place).is_some_and(|cells| *cells >= OPEN));
            if begin == 0 || is_wide() {
                self.mark(&area, Cell::Open);
            }
        }
    }

    /// How many cells each one is from the next line, along an axis or a diagonal; at most [`OPEN`].
    fn distances(&self) -> Vec<u8> {
        let width = self.size[0] as usize;
        let mut far: Vec<_> = self.cells.iter().map(|cell| if *cell == Cell::Line { 0 } else { OPEN }).collect();
        // Once down and once up; each cell is one further than the nearest of its earlier neighbours.
        let nearer = |far: &[u8], place: usize, neighbours: [Option<usize>; 4]| {
            let steps = neighbours.into_iter().flatten().filter_map(|beside| far.get(beside));
            steps.map(|cells| cells + 1).chain(far.get(place).copied()).min()
        };
        for place in 0..far.len() {
            let above = place.checked_sub(width);
            let before = [place.checked_sub(1), above.and_then(|up| up.checked_sub(1)), above, above.map(|up| up + 1)];
            if let (Some(least), Some(cells)) = (nearer(&far, place, before), far.get_mut(place)) {
                *cells = least;
            }
        }
        for place in (0..far.len()).rev() {
            let below = place + width;
            let after = [place + 1, below - 1, below, below + 1].map(Some);
            if let (Some(least), Some(cells)) = (nearer(&far, place, after), far.get_mut(place)) {
                *cells = least;
            }
        }
        far
    }

    fn mark(&mut self, area: &[usize], what: Cell) {
        for place in area {
            if let Some(cell) = self.cells.get_mut(*place) {
                *cell = what;
            }
        }
    }

    /// Whether at least half of a line is at an open area.
    fn is_outside(&self, ends: [[f64; 2]; 2]) -> bool {
        let reach = REACH.ceil() as i64;
        let near = || square(reach).filter(|(dx, dy)| ((dx * dx + dy * dy) as f64) <= REACH * REACH);
        let (mut all, mut open) = (0_u32, 0_u32);
        along(ends, |at| {
            all += 1;
            let is_near = near().any(|(dx, dy)| self.get([cell(at[0]) + dx, cell(at[1]) + dy]) == Some(Cell::Open));
            open += u32::from(is_near);
        });
        2 * open >= all
    }

    fn place(&self, [x, y]: [i64; 2]) -> Option<usize> {
        let (x, y) = (x - self.from[0], y - self.from[1]);
        let is_in = (0..self.size[0]).contains(&x) && (0..self.size[1]).contains(&y);
        is_in.then_some((y * self.size[0] + x) as usize)
    }

    fn get(&self, at: [i64; 2]) -> Option<Cell> {
        self.cells.get(self.place(at)?).copied()
    }

    fn set(&mut self, at: [i64; 2], what: Cell) {
        if let Some(cell) = self.place(at).and_then(|place| self.cells.get_mut(place)) {
            *cell = what;
        }
    }
}

fn cell(mm: f64) -> i64 {
    (mm * CELLS).round() as i64
}

/// Offsets of a square of cells.
fn square(half: i64) -> impl Iterator<Item = (i64, i64)> {
    (-half..=half).flat_map(move |dy| (-half..=half).map(move |dx| (dx, dy)))
}

/// Visits a line in steps of a cell.
fn along([from, to]: [[f64; 2]; 2], mut visit: impl FnMut([f64; 2])) {
    let way = [to[0] - from[0], to[1] - from[1]];
    let steps = ((way[0].abs().max(way[1].abs()) * CELLS).ceil() as u32).max(1);
    for step in 0..=steps {
        let part = f64::from(step) / f64::from(steps);
        visit([from[0] + way[0] * part, from[1] + way[1] * part]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot_twin::steps::Begins;

    /// A file under construction: moves with their rise.
    #[derive(Default)]
    struct Moves {
        plan: Vec<Planned>,
        rises: Vec<f64>,
        at: [f64; 2],
    }

    impl Moves {
        fn to(&mut self, at: [f64; 2], rise: f64, line_type: u16) -> usize {
            let way_mm = [at[0] - self.at[0], at[1] - self.at[1]];
            self.at = at;
            self.rises.push(rise);
            self.plan.push(Planned { ticks: [0; 2], way_mm, begins: Begins::AtTheEnd, is_touch: false, line_type });
            self.plan.len() - 1
        }

        /// Prints a square about (50, 50), and leaves a seam of 0.2 mm.
        fn square(&mut self, half: f64) -> Vec<usize> {
            let corners = [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
            self.to([50.0 + half, 50.0 + half], 0.0, 0);
            let mut lines: Vec<_> =
                corners[..3].iter().map(|[x, y]| self.to([50.0 + half * x, 50.0 + half * y], 0.0, UNNAMED)).collect();
            lines.push(self.to([50.0 + half, 50.0 + half - 0.2], 0.0, UNNAMED));
            lines
        }
    }

    fn types() -> Vec<LineType> {
        let of = |(name, is_printed): (&str, bool)| LineType { name: name.to_owned(), is_printed };
        [("Travel", false), ("Retract", false), ("Without a name", true), ("Wall", true)].map(of).to_vec()
    }

    /// Walls of 20 mm with an infill of 4 mm, and a hole of 12 mm, layer upon layer.
    #[test]
    fn walls_and_the_walls_of_wide_holes_are_outside_and_all_between_is_inside() {
        let (mut moves, mut outside, mut inside) = (Moves::default(), Vec::new(), Vec::new());
        for _ in 0..2 {
            moves.to([40.0, 40.0], 0.2, 0);
            outside.extend(moves.square(15.0));
            inside.extend(moves.square(14.55));
            inside.extend(moves.square(6.45));
            outside.extend(moves.square(6.0));
            for n in 0..8 {
                let x = 36.0 + 4.0 * f64::from(n);
                let parts =
                    if (43.0..57.0).contains(&x) { vec![[35.8, 43.2], [56.8, 64.2]] } else { vec![[35.8, 64.2]] };
                for [from, to] in parts {
                    moves.to([x, from], 0.0, 0);
                    inside.push(moves.to([x, to], 0.0, UNNAMED));
                }
            }
        }
        let (mut plan, mut types) = (moves.plan, types());
        name_by_place(&mut plan, &moves.rises, &mut types);
        assert_eq!([4, 5].map(|place| types[place].name.as_str()), ["Outside", "Inside"]);
        assert!(outside.iter().all(|line| plan[*line].line_type == 4), "{plan:?}");
        assert!(inside.iter().all(|line| plan[*line].line_type == 5), "{plan:?}");
        assert!(plan.iter().all(|planned| planned.line_type != UNNAMED));
    }

    #[test]
    fn names_of_the_slicer_count() {
        let mut moves = Moves::default();
        moves.square(5.0);
        moves.to([0.0; 2], 0.0, 3);
        let (mut plan, mut types) = (moves.plan.clone(), types());
        name_by_place(&mut plan, &moves.rises, &mut types);
        assert_eq!((plan, types.len()), (moves.plan, 4));
    }
}
