//! Source: something that repeats as the belt runs, and how it pulls at the machine.
//!
//! | kind | repeats | pulls by |
//! |---|---|---|
//! | detent | every full step | a torque on the rotor |
//! | full step | every full step | a field that rests off its place |
//! | half turn | every two full steps | the same, as by phases of unlike strength |
//! | electrical turn | every four full steps | the same, as by an offset of a phase's current |
//! | tooth | every tooth of a motor's pulley | a pulley that seems to turn by more or less belt |
//! | pulley | every turn of a motor's pulley or an idler | a pulley with its circle off its axis |
//!
//! An eccentric circle moves with its pulley. By the segment law, it stretches the part of the belt that arrives in
//! direction t by `t . dP`, and the part that leaves by `-t . dP`. Teeth of idlers are left out: an idler turns freely,
//! so they hardly pull.
//!
//! A field is sent to the electrical angle a. Phases of strengths 1 + d and 1 - d, with d small, turn it to
//! `a - d sin 2a`. A difference of 6.3 % between them is an error of 2 % of a full step.

use crate::geometry::layout;
use crate::model::coordinate::Coordinate;
use crate::model::elastic::Elastic;
use crate::model::ways::Ways;
use crate::params::{Params, TOOTH_MM};
use crate::routing::{Place, Stop};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::f64::consts::TAU;

/// Detent of a motor over its holding torque, where the machine file has none: 0.022 of 0.4 N m, as a small motor's
/// data sheet (42BYG228, by Mosaic Industries) has at most.
const DETENT_PART: f64 = 0.055;

/// Smaller singular values count as zero.
const NO_WAY: f64 = 1e-6;

/// What repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RippleKind {
    /// The detent of a motor.
    Detent,
    /// Error of a motor's field once a full step.
    FullStep,
    /// Error of a motor's field twice an electrical turn, as by phases of unlike strength.
    HalfTurn,
    /// Error of a motor's field once an electrical turn, as by an offset of a phase's current.
    ElectricalTurn,
    /// Error of a tooth on a motor's pulley.
    Tooth,
    /// A pulley that runs out.
    Pulley,
}

impl RippleKind {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Detent, Self::FullStep, Self::HalfTurn, Self::ElectricalTurn, Self::Tooth, Self::Pulley];

    /// Its name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Detent => "detent",
            Self::FullStep => "full steps",
            Self::HalfTurn => "half turns",
            Self::ElectricalTurn => "electrical turns",
            Self::Tooth => "teeth",
            Self::Pulley => "pulleys",
        }
    }
}

/// How strong the sources are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Amounts {
    /// Detent torque of a motor.
    #[serde(rename = "detent_torque_Nm")]
    pub detent_torque_nm: f64,
    /// Whether it was taken as a part of the holding torque, because the machine has none.
    pub is_detent_assumed: bool,
    /// Amplitude of the field's error once a full step, in percent of a full step.
    pub full_step_error_percent: f64,
    /// The same twice an electrical turn.
    pub half_turn_error_percent: f64,
    /// The same once an electrical turn.
    pub electrical_turn_error_percent: f64,
    /// Amplitude of the error of teeth.
    pub tooth_error_um: f64,
    /// Distance of a pulley's circle from its axis.
    pub pulley_eccentricity_um: f64,
}

impl Amounts {
    /// As the machine's numbers have them.
    #[must_use]
    pub fn of(params: &Params) -> Self {
        Self {
            detent_torque_nm: params.detent_torque_nm.unwrap_or(DETENT_PART * params.holding_torque_nm),
            is_detent_assumed: params.detent_torque_nm.is_none(),
            full_step_error_percent: params.full_step_error_percent,
            half_turn_error_percent: params.half_turn_error_percent,
            electrical_turn_error_percent: params.electrical_turn_error_percent,
            tooth_error_um: params.tooth_error_um,
            pulley_eccentricity_um: params.pulley_eccentricity_um,
        }
    }
}

/// A source.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// What repeats.
    pub kind: RippleKind,
    /// Number of its motor or idler.
    pub pulley: u8,
    /// Belt from one repeat to the next.
    pub pitch_mm: f64,
    /// Belt that runs forwards over its pulley per millimetre of the tool in x and in y.
    pub belt_per_mm: [f64; 2],
    /// Amplitude of its force in N on each coordinate of the links: in phase with it, and a quarter of a repeat later
    /// while the belt runs forwards.
    pub force_n: [DVector<f64>; 2],
    /// Whether it stretches the belt, so that the belt's damper pulls too.
    pub is_stretch: bool,
}

