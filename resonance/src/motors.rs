//! Motors: what a group of motors does to the tool, by the frequency of its turns and steps.
//!
//! A motor that turns evenly shakes the tool once an electrical turn (an offset of a phase's current), twice (phases of
//! unlike strength) and four times (full steps, detent). These are orders of its speed, so each run has them at
//! frequencies that are known. The force of an order does not depend on the speed. So the amplitude of the tool at it,
//! over all speeds, is the response of the machine from the motor to the tool, times a strength of each order. This is
//! an order analysis of a run-up (A. Brandt, Noise and Vibration Analysis, 2011, chapter 12). Modes are fitted to it.
//!
//! Motors that turn together cannot be told apart here: their orders have the same frequencies. Directions along which
//! one group turns and the others stand tell the groups apart.

use crate::modes::{Mode, Modes, Unfitted, fit_sources};
use crate::run::{BAND_HZ, Run};
use crate::spectrum::{Spectrum, WINDOW_S};
use serde::Serialize;
use std::f64::consts::TAU;

/// Kaiser's window with beta 6 has its first zeros `(1 + (beta / pi)^2)^(1/2) = 2.2` places from the middle (Kaiser,
/// 1974). A tone is within as many places, and one more for a frequency between two.
const TONE: usize = 3;

/// Places to each side that tell the noise around a tone.
const AROUND: usize = 12;

/// A tone has this many times the power of the noise around it.
const CLEAR: f64 = 4.0;

/// Above this part of the rate a sensor's filter attenuates.
const OF_RATE: f64 = 0.4;

/// Fewest places of an order that counts, and fewest around a mode that tell its damping.
const FEWEST: usize = 8;
const FEWEST_AT_MODE: usize = 3;

/// A group turns alone if the others make at most this part of its steps.
const STANDS: f64 = 0.01;

/// Motors that always turn together.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Their names.
    pub motors: String,
    /// Full steps per mm of the tool in x and in y.
    pub full_steps_per_mm: [f64; 2],
}

/// What a motor does again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Repeat {
    /// Once in four full steps.
    ElectricalTurn,
    /// Once in two full steps.
    HalfTurn,
    /// Once in a full step.
    FullStep,
}

impl Repeat {
    const ALL: [Self; 3] = [Self::ElectricalTurn, Self::HalfTurn, Self::FullStep];

    const fn full_steps(self) -> f64 {
        match self {
            Self::ElectricalTurn => 4.0,
            Self::HalfTurn => 2.0,
            Self::FullStep => 1.0,
        }
    }
}

/// Motion of the tool at the frequency of an order, over all speeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Order {
    /// What repeats.
    pub repeats: Repeat,
    /// Amplitude without a resonance, by the fit: the error of the motors as the tool has it in slow motion.
    pub slow_um: Option<f64>,
    /// Frequencies, ascending.
    #[serde(rename = "frequencies_Hz")]
    pub frequencies_hz: Vec<f64>,
    /// Speed of the tool at each.
    pub speeds_mm_s: Vec<f64>,
    /// Amplitude of the tool at each.
    pub amplitudes_um: Vec<f64>,
    /// The fitted ones; empty without a fit.
    pub fitted_um: Vec<f64>,
}

/// A group of motors, and what it does to the tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motors {
    /// Its motors.
    pub motors: String,
    /// The direction along which they turn alone.
    pub angle_deg: f64,
    /// Runs along it.
    pub runs: usize,
    /// Distance of the frequencies of `density`; the first is 0.
    #[serde(rename = "step_Hz")]
    pub step_hz: f64,
    /// Mean power spectral density of all runs, so of all speeds.
    #[serde(rename = "density_mm2_s4_Hz")]
    pub density: Vec<f64>,
    /// Orders that are above the noise.
    pub orders: Vec<Order>,
    /// Modes that they excite, the strongest first.
    pub modes: Vec<Mode>,
    /// Root mean square of the fit's differences, in dB.
    #[serde(rename = "fit_error_dB")]
    pub fit_error_db: Option<f64>,
    /// Why a figure is missing or coarse.
    pub remarks: Vec<String>,
}

/// The groups that a measured direction turns alone.
pub(crate) fn motors(runs: &[Run], drives: &[Drive]) -> Vec<Motors> {
    let rate = |drive: &Drive, angle: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        (drive.full_steps_per_mm[0] * cos + drive.full_steps_per_mm[1] * sin).abs()
    };
    let alone = |drive: &Drive, run: &&Run| {
        let own = rate(drive, run.angle_deg);
        drives.iter().all(|other| other == drive || rate(other, run.angle_deg) <= STANDS * own)
    };
    let one = |drive: &Drive| {
        let own: Vec<&Run> = runs.iter().filter(|run| run.speed_mm_s > 0.0 && alone(drive, run)).collect();
        let first = own.first()?;
        Some(of_group(drive, &own, |run| run.speed_mm_s * rate(drive, run.angle_deg), first.angle_deg))
    };
    drives.iter().filter_map(one).collect()
}

