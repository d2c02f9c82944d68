//! Links: the elastic parts of the belt, as rows over the coordinates.
//!
//! A link is a segment between two stops, or a span from one motor or clamp to the next. In a span the idlers are in
//! equilibrium, so all of its segments have one tension: stretches and compliances add up, and the idlers drop out of
//! the sum. This is the exact static condensation of the idlers.

use super::SHORTEST_FREE_MM;
use super::coordinate::Coordinate;
use crate::geometry::{Segment, follows_x, follows_y, layout};
use crate::params::Params;
use crate::routing::{Block, Machine, Place, Role, Stop};

/// A part of the belt that stretches as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The span that it is or belongs to.
    pub span: &'static str,
    /// Free length in mm.
    pub length_mm: f64,
    /// Its stretch in mm for a unit of each coordinate.
    pub row: Vec<f64>,
}

impl Link {
    /// Its stiffness in N/mm.
    #[must_use]
    pub fn stiffness(&self, params: &Params) -> f64 {
        params.belt_ea_n / self.length_mm.max(SHORTEST_FREE_MM)
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
    /// Coordinates of the rows: x, y, yaw, then the pulleys in the order of the stops.
    pub coordinates: Vec<Coordinate>,
    /// The links, belt after belt in the direction of travel.
    pub links: Vec<Link>,
}

impl Links {
    /// A link for every straight segment.
    #[must_use]
    pub fn segments(machine: Machine, params: &Params, tool: Place) -> Self {
        let stops: Vec<&Stop> = machine.stops().collect();
        let coordinates = coordinates(&stops);
        let segments = layout(machine, params, tool).segments;
        let link = |(segment, span)| link(segment, span, &stops, &coordinates, params, tool);
        let links = segments.iter().zip(span_names(machine)).filter_map(link).collect();
        Self { coordinates, links }
    }

    /// A link for every span between motors and clamps.
    #[must_use]
    pub fn spans(machine: Machine, params: &Params, tool: Place) -> Self {
        let Self { coordinates, links: segments } = Self::segments(machine, params, tool);
        let mut links: Vec<Link> = Vec::new();
        for segment in segments {
            match links.last_mut() {
                Some(span) if span.span == segment.span => span.join(&segment),
                _ => links.push(segment),
            }
        }
        let mut spans = Self { coordinates, links };
        spans.keep(|coordinate| !matches!(coordinate, Coordinate::Idler(_)));
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

/// Span of each segment, belt after belt. Motors and clamps end spans.
fn span_names(machine: Machine) -> Vec<&'static str> {
    let mut names = Vec::new();
    for belt in machine.belts() {
        let mut spans = belt.spans.iter();
        let mut open = None;
        let ends = belt.stops.iter().skip(1).chain(belt.is_closed().then(|| belt.stops.first()).flatten());
        for end in ends {
            let span = open.take().or_else(|| spans.next().copied()).unwrap_or_default();
            names.push(span);
            open = matches!(end.role, Role::Idler(_)).then_some(span);
        }
    }
    names
}

fn coordinates(stops: &[&Stop]) -> Vec<Coordinate> {
    let pulley = |(index, stop): (usize, &&Stop)| match stop.role {
        Role::Motor => Some(Coordinate::Motor(stop.number)),
        Role::Idler(_) => Some(Coordinate::Idler(index)),
        Role::Clamp => None,
    };
    let pulleys = stops.iter().enumerate().filter_map(pulley);
    [Coordinate::X, Coordinate::Y, Coordinate::Yaw].into_iter().chain(pulleys).collect()
}

/// The segment law: see the head of the room.
fn link(
    segment: &Segment,
    span: &'static str,
    stops: &[&Stop],
    coordinates: &[Coordinate],
    params: &Params,
    tool: Place,
) -> Option<Link> {
    let (from, to) = (*stops.get(segment.from)?, *stops.get(segment.to)?);
    let [along_x, along_y] = segment.heading;
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
        Coordinate::X => along_x * (follows_x(to) - follows_x(from)),
        Coordinate::Y => along_y * (follows_y(to) - follows_y(from)),
        Coordinate::Yaw => yaws(to) - yaws(from),
        pulley => turns(segment.to, to, *pulley) - turns(segment.from, from, *pulley),
    };
    let row = coordinates.iter().map(entry).collect();
    Some(Link { span, length_mm: segment.length_mm, row })
}

/// Motion of a stop's centre per radian of the bar about its middle.
fn yaw_of(stop: &Stop, params: &Params, tool: Place) -> [f64; 2] {
    if stop.block() == Block::Frame {
        return [0.0, 0.0];
    }
    let [x, y] = stop.centre(params, tool);
    [tool.y - y, x - params.width_mm / 2.0]
}
