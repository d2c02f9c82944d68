//! Elastic: stiffness and mass of the machine about a place of the tool.
//!
//! The query decides which parts may move. *Reduced*: the tool alone; idlers follow without mass. *Full*: idlers too,
//! each with its inertia. *Rotors*: motors too, each held by its field as by a spring. The bar may also yaw on its
//! guides. A motor without power is free.

use super::coordinate::Coordinate;
use super::links::Links;
use crate::math::square;
use crate::params::Params;
use crate::routing::{Machine, Place};
use nalgebra::DMatrix;

/// Parts that may move besides the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freedom {
    /// Idlers, each with its inertia.
    pub idlers: bool,
    /// Rotors, held by their fields.
    pub rotors: bool,
    /// The bar, on its guides.
    pub yaw: bool,
    /// A motor without power.
    pub free_motor: Option<u8>,
}

/// Role of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElasticPart {
    /// It moves and has mass.
    Moves,
    /// It is compliant, with negligible mass.
    GivesWay,
    /// It is fixed.
    Held,
}

/// Stiffness and mass over all coordinates of the links.
#[derive(Clone, Debug)]
pub struct Elastic {
    /// The machine.
    pub machine: Machine,
    /// The elastic parts of the belt.
    pub links: Links,
    /// Role of each coordinate.
    pub parts: Vec<ElasticPart>,
    /// Stiffness of each coordinate without the belt, in N/mm: a field, or the guides.
    pub held_by: Vec<f64>,
    /// N/mm; N between x or y and the yaw, N mm/rad for the yaw.
    pub stiffness: DMatrix<f64>,
    /// kg; kg mm between y and the yaw, kg mm^2 for the yaw.
    pub mass: DMatrix<f64>,
    /// Viscous friction of belts, guides and rotors in N s/mm, over the same coordinates. It does not include dry
    /// friction.
    pub damping: DMatrix<f64>,
}

/// N mm in an N m.
const MM_PER_M: f64 = 1000.0;

impl Elastic {
    /// The machine with its tool at a place.
    #[must_use]
    pub fn new(machine: Machine, params: &Params, tool: Place, freedom: Freedom) -> Self {
        let links =
            if freedom.idlers { Links::segments(machine, params, tool) } else { Links::spans(machine, params, tool) };
        Self::of(links, machine, params, tool, freedom)
    }

    /// The same with these links.
    #[must_use]
    pub fn of(links: Links, machine: Machine, params: &Params, tool: Place, freedom: Freedom) -> Self {
        let parts = links.coordinates.iter().map(|c| part(*c, freedom)).collect();
        let held_by: Vec<f64> = links.coordinates.iter().map(|c| held_by(*c, machine, params, freedom)).collect();
        let stiffness = stiffness(&links, &held_by, params);
        let mass = mass(&links.coordinates, machine, params, tool);
        let damping = damping(&links, &held_by, &stiffness, machine, params);
        Self { machine, links, parts, held_by, stiffness, mass, damping }
    }

    /// The coordinates with this role.
    #[must_use]
    pub fn with_part(&self, part: ElasticPart) -> Vec<usize> {
        (0..self.parts.len()).filter(|i| self.parts.get(*i) == Some(&part)).collect()
    }
}

fn part(coordinate: Coordinate, freedom: Freedom) -> ElasticPart {
    match coordinate {
        Coordinate::X | Coordinate::Y | Coordinate::Z | Coordinate::Frame(_) => ElasticPart::Moves,
        Coordinate::Yaw if freedom.yaw => ElasticPart::Moves,
        Coordinate::Yaw => ElasticPart::Held,
        // Spans have none.
        Coordinate::Idler(_) => ElasticPart::Moves,
        Coordinate::Motor(_) if freedom.rotors => ElasticPart::Moves,
        Coordinate::Motor(number) if freedom.free_motor == Some(number) => ElasticPart::GivesWay,
        Coordinate::Motor(_) => ElasticPart::Held,
    }
}

