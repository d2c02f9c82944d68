//! Measured: the file with a machine owner's measurements. docs/research/twin.md describes it.

use super::setup::syntax;
use anyhow::{Context as _, Result, bail, ensure};
use corehbot_twin::calibration::{Direction, Figure, Measurement, Parameter, Weighed};
use corehbot_twin::geometry::Workspace;
use corehbot_twin::routing::Place;
use serde::Deserialize;
use std::ops::RangeInclusive;
use std::path::Path;
use toml::Spanned;

/// A file of measurements.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MeasuredToml {
    frame: Frame,
    #[serde(rename = "belt_kg_per_m")]
    belt: Option<Spanned<f64>>,
    belt_uncertainty_percent: Option<Spanned<f64>>,
    fixed: Vec<Parameter>,
    pluck: Vec<PluckToml>,
    weight: Vec<WeightToml>,
    ring: Vec<RingToml>,
    push: Vec<PushToml>,
    slip: Vec<SlipToml>,
}

impl Default for MeasuredToml {
    fn default() -> Self {
        Self {
            frame: Frame::Gcode,
            belt: None,
            belt_uncertainty_percent: None,
            fixed: Vec::new(),
            pluck: Vec::new(),
            weight: Vec::new(),
            ring: Vec::new(),
            push: Vec::new(),
            slip: Vec::new(),
        }
    }
}

