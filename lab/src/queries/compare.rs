//! Compare: mechanisms of one size, with one belt and the same masses, over one area.

use super::frame::FrameTorque;
use corehbot_twin::geometry::{Workspace, greatest, layout, workspace};
use corehbot_twin::math::hypot;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::{Elastic, Freedom};
use corehbot_twin::params::Params;
use corehbot_twin::queries::stiffness::Stiffness;
use corehbot_twin::queries::{Setup, shown};
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::solve::NotHeld;
use corehbot_twin::solve::balance::condensed;
use corehbot_twin::solve::modes::{Ringing, modes};
use nalgebra::DVector;
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
    /// Length of all its belts.
    pub belt_mm: f64,
    /// Area that the tool reaches.
    pub reach_mm2: f64,
    /// Stiffness in the middle of the area.
    #[serde(rename = "centre_N_per_mm")]
    pub centre_n_per_mm: [f64; 2],
    /// Stiffness of the softest direction: at the softest place and at the stiffest.
    #[serde(rename = "softest_N_per_mm")]
    pub softest_n_per_mm: [f64; 2],
    /// Largest deflection of the tool by the force.
    pub deflection_um: f64,
    /// Lowest and highest first mode.
    #[serde(rename = "first_mode_Hz")]
    pub first_mode_hz: [f64; 2],
    /// Largest stiffness between x and y.
    #[serde(rename = "coupling_N_per_mm")]
    pub coupling_n_per_mm: f64,
    /// Resistance of the belts alone to the bar's yaw, in the middle of the area.
    #[serde(rename = "belt_yaw_stiffness_Nm_per_rad")]
    pub belt_yaw_stiffness_nm_per_rad: f64,
    /// Tool error by yaw of the bar on its guides for 1 m/s2 along x, at the worst place, at rest.
    pub racking_x_um_per_m_s2: f64,
    /// The same along y.
    pub racking_y_um_per_m_s2: f64,
    /// Torque of all motors on the frame, along x.
    pub frame_torque_x: FrameTorque,
    /// The same along y.
    pub frame_torque_y: FrameTorque,
    /// Lowest frequency of a soft frame in x and in y; none of a rigid one.
    #[serde(rename = "frame_modes_Hz", skip_serializing_if = "Option::is_none")]
    pub frame_modes_hz: Option<[f64; 2]>,
}

impl Compare {
    /// Compares them over the area that all of them reach, or another one. The search for the worst places begins with
    /// this many columns and rows of it.
    ///
    /// # Errors
    /// Nothing holds a machine.
    pub fn new(
        params: &Params,
        freedom: Freedom,
        area: Option<Workspace>,
        grid: [usize; 2],
        force_n: f64,
    ) -> Result<Self, NotHeld> {
        let area = area.unwrap_or_else(|| common(params));
        let one = |machine| compared(machine, params, freedom, &area, grid, force_n);
        let machines = COMPARED.into_iter().map(one).collect::<Result<_, _>>()?;
        Ok(Self { x_mm: area.x, y_mm: area.y, force_n, machines })
    }
}

/// The area that every machine reaches.
#[must_use]
pub fn common(params: &Params) -> Workspace {
    let all = COMPARED.map(|machine| workspace(machine, params));
    const WIDEST: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
    let widest = Workspace { x: WIDEST, y: WIDEST, z: WIDEST };
    let both = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.min(d)];
    all.into_iter().fold(widest, |area, reach| Workspace {
        x: both(area.x, reach.x),
        y: both(area.y, reach.y),
        z: both(area.z, reach.z),
    })
}

