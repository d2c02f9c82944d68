//! Misalignment: the effect of pulleys that are not where they should be (\[H\] equations 26 to 29).
//!
//! At rest each segment pulls with the preload. The paper takes all segments along x and y, and sums the moments of
//! these pulls on the head (tau_B3, equation 27) and on bar and head (tau_B2, equation 26). Both are 0 if the pulleys
//! that share a segment's line are aligned (equations 28 and 29). Here the same sum is over the routing table, so it
//! holds for every machine with flat belts.
//!
//! Beside it stands the sum along the real lines, which slant where a pulley is off. A segment between two parts of bar
//! and head pulls both along one line, and has no moment on the whole. So offsets in y make no torque on the bar's
//! guides, though equations 26 and 29 have terms for them.
//!
//! The tension along the stroke is an addition to the paper. A pulley that is off lengthens its belt by the same amount
//! everywhere, which the preload takes up, and by the slant: off^2 / (2 L) for a segment of length L. L changes along
//! the stroke. Motors hold their place, so spans pull more where their segments are short, and the tool gives way. A
//! stroke ends where the pulleys leave the belt no room, and a pulley has no torque by real lines where a mm of it to
//! either side would. `stroke` has both.

mod stroke;

use corehbot_twin::geometry::{layout_of, workspace};
use corehbot_twin::math::hypot;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::model::links::Links;
use corehbot_twin::model::loads::load;
use corehbot_twin::queries::{At, Setup, shown};
use corehbot_twin::routing::{Belt, Block, Place, Role, Runs, Stop};
use corehbot_twin::solve::NotHeld;
use corehbot_twin::solve::balance::condensed;
use serde::Serialize;
use std::collections::BTreeMap;
use stroke::Off;

/// An offset for which torques are proportional to it, in mm.
const SMALL_MM: f64 = 1e-3;

/// mm in an m, N mm in an N m.
const MM_PER_M: f64 = 1000.0;

/// A pulley that is off its place.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offset {
    /// Its number.
    pub pulley: u8,
    /// To the right and away from the front.
    pub off_mm: [f64; 2],
}

/// The effect of pulleys that are off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misalignment {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// Tension of each belt, set with the tool at this place.
    #[serde(rename = "preload_N")]
    pub preload_n: Vec<f64>,
    /// The pulleys.
    pub offsets: Vec<Offset>,
    /// Torques by the paper's equations.
    pub paper: Torques,
    /// The same with segments along their real lines, about the tool.
    pub slanted: Torques,
    /// Yaw of the bar that this torque makes on guides and belts, counter-clockwise; none where nothing holds the bar.
    pub yaw_mrad: Option<f64>,
    /// Along the stroke of x, at this y.
    pub along_x: Vec<OnStroke>,
    /// Along the stroke of y, at this x.
    pub along_y: Vec<OnStroke>,
    /// Torques for 1 mm of each pulley on bar and head.
    pub per_mm: Vec<PerMm>,
}

/// Torques of the belts on the guides, counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Torques {
    /// On the bar's guides along y: tau_B2.
    #[serde(rename = "bar_torque_Nm")]
    pub bar_nm: f64,
    /// On the head's guide along x: tau_B3.
    #[serde(rename = "head_torque_Nm")]
    pub head_nm: f64,
}

/// A place on a stroke.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OnStroke {
    /// The tool's place, from motor 1's axis.
    pub x_mm: f64,
    /// The same away from the front.
    pub y_mm: f64,
    /// Change of each span's tension since the preload was set.
    #[serde(rename = "tension_change_N")]
    pub tension_change_n: BTreeMap<&'static str, f64>,
    /// Displacement of the tool by it, to the right.
    pub dx_mm: f64,
    /// The same away from the front.
    pub dy_mm: f64,
    /// Whether preload and change of a span are below 0 together: the figures do not hold.
    pub goes_slack: bool,
}