/// The origin of places.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Frame {
    /// G-code's X0 Y0, the lower left corner of the reach.
    Gcode,
    /// Motor 1's axis.
    Motor1,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PluckToml {
    length_mm: Spanned<f64>,
    #[serde(rename = "frequency_Hz")]
    frequency: Spanned<f64>,
    uncertainty_percent: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WeightToml {
    of: WeighedToml,
    mass_kg: Spanned<f64>,
    uncertainty_percent: Option<Spanned<f64>>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum WeighedToml {
    Head,
    Bar,
    Both,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RingToml {
    at: Spanned<[f64; 2]>,
    #[serde(rename = "x_Hz")]
    x: Option<Spanned<f64>>,
    #[serde(rename = "y_Hz")]
    y: Option<Spanned<f64>>,
    uncertainty_percent: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PushToml {
    at: Spanned<[f64; 2]>,
    #[serde(rename = "force_N")]
    force: Spanned<f64>,
    x_mm: Option<Spanned<f64>>,
    y_mm: Option<Spanned<f64>>,
    uncertainty_percent: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SlipToml {
    lever_mm: Spanned<f64>,
    #[serde(rename = "force_N")]
    force: Spanned<f64>,
    uncertainty_percent: Option<Spanned<f64>>,
}

// Standard uncertainties, as parts, of measurements by the method of docs/research/twin.md; all assumed.

/// A pitch: 1 % of the phone, and 1.5 % of the span's length by a ruler and of its ends that hold it.
const PLUCKED: f64 = 0.02;
/// Half a metre of belt on a scale of 0.1 g: 0.1 g of 6 g, and 1 mm of its length; for all parts that are plucked
/// alike.
const BELT_WEIGHED: f64 = 0.02;
/// A kitchen scale of 5 g under 600 g.
const WEIGHED: f64 = 0.01;
/// A frequency from two seconds of a phone's accelerometer.
const RUNG: f64 = 0.015;
/// A dial gauge of 0.01 mm, read to a half of that, under 0.08 mm.
const PUSHED: f64 = 0.06;
/// A spring scale that is pulled until the motor slips.
const SLIPPED: f64 = 0.10;

/// The content of a file.
pub(super) struct Measured {
    /// Measurements, each with its name for people.
    pub measurements: Vec<(String, Measurement)>,
    /// Parameters that are not sought.
    pub fixed: Vec<Parameter>,
}

impl Measured {
    /// Reads a file about a machine with this reach.
    ///
    /// # Errors
    /// The problem, with file and line.
    pub(super) fn read(path: &Path, reach: &Workspace) -> Result<Self> {
        let file = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot open {file}"))?;
        let toml: MeasuredToml =
            toml::from_str(&text).map_err(|error| syntax(&text, &error)).context(file.to_string())?;
        Reader { text: &text, reach, frame: toml.frame }.all(toml).context(file.to_string())
    }
}

struct Reader<'t> {
    text: &'t str,
    reach: &'t Workspace,
    frame: Frame,
}

impl Reader<'_> {
    fn all(&self, toml: MeasuredToml) -> Result<Measured> {
        let mut measurements = Vec::new();
        let mut add = |name: String, figure, measured, uncertainty| {
            measurements.push((name, Measurement { figure, measured, uncertainty }));
        };
        if let Some(belt) = &toml.belt {
            let kg_per_m = self.number("belt_kg_per_m", belt, 0.001..=0.1)?;
            let uncertainty = self.uncertainty(toml.belt_uncertainty_percent.as_ref(), BELT_WEIGHED)?;
            add(self.name("belt_kg_per_m", belt), Figure::BeltMass, kg_per_m, uncertainty);
        } else if let Some(percent) = &toml.belt_uncertainty_percent {
            bail!("line {}: belt_uncertainty_percent is one of belt_kg_per_m, which is missing", self.line(percent));
        }
        for pluck in &toml.pluck {
            let length_mm = self.number("length_mm", &pluck.length_mm, 50.0..=3000.0)?;
            let hz = self.number("frequency_Hz", &pluck.frequency, 5.0..=2000.0)?;
            let name = self.name("pluck", &pluck.frequency);
            add(name, Figure::Pluck { length_mm }, hz, self.uncertainty(pluck.uncertainty_percent.as_ref(), PLUCKED)?);
        }
        for weight in &toml.weight {
            let of = match weight.of {
                WeighedToml::Head => Weighed::Head,
                WeighedToml::Bar => Weighed::Bar,
                WeighedToml::Both => Weighed::Both,
            };
            let kg = self.number("mass_kg", &weight.mass_kg, 0.01..=50.0)?;
            let uncertainty = self.uncertainty(weight.uncertainty_percent.as_ref(), WEIGHED)?;
            add(self.name("weight", &weight.mass_kg), Figure::Weight(of), kg, uncertainty);
        }
        for ring in &toml.ring {
            let at = self.place(&ring.at)?;
            let uncertainty = self.uncertainty(ring.uncertainty_percent.as_ref(), RUNG)?;
            for (key, along, hz) in self.either("x_Hz or y_Hz", &ring.at, [&ring.x, &ring.y], ["x_Hz", "y_Hz"])? {
                let rung = self.number(key, hz, 1.0..=5000.0)?;
                add(self.name(&format!("ring {key}"), hz), Figure::Ring { at, along }, rung, uncertainty);
            }
        }
        for push in &toml.push {
            let at = self.place(&push.at)?;
            let force_n = self.number("force_N", &push.force, 0.1..=500.0)?;
            let uncertainty = self.uncertainty(push.uncertainty_percent.as_ref(), PUSHED)?;
            for (key, along, mm) in self.either("x_mm or y_mm", &push.at, [&push.x_mm, &push.y_mm], ["x_mm", "y_mm"])? {
                let moved = self.number(key, mm, 0.001..=20.0)?;
                let figure = Figure::Deflection { at, along, force_n };
                add(self.name(&format!("push {key}"), mm), figure, moved, uncertainty);
            }
        }
        for slip in &toml.slip {
            let lever_mm = self.number("lever_mm", &slip.lever_mm, 2.0..=1000.0)?;
            let force = self.number("force_N", &slip.force, 0.01..=1000.0)?;
            let uncertainty = self.uncertainty(slip.uncertainty_percent.as_ref(), SLIPPED)?;
            add(self.name("slip", &slip.force), Figure::Slip { lever_mm }, force, uncertainty);
        }
        Ok(Measured { measurements, fixed: toml.fixed })
    }

    fn line<T>(&self, value: &Spanned<T>) -> usize {
        1 + self.text.get(..value.span().start).unwrap_or_default().matches('\n').count()
    }

    /// The name of a measurement for people.
    fn name(&self, kind: &str, value: &Spanned<f64>) -> String {
        format!("{kind} in line {}", self.line(value))
    }

    fn number(&self, key: &str, value: &Spanned<f64>, legal: RangeInclusive<f64>) -> Result<f64> {
        let (line, number) = (self.line(value), *value.get_ref());
        let (least, most) = (legal.start(), legal.end());
        ensure!(legal.contains(&number), "line {line}: {key} = {number} is outside {least} to {most}");
        Ok(number)
    }

    fn uncertainty(&self, percent: Option<&Spanned<f64>>, usual: f64) -> Result<f64> {
        let percent = percent.map(|percent| self.number("uncertainty_percent", percent, 0.01..=50.0)).transpose()?;
        Ok(percent.map_or(usual, |percent| percent / 100.0))
    }

    fn place(&self, at: &Spanned<[f64; 2]>) -> Result<Place> {
        let [x, y] = *at.get_ref();
        let origin = match self.frame {
            Frame::Gcode => self.reach.origin(),
            Frame::Motor1 => Place::flat(0.0, 0.0),
        };
        let place = Place::flat(x + origin.x, y + origin.y);
        if !self.reach.has(place) {
            let [x0, x1] = self.reach.x.map(|v| v - origin.x);
            let [y0, y1] = self.reach.y.map(|v| v - origin.y);
            let line = self.line(at);
            bail!("line {line}: at = [{x}, {y}] is outside the reach: x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}");
        }
        Ok(place)
    }

    /// The measurements of x and of y, at least one of them.
    fn either<'v>(
        &self,
        wanted: &str,
        at: &Spanned<[f64; 2]>,
        values: [&'v Option<Spanned<f64>>; 2],
        keys: [&'static str; 2],
    ) -> Result<Vec<(&'static str, Direction, &'v Spanned<f64>)>> {
        let both = keys.into_iter().zip([Direction::X, Direction::Y]).zip(values);
        let all: Vec<_> = both.filter_map(|((key, along), v)| v.as_ref().map(|v| (key, along, v))).collect();
        ensure!(!all.is_empty(), "line {}: expected {wanted} beside this place", self.line(at));
        Ok(all)
    }
}
