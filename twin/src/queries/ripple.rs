//! Ripple: fine waves on walls by speed and angle, and what lowers them.
//!
//! Each source ([`crate::ripple`]) moves the tool by a sine. Phases of different sources are not known, so amplitudes
//! add as the root of the sum of squares; where all phases meet, they add up. Only the part across the path is on the
//! wall. Waves longer than a limit are an error of shape and no ripple: they are told apart.
//!
//! The worst direction of a speed is one of even distances, or one in which a source meets a mode. Close to a diagonal
//! one pair of motors turns slowly, and meets a mode within a tenth of a degree.

use super::{At, Setup, shown};
use crate::params::Params;
use crate::ripple::quiet::quiet_and_loud;
use crate::ripple::response::{Response, Shaken};
use crate::ripple::source::{Amounts, RippleKind};
use crate::solve::NotHeld;
use serde::Serialize;

/// Currents that are tried, over the run current: a motor's torque is in proportion.
const CURRENTS: [f64; 5] = [0.5, 0.75, 1.0, 1.25, 1.5];

/// Directions of walls along x and y, in degrees.
const STRAIGHT_DEG: [f64; 2] = [0.0, 90.0];

/// Why there is no ripple.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RippleError {
    /// Nothing holds the machine.
    NotHeld(NotHeld),
    /// Nothing damps the bar's yaw, so its ripple at resonance has no bound.
    Undamped,
}

impl From<NotHeld> for RippleError {
    fn from(error: NotHeld) -> Self {
        Self::NotHeld(error)
    }
}

impl std::fmt::Display for RippleError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotHeld(error) => error.fmt(f),
            Self::Undamped => f.write_str(
                "guide_y_N_s_per_m is 0, so nothing damps the bar's yaw and its ripple has no bound: give [twin] the \
                 guides' friction, or leave out the yaw",
            ),
        }
    }
}

impl std::error::Error for RippleError {}

/// A ripple to be told.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Lowest and highest speed of outer walls.
    pub speeds_mm_s: [f64; 2],
    /// Distance of the speeds.
    pub step_mm_s: f64,
    /// Distance of the angles.
    pub angle_step_deg: f64,
    /// Longest wave that is ripple.
    pub longest_mm: f64,
}

impl Default for Question {
    fn default() -> Self {
        Self { speeds_mm_s: [20.0, 300.0], step_mm_s: 2.0, angle_step_deg: 5.0, longest_mm: 10.0 }
    }
}

/// Ripple by speed and angle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ripple {
    /// Machine and place.
    #[serde(flatten)]
    pub at: At,
    /// Strength of the sources.
    pub amounts: Amounts,
    /// Longest wave that is ripple.
    pub longest_wave_mm: f64,
    /// Directions of travel from x towards y; 180 degrees more is the same.
    pub angles_deg: Vec<f64>,
    /// Speeds.
    pub speeds_mm_s: Vec<f64>,
    /// Amplitude across the path, for each angle at each speed.
    pub across_um: Vec<Vec<f64>>,
    /// The worst angle of each speed, of these and of all in which a source meets a mode.
    pub worst: Vec<Worst>,
    /// The calmest speed for walls in every direction.
    pub best: Best,
    /// The calmest speed for walls along x and y alone.
    pub best_along_x_and_y: Best,
    /// Ranges of speed without much ripple in any direction.
    pub quiet_mm_s: Vec<[f64; 2]>,
    /// Speeds to avoid.
    pub loud_mm_s: Vec<f64>,
    /// Each kind of source by itself: its loudest speed and direction.
    pub sources: Vec<SourceAnswer>,
    /// Amplitude across the path of waves longer than the limit, in the worst direction at the lowest speed.
    pub long_waves_um: f64,
    /// The same with other currents.
    pub currents: Vec<Current>,
}

/// The worst direction at a speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The direction.
    pub angle_deg: f64,
    /// Amplitude across the path.
    pub across_um: f64,
    /// The same if all phases meet.
    pub aligned_um: f64,
    /// The strongest kind of source.
    pub by: Option<RippleKind>,
}

