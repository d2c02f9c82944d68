//! Measures the remaining error on the machine with rotors, and the part of it that the machine does not cause.

use anyhow::{Result, bail};
use corehbot_host::progress::Progress;
use corehbot_host::stop::Stop;
use corehbot_questions::play::{RunModel, played};
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use corehbot_twin::steps::StepTrace;
use rayon::iter::{IndexedParallelIterator as _, IntoParallelRefIterator as _, ParallelIterator as _};
use serde::Serialize;

/// Belts and fields that hardly give way are this many times as stiff.
const RIGID: f64 = 50.0;

/// A machine that rings faster needs shorter steps of integration: with first-print it takes twice as long, as
/// measured.
const LONGER: f64 = 2.0;

/// Stiffness that is believed, too low and too high.
const SCALES: [f64; 2] = [0.8, 1.2];

/// RMS and greatest error in um.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Error {
    rms_um: f64,
    max_um: f64,
}

/// The remaining errors.
#[derive(Serialize)]
pub(super) struct Measured {
    /// As the file is.
    before: Error,
    /// Compensated by the machine's true values.
    after: Error,
    /// By belts and fields 20 % softer than they are.
    too_soft: Error,
    /// By belts and fields 20 % stiffer.
    too_stiff: Error,
    /// As the file is, where next to nothing gives way: the error of steps.
    rigid: Error,
    /// RMS before over RMS after.
    divided: f64,
    /// The same with stiffness off, the worse of both.
    divided_off: f64,
    /// The same three with the square of the rigid machine's error taken off.
    divided_without_steps: Option<f64>,
    divided_off_without_steps: Option<f64>,
    /// The most that anything could divide it by that leaves the steps as they are.
    divided_at_most: f64,
}

impl Measured {
    pub(super) fn new(
        (machine, params, model): (Machine, &Params, RunModel),
        start: Place,
        meant: &StepTrace,
        bent: &StepTrace,
        believing: impl Fn(&Params) -> Result<StepTrace>,
        stop: &Stop,
    ) -> Result<Self> {
        let [soft, stiff] = SCALES.map(|times| believing(&times_as_stiff(params, times)));
        let (soft, stiff, rigid) = (soft?, stiff?, times_as_stiff(params, RIGID));
        let jobs = [
            (params, meant, 1.0),
            (params, bent, 1.0),
            (params, &soft, 1.0),
            (params, &stiff, 1.0),
            (&rigid, meant, LONGER),
        ];
        let progress = Progress::new(jobs.map(|(_, _, weight)| weight));
        let error = |(index, (params, steps, _)): (usize, &(&Params, &StepTrace, f64))| -> Result<Error> {
            let (report, _) = progress
                .piece(index, stop, |go_on| played(machine, params, start, model, (steps, Some(meant)), go_on))?;
            Ok(Error { rms_um: 1000.0 * report.contour.rms_mm, max_um: 1000.0 * report.contour.max_mm })
        };
        // The longest first, so that no processor waits for it at the end.
        let errors: Vec<Error> = jobs.par_iter().enumerate().rev().with_max_len(1).map(error).collect::<Result<_>>()?;
        drop(progress);
        let [rigid, too_stiff, too_soft, after, before] = errors[..] else { bail!("not all runs were played") };
        let off = too_soft.rms_um.max(too_stiff.rms_um);
        let without = |rms_um: f64| {
            let square = rms_um * rms_um - rigid.rms_um * rigid.rms_um;
            (square > 0.0).then(|| square.sqrt())
        };
        let divided_by = |rms_um: f64| Some(without(before.rms_um)? / without(rms_um)?);
        Ok(Self {
            before,
            after,
            too_soft,
            too_stiff,
            rigid,
            divided: before.rms_um / after.rms_um,
            divided_off: before.rms_um / off,
            divided_without_steps: divided_by(after.rms_um),
            divided_off_without_steps: divided_by(off),
            divided_at_most: before.rms_um / rigid.rms_um,
        })
    }
}

fn times_as_stiff(params: &Params, times: f64) -> Params {
    Params {
        belt_ea_n: params.belt_ea_n.times(times),
        holding_torque_nm: times * params.holding_torque_nm,
        ..params.clone()
    }
}

impl std::fmt::Display for Measured {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "error on the machine with rotors, um      RMS   greatest")?;
        for (name, Error { rms_um, max_um }) in [
            ("as it is", self.before),
            ("compensated", self.after),
            ("by stiffness 20 % too low", self.too_soft),
            ("by stiffness 20 % too high", self.too_stiff),
            ("as it is, nothing gives way", self.rigid),
        ] {
            writeln!(f, "  {name:<36}{rms_um:>7.2}{max_um:>11.1}")?;
        }
        writeln!(f, "RMS is divided by {:.2}, with stiffness off by {:.2};", self.divided, self.divided_off)?;
        writeln!(f, "steps leave room for {:.2}.", self.divided_at_most)?;
        let text = |divided: Option<f64>| divided.map_or("none that can be told".to_owned(), |by| format!("{by:.2}"));
        let [exact, off] = [self.divided_without_steps, self.divided_off_without_steps].map(text);
        writeln!(f, "Without the error of steps it is divided by {exact}, with stiffness off by {off}.")
    }
}
