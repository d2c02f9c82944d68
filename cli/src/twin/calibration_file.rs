//! Calibrated: numbers of a machine found from measurements, as a table `[twin]` with the source of each.

use super::measurements::Measured;
use super::octave::octaves;
use anyhow::{Context as _, Result, anyhow};
use corehbot_twin::calibration::{
    CalibrateError, Calibrated as Found, Direction, Estimate, Figure, Further, Improved, Misfit, Parameter, Unknown,
    Weighed, calibrate,
};
use corehbot_twin::geometry::workspace;
use corehbot_twin::math::{exp, log10};
use corehbot_twin::params::{Each, Params, ROWS, Row, split_unit};
use corehbot_twin::routing::{Machine, Place};
use serde::Serialize;
use std::path::Path;

/// The result of a calibration.
#[derive(Serialize)]
pub(super) struct Calibrated {
    /// The routing that the machine file must name.
    routing: Option<&'static str>,
    estimates: Vec<Sourced>,
    /// Numbers that are hardly better known than before.
    not_told: Vec<Sourced>,
    /// Numbers on which no measurement depends.
    unasked: Vec<Unasked>,
    /// Parameters that were not sought.
    fixed: Vec<Parameter>,
    measurements: Vec<Told>,
    /// Factor by which differences enlarged the measurements' uncertainties.
    spread: f64,
    /// The measurements that would help most.
    further: Vec<Helps>,
    /// All numbers of the machine.
    params: Params,
    /// The same before.
    #[serde(skip)]
    was: Params,
}

/// A number and the measurements that it comes from.
#[derive(Serialize)]
struct Sourced {
    #[serde(flatten)]
    estimate: Estimate,
    /// Of the value.
    unit: &'static str,
    from: Vec<String>,
}

/// A number of a belt, or of the machine.
#[derive(Serialize)]
struct Unasked {
    parameter: Parameter,
    #[serde(skip_serializing_if = "Option::is_none")]
    belt: Option<usize>,
}

/// A measurement and the model.
#[derive(Serialize)]
struct Told {
    measurement: String,
    #[serde(flatten)]
    misfit: Misfit,
    /// A pluck that seems to be an octave off.
    #[serde(skip_serializing_if = "Option::is_none")]
    doubt: Option<&'static str>,
}

/// A measurement that would help.
#[derive(Serialize)]
struct Helps {
    measurement: String,
    /// Part of the variance of all logarithms that it removes, of 1.
    removes: f64,
    improves: Vec<Improved>,
}

/// A measurement that is off by more uncertainties than this should be checked again.
const SUSPICIOUS: f64 = 3.0;

/// A number is far from the nominal one beyond this factor.
const FAR: f64 = 10.0;

impl Calibrated {
    /// From a file of measurements.
    ///
    /// # Errors
    /// Errors in the file, quantities that the measurements do not determine, or measurements that contradict each
    /// other on every machine.
    pub(super) fn read(path: &Path, machine: Machine, routing: Option<&'static str>, was: &Params) -> Result<Self> {
        let reach = workspace(machine, was);
        let Measured { measurements, fixed } = Measured::read(path, machine, was, &reach)?;
        let (names, measurements): (Vec<_>, Vec<_>) = measurements.into_iter().unzip();
        let doubts = octaves(&measurements, was);
        let found = calibrate(machine, was, &measurements, &fixed);
        let found = found.map_err(|error| unlike(&names, error)).with_context(|| path.display().to_string())?;
        let Found { params, estimates, not_told, unasked, misfits, spread, further } = found;
        let sourced = |estimate: Estimate| {
            let from = estimate.from.iter().filter_map(|i| names.get(*i)).cloned().collect();
            let (_, unit) = split_unit(estimate.parameter.key());
            Sourced { estimate, unit, from }
        };
        let [estimates, not_told] = [estimates, not_told].map(|all| all.into_iter().map(sourced).collect());
        let belt = |unknown: &Unknown| (unknown.parts > 1).then_some(unknown.part + 1);
        let unasked =
            unasked.iter().map(|unknown| Unasked { parameter: unknown.parameter, belt: belt(unknown) }).collect();
        let origin = reach.origin();
        let helps = |Further { figure, removes, improves }| Helps {
            measurement: described(&figure, origin),
            removes,
            improves,
        };
        let further = further.into_iter().map(helps).collect();
        let told = |((measurement, misfit), doubt): ((&String, Misfit), _)| Told {
            measurement: measurement.clone(),
            misfit,
            doubt,
        };
        let measurements = names.iter().zip(misfits).zip(doubts).map(told).collect();
        let was = was.clone();
        Ok(Self { routing, estimates, not_told, unasked, fixed, measurements, spread, further, params, was })
    }