fn held_by(coordinate: Coordinate, machine: Machine, params: &Params, freedom: Freedom) -> f64 {
    match coordinate {
        Coordinate::Yaw => params.bar_yaw_stiffness_nm_per_rad * MM_PER_M,
        Coordinate::Frame(axis) => params.frame_stiffness_n_per_mm.of(axis),
        Coordinate::Motor(number) if freedom.rotors && freedom.free_motor != Some(number) => {
            params.field_stiffness_n_per_mm(machine.index_of(number))
        }
        _ => 0.0,
    }
}

fn stiffness(links: &Links, held_by: &[f64], params: &Params) -> DMatrix<f64> {
    let mut sum = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(held_by));
    for link in &links.links {
        let row = nalgebra::DVector::from_column_slice(&link.row);
        sum += &row * row.transpose() * link.stiffness(params);
    }
    sum
}

/// Belt damping is proportional to belt stiffness; fields have none.
fn damping(
    links: &Links,
    held_by: &[f64],
    stiffness: &DMatrix<f64>,
    machine: Machine,
    params: &Params,
) -> DMatrix<f64> {
    let mut sum = stiffness * params.belt_damping_s;
    for (i, (coordinate, held)) in links.coordinates.iter().zip(held_by).enumerate() {
        sum[(i, i)] -= held * params.belt_damping_s;
        sum[(i, i)] += match coordinate {
            Coordinate::X => params.guide_x_n_s_per_m / MM_PER_M,
            Coordinate::Y => params.guide_y_n_s_per_m / MM_PER_M,
            Coordinate::Z => params.guide_z_n_s_per_m / MM_PER_M,
            Coordinate::Motor(number) => params.rotor_damping_n_s_per_mm(machine.index_of(*number)),
            Coordinate::Frame(axis) => {
                params.frame_damping_n_s_per_mm(*axis, params.frame_mass_kg + machine.carried_kg(params))
            }
            // Both guides of y hold the bar by its ends, each with half of the friction.
            Coordinate::Yaw => params.guide_y_n_s_per_m / MM_PER_M * square(params.width_mm / 2.0),
            Coordinate::Idler(_) => 0.0,
        };
    }
    sum
}

/// The head rides on the bar: when the bar yaws about its middle, the head moves by its distance from there.
fn mass(coordinates: &[Coordinate], machine: Machine, params: &Params, tool: Place) -> DMatrix<f64> {
    let arm = tool.x - params.width_mm / 2.0;
    let head = params.head_mass_kg;
    let [along_x, along_y, up] = machine.masses_kg(params);
    let entry = |a: Coordinate, b: Coordinate| match (a, b) {
        (Coordinate::X, Coordinate::X) => along_x,
        (Coordinate::Y, Coordinate::Y) => along_y,
        (Coordinate::Z, Coordinate::Z) => up,
        (Coordinate::Y | Coordinate::Frame(1), Coordinate::Yaw)
        | (Coordinate::Yaw, Coordinate::Y | Coordinate::Frame(1)) => head * arm,
        (Coordinate::Yaw, Coordinate::Yaw) => params.bar_yaw_inertia_kg_mm2() + head * arm * arm,
        // x and y are counted from the frame, so what moves along them moves with it too.
        (Coordinate::Frame(i), Coordinate::Frame(j)) if i == j => params.frame_mass_kg + machine.carried_kg(params),
        (Coordinate::X, Coordinate::Frame(0)) | (Coordinate::Frame(0), Coordinate::X) => along_x,
        (Coordinate::Y, Coordinate::Frame(1)) | (Coordinate::Frame(1), Coordinate::Y) => along_y,
        (Coordinate::Idler(i), Coordinate::Idler(j)) if i == j => params.idler_mass_kg(),
        (Coordinate::Motor(i), Coordinate::Motor(j)) if i == j => params.rotor_mass_kg(machine.index_of(i)),
        _ => 0.0,
    };
    DMatrix::from_fn(coordinates.len(), coordinates.len(), |i, j| match (coordinates.get(i), coordinates.get(j)) {
        (Some(a), Some(b)) => entry(*a, *b),
        _ => 0.0,
    })
}