fn of_group(drive: &Drive, runs: &[&Run], full_steps_hz: impl Fn(&Run) -> f64, angle_deg: f64) -> Motors {
    let orders = Repeat::ALL.map(|repeats| order(repeats, runs, |run| full_steps_hz(run) / repeats.full_steps()));
    let mut orders: Vec<Order> = orders.into_iter().filter(|order| order.amplitudes_um.len() >= FEWEST).collect();
    let (mut remarks, mut modes, mut fit_error_db) = (Vec::new(), Vec::new(), None);
    match fit(&orders) {
        Ok(fitted) => {
            put(&mut orders, &fitted);
            modes = fitted.modes;
            fit_error_db = Some(fitted.fit_error_db);
            if let Some(mode) = modes.first().filter(|mode| at(&orders, mode) < FEWEST_AT_MODE) {
                remarks.push(format!(
                    "too few speeds meet {:.0} Hz to tell the damping: record smaller steps of speed",
                    mode.frequency_hz
                ));
            }
        }
        Err(Unfitted::Short) => remarks.push("no order of these motors is above the noise at eight speeds".to_owned()),
        Err(Unfitted::Flat | Unfitted::Unclear) => {
            remarks.push("no mode was found: their orders have no peak".to_owned())
        }
    }
    let (step_hz, density) = mean_density(runs);
    Motors {
        motors: drive.motors.clone(),
        angle_deg,
        runs: runs.len(),
        step_hz,
        density,
        orders,
        modes,
        fit_error_db,
        remarks,
    }
}

/// An order in each run where it is above the noise.
fn order(repeats: Repeat, runs: &[&Run], hz: impl Fn(&Run) -> f64) -> Order {
    let found = |run: &&Run| {
        let hz = hz(run);
        let amplitude = tone(&run.spectrum, hz)?.sqrt() / (TAU * hz).powi(2) * 1e3;
        Some((hz, run.speed_mm_s, amplitude))
    };
    let mut all: Vec<(f64, f64, f64)> = runs.iter().filter_map(found).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    Order {
        repeats,
        slow_um: None,
        frequencies_hz: all.iter().map(|one| one.0).collect(),
        speeds_mm_s: all.iter().map(|one| one.1).collect(),
        amplitudes_um: all.iter().map(|one| one.2).collect(),
        fitted_um: Vec::new(),
    }
}

/// Square of the amplitude of the acceleration at a frequency, in (mm/s^2)^2; nothing if it is not above the noise.
fn tone(spectrum: &Spectrum, hz: f64) -> Option<f64> {
    let psd = &spectrum.sum;
    // Half of the rate is the last place.
    let most = BAND_HZ[1].min(2.0 * OF_RATE * (psd.len() - 1) as f64 * spectrum.step_hz);
    let middle = (hz / spectrum.step_hz).round() as usize;
    if !(BAND_HZ[0]..=most).contains(&hz) || middle <= TONE {
        return None;
    }
    let own = psd.get(middle - TONE..=middle + TONE)?;
    let around = (middle.saturating_sub(AROUND)..middle - TONE).chain(middle + TONE + 1..=middle + AROUND);
    let mut around: Vec<f64> = around.filter_map(|i| psd.get(i).copied()).collect();
    around.sort_by(f64::total_cmp);
    let noise = around.get(around.len() / 2)? * own.len() as f64;
    let power = own.iter().sum::<f64>();
    // The mean square of a sine is half of its amplitude's square.
    (power > CLEAR * noise).then_some(2.0 * (power - noise) * spectrum.step_hz)
}

fn fit(orders: &[Order]) -> Result<Modes, Unfitted> {
    let point = |source: usize, (hz, um): (&f64, &f64)| (*hz, 2.0 * um.ln(), source);
    let mut points: Vec<(f64, f64, usize)> = orders
        .iter()
        .enumerate()
        .flat_map(|(i, order)| order.frequencies_hz.iter().zip(&order.amplitudes_um).map(move |all| point(i, all)))
        .collect();
    if points.is_empty() {
        return Err(Unfitted::Short);
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    fit_sources(&points, orders.len())
}

/// Puts the fit into the orders, each with the strength that suits it best.
fn put(orders: &mut [Order], fitted: &Modes) {
    let slow = fitted.modes.iter().map(|mode| mode.part * mode.part).sum::<f64>().sqrt();
    for order in orders {
        let response: Vec<f64> = order.frequencies_hz.iter().map(|hz| response(&fitted.modes, *hz)).collect();
        let ratios = order.amplitudes_um.iter().zip(&response).map(|(um, response)| (um / response).ln());
        let strength = (ratios.sum::<f64>() / response.len().max(1) as f64).exp();
        order.slow_um = Some(strength * slow);
        order.fitted_um = response.iter().map(|response| strength * response).collect();
    }
}

/// Root of the sum of the modes' powers.
fn response(modes: &[Mode], hz: f64) -> f64 {
    let power = |mode: &Mode| {
        let r = hz / mode.frequency_hz;
        mode.part * mode.part / ((1.0 - r * r).powi(2) + (2.0 * mode.damping_ratio * r).powi(2))
    };
    modes.iter().map(power).sum::<f64>().sqrt()
}

/// Places within twice the half width of a mode's peak.
fn at(orders: &[Order], mode: &Mode) -> usize {
    let is_near = |hz: &&f64| (*hz / mode.frequency_hz - 1.0).abs() <= 2.0 * mode.damping_ratio;
    orders.iter().flat_map(|order| &order.frequencies_hz).filter(is_near).count()
}

/// Mean of all runs, at the frequencies of the first, up to the end of the band.
fn mean_density(runs: &[&Run]) -> (f64, Vec<f64>) {
    let step_hz = runs.first().map_or(1.0 / WINDOW_S, |run| run.spectrum.step_hz);
    let count = (BAND_HZ[1] / step_hz) as usize + 1;
    let mean =
        |i: usize| runs.iter().map(|run| run.spectrum.at(i as f64 * step_hz)).sum::<f64>() / runs.len().max(1) as f64;
    (step_hz, (0..count).map(mean).collect())
}
