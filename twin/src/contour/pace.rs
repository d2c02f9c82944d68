//! Pace: matches two paths along the same line with different timing.
//!
//! A compensated file, or one with other accelerations, follows the same line with its own timing. Lines also lie next
//! to each other, so a place alone does not determine its intended time. So the two rows of places are matched as
//! wholes and in order, with the least sum of squared distances (dynamic time warping; Sakoe and Chiba, 1978). Only the
//! `REACH` places of the second row about the last match are searched. This follows any difference that grows more
//! slowly than the tool moves. Rests have no places, so they may be of any length.

use super::path::Vertex;

/// Ticks between two places of a row: 1 ms.
pub const EVERY: u64 = 10_000;

/// Places searched before and after the last match: a quarter of a second of motion.
const REACH: usize = 256;

/// Rows matched at once. The match is final for all but the last ones.
const ROWS: usize = 8192;

/// The last rows of a block, which later places may still change.
const OPEN: usize = 1024;

/// The last step of the best path: in both rows, or in one of them.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Both,
    Row,
    Column,
}

/// A row of places under construction, with at least [`EVERY`] between them.
#[derive(Clone, Debug, Default)]
pub struct Places {
    places: Vec<Vertex>,
    latest: Option<Vertex>,
}

impl Places {
    /// The tool is sent to a place.
    pub fn add(&mut self, at: [f64; 2], tick: u64) {
        let is_due = |before: &Vertex| before.tick + EVERY <= tick;
        // The place of a rest, and the begin of the next motion.
        if self.latest.is_some_and(|latest| is_due(&latest)) {
            let rest = self.latest.take_if(|latest| self.places.last().is_none_or(|last| last.tick < latest.tick));
            self.places.extend(rest);
        }
        let place = Vertex { at, tick };
        if self.places.last().is_none_or(is_due) {
            self.places.push(place);
        }
        self.latest = Some(place);
    }

    /// All of them.
    #[must_use]
    pub fn finish(mut self) -> Vec<Vertex> {
        let end = self.latest.filter(|latest| self.places.last().is_none_or(|last| last.tick < latest.tick));
        self.places.extend(end);
        self.places
    }
}

/// Matching ticks of both rows, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pace {
    pairs: Vec<(u64, u64)>,
    /// The pair of the last lookup.
    at: usize,
}

impl Pace {
    /// Intended times of a row's places, from another row.
    #[must_use]
    pub fn new(played: &[Vertex], meant: &[Vertex]) -> Self {
        let mut pairs = Vec::new();
        let mut begin = (0, 0);
        while begin.0 < played.len() && begin.1 < meant.len() {
            let rows = played.get(begin.0..).unwrap_or_default();
            let is_last = rows.len() <= ROWS;
            let matched = Block::new(rows.get(..ROWS).unwrap_or(rows), meant, begin.1).matched(is_last);
            let counts = if is_last { matched.len() } else { ROWS - OPEN };
            for (place, range) in rows.iter().zip(&matched).take(counts) {
                let tick = |index: usize| meant.get(index).map_or(0, |place| place.tick);
                pairs.push((place.tick, u64::midpoint(tick(range.0), tick(range.1))));
            }
            match matched.get(counts) {
                Some((column, _)) if !is_last => begin = (begin.0 + counts, *column),
                _ => break,
            }
        }
        Self { pairs, at: 0 }
    }

    /// Intended time of the tool's commanded place; times must not decrease.
    pub fn meant(&mut self, tick: u64) -> u64 {
        while self.pairs.get(self.at + 1).is_some_and(|(played, _)| *played <= tick) {
            self.at += 1;
        }
        let Some((from, meant)) = self.pairs.get(self.at).copied() else { return tick };
        let gone = tick.saturating_sub(from);
        match self.pairs.get(self.at + 1) {
            Some((to, until)) if *to > from => {
                let way = u128::from(gone) * u128::from(until.saturating_sub(meant)) / u128::from(to - from);
                meant + u64::try_from(way).unwrap_or(0)
            }
            _ => meant + gone,
        }
    }
}

/// Rows matched at once, and the paths to their best matches.
struct Block<'a> {
    meant: &'a [Vertex],
    /// First searched column of each row, and the predecessor on the best path to each.
    rows: Vec<(usize, Vec<Way>)>,
    /// Column of the last row with the least sum.
    best: usize,
}

