//! Links: the elastic parts of the belt, as rows over the coordinates.
//!
//! A link is a segment between two stops, or a span from one motor or clamp to the next. In a span the idlers are in
//! equilibrium, so all of its segments have one tension: stretches and compliances add up, and the idlers drop out of
//! the sum. This is the exact static condensation of the idlers.

use super::SHORTEST_FREE_MM;
use super::coordinate::Coordinate;
use crate::geometry::{Segment, layout};
use crate::params::Params;
use crate::routing::{Block, Machine, Place, Role, Stop};

/// A part of the belt that stretches as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The span that it is or belongs to.
    pub span: &'static str,
    /// Its belt, in the order of the machine's belts.
    pub belt: usize,
    /// Free length in mm.
    pub length_mm: f64,
    /// Its stretch in mm for a unit of each coordinate.
    pub row: Vec<f64>,
}

impl Link {
    /// Its stiffness in N/mm.
    #[must_use]
    pub fn stiffness(&self, params: &Params) -> f64 {
        params.belt_ea_n.of(self.belt) / self.length_mm.max(SHORTEST_FREE_MM)
    }

    /// Adds a link with the same tension.
    fn join(&mut self, other: &Self) {
        self.length_mm += other.length_mm;
        for (entry, more) in self.row.iter_mut().zip(&other.row) {
            *entry += more;
        }
    }

    /// Its stretch in mm for these displacements.
    #[must_use]
    pub fn stretch(&self, moved: &[f64]) -> f64 {
        self.row.iter().zip(moved).map(|(row, moved)| row * moved).sum()
    }
}

/// All links of a machine for a place of the tool.
#[derive(Clone, Debug, PartialEq)]
pub struct Links {
    /// Coordinates of the rows: x, y, yaw, z where belts lift the tool, a soft frame, then the pulleys in the order of
    /// the stops.
    pub coordinates: Vec<Coordinate>,
    /// The links, belt after belt in the direction of travel.
    pub links: Vec<Link>,
}

impl Links {
    /// A link for every straight segment.
    #[must_use]
    pub fn segments(machine: Machine, params: &Params, tool: Place) -> Self {
        let stops = machine.stops();
        let coordinates = coordinates(&stops, machine.lifts(), !params.frame_stiffness_n_per_mm.values().is_empty());
        let segments = layout(machine, params, tool).segments;
        let link = |(segment, part)| link(segment, part, &stops, &coordinates, params, tool);
        let links = segments.iter().zip(parts(machine)).filter_map(link).collect();
        Self { coordinates, links }
    }

    /// A link for every span between motors and clamps.
    #[must_use]
    pub fn spans(machine: Machine, params: &Params, tool: Place) -> Self {
        Self::spans_between(machine, params, tool, &[])
    }

    /// The same, with a span ending at each of these idlers too: the stops by their indices. They keep their
    /// coordinates.
    #[must_use]
    pub fn spans_between(machine: Machine, params: &Params, tool: Place, idlers: &[usize]) -> Self {
        let Self { coordinates, links: segments } = Self::segments(machine, params, tool);
        let is_kept = |coordinate: &Coordinate| matches!(coordinate, Coordinate::Idler(stop) if idlers.contains(stop));
        // An idler between two links turns with the end of one and the begin of the other.
        let is_parted = |before: &Link, after: &Link| {
            let entries = before.row.iter().zip(&after.row).zip(&coordinates);
            entries.into_iter().any(|((a, b), coordinate)| is_kept(coordinate) && *a != 0.0 && *b != 0.0)
        };
        let mut links: Vec<Link> = Vec::new();
        for segment in segments {
            match links.last_mut() {
                Some(span) if span.span == segment.span && !is_parted(span, &segment) => span.join(&segment),
                _ => links.push(segment),
            }
        }
        let mut spans = Self { coordinates, links };
        spans.keep(|coordinate| !matches!(coordinate, Coordinate::Idler(_)) || is_kept(&coordinate));
        spans
    }

    /// Index of a coordinate.
    #[must_use]
    pub fn index(&self, coordinate: Coordinate) -> Option<usize> {
        self.coordinates.iter().position(|c| *c == coordinate)
    }