/// A speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Best {
    /// The speed.
    pub speed_mm_s: f64,
    /// Amplitude across the path in the worst direction.
    pub across_um: f64,
}

/// A kind of source where it is loudest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SourceAnswer {
    /// Which.
    pub kind: RippleKind,
    /// Amplitude across the path.
    pub across_um: f64,
    /// The speed.
    pub speed_mm_s: f64,
    /// The direction.
    pub angle_deg: f64,
    /// Frequency of the strongest of its pulleys there.
    #[serde(rename = "frequency_Hz")]
    pub frequency_hz: f64,
    /// Path from wave to wave.
    pub wave_mm: f64,
}

/// Ripple with another current.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Current {
    /// The current over the run current, in percent.
    pub current_percent: f64,
    /// Holding torque with it.
    #[serde(rename = "holding_torque_Nm")]
    pub holding_torque_nm: f64,
    /// Its calmest speed.
    pub best: Best,
    /// Ripple at the speed that is best with the run current.
    pub there_um: f64,
    /// Median over the speeds, each in its worst direction.
    pub median_um: f64,
}

/// Amplitudes of one direction and speed.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    squares: f64,
    aligned: f64,
    kinds: [f64; RippleKind::ALL.len()],
}

impl Sum {
    fn of(response: &Response, angle_deg: f64, speed: f64, longest_mm: f64) -> Self {
        let mut sum = Self::default();
        for Shaken { kind, across_um, .. } in response.at(angle_deg.to_radians(), speed, longest_mm) {
            sum.squares += across_um * across_um;
            sum.aligned += across_um;
            if let Some(own) = sum.kinds.get_mut(kind as usize) {
                *own += across_um * across_um;
            }
        }
        sum
    }

    fn across_um(&self) -> f64 {
        self.squares.sqrt()
    }

    fn loudest(&self) -> Option<RippleKind> {
        let kinds = RippleKind::ALL.into_iter().zip(self.kinds).filter(|(_, square)| *square > 0.0);
        kinds.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(kind, _)| kind)
    }
}

/// Directions that differ by less, in degrees, are one.
const ALIKE_DEG: f64 = 0.02;

/// Amplitudes in a direction, in degrees.
type Along = (f64, Sum);

/// A machine at these angles and speeds.
struct Look<'q> {
    response: Response,
    longest_mm: f64,
    angles: &'q [f64],
    speeds: &'q [f64],
}

impl<'q> Look<'q> {
    fn new(
        setup: &Setup,
        params: &Params,
        question: &Question,
        (angles, speeds): (&'q [f64], &'q [f64]),
    ) -> Result<Self, NotHeld> {
        let amounts = Amounts::of(&setup.params);
        let response = Response::new(setup.machine, params, setup.tool, &amounts, setup.freedom.yaw)?;
        Ok(Self { response, longest_mm: question.longest_mm, angles, speeds })
    }

    fn sum(&self, angle_deg: f64, speed: f64) -> Sum {
        Sum::of(&self.response, angle_deg, speed, self.longest_mm)
    }

    /// For each of these angles at each speed.
    fn map(&self, angles: &[f64]) -> Vec<Vec<Sum>> {
        let row = |angle: &f64| self.speeds.iter().map(|v| self.sum(*angle, *v)).collect();
        angles.iter().map(row).collect()
    }

    /// With this current.
    fn current(&self, params: &Params, percent: f64, nominal: Best) -> Current {
        let worst = self.worst(&self.map(self.angles));
        let there = self.speeds.iter().zip(&worst).find(|(speed, _)| **speed == nominal.speed_mm_s);
        let mut order: Vec<f64> = worst.iter().map(|(_, sum)| sum.across_um()).collect();
        order.sort_by(f64::total_cmp);
        Current {
            current_percent: percent,
            holding_torque_nm: params.holding_torque_nm,
            best: calmest(self.speeds, &worst),
            there_um: there.map_or(0.0, |(_, (_, sum))| sum.across_um()),
            median_um: order.get(order.len() / 2).copied().unwrap_or(0.0),
        }
    }

