//! Queries: computations on a sample, as figures in columns.

use super::figure::{Figure, LIMITS, MODES, PUSH, RESONANCE, RUN, STIFFNESS};
use super::played::Played;
use crate::sampling::levels;
use corehbot_host::stop::Stop;
use corehbot_questions::play::{RunModel, played};
use corehbot_twin::geometry::workspace;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::limits::{AxisLimits, Limits};
use corehbot_twin::queries::modes::Modes;
use corehbot_twin::queries::push::Push;
use corehbot_twin::queries::resonance::{AxisResonance, Resonance};
use corehbot_twin::queries::stiffness::Stiffness;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::run::RunError;
use corehbot_twin::run::report::Report;
use corehbot_twin::solve::NotHeld;

/// Where questions about a place are asked.
#[derive(Clone, Copy)]
pub(in crate::commands) enum Places {
    /// In the middle of the reach.
    Centre,
    /// At one place.
    At(Place),
    /// At this many columns and rows over the reach; the worst value of each figure counts.
    Worst([usize; 2]),
}

/// A question.
pub(in crate::commands) enum Query {
    Stiffness { places: Places, freedom: Freedom },
    Modes { places: Places, freedom: Freedom },
    Push { places: Places, freedom: Freedom, force_n: [f64; 2] },
    Limits { freedom: Freedom, error_mm: f64, torque_part: f64 },
    Resonance { freedom: Freedom, grid: [usize; 2] },
    Run { file: Played, model: RunModel, begin: Option<Place> },
}

impl Query {
    /// Its columns.
    pub(super) const fn figures(&self) -> &'static [Figure] {
        match self {
            Self::Stiffness { .. } => STIFFNESS,
            Self::Modes { .. } => MODES,
            Self::Push { .. } => PUSH,
            Self::Limits { .. } => LIMITS,
            Self::Resonance { .. } => RESONANCE,
            Self::Run { .. } => RUN,
        }
    }

    /// Reads its file, if it plays one.
    ///
    /// # Errors
    /// It cannot be played, or it was stopped.
    pub(super) fn load(&self, stop: &Stop) -> anyhow::Result<()> {
        match self {
            Self::Run { file, .. } => file.load(stop),
            _ => Ok(()),
        }
    }

    /// Whether there is nothing to be read any more.
    pub(super) fn is_loaded(&self) -> bool {
        !matches!(self, Self::Run { file, .. } if file.source().is_none())
    }

    /// Its figures of one machine, in the order of the columns.
    ///
    /// # Errors
    /// This machine has no answer, or it was stopped.
    pub(super) fn answer(&self, machine: Machine, params: &Params, stop: &Stop) -> Result<Vec<f64>, NoAnswer> {
        let setup = |tool, freedom| Setup { machine, params: params.clone(), tool, freedom };
        let middle = |freedom| setup(workspace(machine, params).centre(), freedom);
        match self {
            Self::Stiffness { places, freedom } => self.worst(places, machine, params, |tool| {
                let Stiffness { kxx, kyy, kxy, softest, .. } = Stiffness::new(&setup(tool, *freedom))?;
                Ok(vec![kxx, kyy, kxy, softest])
            }),
            Self::Modes { places, freedom } => self.worst(places, machine, params, |tool| {
                let modes = Modes::new(&setup(tool, *freedom))?.frequencies_hz;
                Ok([0, 1].map(|i| modes.get(i).copied().unwrap_or(f64::NAN)).to_vec())
            }),
            Self::Push { places, freedom, force_n } => self.worst(places, machine, params, |tool| {
                let strain = Push::new(&setup(tool, *freedom), *force_n)?.strain;
                let torque = strain.motor_torque_mnm.iter().map(|torque| torque.abs()).fold(0.0, f64::max);
                Ok(vec![strain.dx_mm, strain.dy_mm, torque])
            }),
            Self::Limits { freedom, error_mm, torque_part } => {
                let limits = Limits::new(&middle(*freedom), *error_mm, *torque_part)?;
                let figures = [axis_limits(&limits.x), axis_limits(&limits.y)].concat();
                Ok([figures, vec![limits.yaw_error_um_per_m_s2.unwrap_or(f64::NAN)]].concat())
            }
            Self::Resonance { freedom, grid: [columns, rows] } => {
                let resonance = Resonance::new(&middle(*freedom), *columns, *rows)?;
                Ok([axis_resonance(&resonance.x), axis_resonance(&resonance.y)].concat())
            }
            Self::Run { file, model, begin } => {
                let source = file.source().ok_or(NoAnswer::NotLoaded)?;
                let firmware = workspace(machine, params).of_gcode(source.begin);
                let start = begin.unwrap_or(firmware);
                let (report, _) = played(machine, params, start, *model, (&source.steps, None), |_| !stop.is_set())?;
                Ok(run_figures(&report))
            }
        }
    }

    /// At one place, or the worst of many.
    fn worst(
        &self,
        places: &Places,
        machine: Machine,
        params: &Params,
        at: impl Fn(Place) -> Result<Vec<f64>, NotHeld>,
    ) -> Result<Vec<f64>, NoAnswer> {
        let reach = workspace(machine, params);
        let [columns, rows] = match *places {
            Places::Centre => return Ok(at(reach.centre())?),
            Places::At(tool) if reach.has(reach.at(tool.x, tool.y)) => return Ok(at(reach.at(tool.x, tool.y))?),
            Places::At(tool) => return Err(NoAnswer::OutOfReach(tool)),
            Places::Worst(grid) => grid,
        };
        let (xs, ys) = (levels(reach.x, columns), levels(reach.y, rows));
        let mut worst = vec![f64::NAN; self.figures().len()];
        for tool in ys.iter().flat_map(|y| xs.iter().map(|x| reach.at(*x, *y))) {
            for ((worst, column), figure) in worst.iter_mut().zip(self.figures()).zip(at(tool)?) {
                *worst = column.worse(*worst, figure);
            }
        }
        Ok(worst)
    }
}

