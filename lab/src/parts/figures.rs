//! Figures: the dimensional errors of the parts, in micrometres. A dimension that is too large is positive: for a
//! square, a disc and a wall where the tool is too far outside, for a hole where it is too wide.

use super::profile::{Profile, corner};
use super::{Outline, Part, stretches};
use corehbot_twin::contour::trail::Beside;
use corehbot_twin::math::hypot;
use corehbot_twin::queries::shown;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::watch::Watch;
use corehbot_twin::steps::{StepTrace, TICKS_PER_SECOND};
use serde::Serialize;

const UM: f64 = 1000.0;

/// A square of 40 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SquareFigures {
    /// Distance of the left and the right side, in the middle half of both.
    pub x_too_large_um: f64,
    /// Distance of the front and the back.
    pub y_too_large_um: f64,
    /// How far outside of a corner the tool gets, or inside where this is more: the worst of three (the loop begins in
    /// the fourth).
    pub corner_outside_um: f64,
    /// The tool's furthest places outside and inside of a side, a millimetre from its ends on.
    pub side_outside_um: f64,
    /// See the one before; inside is negative.
    pub side_inside_um: f64,
    /// Time of the loop.
    pub time_s: f64,
}

/// A disc of 40 mm, or the mean of nine holes of 6 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RoundFigures {
    /// Diameter along x, about ten degrees to both sides.
    pub x_too_large_um: f64,
    /// Diameter along y.
    pub y_too_large_um: f64,
    /// Diameter on average.
    pub mean_too_large_um: f64,
    /// Greatest radius minus least.
    pub out_of_round_um: f64,
    /// Distance of the centre from its place; of holes, the largest.
    pub centre_off_um: f64,
    /// Time of all loops.
    pub time_s: f64,
}

/// A wall of 40 mm, a loop of two lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WallFigures {
    /// Distance of the lines, in their middle half.
    pub too_thick_um: f64,
    /// The largest distance, a millimetre from the ends on.
    pub thickest_um: f64,
    /// The least.
    pub thinnest_um: f64,
    /// Time of the loop.
    pub time_s: f64,
}

/// All parts on a machine at a speed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PartFigures {
    /// The machine.
    pub machine: &'static str,
    /// The commanded speed.
    pub speed_mm_s: f64,
    /// The square.
    pub square: SquareFigures,
    /// The disc.
    pub circle: RoundFigures,
    /// The holes.
    pub holes: RoundFigures,
    /// The wall along x.
    pub wall_along_x: WallFigures,
    /// The wall along y.
    pub wall_along_y: WallFigures,
    /// The dimension of all that is furthest off.
    pub worst_dimension_um: f64,
}

/// A loop that was played: where the tool was, from the middle of the part, and for how long.
struct Loop {
    outline: Outline,
    tool: Vec<[f64; 2]>,
    time_s: f64,
}

impl PartFigures {
    /// None yet.
    #[must_use]
    pub fn new(machine: Machine, speed_mm_s: f64) -> Self {
        Self { machine: machine.key(), speed_mm_s, ..Self::default() }
    }

    /// Takes a part that was played from its middle on. Returns whether its trace has all loops.
    pub fn take(&mut self, part: Part, trace: &StepTrace, watch: &Watch, middle: Place) -> bool {
        let Some(loops) = loops(part, trace, &watch.contour.trail.places, middle) else { return false };
        match part {
            Part::Square => self.square = loops.first().map(square).unwrap_or_default(),
            Part::Circle => self.circle = round(&loops),
            Part::Holes => self.holes = round(&loops),
            Part::Walls => {
                let mut walls = loops.iter().map(wall);
                self.wall_along_x = walls.next().unwrap_or_default();
                self.wall_along_y = walls.next().unwrap_or_default();
            }
        }
        self.worst_dimension_um = self.dimensions().into_iter().fold(0.0, |a, b| if b.abs() > a.abs() { b } else { a });
        true
    }

    /// Errors of all dimensions that callipers measure.
    fn dimensions(&self) -> [f64; 8] {
        let Self { square, circle, holes, wall_along_x, wall_along_y, .. } = self;
        let [x, y] = [circle, holes].map(|round| [round.x_too_large_um, round.y_too_large_um]);
        [
            square.x_too_large_um,
            square.y_too_large_um,
            x[0],
            x[1],
            y[0],
            y[1],
            wall_along_x.too_thick_um,
            wall_along_y.too_thick_um,
        ]
    }
}

/// The loops: every second stretch of steps.
fn loops(part: Part, trace: &StepTrace, trail: &[Beside], middle: Place) -> Option<Vec<Loop>> {
    let outlines = part.loops();
    let all = stretches(trace);
    // The first loop begins at the end of a way, unless it begins where the tool is.
    let times: Vec<[u64; 2]> = all.into_iter().skip(1).step_by(2).collect();
    if times.len() != outlines.len() {
        return None;
    }
    let played = |(outline, [begin, end]): (Outline, [u64; 2])| {
        let within = trail.iter().filter(|beside| (begin..=end).contains(&beside.tick));
        let from_middle = |b: &Beside| [b.at[0] + b.off[0] - middle.x, b.at[1] + b.off[1] - middle.y];
        Loop { outline, tool: within.map(from_middle).collect(), time_s: (end - begin) as f64 / TICKS_PER_SECOND }
    };
    Some(outlines.into_iter().zip(times).map(played).collect())
}