    /// Directions in which a source meets a mode at this speed.
    fn resonant(&self, speed: f64) -> Vec<Along> {
        let mut angles: Vec<f64> = self.response.resonant_angles(speed).map(f64::to_degrees).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|next, kept| *next - *kept < ALIKE_DEG);
        angles.into_iter().map(|angle| (angle, self.sum(angle, speed))).collect()
    }

    /// The worst direction of each speed, of which even distances have these sums.
    fn worst(&self, all: &[Vec<Sum>]) -> Vec<Along> {
        let even = loudest(self.angles, all, self.speeds.len());
        let with_modes = |(speed, even): (&f64, Along)| {
            let both = self.resonant(*speed).into_iter().chain([even]);
            both.max_by(|a, b| a.1.squares.total_cmp(&b.1.squares)).unwrap_or(even)
        };
        self.speeds.iter().zip(even).map(with_modes).collect()
    }

    /// Each kind where it is loudest.
    fn by_source(&self, all: &[Vec<Sum>]) -> Vec<SourceAnswer> {
        let [slowest, fastest] = [self.speeds.first(), self.speeds.last()].map(|speed| speed.copied().unwrap_or(0.0));
        let even = self
            .angles
            .iter()
            .zip(all)
            .flat_map(|(angle, row)| self.speeds.iter().zip(row).map(move |(speed, sum)| (*angle, *speed, *sum)));
        let by_speed = self.speeds.iter().flat_map(|v| self.resonant(*v).into_iter().map(move |(a, sum)| (a, *v, sum)));
        let by_angle = self.angles.iter().flat_map(|angle| {
            let speeds = self.response.resonant_speeds(angle.to_radians());
            speeds.filter(move |v| (slowest..=fastest).contains(v)).map(move |v| (*angle, v, self.sum(*angle, v)))
        });
        let places: Vec<(f64, f64, Sum)> = even.chain(by_speed).chain(by_angle).collect();
        let loudest = |kind: RippleKind| {
            let own = |sum: &Sum| sum.kinds.get(kind as usize).copied().unwrap_or(0.0).sqrt();
            let all = places.iter().map(|(angle, speed, sum)| (own(sum), *angle, *speed));
            let (across_um, angle_deg, speed_mm_s) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
            let here = self.response.at(angle_deg.to_radians(), speed_mm_s, self.longest_mm);
            let strongest = here.filter(|s| s.kind == kind).max_by(|a, b| a.across_um.total_cmp(&b.across_um))?;
            let Shaken { frequency_hz, wave_mm, .. } = strongest;
            Some(SourceAnswer { kind, across_um, speed_mm_s, angle_deg, frequency_hz, wave_mm })
        };
        RippleKind::ALL.into_iter().filter_map(loudest).collect()
    }

    /// Amplitude of waves that are too long for a ripple, in the worst direction at the lowest speed.
    fn long_waves(&self) -> f64 {
        let slowest = self.speeds.first().copied().unwrap_or(0.0);
        let along = |angle: &f64| {
            let all = self.response.at(angle.to_radians(), slowest, f64::INFINITY);
            all.filter(|s| s.wave_mm > self.longest_mm).map(|s| s.across_um * s.across_um).sum::<f64>().sqrt()
        };
        self.angles.iter().map(along).fold(0.0, f64::max)
    }
}

/// The loudest of these angles at each speed, with a row of sums for each angle.
fn loudest(angles: &[f64], rows: &[Vec<Sum>], speeds: usize) -> Vec<Along> {
    let at = |speed: usize| {
        let all = angles.iter().zip(rows).filter_map(|(angle, row)| Some((*angle, *row.get(speed)?)));
        all.max_by(|a, b| a.1.squares.total_cmp(&b.1.squares)).unwrap_or_default()
    };
    (0..speeds).map(at).collect()
}