    /// What was found of a key, part after part: told or not.
    fn found(&self, key: &str) -> Vec<(bool, &Sourced)> {
        let told = self.estimates.iter().map(|sourced| (true, sourced));
        let all = told.chain(self.not_told.iter().map(|sourced| (false, sourced)));
        let mut all: Vec<_> = all.filter(|(_, sourced)| sourced.estimate.parameter.key() == key).collect();
        all.sort_by_key(|(_, sourced)| sourced.estimate.belt);
        all
    }

    /// The numbers of a row that the table has, with a remark if no measurement changed them; `None` if it leaves them
    /// out, as the machine has them without it.
    fn unchanged(&self, row: &Row) -> Option<(Each, &'static str)> {
        if self.fixed.iter().any(|parameter| parameter.key() == row.key) {
            return Some((row.values(&self.params), "fixed, taken as exact"));
        }
        let was = row.values(&self.was);
        (was != row.values(&Params::default())).then_some((was, "as it was"))
    }

    /// Whether a number would print otherwise if its row stayed as it was.
    fn is_changed(&self, row: &Row, estimate: &Estimate) -> bool {
        let mut kept = self.params.clone();
        (row.field)(&mut kept).set(row.values(&self.was));
        digits(estimate.unknown.of(&kept)) != digits(estimate.value)
    }
}

/// A number's remark: its uncertainty, and its source.
fn remark(is_told: bool, sourced: &Sourced) -> String {
    let Estimate { value, nominal, uncertainty, assumed_uncertainty, .. } = &sourced.estimate;
    let from = sourced.from.join(", ");
    let mut text = if is_told {
        format!("+- {:.1} %: {from}", 100.0 * uncertainty)
    } else {
        let [now, before] = [*uncertainty, *assumed_uncertainty].map(exp);
        let from = if from.is_empty() { from } else { format!(": {from}") };
        format!("not told: good to a factor of {now:.2}, assumed {before:.2}{from}")
    };
    let factor = (value / nominal).max(nominal / value);
    if is_told && factor > FAR {
        text += &format!("; {factor:.0} times from the nominal {nominal}: are the units right?");
    }
    text
}

impl std::fmt::Display for Calibrated {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(
            f,
            "# Replaces the table [twin] of the machine file. Uncertainties are standard ones, by the measurements' own and \
            by what is not told."
        )?;
        if self.spread > 1.0 {
            let spread = self.spread;
            writeln!(
                f,
                "# The model differs more than stated: all measurements count as {spread:.1} times as uncertain."
            )?;
        }
        writeln!(f, "[twin]")?;
        if let Some(routing) = self.routing {
            writeln!(f, "routing = \"{routing}\"")?;
        }
        for row in &ROWS {
            let values = row.values(&self.params);
            let found = self.found(row.key);
            if !found.iter().any(|(is_told, one)| *is_told || self.is_changed(row, &one.estimate)) {
                if let Some((values, remark)) = self.unchanged(row) {
                    writeln!(f, "{} = {values}  # {remark}", row.key)?;
                }
                continue;
            }
            match &found[..] {
                [(is_told, one)] if one.estimate.belt.is_none() => {
                    let key = row.key;
                    // One number for all belts may be a list in proportion.
                    let value = if values.values().len() > 1 { list(&values) } else { digits(one.estimate.value) };
                    writeln!(f, "{key} = {value}  # {}", remark(*is_told, one))?;
                }
                all => {
                    writeln!(f, "{} = [", row.key)?;
                    for (belt, value) in values.values().iter().enumerate() {
                        let own = all.iter().find(|(_, sourced)| sourced.estimate.belt == Some(belt + 1));
                        let says = own.map_or_else(|| "as it was".to_owned(), |(told, own)| remark(*told, own));
                        writeln!(f, "    {},  # belt {}, {says}", digits(*value), belt + 1)?;
                    }
                    writeln!(f, "]")?;
                }
            }
        }
        for Told { measurement, misfit: Misfit { part, uncertainties, .. }, doubt } in &self.measurements {
            let percent = 100.0 * part;
            write!(f, "# {measurement}: the model says {percent:+.1} %, {:.1} uncertainties", uncertainties.abs())?;
            write!(f, "{}", if uncertainties.abs() > SUSPICIOUS { "; look at it again" } else { "" })?;
            writeln!(f, "{}", doubt.map_or_else(String::new, |doubt| format!("; {doubt}")))?;
        }
        for (place, Helps { measurement, improves, .. }) in self.further.iter().enumerate() {
            let lead = if place == 0 { "What would help most now" } else { "Then" };
            writeln!(f, "# {lead}: {measurement}")?;
            for Improved { unknown, now, then, .. } in improves.iter().take(3) {
                writeln!(f, "#   {unknown}: +- {} instead of {}", part(*then), part(*now))?;
            }
        }
        Ok(())
    }
}