/// The sides of a polygon, each by the samples that are nearer to it than to the others.
fn sides(corners: &[[f64; 2]], tool: &[[f64; 2]]) -> Vec<Profile> {
    let ends = || corners.iter().copied().zip(corners.iter().copied().cycle().skip(1));
    let nearest = |at: &[f64; 2]| {
        let far = ends().map(|(a, b)| corehbot_twin::contour::path::nearest(a, b, *at).1).enumerate();
        far.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(side, _)| side)
    };
    let of: Vec<usize> = tool.iter().map(nearest).collect();
    let side = |(index, (a, b)): (usize, ([f64; 2], [f64; 2]))| {
        let own: Vec<[f64; 2]> = tool.iter().zip(&of).filter(|(_, of)| **of == index).map(|(at, _)| *at).collect();
        Profile::of_side(a, b, &own)
    };
    ends().enumerate().map(side).collect()
}

fn square(played: &Loop) -> SquareFigures {
    let Outline::Polygon(corners) = &played.outline else { return SquareFigures::default() };
    let sides = sides(corners, &played.tool);
    let [front, right, back, left] = sides.as_slice() else { return SquareFigures::default() };
    let ranges = sides.iter().map(Profile::range);
    let [inside, outside] = ranges.fold([0.0_f64; 2], |[a, b], [low, high]| [a.min(low), b.max(high)]);
    let around = corners.iter().chain(corners).copied().collect::<Vec<_>>();
    let bends = around.windows(3).take(corners.len() - 1);
    let off = bends.map(|three| match three {
        [before, at, after] => corner(*before, *at, *after, &played.tool),
        _ => 0.0,
    });
    SquareFigures {
        x_too_large_um: UM * (left.middle() + right.middle()),
        y_too_large_um: UM * (front.middle() + back.middle()),
        corner_outside_um: UM * off.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a }),
        side_outside_um: UM * outside,
        side_inside_um: UM * inside,
        time_s: played.time_s,
    }
}

/// The mean of circles.
fn round(loops: &[Loop]) -> RoundFigures {
    let mut mean = RoundFigures::default();
    let part = 1.0 / loops.len().max(1) as f64;
    for played in loops {
        let Outline::Circle { centre, radius, .. } = played.outline else { continue };
        let profile = Profile::of_circle(centre, radius, &played.tool);
        mean.x_too_large_um += part * UM * (profile.about(0) + profile.about(180));
        mean.y_too_large_um += part * UM * (profile.about(90) + profile.about(270));
        mean.mean_too_large_um += part * UM * 2.0 * profile.all_around();
        mean.out_of_round_um += part * UM * profile.out_of_round();
        let [x, y] = profile.centre();
        mean.centre_off_um = mean.centre_off_um.max(UM * hypot(x, y));
        mean.time_s += played.time_s;
    }
    mean
}

fn wall(played: &Loop) -> WallFigures {
    let Outline::Polygon(corners) = &played.outline else { return WallFigures::default() };
    let sides = sides(corners, &played.tool);
    let [there, _, back, _] = sides.as_slice() else { return WallFigures::default() };
    let across = there.across(back);
    let [thinnest, thickest] = across.range();
    WallFigures {
        too_thick_um: UM * across.middle(),
        thickest_um: UM * thickest,
        thinnest_um: UM * thinnest,
        time_s: played.time_s,
    }
}

/// Figures of one machine, in rows by speed.
pub(crate) struct Rows<'f>(pub(crate) &'f [PartFigures]);

impl std::fmt::Display for Rows<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for p in self.0 {
            let of = |value: f64| shown(value, 1);
            write!(f, "  {:>5}", shown(p.speed_mm_s, 0))?;
            let s = p.square;
            write!(f, " |{:>7}{:>7}{:>8}", of(s.x_too_large_um), of(s.y_too_large_um), of(s.corner_outside_um))?;
            for r in [p.circle, p.holes] {
                write!(f, " |{:>7}{:>7}{:>7}", of(r.x_too_large_um), of(r.y_too_large_um), of(r.out_of_round_um))?;
            }
            write!(f, " |{:>8}{:>8}", of(p.wall_along_x.too_thick_um), of(p.wall_along_y.too_thick_um))?;
            writeln!(f, " |{:>8}", of(p.worst_dimension_um))?;
        }
        Ok(())
    }
}

/// All figures of a command.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Parts {
    /// The meaning of signs.
    pub sign: &'static str,
    /// Machine after machine, by speed.
    pub parts: Vec<PartFigures>,
}

impl Parts {
    /// With the meaning of signs.
    #[must_use]
    pub const fn new(parts: Vec<PartFigures>) -> Self {
        Self { sign: "a dimension that is too large is positive; a corner outside is positive", parts }
    }
}

impl std::fmt::Display for Parts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "Errors of dimensions in um: too large is positive, a corner outside too")?;
        for one in self.parts.chunk_by(|a, b| a.machine == b.machine) {
            let Some(first) = one.first() else { continue };
            writeln!(f, "{}", Machine::name_of(first.machine))?;
            writeln!(
                f,
                "  speed | square 40 mm         | disc 40 mm           | holes 6 mm           | walls           |"
            )?;
            writeln!(
                f,
                "   mm/s |      x      y  corner |      x      y  round |      x      y  round | along x along y |   worst"
            )?;
            write!(f, "{}", Rows(one))?;
        }
        Ok(())
    }
}