/// The torque that a pulley makes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerMm {
    /// Its number.
    pub pulley: u8,
    /// For 1 mm to the right, by the paper.
    pub right_paper: Torques,
    /// For 1 mm away from the front, by the paper.
    pub back_paper: Torques,
    /// For 1 mm to the right, along real lines; none where a mm to either side leaves the belt no room.
    pub right_slanted: Option<Torques>,
    /// For 1 mm away from the front, likewise.
    pub back_slanted: Option<Torques>,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MisalignmentError {
    /// There is no such pulley; there are these.
    NoPulley(u8, Vec<u8>),
    /// The belts do not lie in a plane.
    InSpace,
    /// Pulleys overlap so far that no belt runs between them.
    NoRoom,
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for MisalignmentError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoPulley(pulley, known) => {
                let known: Vec<String> = known.iter().map(ToString::to_string).collect();
                write!(f, "there is no pulley {pulley}; the machine has {}", known.join(", "))
            }
            Self::InSpace => f.write_str("offsets of pulleys are known for belts in one plane only"),
            Self::NoRoom => f.write_str("the pulleys leave the belt no room somewhere on the stroke"),
            Self::NotHeld(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MisalignmentError {}

impl From<NotHeld> for MisalignmentError {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

impl Misalignment {
    /// The answer. Several offsets of one pulley add up.
    ///
    /// # Errors
    /// There is no such pulley, no room or no hold, or belts run in space.
    pub fn new(setup: &Setup, offsets: &[Offset]) -> Result<Self, MisalignmentError> {
        let (machine, params) = (setup.machine, &setup.params);
        let belts = machine.belts();
        if belts.iter().any(|belt| belt.runs == Runs::Upright) {
            return Err(MisalignmentError::InSpace);
        }
        let known = pulleys(&machine.stops(), |_| true);
        if let Some(offset) = offsets.iter().find(|offset| !known.contains(&offset.pulley)) {
            return Err(MisalignmentError::NoPulley(offset.pulley, known));
        }
        let off = Off { setup, belts: moved(&belts, offsets), reference: Vec::new() };
        let off = Off { reference: off.longer(setup.tool)?, ..off };
        let torques = |offsets: &[Offset]| by_paper(setup, &belts, &moved(&belts, offsets));
        let per_mm = |pulley: u8| {
            let one = |off_mm| torques(&[Offset { pulley, off_mm }]);
            let with = |off_mm| moved(&belts, &[Offset { pulley, off_mm }]);
            let has_room =
                |off_mm| Off { setup, belts: with(off_mm), reference: Vec::new() }.longer(setup.tool).is_ok();
            let real = |[x, y]: [f64; 2]| {
                (has_room([x, y]) && has_room([-x, -y])).then(|| {
                    let Torques { bar_nm, head_nm } = slanted(setup, &with([x * SMALL_MM, y * SMALL_MM]));
                    Torques { bar_nm: bar_nm / SMALL_MM, head_nm: head_nm / SMALL_MM }
                })
            };
            let [right, back] = [[1.0, 0.0], [0.0, 1.0]];
            let (right_paper, back_paper) = (one(right), one(back));
            PerMm { pulley, right_paper, back_paper, right_slanted: real(right), back_slanted: real(back) }
        };
        let slanted = slanted(setup, &off.belts);
        let reach = workspace(machine, params);
        let Place { x, y, .. } = setup.tool;
        let along = |stroke: [f64; 2], at: &dyn Fn(f64) -> Place| {
            off.with_room(stroke, at).into_iter().map(|way| off.on_stroke(at(way))).collect::<Result<_, _>>()
        };
        Ok(Self {
            at: setup.at(),
            preload_n: (0..belts.len()).map(|belt| params.preload_n.of(belt)).collect(),
            offsets: offsets.to_vec(),
            paper: torques(offsets),
            slanted,
            yaw_mrad: yaw_mrad(setup, slanted.bar_nm),
            along_x: along(reach.x, &|x| reach.at(x, y))?,
            along_y: along(reach.y, &|y| reach.at(x, y))?,
            per_mm: pulleys(&machine.stops(), |stop| stop.block() != Block::Frame).into_iter().map(per_mm).collect(),
        })
    }
}

/// Numbers of the pulleys of a kind, ascending.
fn pulleys(stops: &[Stop], is_wanted: impl Fn(&Stop) -> bool) -> Vec<u8> {
    let mut numbers: Vec<u8> =
        stops.iter().filter(|stop| stop.role != Role::Clamp && is_wanted(stop)).map(|stop| stop.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The belts with their pulleys off.
fn moved(belts: &[Belt], offsets: &[Offset]) -> Vec<Belt> {
    let mut belts = belts.to_vec();
    for stop in belts.iter_mut().flat_map(|belt| belt.stops.to_mut()).filter(|stop| stop.role != Role::Clamp) {
        for Offset { off_mm: [x, y], .. } in offsets.iter().filter(|offset| offset.pulley == stop.number) {
            stop.x.off_mm += x;
            stop.y.off_mm += y;
        }
    }
    belts
}

/// Preload of each segment.
fn preloads(setup: &Setup) -> Vec<f64> {
    let links = Links::segments(setup.machine, &setup.params, setup.tool).links;
    links.iter().map(|link| setup.params.preload_n.of(link.belt)).collect()
}

/// Moments on head and bar of pulls along the aligned lines, at the pulleys' places.
fn by_paper(setup: &Setup, belts: &[Belt], off: &[Belt]) -> Torques {
    let stops = |belts: &[Belt]| belts.iter().flat_map(|belt| belt.stops.to_vec()).collect::<Vec<Stop>>();
    let (aligned, off) = (stops(belts), stops(off));
    let mut torques = [0.0; 2];
    for (segment, tension) in layout_of(belts, &setup.params, setup.tool).segments.iter().zip(preloads(setup)) {
        for (end, pull) in [(segment.from, tension), (segment.to, -tension)] {
            let Some((aligned, off)) = aligned.get(end).zip(off.get(end)) else { continue };
            // A couple does not depend on the origin; only what the offset adds is not 0.
            let [x, y] = [off.x.off_mm - aligned.x.off_mm, off.y.off_mm - aligned.y.off_mm];
            let [along_x, along_y] = segment.heading.map(|along| along * pull);
            let moment = x * along_y - y * along_x;
            match aligned.block() {
                Block::Frame => {}
                Block::Bar => torques[0] += moment,
                Block::Head => torques = torques.map(|torque| torque + moment),
            }
        }
    }
    let [bar_nm, head_nm] = torques.map(|torque| torque / MM_PER_M);
    Torques { bar_nm, head_nm }
}

/// Moments on head and bar of pulls along the real lines of these belts, about the tool.
fn slanted(setup: &Setup, belts: &[Belt]) -> Torques {
    let Setup { machine, params, tool, .. } = setup;
    let layout = layout_of(belts, params, *tool);
    let tensions = preloads(setup);
    let [bar, head] =
        [Block::Bar, Block::Head].map(|block| load(*machine, &layout, &tensions, block, *tool).couple_n_mm);
    Torques { bar_nm: (bar + head) / MM_PER_M, head_nm: head / MM_PER_M }
}

/// Yaw of the bar by a torque on it.
fn yaw_mrad(setup: &Setup, torque_nm: f64) -> Option<f64> {
    let freedom = Freedom { yaw: true, ..setup.freedom };
    let elastic = Elastic::new(setup.machine, &setup.params, setup.tool, freedom);
    let yaw = elastic.links.index(Coordinate::Yaw)?;
    let stiffness = condensed(&elastic, &[yaw]).ok()?[(0, 0)];
    (stiffness > 0.0).then(|| 1e3 * torque_nm * MM_PER_M / stiffness)
}

impl OnStroke {
    /// The change that is farthest from 0.
    #[must_use]
    pub fn greatest_n(&self) -> f64 {
        self.tension_change_n.values().fold(0.0, |most: f64, n| if n.abs() > most.abs() { *n } else { most })
    }
}

impl std::fmt::Display for Misalignment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let preload: Vec<String> = self.preload_n.iter().map(|n| shown(*n, 1)).collect();
        writeln!(f, "{}, preload {} N", self.at, preload.join(" and "))?;
        let torque = |nm: f64| format!("{:>9}", shown(1000.0 * nm, 2));
        if !self.offsets.is_empty() {
            for Offset { pulley, off_mm: [x, y] } in &self.offsets {
                writeln!(f, "  pulley {pulley} is off by ({x}, {y}) mm")?;
            }
            writeln!(f, "  torque of the belts, counter-clockwise, mN m      by the paper  along real lines")?;
            for (what, of) in [
                ("on the bar's guides, tau_B2", (self.paper.bar_nm, self.slanted.bar_nm)),
                ("on the head's guide, tau_B3", (self.paper.head_nm, self.slanted.head_nm)),
            ] {
                writeln!(f, "    {what:<44} {:>13} {:>17}", torque(of.0), torque(of.1))?;
            }
            if let Some(yaw) = self.yaw_mrad {
                writeln!(f, "  the bar yaws by {} mrad", shown(yaw, 4))?;
            }
            for (letter, stroke) in [("x", &self.along_x), ("y", &self.along_y)] {
                let all = || stroke.iter().flat_map(|place| place.tension_change_n.values().copied());
                let [least, most] = all().fold([0.0_f64; 2], |[low, high], n| [low.min(n), high.max(n)]);
                let off = stroke.iter().map(|place| hypot(place.dx_mm, place.dy_mm)).fold(0.0, f64::max);
                write!(
                    f,
                    "  along the stroke of {letter} spans change by {} to {} N",
                    shown(least, 3),
                    shown(most, 3)
                )?;
                writeln!(f, " and the tool moves by {} um", shown(1000.0 * off, 1))?;
                if stroke.iter().any(|place| place.goes_slack) {
                    writeln!(f, "    there belts go slack, so figures do not hold")?;
                }
            }
        }
        writeln!(f, "  for 1 mm of a pulley, mN m    tau_B2 by x   tau_B2 by y   tau_B3 by y  (paper / real lines)")?;
        for of in &self.per_mm {
            let pair = |paper: f64, real: Option<f64>| {
                let real = real.map_or_else(|| format!("{:>9}", "no room"), torque);
                format!("{} /{real}", torque(paper).trim_start())
            };
            let bar = [(of.right_paper, of.right_slanted), (of.back_paper, of.back_slanted)];
            let [x, y] = bar.map(|(paper, real)| pair(paper.bar_nm, real.map(|real| real.bar_nm)));
            let head = pair(of.back_paper.head_nm, of.back_slanted.map(|real| real.head_nm));
            writeln!(f, "    pulley {:<8} {x:>20} {y:>20} {head:>20}", of.pulley)?;
        }
        Ok(())
    }
}
