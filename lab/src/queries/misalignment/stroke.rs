//! The strokes of a machine with pulleys that are off: where its belts have room, and what they pull.

use super::{MisalignmentError, OnStroke};
use corehbot_twin::geometry::{Segment, layout, layout_of, points};
use corehbot_twin::math::atan2;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::Elastic;
use corehbot_twin::model::links::Links;
use corehbot_twin::queries::Setup;
use corehbot_twin::routing::{Belt, Place, Stop};
use corehbot_twin::solve::balance::settle;

/// Places along a stroke.
const PLACES: usize = 41;

/// Where room ends is found to a micrometre: 10 mm between two places, halved so often.
const HALVINGS: u32 = 14;

/// A machine with pulleys that are off.
pub(super) struct Off<'s> {
    /// The machine with its pulleys right.
    pub setup: &'s Setup,
    /// Its belts.
    pub belts: Vec<Belt>,
    /// What the offsets add to each segment where the preload was set.
    pub reference: Vec<f64>,
}

impl Off<'_> {
    /// What the offsets add to the way of the belt along each segment and its arcs.
    pub fn longer(&self, tool: Place) -> Result<Vec<f64>, MisalignmentError> {
        let Setup { machine, params, .. } = self.setup;
        let stops = machine.stops();
        let sign = |index: usize| stops.get(index).map_or(0.0, Stop::sign);
        let aligned = layout(*machine, params, tool).segments;
        let off = layout_of(&self.belts, params, tool).segments;
        let longer = |(aligned, off): (&Segment, &Segment)| {
            let ([ax, ay], [bx, by]) = (aligned.heading, off.heading);
            // A line that turns to the left lies longer on a pulley behind it, and shorter on one before it.
            let turned = atan2(ax * by - ay * bx, ax * bx + ay * by);
            let arcs = params.pulley_radius_mm * (sign(aligned.from) - sign(aligned.to)) * turned;
            // A line that came to run back has no room.
            let is_ahead = ax * bx + ay * by > 0.0;
            if is_ahead { off.length_mm - aligned.length_mm + arcs } else { f64::NAN }
        };
        let all: Vec<f64> = aligned.iter().zip(&off).map(longer).collect();
        if all.iter().all(|longer| longer.is_finite()) { Ok(all) } else { Err(MisalignmentError::NoRoom) }
    }

    /// Places along a stroke where the belt has room. Where it ends within the stroke, the last place with room is one:
    /// lines are shortest there, and spans pull most.
    pub fn with_room(&self, stroke: [f64; 2], at: &dyn Fn(f64) -> Place) -> Vec<f64> {
        let has_room = |way: f64| self.longer(at(way)).is_ok();
        let last = |mut room: f64, mut none: f64| {
            for _ in 0..HALVINGS {
                let middle = f64::midpoint(room, none);
                if has_room(middle) { room = middle } else { none = middle }
            }
            room
        };
        let (mut found, mut before) = (Vec::new(), None);
        for way in points(stroke, PLACES) {
            let is_there = has_room(way);
            match before {
                Some((other, true)) if !is_there => found.push(last(other, way)),
                Some((other, false)) if is_there => found.push(last(way, other)),
                _ => {}
            }
            found.extend(is_there.then_some(way));
            before = Some((way, is_there));
        }
        found
    }

    /// Motors hold, and the rest finds its balance.
    pub fn on_stroke(&self, tool: Place) -> Result<OnStroke, MisalignmentError> {
        let Setup { machine, params, freedom, .. } = self.setup;
        let elastic = Elastic::new(*machine, params, tool, *freedom);
        let since = self.longer(tool)?.into_iter().zip(&self.reference).map(|(now, then)| now - then);
        let each: Vec<(&str, f64)> =
            Links::segments(*machine, params, tool).links.iter().map(|l| l.span).zip(since).collect();
        let links = &elastic.links.links;
        let stretched: Vec<f64> = if links.len() == each.len() {
            each.iter().map(|(_, longer)| *longer).collect()
        } else {
            let of = |span: &str| each.iter().filter(|(name, _)| *name == span).map(|(_, longer)| longer).sum();
            links.iter().map(|link| of(link.span)).collect()
        };
        let moved = settle(&elastic, params, &stretched)?;
        let tension = |(link, longer): (&corehbot_twin::model::links::Link, &f64)| {
            (link.span, link.stiffness(params) * (longer + link.stretch(&moved)))
        };
        let of = |coordinate| elastic.links.index(coordinate).and_then(|i| moved.get(i)).copied().unwrap_or(0.0);
        let changes = || links.iter().zip(&stretched).map(tension);
        let left = |(link, (_, change)): (&corehbot_twin::model::links::Link, (&str, f64))| {
            params.preload_n.of(link.belt) + change
        };
        Ok(OnStroke {
            x_mm: tool.x,
            y_mm: tool.y,
            goes_slack: links.iter().zip(changes()).map(left).any(|tension| tension < 0.0),
            tension_change_n: changes().collect(),
            dx_mm: of(Coordinate::X),
            dy_mm: of(Coordinate::Y),
        })
    }
}