fn calmest(speeds: &[f64], loudest: &[Along]) -> Best {
    let best = |(speed, (_, sum)): (&f64, &Along)| Best { speed_mm_s: *speed, across_um: sum.across_um() };
    let all = speeds.iter().zip(loudest).map(best);
    all.min_by(|a, b| a.across_um.total_cmp(&b.across_um)).unwrap_or_default()
}

/// Evenly from one end to the other, both included as far as the step allows.
fn steps([from, to]: [f64; 2], step: f64) -> Vec<f64> {
    let count = ((to - from) / step + 1e-9) as usize;
    (0..=count).map(|i| from + i as f64 * step).collect()
}

impl Ripple {
    /// The answer, with idlers and rotors; the bar yaws if the setup says so.
    ///
    /// # Errors
    /// Nothing holds the machine, or damps its bar's yaw.
    pub fn new(setup: &Setup, question: &Question) -> Result<Self, RippleError> {
        let yaws = setup.freedom.yaw && setup.machine.has_yawing_bar();
        if yaws && setup.params.guide_y_n_s_per_m == 0.0 {
            return Err(RippleError::Undamped);
        }
        let speeds = steps(question.speeds_mm_s, question.step_mm_s);
        let angles: Vec<f64> =
            steps([0.0, 180.0], question.angle_step_deg).into_iter().filter(|a| *a < 180.0).collect();
        let look = |params: &Params| Look::new(setup, params, question, (&angles, &speeds));
        let own = look(&setup.params)?;
        let all = own.map(&angles);
        let worst_of = own.worst(&all);
        let worst = |(angle_deg, sum): &Along| Worst {
            angle_deg: *angle_deg,
            across_um: sum.across_um(),
            aligned_um: sum.aligned,
            by: sum.loudest(),
        };
        let best = calmest(&speeds, &worst_of);
        let straight = loudest(&STRAIGHT_DEG, &own.map(&STRAIGHT_DEG), speeds.len());
        let by_speed: Vec<(f64, f64)> =
            speeds.iter().zip(&worst_of).map(|(v, (_, sum))| (*v, sum.across_um())).collect();
        let (quiet_mm_s, loud_mm_s) = quiet_and_loud(&by_speed);
        let current = |factor: f64| {
            let params = Params { holding_torque_nm: setup.params.holding_torque_nm * factor, ..setup.params.clone() };
            look(&params).map(|look| look.current(&params, 100.0 * factor, best))
        };
        let currents = CURRENTS.into_iter().map(current).collect::<Result<_, _>>()?;
        let (sources, long_waves_um) = (own.by_source(&all), own.long_waves());
        Ok(Self {
            at: setup.at(),
            amounts: Amounts::of(&setup.params),
            longest_wave_mm: question.longest_mm,
            across_um: all.iter().map(|row| row.iter().map(Sum::across_um).collect()).collect(),
            worst: worst_of.iter().map(worst).collect(),
            best,
            best_along_x_and_y: calmest(&speeds, &straight),
            quiet_mm_s,
            loud_mm_s,
            sources,
            long_waves_um,
            currents,
            angles_deg: angles,
            speeds_mm_s: speeds,
        })
    }
}

/// Speeds shown to people are this far apart, in mm/s; each stands for all up to the next.
const SHOWN_MM_S: f64 = 20.0;