    /// Removes coordinates from the rows.
    fn keep(&mut self, is_kept: impl Fn(Coordinate) -> bool) {
        let kept: Vec<bool> = self.coordinates.iter().map(|c| is_kept(*c)).collect();
        let mut at = kept.iter();
        self.coordinates.retain(|_| at.next() == Some(&true));
        for link in &mut self.links {
            let mut at = kept.iter();
            link.row.retain(|_| at.next() == Some(&true));
        }
    }
}

/// The part of a belt that a segment is.
#[derive(Clone, Copy)]
struct Piece {
    belt: usize,
    /// Its span, in the order of the machine's spans, and its name.
    span: usize,
    name: &'static str,
    /// Whether it is the first segment of its span, which the belt outside counts for.
    is_first: bool,
}

/// Belt and span of each segment, belt after belt. Motors and clamps end spans.
fn parts(machine: Machine) -> Vec<Piece> {
    let mut parts = Vec::new();
    let mut span = 0;
    for (index, belt) in machine.belts().iter().enumerate() {
        let mut names = belt.spans.iter();
        let mut name = names.next().copied().unwrap_or_default();
        let mut is_first = true;
        let ends = belt.stops.iter().skip(1).chain(belt.is_closed().then(|| belt.stops.first()).flatten());
        for end in ends {
            parts.push(Piece { belt: index, span, name, is_first });
            is_first = !matches!(end.role, Role::Idler(_));
            if is_first {
                span += 1;
                name = names.next().copied().unwrap_or_default();
            }
        }
    }
    parts
}

fn coordinates(stops: &[Stop], lifts: bool, has_soft_frame: bool) -> Vec<Coordinate> {
    let pulley = |(index, stop): (usize, &Stop)| match stop.role {
        Role::Motor => Some(Coordinate::Motor(stop.number)),
        Role::Idler(_) => Some(Coordinate::Idler(index)),
        Role::Clamp => None,
    };
    let pulleys = stops.iter().enumerate().filter_map(pulley);
    let lift = lifts.then_some(Coordinate::Z);
    let frame = [0, 1].into_iter().filter(|_| has_soft_frame).map(Coordinate::Frame);
    [Coordinate::X, Coordinate::Y, Coordinate::Yaw].into_iter().chain(lift).chain(frame).chain(pulleys).collect()
}

/// The segment law: see the head of the room.
fn link(
    segment: &Segment,
    part: Piece,
    stops: &[Stop],
    coordinates: &[Coordinate],
    params: &Params,
    tool: Place,
) -> Option<Link> {
    let (from, to) = (stops.get(segment.from)?, stops.get(segment.to)?);
    let [along_x, along_y, up] = segment.along();
    let turns = |index: usize, stop: &Stop, coordinate: Coordinate| match coordinate {
        Coordinate::Idler(idler) if idler == index => stop.sign(),
        Coordinate::Motor(number) if stop.motor() == Some(number) => stop.sign(),
        _ => 0.0,
    };
    let yaws = |stop: &Stop| {
        let [x, y] = yaw_of(stop, params, tool);
        along_x * x + along_y * y
    };
    let entry = |coordinate: &Coordinate| match coordinate {
        Coordinate::X => along_x * (to.follows(0) - from.follows(0)),
        Coordinate::Y => along_y * (to.follows(1) - from.follows(1)),
        // All stops move with it.
        Coordinate::Frame(_) => 0.0,
        Coordinate::Z => up * (to.follows(2) - from.follows(2)),
        Coordinate::Yaw => yaws(to) - yaws(from),
        pulley => turns(segment.to, to, *pulley) - turns(segment.from, from, *pulley),
    };
    let row = coordinates.iter().map(entry).collect();
    let outside = if part.is_first { params.outside_mm.of(part.span) } else { 0.0 };
    Some(Link { span: part.name, belt: part.belt, length_mm: segment.length_mm + outside, row })
}

/// Motion of a stop's centre per radian of the bar about its middle.
fn yaw_of(stop: &Stop, params: &Params, tool: Place) -> [f64; 2] {
    if stop.block() == Block::Frame {
        return [0.0, 0.0];
    }
    let [x, y] = stop.centre(params, tool);
    [tool.y - y, x - params.width_mm / 2.0]
}