/// All sources of the machine with its tool at a place. `elastic` has idlers and rotors that move.
#[must_use]
pub fn sources(elastic: &Elastic, params: &Params, amounts: &Amounts, tool: Place) -> Vec<Source> {
    let machine = elastic.machine;
    let stops = machine.stops();
    let rolling = rolling(elastic, params);
    let forwards =
        |at: usize, stop: &Stop| rolling.each_ref().map(|moved| stop.sign() * moved.get(at).copied().unwrap_or(0.0));
    let mut sources = Vec::new();
    for (index, stop) in stops.iter().enumerate() {
        let coordinate = match stop.motor() {
            Some(number) => Coordinate::Motor(number),
            None => Coordinate::Idler(index),
        };
        let Some(at) = elastic.links.index(coordinate) else { continue };
        let belt_per_mm = forwards(at, stop);
        let mut add = |kind: RippleKind, pitch_mm: f64, force_n: [DVector<f64>; 2], is_stretch: bool| {
            sources.push(Source { kind, pulley: stop.number, pitch_mm, belt_per_mm, force_n, is_stretch });
        };
        let none = || DVector::<f64>::zeros(elastic.parts.len());
        let mut radius_mm = params.pulley_radius_mm;
        if let Some(number) = stop.motor() {
            let motor = machine.index_of(number);
            radius_mm = params.radius_mm(motor);
            let step_mm = params.full_step_mm(motor);
            let on_rotor = |force: f64| {
                let mut all = none();
                all[at] = force;
                [all, none()]
            };
            let field = |percent: f64| params.field_stiffness_n_per_mm(motor) * step_mm * percent / 100.0;
            add(RippleKind::Detent, step_mm, on_rotor(amounts.detent_torque_nm * 1000.0 / radius_mm), false);
            add(RippleKind::FullStep, step_mm, on_rotor(field(amounts.full_step_error_percent)), false);
            add(RippleKind::HalfTurn, 2.0 * step_mm, on_rotor(field(amounts.half_turn_error_percent)), false);
            add(
                RippleKind::ElectricalTurn,
                4.0 * step_mm,
                on_rotor(field(amounts.electrical_turn_error_percent)),
                false,
            );
            let stretches = elastic.links.links.iter().map(|link| link.row.get(at).copied().unwrap_or(0.0));
            let stretches: Vec<f64> = stretches.map(|row| row * amounts.tooth_error_um / 1000.0).collect();
            add(RippleKind::Tooth, TOOTH_MM, [pull(elastic, params, &stretches), none()], true);
        }
        let stretches = eccentric(elastic, params, tool, index);
        let force = stretches.map(|stretches| {
            let stretches: Vec<f64> = stretches.iter().map(|e| e * amounts.pulley_eccentricity_um / 1000.0).collect();
            pull(elastic, params, &stretches)
        });
        add(RippleKind::Pulley, TAU * radius_mm, force, true);
    }
    sources
}

/// Force on each coordinate when links are stretched by these lengths, in addition to the coordinates' own stretch.
fn pull(elastic: &Elastic, params: &Params, stretches_mm: &[f64]) -> DVector<f64> {
    let mut force = DVector::zeros(elastic.parts.len());
    for (link, stretch) in elastic.links.links.iter().zip(stretches_mm) {
        let tension = link.stiffness(params) * stretch;
        for (entry, row) in force.iter_mut().zip(&link.row) {
            *entry -= row * tension;
        }
    }
    force
}

/// Stretch of each link in mm per mm of eccentricity of the pulley at a stop: in phase, and a quarter of a turn later
/// while the belt runs forwards. The circle moves from the direction in which the belt arrives towards the one in which
/// it leaves.
fn eccentric(elastic: &Elastic, params: &Params, tool: Place, stop: usize) -> [Vec<f64>; 2] {
    let segments = layout(elastic.machine, params, tool).segments;
    let into = segments.iter().find(|segment| segment.to == stop).map(crate::geometry::Segment::along);
    let out = segments.iter().find(|segment| segment.from == stop).map(crate::geometry::Segment::along);
    let (Some(into), Some(out)) = (into, out) else { return [0, 1].map(|_| vec![0.0; segments.len()]) };
    let dot = |a: [f64; 3], b: [f64; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let straight = dot(into, out);
    // The part of the leaving direction at a right angle to the arriving one.
    let aside = (1.0 - straight * straight).max(0.0).sqrt();
    let stretch = |arrives: f64, leaves: f64| {
        let of = |segment: &crate::geometry::Segment| {
            let arriving = if segment.to == stop { arrives } else { 0.0 };
            let leaving = if segment.from == stop { leaves } else { 0.0 };
            arriving - leaving
        };
        segments.iter().map(of).collect()
    };
    [stretch(1.0, straight), stretch(0.0, aside)]
}

/// Motion of each coordinate of the links per millimetre of the tool in x and in y, with rigid belts: motors by their
/// ways, idlers as the belt turns them.
fn rolling(elastic: &Elastic, params: &Params) -> [Vec<f64>; 2] {
    let links = &elastic.links;
    let ways = Ways::new(elastic.machine, params);
    let idlers: Vec<usize> = (0..links.coordinates.len())
        .filter(|i| matches!(links.coordinates.get(*i), Some(Coordinate::Idler(_))))
        .collect();
    let row = |link: usize, at: usize| links.links.get(link).and_then(|link| link.row.get(at)).copied().unwrap_or(0.0);
    let turns =
        DMatrix::from_fn(links.links.len(), idlers.len(), |link, i| row(link, idlers.get(i).copied().unwrap_or(0)));
    let inverse = turns.pseudo_inverse(NO_WAY).unwrap_or_default();
    [0, 1].map(|axis| {
        let known = |coordinate: &Coordinate| match coordinate {
            Coordinate::X => f64::from(u8::from(axis == 0)),
            Coordinate::Y => f64::from(u8::from(axis == 1)),
            Coordinate::Motor(number) => {
                let way = ways.motors.iter().zip(&ways.rows).find(|(motor, _)| *motor == number);
                way.map_or(0.0, |(_, row)| row[axis])
            }
            _ => 0.0,
        };
        let mut moved: Vec<f64> = links.coordinates.iter().map(known).collect();
        let stretched: Vec<f64> = links.links.iter().map(|link| link.stretch(&moved)).collect();
        let turned = -(&inverse * DVector::from_vec(stretched));
        for (at, turn) in idlers.iter().zip(turned.iter()) {
            if let Some(entry) = moved.get_mut(*at) {
                *entry = *turn;
            }
        }
        moved
    })
}