impl std::fmt::Display for Ripple {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}", self.at)?;
        let a = &self.amounts;
        let assumed = if a.is_detent_assumed { " (assumed, as the machine has none)" } else { "" };
        writeln!(f, "  detent {:.1} mN m{assumed}", 1000.0 * a.detent_torque_nm)?;
        write!(
            f,
            "  fields off by {} % of a full step, by {} % twice and by {} % once an electrical turn",
            a.full_step_error_percent, a.half_turn_error_percent, a.electrical_turn_error_percent
        )?;
        writeln!(f, "; teeth {} um; pulleys {} um off their axes", a.tooth_error_um, a.pulley_eccentricity_um)?;
        let longest = self.longest_wave_mm;
        writeln!(f, "Amplitude across the wall in um, waves up to {longest} mm; peak to valley is twice as much")?;
        writeln!(
            f,
            "  speed, mm/s    along x    along y    45 deg   135 deg   worst, at         all phases aligned, by"
        )?;
        let nearest = |angle: f64| self.angles_deg.iter().position(|a| (a - angle).abs() < 1e-6);
        let mut from = 0;
        while let Some(first) = self.speeds_mm_s.get(from) {
            let count = self.speeds_mm_s.iter().skip(from).take_while(|v| **v < first + SHOWN_MM_S - 1e-9).count();
            let some = from..from + count.max(1);
            let greatest =
                |row: &Vec<f64>| row.get(some.clone()).unwrap_or_default().iter().copied().fold(0.0, f64::max);
            let angle = |angle: f64| {
                let row = nearest(angle).and_then(|i| self.across_um.get(i));
                row.map_or_else(|| "-".to_owned(), |row| shown(greatest(row), 1))
            };
            let last = self.speeds_mm_s.get(some.end - 1).copied().unwrap_or(*first);
            write!(f, "  {first:>5.0} to {last:<5.0}")?;
            for deg in [0.0, 90.0, 45.0, 135.0] {
                write!(f, "{:>10}", angle(deg))?;
            }
            let worst = self.worst.get(some.clone()).unwrap_or_default();
            if let Some(worst) = worst.iter().max_by(|a, b| a.across_um.total_cmp(&b.across_um)) {
                let by = worst.by.map_or("", RippleKind::name);
                write!(
                    f,
                    "{:>9}, {:>5.1} deg {:>11}  {by}",
                    shown(worst.across_um, 1),
                    worst.angle_deg,
                    shown(worst.aligned_um, 1)
                )?;
            }
            writeln!(f)?;
            from = some.end;
        }
        writeln!(f, "Loudest of each kind")?;
        for s in &self.sources {
            write!(f, "  {:<17} {:>6} um at {:.0} mm/s", s.kind.name(), shown(s.across_um, 1), s.speed_mm_s)?;
            writeln!(f, ", {:.1} degrees: {:.1} Hz, a wave every {:.2} mm", s.angle_deg, s.frequency_hz, s.wave_mm)?;
        }
        writeln!(f, "  longer waves      {:>6} um, an error of shape", shown(self.long_waves_um, 1))?;
        let best = |f: &mut std::fmt::Formatter<'_>, what: &str, best: &Best| {
            writeln!(f, "  {what:<34} {:.0} mm/s, {} um", best.speed_mm_s, shown(best.across_um, 2))
        };
        writeln!(f, "Best speeds for outer walls")?;
        best(f, "in every direction", &self.best)?;
        best(f, "along x and y alone", &self.best_along_x_and_y)?;
        let range =
            |[from, to]: &[f64; 2]| if from == to { format!("{from:.0}") } else { format!("{from:.0} to {to:.0}") };
        let quiet: Vec<String> = self.quiet_mm_s.iter().map(range).collect();
        let quiet = if quiet.is_empty() { "none".to_owned() } else { format!("{} mm/s", quiet.join(", ")) };
        writeln!(f, "  quiet in every direction           {quiet}")?;
        writeln!(f, "Motor current (torque in proportion)")?;
        for c in &self.currents {
            write!(f, "  {:>4.0} %  {:.2} N m  ", c.current_percent, c.holding_torque_nm)?;
            write!(
                f,
                "median {} um, best {} um at {:.0} mm/s",
                shown(c.median_um, 2),
                shown(c.best.across_um, 2),
                c.best.speed_mm_s
            )?;
            writeln!(f, ", at {:.0} mm/s {} um", self.best.speed_mm_s, shown(c.there_um, 2))?;
        }
        writeln!(
            f,
            "  M593 changes nothing of this: a shaper spreads changes of the command, and the speed is constant"
        )
    }
}
