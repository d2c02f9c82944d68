//! The contour error at a corner, equation 17 of the paper: distance from the corner to where the tool crosses its
//! bisector.

use super::path::Corner;

/// Watches the tool at a corner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    corner: Corner,
    /// The tool's distance beyond the bisector, and along the side out of the corner, m.
    last: Option<(f64, f64)>,
    /// m; positive inside the corner (cut short), negative outside (overshoot).
    pub error: Option<f64>,
    /// How far the tool went on along the side into the corner, m; 0 if it never reached its end.
    pub beyond: f64,
}

impl Watch {
    pub fn new(corner: Corner) -> Watch {
        Watch { corner, last: None, error: None, beyond: 0.0 }
    }

    /// Takes the tool's next place. The first crossing counts; between two places the path is a chord.
    pub fn see(&mut self, [x, y]: [f64; 2]) {
        let Corner { place, into, out_of } = self.corner;
        let along = |direction: [f64; 2]| (x - place[0]) * direction[0] + (y - place[1]) * direction[1];
        let now = (along(into) + along(out_of), along(out_of));
        if let (None, Some(before)) = (self.error, self.last)
            && before.0 < 0.0
            && now.0 >= 0.0
        {
            let part = before.0 / (before.0 - now.0);
            self.error = Some((before.1 + part * (now.1 - before.1)) * std::f64::consts::SQRT_2);
        }
        self.beyond = self.beyond.max(along(into));
        self.last = Some(now);
    }
}