/// An uncertainty, as a factor where it is large.
fn part(uncertainty: f64) -> String {
    if uncertainty < 0.25 {
        format!("{:.1} %", 100.0 * uncertainty)
    } else {
        format!("a factor of {:.2}", exp(uncertainty))
    }
}

/// A measurement to make, with its table in the file.
fn described(figure: &Figure, origin: Place) -> String {
    let place = |at: &Place| format!("at G-code's X{:.0} Y{:.0}", at.x - origin.x, at.y - origin.y);
    let letter = |along: &Direction| match along {
        Direction::X => "x",
        Direction::Y => "y",
    };
    match figure {
        Figure::Pluck { length_mm, belt } => {
            format!("pluck {length_mm:.0} mm of belt {} ([[pluck]] belt = {})", belt + 1, belt + 1)
        }
        Figure::BeltMass => "weigh a piece of belt (belt_kg_per_m)".to_owned(),
        Figure::Deflection { at, along, force_n } => {
            format!("pull along {} with {force_n:.0} N {} ([[push]])", letter(along), place(at))
        }
        Figure::Diagonal { at, rises, force_n } => {
            let (way, key) = if *rises { ("(1, 1)", "b_mm") } else { ("(1, -1)", "a_mm") };
            format!("pull along the diagonal {way} with {force_n:.0} N {} ([[push]] {key})", place(at))
        }
        Figure::Ring { at, along } => {
            let letter = letter(along);
            format!("the frequency of {letter} {} ([[ring]] {letter}_Hz, or [[resonance]])", place(at))
        }
        Figure::YawRing { at } => format!("the frequency at which the bar yaws, {} ([[ring]] yaw_Hz)", place(at)),
        Figure::Damping { at, along } => {
            let letter = letter(along);
            format!("the damping of {letter} {} ([[resonance]], or [[ring]] {letter}_damping)", place(at))
        }
        Figure::Skew { at } => format!("how far the belts turn the bar, {} ([[skew]])", place(at)),
        Figure::Weight(of) => {
            let of = match of {
                Weighed::Head => "head",
                Weighed::Bar => "bar",
                Weighed::Both => "both",
                Weighed::Gantry => "gantry",
                Weighed::Bed => "bed",
            };
            format!("a scale under the {of} ([[weight]] of = \"{of}\")")
        }
        Figure::Slip { lever_mm } => format!("a lever of {lever_mm:.0} mm on a motor ([[slip]])"),
    }
}

/// Why no machine fits; names the measurement that the others contradict, or the one that is furthest from the nearest
/// machine.
fn unlike(names: &[String], error: CalibrateError) -> anyhow::Error {
    let CalibrateError::Unlike(misfits) = &error else { return error.into() };
    let all = || names.iter().zip(misfits);
    let suspect = all().find(|(_, misfit)| misfit.is_suspect);
    let worst = all().max_by(|a, b| a.1.uncertainties.abs().total_cmp(&b.1.uncertainties.abs()));
    let Some((name, Misfit { part, uncertainties, .. })) = suspect.or(worst) else { return error.into() };
    let (percent, uncertainties) = (100.0 * part, uncertainties.abs());
    let (machine, others) = if suspect.is_some() {
        ("the one that the others fit", "the others fit without it")
    } else {
        ("the nearest one", "if it stays, check the others: no single one is wrong")
    };
    anyhow!(
        "no machine measures like this: of {name} {machine} says {percent:+.0} %, {uncertainties:.0} uncertainties; \
        check its unit and measure it again; {others}"
    )
}

fn list(values: &Each) -> String {
    let values: Vec<String> = values.values().iter().map(|value| digits(*value)).collect();
    format!("[{}]", values.join(", "))
}

/// Five digits, because measurements by hand are no more exact.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let before = log10(value.abs()).floor() as i32 + 1;
    let behind = usize::try_from(5 - before).unwrap_or(0);
    format!("{value:.behind$}")
}
