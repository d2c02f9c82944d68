//! Tool path: where the tool went, when and how fast, in bounded memory.
//!
//! Points that lie on the line between their neighbours, at about the same speed, are left out. When there
//! are too many points all the same, the tolerance is doubled and the path thinned once more.

/// Most points that are kept.
const MOST_POINTS: usize = 40_000;

/// Points looked back upon when one is to be left out; bounds the work a point.
const MOST_PENDING: usize = 40;

/// A place on the path.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Point {
    /// Position in mm.
    pub at: [f32; 3],
    /// Speed in mm/s.
    pub speed: f32,
    /// When, in ticks of motion time.
    pub tick: u64,
    /// Whether filament went forward on the way here.
    pub is_printing: bool,
}

/// A path that grows by points and forgets those that do not matter.
#[derive(Clone, PartialEq, Debug)]
pub struct ToolPath {
    kept: Vec<Point>,
    pending: Vec<Point>,
    tolerance: f32,
}

impl Default for ToolPath {
    fn default() -> Self {
        Self { kept: Vec::new(), pending: Vec::new(), tolerance: 0.02 }
    }
}

impl ToolPath {
    /// The points that matter.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.kept
    }

    /// The next point.
    pub fn add(&mut self, point: Point) {
        let Some(&anchor) = self.kept.last() else {
            self.kept.push(point);
            return;
        };
        if let [.., before, last] = self.pending.as_mut_slice()
            && stands(before, last)
            && stands(last, &point)
        {
            // Only the time grows.
            last.tick = point.tick;
            return;
        }
        if !self.pending.is_empty() && !self.is_redundant(anchor, point) {
            self.keep_pending();
        }
        self.pending.push(point);
        if self.kept.len() > MOST_POINTS {
            self.thin();
        }
    }

    /// Ends the path: its last point matters.
    pub fn finish(&mut self) {
        self.keep_pending();
    }

    /// Whether the pending points may go if `end` follows `anchor`.
    fn is_redundant(&self, anchor: Point, end: Point) -> bool {
        let speed_tolerance = (0.05 * end.speed.max(anchor.speed)).max(100.0 * self.tolerance);
        self.pending.len() < MOST_PENDING
            && self.pending.iter().all(|p| {
                p.is_printing == end.is_printing
                    && (p.speed - end.speed).abs() <= speed_tolerance
                    && distance(anchor.at, end.at, p.at) <= self.tolerance
            })
    }

    fn keep_pending(&mut self) {
        if let Some(last) = self.pending.last() {
            self.kept.push(*last);
        }
        self.pending.clear();
    }

    /// Doubles the tolerance and leaves out what has become redundant, and more if that is too little:
    /// halving the path each time keeps the work a point constant.
    fn thin(&mut self) {
        let mut thinner = Self { tolerance: 2.0 * self.tolerance, ..Self::default() };
        for point in self.kept.drain(..) {
            thinner.add(point);
        }
        thinner.keep_pending();
        if thinner.kept.len() > MOST_POINTS / 2 {
            let mut index = 0;
            thinner.kept.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
        thinner.pending.append(&mut self.pending);
        *self = thinner;
    }
}

/// Whether the tool did not move from one point to the next.
fn stands(a: &Point, b: &Point) -> bool {
    a.at == b.at && a.speed == b.speed && a.is_printing == b.is_printing
}

/// How far `p` is from the segment from `a` to `b`.
fn distance(a: [f32; 3], b: [f32; 3], p: [f32; 3]) -> f32 {
    let along = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    let to = [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let dot = |u: [f32; 3], v: [f32; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let t = (dot(along, to) / dot(along, along).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    let off = [to[0] - t * along[0], to[1] - t * along[1], to[2] - t * along[2]];
    dot(off, off).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_is_two_points_and_a_corner_a_third() {
        let mut path = ToolPath::default();
        for i in 0..=60u64 {
            let along = i as f32;
            let at = if i <= 30 { [along, 0.0, 0.0] } else { [30.0, along - 30.0, 0.0] };
            path.add(Point { at, speed: 100.0, tick: i, is_printing: true });
        }
        path.finish();
        let places: Vec<_> = path.points().iter().map(|p| p.at).collect();
        assert_eq!(places, [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [30.0, 30.0, 0.0]]);
    }

    #[test]
    fn a_long_print_stays_bounded() {
        let mut path = ToolPath::default();
        for i in 0..400_000u64 {
            let angle = i as f32 * 0.3;
            path.add(Point {
                at: [50.0 * angle.cos(), 50.0 * angle.sin(), 0.0],
                speed: 50.0,
                tick: i,
                is_printing: true,
            });
        }
        assert!(path.points().len() <= MOST_POINTS + 1);
    }

    /// Nothing here is ever redundant: the thinning must not fall back to touching every point every time.
    #[test]
    fn a_path_without_any_straight_stays_bounded() {
        let mut path = ToolPath::default();
        for i in 0..400_000u64 {
            let at = [(i % 2) as f32 * 300.0, (i % 3) as f32 * 100.0, 0.0];
            path.add(Point { at, speed: (i % 5) as f32 * 60.0, tick: i, is_printing: i % 2 == 0 });
        }
        assert!(path.points().len() <= MOST_POINTS + 1);
    }

    #[test]
    fn a_pause_is_two_points_however_long() {
        let mut path = ToolPath::default();
        for i in 0..10_000u64 {
            path.add(Point {
                at: [(i.min(20)) as f32, 0.0, 0.0],
                speed: if i < 20 { 50.0 } else { 0.0 },
                tick: i,
                is_printing: false,
            });
        }
        path.finish();
        let ticks: Vec<_> = path.points().iter().map(|p| p.tick).collect();
        assert_eq!((ticks.len(), ticks[ticks.len() - 1]), (3, 9999), "{ticks:?}");
    }
}