fn compared(
    machine: Machine,
    params: &Params,
    freedom: Freedom,
    area: &Workspace,
    grid: [usize; 2],
    force_n: f64,
) -> Result<Compared, NotHeld> {
    let setup = |tool| Setup { machine, params: params.clone(), tool, freedom };
    let centre = area.centre();
    // The least of a figure is the greatest with the other sign.
    let [least, stiffest, lowest, highest, coupling_n_per_mm, frame_x, frame_y, racking_x, racking_y] =
        greatest(area, grid, |place| {
            let setup = setup(place);
            let stiffness = Stiffness::new(&setup)?;
            let modes = modes(&setup.elastic())?;
            let first = modes.first().map_or(0.0, |mode| mode.frequency_hz);
            let [frame_x, frame_y] = [Coordinate::X, Coordinate::Y].map(|axis| {
                let frame = Ringing::of(&modes, axis).and_then(|ringing| ringing.frame);
                frame.map_or(f64::NEG_INFINITY, |mode| -mode.frequency_hz)
            });
            let [racking_x, racking_y] = racking_um(machine, params, place)?;
            let (soft, kxy) = (stiffness.softest, stiffness.kxy.abs());
            Ok::<_, NotHeld>([-soft, soft, -first, first, kxy, frame_x, frame_y, racking_x, racking_y])
        })?;
    let (softest_n_per_mm, first_mode_hz) = ([-least, stiffest], [-lowest, highest]);
    let frame_modes_hz = params.frame_stiffness_n_per_mm.get(0).map(|_| [-frame_x, -frame_y]);
    let middle = Stiffness::new(&setup(centre))?;
    let reach = workspace(machine, params);
    let [frame_torque_x, frame_torque_y] = FrameTorque::new(machine, params, centre)?;
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
        racking_x_um_per_m_s2: racking_x,
        racking_y_um_per_m_s2: racking_y,
        frame_torque_x,
        frame_torque_y,
        frame_modes_hz,
    })
}

/// Displacement of the tool, relative to a bar that cannot yaw, for a lasting 1 m/s2 along x and along y. Every moving
/// part is pulled back by its mass.
fn racking_um(machine: Machine, params: &Params, tool: Place) -> Result<[f64; 2], NotHeld> {
    let elastic = Elastic::new(machine, params, tool, Freedom { yaw: true, ..Freedom::default() });
    let index = |coordinate| elastic.links.index(coordinate).ok_or(NotHeld);
    let kept = [index(Coordinate::X)?, index(Coordinate::Y)?, index(Coordinate::Yaw)?];
    let stiffness = condensed(&elastic, &kept)?;
    let translation = stiffness.view((0, 0), (2, 2)).into_owned().cholesky().ok_or(NotHeld)?;
    let all = stiffness.cholesky().ok_or(NotHeld)?;
    let aside = |axis: usize| {
        // 1 kg times 1 m/s2 is 1 N; 1 kg mm gives 1 N mm.
        let force = DVector::from_iterator(3, kept.iter().map(|i| -elastic.mass[(*i, kept[axis])]));
        let (moved, square) = (all.solve(&force), translation.solve(&force.rows(0, 2).into_owned()));
        1000.0 * hypot(moved[0] - square[0], moved[1] - square[1] + moved[2] * (tool.x - params.width_mm / 2.0))
    };
    Ok([aside(0), aside(1)])
}

/// With guides that do not resist, holding motors and a free tool.
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
        let name = Machine::name_of;
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
        row("belts resist yaw, N m/rad", &|m| shown(m.belt_yaw_stiffness_nm_per_rad, 0))?;
        row("racking by 1 m/s2 of x, um", &|m| shown(m.racking_x_um_per_m_s2, 1))?;
        row("racking by 1 m/s2 of y, um", &|m| shown(m.racking_y_um_per_m_s2, 1))?;
        row("torque on the frame, x, mN m", &|m| shown(m.frame_torque_x.belts_mnm, 2))?;
        row("  as the paper prints it", &|m| shown(m.frame_torque_x.printed_mnm, 2))?;
        row("  with rotors", &|m| shown(m.frame_torque_x.belts_mnm + m.frame_torque_x.rotors_mnm, 2))?;
        row("torque on the frame, y, mN m", &|m| shown(m.frame_torque_y.belts_mnm, 2))?;
        if self.machines.iter().any(|m| m.frame_modes_hz.is_some()) {
            row("frame in x / y, Hz", &|m| m.frame_modes_hz.map_or(String::new(), |hz| pair(hz, " / ")))?;
        }
        Ok(())
    }
}