impl<'a> Block<'a> {
    /// The first row matches the column `begin`.
    fn new(played: &[Vertex], meant: &'a [Vertex], begin: usize) -> Self {
        let mut rows: Vec<(usize, Vec<Way>)> = Vec::with_capacity(played.len());
        let mut best = begin;
        let (mut before, mut before_first): (Vec<f64>, usize) = (Vec::new(), begin);
        for place in played {
            let first = best.saturating_sub(REACH).max(begin).max(before_first);
            let columns = meant.get(first..).unwrap_or_default();
            let mut sums: Vec<f64> = Vec::with_capacity(2 * REACH);
            let mut ways = Vec::with_capacity(2 * REACH);
            for (index, column) in columns.iter().take(best + REACH - first).enumerate() {
                let off = [place.at[0] - column.at[0], place.at[1] - column.at[1]];
                let above = |index: usize| before.get(index).copied().unwrap_or(f64::INFINITY);
                let shifted = index + (first - before_first);
                let both = shifted.checked_sub(1).map_or(f64::INFINITY, above);
                let (row, left) = (above(shifted), sums.last().copied().unwrap_or(f64::INFINITY));
                let (least, way) = match () {
                    () if both <= row && both <= left => (both, Way::Both),
                    () if row <= left => (row, Way::Row),
                    () => (left, Way::Column),
                };
                let least = if rows.is_empty() && index == 0 { 0.0 } else { least };
                sums.push(least + off[0] * off[0] + off[1] * off[1]);
                ways.push(way);
            }
            let least = sums.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(index, _)| index);
            best = first + least;
            rows.push((first, ways));
            (before, before_first) = (sums, first);
        }
        Self { meant, rows, best }
    }

    /// First and last column that each row matches. The last row matches the last column if it is the end.
    fn matched(&self, is_end: bool) -> Vec<(usize, usize)> {
        let has = |column: usize| self.rows.last().is_some_and(|(first, ways)| column - first < ways.len());
        let end = self.meant.len().saturating_sub(1);
        let mut column = if is_end && has(end) { end } else { self.best };
        let mut matched = vec![(0, 0); self.rows.len()];
        for (row, of) in self.rows.iter().zip(&mut matched).rev() {
            let last = column;
            let way = |column: usize| column.checked_sub(row.0).and_then(|index| row.1.get(index).copied());
            while way(column) == Some(Way::Column) && column > row.0 {
                column -= 1;
            }
            *of = (column, last);
            if way(column) == Some(Way::Both) {
                column = column.saturating_sub(1);
            }
        }
        matched
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A zigzag with lines of 2 mm, 0.05 mm apart, at a changing speed, with a rest at each tenth line.
    fn zigzag(lines: usize, speed: impl Fn(f64) -> f64, rest: u64) -> Vec<Vertex> {
        let mut places = Places::default();
        let (mut tick, mut way) = (0.0_f64, 0.0_f64);
        while way < 2.0 * lines as f64 {
            let (line, part) = ((way / 2.0).floor(), way % 2.0);
            let x = if (line as u64).is_multiple_of(2) { part } else { 2.0 - part };
            places.add([x, 0.05 * line], tick as u64);
            let before = way;
            way += 0.0125;
            tick += 0.0125 / speed(way) * 1e7;
            if (way / 20.0).floor() > (before / 20.0).floor() {
                tick += rest as f64;
            }
        }
        places.finish()
    }

    /// Distance along the zigzag of the place at a tick.
    fn along(places: &[Vertex], tick: u64) -> f64 {
        let next = places.partition_point(|place| place.tick <= tick).clamp(1, places.len() - 1);
        let way = |place: &Vertex| {
            let line = (place.at[1] / 0.05).round();
            2.0 * line + if (line as u64).is_multiple_of(2) { place.at[0] } else { 2.0 - place.at[0] }
        };
        let (a, b) = (&places[next - 1], &places[next]);
        let part = (tick.saturating_sub(a.tick) as f64 / (b.tick - a.tick) as f64).min(1.0);
        way(a) + part * (way(b) - way(a))
    }

    #[test]
    fn a_row_matches_itself_tick_by_tick() {
        let row = zigzag(400, |_| 100.0, 3_000_000);
        assert!(row.len() > 7000, "{}", row.len());
        let mut pace = Pace::new(&row, &row);
        for tick in (0..row.last().unwrap().tick).step_by(777) {
            assert_eq!(pace.meant(tick), tick);
        }
    }

    /// Half as fast, twice as fast, faster here and slower there, with other rests, for longer than a block. Each place
    /// is found within a millimetre, which excludes the neighbouring lines.
    #[test]
    fn a_row_in_another_time_is_matched_although_lines_lie_close() {
        let meant = zigzag(900, |_| 100.0, 3_000_000);
        let own: [fn(f64) -> f64; 3] = [|_| 50.0, |_| 200.0, |way| 100.0 + 60.0 * (way / 30.0).sin()];
        for (index, speed) in own.into_iter().enumerate() {
            let played = zigzag(900, speed, 1_000_000);
            let mut pace = Pace::new(&played, &meant);
            let mut worst = 0.0_f64;
            for place in &played {
                let off = along(&meant, pace.meant(place.tick)) - along(&played, place.tick);
                worst = worst.max(off.abs());
            }
            assert!(worst < 0.6, "{index}: {worst}");
        }
    }
}