fn axis_limits(axis: &AxisLimits) -> Vec<f64> {
    vec![
        axis.torque_acceleration_mm_s2,
        axis.slack_acceleration_mm_s2,
        axis.ringing_acceleration_mm_s2,
        axis.speed_jump_mm_s,
        axis.slip_jump_mm_s,
    ]
}

fn axis_resonance(axis: &AxisResonance) -> Vec<f64> {
    let [lowest, highest] = axis.band_hz;
    let residual = axis.suggestion.map_or(f64::NAN, |shaper| shaper.worst_residual);
    vec![lowest, highest, axis.coupling, axis.damping_ratio, residual]
}

fn run_figures(report: &Report) -> Vec<f64> {
    let motors = || report.motors.iter();
    vec![
        report.contour.max_mm,
        report.contour.rms_mm,
        motors().map(|motor| motor.torque_max_mnm).fold(0.0, f64::max),
        motors().map(|motor| motor.margin).fold(f64::INFINITY, f64::min),
        f64::from(motors().map(|motor| motor.slips).sum::<u32>()),
        report.tension_n.values().map(|[least, _]| *least).fold(f64::INFINITY, f64::min),
    ]
}

/// Why a sample has no figures.
#[derive(Debug)]
pub(super) enum NoAnswer {
    /// The tool does not come to the place.
    OutOfReach(Place),
    /// Nothing holds the machine.
    NotHeld(NotHeld),
    /// The file that is played was not read.
    NotLoaded,
    /// The file cannot be played.
    Run(RunError),
}

impl From<NotHeld> for NoAnswer {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

impl From<RunError> for NoAnswer {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl std::fmt::Display for NoAnswer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OutOfReach(Place { x, y, .. }) => write!(f, "the tool does not reach ({x:.1}, {y:.1})"),
            Self::NotHeld(error) => error.fmt(f),
            Self::NotLoaded => f.write_str("the G-code to play was not read"),
            Self::Run(error) => error.fmt(f),
        }
    }
}
