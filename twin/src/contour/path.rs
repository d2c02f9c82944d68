//! Path: the commanded line of the tool from its steps, cut where it is furthest from its chord until it is within the
//! tolerance (Douglas and Peucker, 1973).

use super::cut::ends;
use crate::math::hypot;

/// A corner of the line, or its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// In mm.
    pub at: [f64; 2],
    /// When the tool was sent there, in ticks.
    pub tick: u64,
}

/// Places handled together. Of a longer line half of the places are kept.
const BLOCK: usize = 1024;

/// A line under construction.
#[derive(Clone, Debug)]
pub struct PathBuilder {
    tolerance_mm: f64,
    vertices: Vec<Vertex>,
    /// Since the last vertex, which is the first.
    places: Vec<Vertex>,
}

impl PathBuilder {
    /// A line from a place on, within this distance of every place (of every kept place, for long lines).
    #[must_use]
    pub fn new(at: [f64; 2], tolerance_mm: f64) -> Self {
        let begin = Vertex { at, tick: 0 };
        Self { tolerance_mm, vertices: vec![begin], places: vec![begin] }
    }

    /// The tool is sent to a place.
    pub fn add(&mut self, at: [f64; 2], tick: u64) {
        self.places.push(Vertex { at, tick });
        if self.places.len() >= BLOCK {
            self.cut(false);
        }
    }

    /// The whole line.
    #[must_use]
    pub fn finish(mut self) -> Vec<Vertex> {
        self.cut(true);
        self.vertices
    }

    /// Makes vertices where the line bends. The last line may still grow, so only the end of the whole line ends it. An
    /// end in its middle would be no bend, and next to a corner it would hide the corner.
    fn cut(&mut self, is_end: bool) {
        let last = self.places.len() - 1;
        let mut begin = 0;
        for end in ends(last, |begin, end| self.furthest(begin, end)) {
            if end == last && !is_end {
                break;
            }
            self.vertices.extend(self.places.get(end));
            begin = end;
        }
        self.places.drain(..begin);
        if self.places.len() > BLOCK / 2 {
            self.thin();
        }
    }

    /// Keeps half of the places between the ends of a line: of two neighbours the one further from it, because this one
    /// decides where the line is cut.
    fn thin(&mut self) {
        let [begin, between @ .., end] = self.places.as_slice() else { return };
        let off = |place: &Vertex| nearest(begin.at, end.at, place.at).1;
        let further = |two: &[Vertex]| two.iter().copied().max_by(|a, b| off(a).total_cmp(&off(b)));
        let kept = between.chunks(2).filter_map(further);
        self.places = std::iter::once(*begin).chain(kept).chain([*end]).collect();
    }

    /// The place between two others that is furthest from the line between them, if it is too far.
    fn furthest(&self, begin: usize, end: usize) -> Option<usize> {
        let (a, b) = (self.places.get(begin)?, self.places.get(end)?);
        let mut found = (self.tolerance_mm, None);
        for (index, place) in self.places.iter().enumerate().take(end).skip(begin + 1) {
            let (_, distance) = nearest(a.at, b.at, place.at);
            if distance > found.0 {
                found = (distance, Some(index));
            }
        }
        found.1
    }
}

/// Nearest point on a line (0 at its begin, 1 at its end), and its distance.
#[must_use]
pub fn nearest(a: [f64; 2], b: [f64; 2], point: [f64; 2]) -> (f64, f64) {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let way = if square > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (way, hypot(to[0] - way * along[0], to[1] - way * along[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_of_steps_has_four_corners_exactly() {
        let mut path = PathBuilder::new([0.0, 0.0], 0.0125);
        let mut tick = 0;
        let mut go = |from: [f64; 2], to: [f64; 2]| {
            for step in 1..=2400 {
                tick += 100;
                let part = f64::from(step) / 2400.0;
                path.add([0, 1].map(|i| from[i] + part * (to[i] - from[i])), tick);
            }
        };
        let corners = [[0.0, 0.0], [30.0, 0.0], [30.0, 30.0], [0.0, 30.0], [0.0, 0.0]];
        for pair in corners.windows(2) {
            go(pair[0], pair[1]);
        }
        let at: Vec<[f64; 2]> = path.finish().into_iter().map(|vertex| vertex.at).collect();
        for corner in corners {
            assert!(at.contains(&corner), "{corner:?} is not among {at:?}");
        }
    }
}
