//! Parts: reference parts, and how far their dimensions would be off.
//!
//! A part is a row of closed loops of the nozzle about the middle of the part. The firmware plans the G-code of a part
//! as any other. Between loops the machine stands still for a moment, as at a retraction. So each stretch of steps is a
//! way to a loop or a loop, in turns. The tool's path of each loop is compared with the loop itself.
//!
//! Dimensions are those of the nozzle's path. Filament adds the same width at each speed, and its own errors, which
//! are not here. Neither is the yaw of the bar.
//!
//! | file | content |
//! |---|---|
//! | this one | the parts, and their G-code |
//! | [`profile`] | deviations along a side or around a circle |
//! | [`figures`] | dimensional errors |

pub mod figures;
pub mod profile;

use corehbot_twin::math::hypot;
use corehbot_twin::steps::StepTrace;
use std::fmt::Write as _;

/// A reference part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A square of 40 mm, counter-clockwise from its front left corner.
    Square,
    /// A disc of 40 mm, counter-clockwise from its front left, between the directions that are measured.
    Circle,
    /// Nine holes of 6 mm, 15 mm apart, each clockwise from its front left.
    Holes,
    /// Two walls of 40 mm, each a loop of two lines 0.4 mm apart: one along x, one along y.
    Walls,
}

/// The outline of a loop, in mm from the middle of the part.
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// Corners, counter-clockwise; the part is inside.
    Polygon(Vec<[f64; 2]>),
    /// A circle.
    Circle {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// The part is outside.
        is_hole: bool,
    },
}

/// Half the side of the square, and the radius of the disc.
const HALF_MM: f64 = 20.0;

/// Radius of a hole, and distance of two centres.
const HOLE_MM: f64 = 3.0;
const PITCH_MM: f64 = 15.0;

/// Half the distance of the two lines of a wall.
const WALL_MM: f64 = 0.2;

/// Distance of a wall from the middle of the part.
const ASIDE_MM: f64 = 10.0;

/// The least reach, in x and y, that the parts need about their middle.
pub const ROOM_MM: f64 = 2.0 * HALF_MM + 2.0;

/// Filament of 1.75 mm for a mm of a bead of 0.4 by 0.2 mm.
const FILAMENT: f64 = 0.033_26;

/// The pause before and after a loop, in ms.
const PAUSE_MS: u32 = 60;

/// A shorter time without steps is part of a stretch, in ticks.
const LEAST_PAUSE: u64 = 300_000;

impl Part {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Square, Self::Circle, Self::Holes, Self::Walls];

    /// Its loops in order.
    #[must_use]
    pub fn loops(self) -> Vec<Outline> {
        let (h, a, w) = (HALF_MM, ASIDE_MM, WALL_MM);
        match self {
            Self::Square => vec![Outline::Polygon(vec![[-h, -h], [h, -h], [h, h], [-h, h]])],
            Self::Circle => vec![Outline::Circle { centre: [0.0; 2], radius: h, is_hole: false }],
            Self::Holes => {
                let at = |i: i32| f64::from(i) * PITCH_MM;
                let hole = |(i, j)| Outline::Circle { centre: [at(i), at(j)], radius: HOLE_MM, is_hole: true };
                (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))).map(hole).collect()
            }
            Self::Walls => vec![
                Outline::Polygon(vec![[-h, -a - w], [h, -a - w], [h, w - a], [-h, w - a]]),
                Outline::Polygon(vec![[a + w, -h], [a + w, h], [a - w, h], [a - w, -h]]),
            ],
        }
    }

    /// G-code that prints it about a place at a speed, in mm/s.
    #[must_use]
    pub fn gcode(self, middle: [f64; 2], speed: f64) -> String {
        let feed = 60.0 * speed;
        let mut text = "G21\nG90\nM83\nM302 P1\n".to_owned();
        for outline in self.loops() {
            let at = |place: [f64; 2]| format!("X{:.4} Y{:.4}", middle[0] + place[0], middle[1] + place[1]);
            let _ = writeln!(text, "G0 {} F{feed:.0}\nG4 P{PAUSE_MS}", at(outline.begin()));
            match &outline {
                Outline::Polygon(corners) => {
                    let next = corners.iter().cycle().skip(1);
                    for (a, b) in corners.iter().zip(next) {
                        let filament = FILAMENT * hypot(b[0] - a[0], b[1] - a[1]);
                        let _ = writeln!(text, "G1 {} E{filament:.5} F{feed:.0}", at(*b));
                    }
                }
                Outline::Circle { radius, centre, is_hole } => {
                    let begin = outline.begin();
                    let [i, j] = [centre[0] - begin[0], centre[1] - begin[1]];
                    let filament = FILAMENT * std::f64::consts::TAU * radius;
                    let word = if *is_hole { "G2" } else { "G3" };
                    let _ = writeln!(text, "{word} {} I{i:.4} J{j:.4} E{filament:.5} F{feed:.0}", at(begin));
                }
            }
            let _ = writeln!(text, "G4 P{PAUSE_MS}");
        }
        text + "M400\n"
    }
}

impl Outline {
    /// Where the nozzle begins and ends.
    #[must_use]
    pub fn begin(&self) -> [f64; 2] {
        match self {
            Self::Polygon(corners) => corners.first().copied().unwrap_or_default(),
            Self::Circle { centre: [x, y], radius, .. } => {
                let aside = radius * std::f64::consts::FRAC_1_SQRT_2;
                [x - aside, y - aside]
            }
        }
    }
}

/// First and last tick of each stretch of steps between two pauses.
#[must_use]
pub fn stretches(trace: &StepTrace) -> Vec<[u64; 2]> {
    let mut found: Vec<[u64; 2]> = Vec::new();
    let mut tick = 0;
    for event in &trace.events {
        tick += u64::from(event.gap);
        if event.steps == 0 {
            continue;
        }
        match found.last_mut() {
            Some([_, end]) if tick - *end < LEAST_PAUSE => *end = tick,
            _ => found.push([tick; 2]),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_are_what_pauses_divide() {
        let mut trace = StepTrace::new(Vec::new(), 0.0125);
        for tick in [0, 100, 200, 400_000, 400_100, 900_000] {
            trace.add(tick, 1, 1);
        }
        assert_eq!(stretches(&trace), [[0, 200], [400_000, 400_100], [900_000, 900_000]]);
    }

    #[test]
    fn parts_stay_within_their_room_and_end_where_they_begin() {
        for part in Part::ALL {
            for outline in part.loops() {
                let within = |[x, y]: [f64; 2]| x.abs().max(y.abs()) <= ROOM_MM / 2.0;
                assert!(within(outline.begin()), "{part:?}");
            }
            let text = part.gcode([100.0, 100.0], 50.0);
            assert_eq!(text.matches("G0").count(), part.loops().len());
            assert!(text.contains("F3000") && !text.contains("X-"), "{text}");
        }
    }
}
