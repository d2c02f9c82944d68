//! Compare: mechanisms of one size, with one belt and the same masses, over one area.

use super::resonance::points;
use super::stiffness::Stiffness;
use super::{Setup, shown};
use crate::geometry::{Workspace, layout, workspace};
use crate::model::coordinate::Coordinate;
use crate::model::elastic::{Elastic, Freedom};
use crate::params::Params;
use crate::routing::{Machine, Place};
use crate::solve::NotHeld;
use crate::solve::balance::condensed;
use crate::solve::modes::modes;
use serde::Serialize;

/// The mechanisms that are compared.
pub const COMPARED: [Machine; 3] = [Machine::CoreHBot, Machine::HBot, Machine::CoreXy];

/// Several machines over one area.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compare {
    /// Left and right end of the area.
    pub x_mm: [f64; 2],
    /// Its front and back.
    pub y_mm: [f64; 2],
    /// The force that deflects the tool.
    #[serde(rename = "force_N")]
    pub force_n: f64,
    /// The machines.
    pub machines: Vec<Compared>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Its name.
    pub machine: &'static str,
    /// All of its belts.
    pub belt_mm: f64,
    /// Area that the tool reaches.
    pub reach_mm2: f64,
    /// Stiffness in the middle of the area.
    #[serde(rename = "centre_N_per_mm")]
    pub centre_n_per_mm: [f64; 2],
    /// Stiffness of the softest direction: at the softest place and at the stiffest.
    #[serde(rename = "softest_N_per_mm")]
    pub softest_n_per_mm: [f64; 2],
    /// How far the force moves the tool at most.
    pub deflection_um: f64,
    /// Slowest and fastest first mode.
    #[serde(rename = "first_mode_Hz")]
    pub first_mode_hz: [f64; 2],
    /// Greatest stiffness between x and y.
    #[serde(rename = "coupling_N_per_mm")]
    pub coupling_n_per_mm: f64,
    /// What the belts alone resist the bar's yaw with, in the middle of the area.
    #[serde(rename = "belt_yaw_stiffness_Nm_per_rad")]
    pub belt_yaw_stiffness_nm_per_rad: f64,
}

impl Compare {
    /// Over the area that all of them reach, or another one, at so many columns and rows of it.
    ///
    /// # Errors
    /// Nothing holds a machine.
    pub fn new(
        params: &Params,
        freedom: Freedom,
        area: Option<Workspace>,
        [columns, rows]: [usize; 2],
        force_n: f64,
    ) -> Result<Self, NotHeld> {
        let area = area.unwrap_or_else(|| common(params));
        let (xs, ys) = (points(area.x, columns), points(area.y, rows));
        let places: Vec<Place> = ys.iter().flat_map(|y| xs.iter().map(|x| Place { x: *x, y: *y })).collect();
        let one = |machine| compared(machine, params, freedom, area.centre(), &places, force_n);
        let machines = COMPARED.into_iter().map(one).collect::<Result<_, _>>()?;
        Ok(Self { x_mm: area.x, y_mm: area.y, force_n, machines })
    }
}

/// What every machine reaches.
#[must_use]
pub fn common(params: &Params) -> Workspace {
    let all = COMPARED.map(|machine| workspace(machine, params));
    let widest = Workspace { x: [f64::NEG_INFINITY, f64::INFINITY], y: [f64::NEG_INFINITY, f64::INFINITY] };
    let both = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.min(d)];
    all.into_iter().fold(widest, |area, reach| Workspace { x: both(area.x, reach.x), y: both(area.y, reach.y) })
}

fn compared(
    machine: Machine,
    params: &Params,
    freedom: Freedom,
    centre: Place,
    places: &[Place],
    force_n: f64,
) -> Result<Compared, NotHeld> {
    let setup = |tool| Setup { machine, params: params.clone(), tool, freedom };
    let mut softest_n_per_mm = [f64::INFINITY, 0.0];
    let mut first_mode_hz = [f64::INFINITY, 0.0];
    let mut coupling_n_per_mm = 0.0_f64;
    let take = |range: &mut [f64; 2], v: f64| *range = [range[0].min(v), range[1].max(v)];
    for place in places {
        let setup = setup(*place);
        let stiffness = Stiffness::new(&setup)?;
        take(&mut softest_n_per_mm, stiffness.softest);
        coupling_n_per_mm = coupling_n_per_mm.max(stiffness.kxy.abs());
        take(&mut first_mode_hz, modes(&setup.elastic())?.first().map_or(0.0, |mode| mode.frequency_hz));
    }
    let middle = Stiffness::new(&setup(centre))?;
    let reach = workspace(machine, params);
    Ok(Compared {
        machine: machine.key(),
        belt_mm: layout(machine, params, centre).belt_lengths_mm.iter().sum(),
        reach_mm2: (reach.x[1] - reach.x[0]) * (reach.y[1] - reach.y[0]),
        centre_n_per_mm: [middle.kxx, middle.kyy],
        softest_n_per_mm,
        deflection_um: 1000.0 * force_n / softest_n_per_mm[0],
        first_mode_hz,
        coupling_n_per_mm,
        belt_yaw_stiffness_nm_per_rad: belt_yaw(machine, params, centre)?,
    })
}

/// With guides that resist nothing, motors that hold, and the tool free to give way.
fn belt_yaw(machine: Machine, params: &Params, tool: Place) -> Result<f64, NotHeld> {
    let loose = Params { bar_yaw_stiffness_nm_per_rad: 0.0, ..params.clone() };
    let elastic = Elastic::new(machine, &loose, tool, Freedom { yaw: true, ..Freedom::default() });
    let yaw = elastic.links.index(Coordinate::Yaw).ok_or(NotHeld)?;
    Ok(condensed(&elastic, &[yaw])?[(0, 0)] / 1000.0)
}

impl std::fmt::Display for Compare {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ([left, right], [front, back]) = (self.x_mm, self.y_mm);
        writeln!(f, "x {left:.1} to {right:.1}, y {front:.1} to {back:.1} mm")?;
        let name = |key| Machine::ALL.into_iter().find(|m| m.key() == key).map_or(key, Machine::name);
        let head: Vec<String> = self.machines.iter().map(|m| format!("{:>18}", name(m.machine))).collect();
        writeln!(f, "  {:<34}{}", "", head.concat())?;
        let mut row = |what: &str, figure: &dyn Fn(&Compared) -> String| {
            let figures: Vec<String> = self.machines.iter().map(|m| format!("{:>18}", figure(m))).collect();
            writeln!(f, "  {what:<34}{}", figures.concat())
        };
        let pair = |[a, b]: [f64; 2], sign: &str| format!("{a:.1}{sign}{b:.1}");
        row("belt, mm", &|m| shown(m.belt_mm, 0))?;
        row("reach, cm2", &|m| shown(m.reach_mm2 / 100.0, 0))?;
        row("Kxx / Kyy in the middle, N/mm", &|m| pair(m.centre_n_per_mm, " / "))?;
        row("softest direction, N/mm", &|m| pair(m.softest_n_per_mm, " to "))?;
        row(&format!("{} N move the tool by, um", self.force_n), &|m| shown(m.deflection_um, 1))?;
        row("greatest |Kxy|, N/mm", &|m| shown(m.coupling_n_per_mm, 1))?;
        row("first mode, Hz", &|m| pair(m.first_mode_hz, " to "))?;
        row("belts resist yaw, N m/rad", &|m| shown(m.belt_yaw_stiffness_nm_per_rad, 0))
    }
}
