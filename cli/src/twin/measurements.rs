//! Measured: the file with a machine owner's measurements. docs/research/twin.md describes it.
//!
//! A number without an uncertainty of its own has the usual one of its kind (`Figure::usual_uncertainty`).

use anyhow::{Context as _, Result, bail, ensure};
use corehbot_host::input;
use corehbot_machine_file::file_kind::Wanted;
use corehbot_questions::setup::syntax;
use corehbot_twin::calibration::{Direction, Figure, Measurement, Parameter, Weighed};
use corehbot_twin::geometry::Workspace;
use corehbot_twin::math::hypot;
use corehbot_twin::params::Params;
use corehbot_twin::routing::{Machine, Place};
use serde::Deserialize;
use serde_json::Value;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
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
    skew: Vec<SkewToml>,
    shaper: Vec<ShaperToml>,
    resonance: Vec<ResonanceToml>,
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
            skew: Vec::new(),
            shaper: Vec::new(),
            resonance: Vec::new(),
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
    belt: Option<Spanned<i64>>,
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
    Gantry,
    Bed,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RingToml {
    at: Spanned<[f64; 2]>,
    #[serde(rename = "x_Hz")]
    x: Option<Spanned<f64>>,
    #[serde(rename = "y_Hz")]
    y: Option<Spanned<f64>>,
    #[serde(rename = "yaw_Hz")]
    yaw: Option<Spanned<f64>>,
    x_damping: Option<Spanned<f64>>,
    y_damping: Option<Spanned<f64>>,
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
    a_mm: Option<Spanned<f64>>,
    b_mm: Option<Spanned<f64>>,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkewToml {
    at: Spanned<[f64; 2]>,
    mrad: Spanned<f64>,
    uncertainty_mrad: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShaperToml {
    at: Spanned<[f64; 2]>,
    #[serde(rename = "x_Hz")]
    x: Option<Spanned<f64>>,
    #[serde(rename = "y_Hz")]
    y: Option<Spanned<f64>>,
    uncertainty_percent: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ResonanceToml {
    at: Spanned<[f64; 2]>,
    file: Spanned<PathBuf>,
    recording: Option<Spanned<String>>,
}

/// Standard uncertainty of a frequency that a shaper was tuned to: prints are judged in steps of some Hz. Assumed.
const SHAPED: f64 = 0.05;

/// Of a frequency by an accelerometer, besides the fit's own: the place of the tool, its clock, and the machine's
/// change as it warms up. Assumed.
const RECORDED: f64 = 0.01;

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
    pub(super) fn read(path: &Path, machine: Machine, params: &Params, reach: &Workspace) -> Result<Self> {
        let file = path.display();
        let text = input::text(path, Wanted::Measurements)?;
        let toml: MeasuredToml =
            toml::from_str(&text).map_err(|error| syntax(&text, &error)).context(file.to_string())?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut reader = Reader { text: &text, folder, machine, params, reach, frame: toml.frame, found: Vec::new() };
        reader.all(&toml).context(file.to_string())?;
        Ok(Self { measurements: reader.found, fixed: toml.fixed })
    }
}

struct Reader<'t> {
    text: &'t str,
    /// Where other files are.
    folder: &'t Path,
    machine: Machine,
    params: &'t Params,
    reach: &'t Workspace,
    frame: Frame,
    found: Vec<(String, Measurement)>,
}

impl Reader<'_> {
    fn all(&mut self, toml: &MeasuredToml) -> Result<()> {
        if let Some(belt) = &toml.belt {
            let percent = toml.belt_uncertainty_percent.as_ref();
            self.add("belt_kg_per_m", belt, 0.001..=0.1, Figure::BeltMass, percent)?;
        } else if let Some(percent) = &toml.belt_uncertainty_percent {
            bail!("line {}: belt_uncertainty_percent is one of belt_kg_per_m, which is missing", self.line(percent));
        }
        for pluck in &toml.pluck {
            let length_mm = self.number("length_mm", &pluck.length_mm, 50.0..=3000.0)?;
            let figure = Figure::Pluck { length_mm, belt: self.belt(pluck.belt.as_ref())? };
            self.add("frequency_Hz", &pluck.frequency, 5.0..=2000.0, figure, pluck.uncertainty_percent.as_ref())?;
        }
        for weight in &toml.weight {
            let of = match weight.of {
                WeighedToml::Head => Weighed::Head,
                WeighedToml::Bar => Weighed::Bar,
                WeighedToml::Both => Weighed::Both,
                WeighedToml::Gantry => Weighed::Gantry,
                WeighedToml::Bed => Weighed::Bed,
            };
            let percent = weight.uncertainty_percent.as_ref();
            self.add("mass_kg", &weight.mass_kg, 0.01..=50.0, Figure::Weight(of), percent)?;
        }
        for ring in &toml.ring {
            self.ring(ring)?;
        }
        for push in &toml.push {
            let (at, percent) = (self.place(&push.at)?, push.uncertainty_percent.as_ref());
            let force_n = self.number("force_N", &push.force, 0.1..=500.0)?;
            let along = |along| Figure::Deflection { at, along, force_n };
            let across = |rises| Figure::Diagonal { at, rises, force_n };
            let all = [
                ("x_mm", &push.x_mm, along(Direction::X)),
                ("y_mm", &push.y_mm, along(Direction::Y)),
                ("a_mm", &push.a_mm, across(false)),
                ("b_mm", &push.b_mm, across(true)),
            ];
            for (key, mm, figure) in self.some("x_mm or y_mm", &push.at, all)? {
                self.add(key, mm, 0.001..=20.0, figure, percent)?;
            }
        }
        for slip in &toml.slip {
            let lever_mm = self.number("lever_mm", &slip.lever_mm, 2.0..=1000.0)?;
            let percent = slip.uncertainty_percent.as_ref();
            self.add("force_N", &slip.force, 0.01..=1000.0, Figure::Slip { lever_mm }, percent)?;
        }
        for skew in &toml.skew {
            let figure = Figure::Skew { at: self.place(&skew.at)? };
            let measured = self.number("mrad", &skew.mrad, -50.0..=50.0)?;
            self.has_part(&skew.mrad, &figure)?;
            let mrad = skew.uncertainty_mrad.as_ref();
            let mrad = mrad.map(|mrad| self.number("uncertainty_mrad", mrad, 0.001..=50.0)).transpose()?;
            let uncertainty = mrad.unwrap_or(figure.usual_uncertainty());
            self.found.push((self.name("mrad", &skew.mrad), Measurement { figure, measured, uncertainty }));
        }
        for shaper in &toml.shaper {
            let (at, percent) = (self.place(&shaper.at)?, shaper.uncertainty_percent.as_ref());
            let uncertainty = self.percent(percent)?.unwrap_or(SHAPED);
            let ring = |along| Figure::Ring { at, along };
            let all = [("x_Hz", &shaper.x, ring(Direction::X)), ("y_Hz", &shaper.y, ring(Direction::Y))];
            for (key, hz, figure) in self.some("x_Hz or y_Hz", &shaper.at, all)? {
                let measured = self.number(key, hz, 1.0..=5000.0)?;
                self.found.push((self.name(key, hz), Measurement { figure, measured, uncertainty }));
            }
        }
        for resonance in &toml.resonance {
            let at = self.place(&resonance.at)?;
            let path = self.folder.join(resonance.file.get_ref());
            let line = self.line(&resonance.file);
            let wanted = resonance.recording.as_ref().map(|name| name.get_ref().as_str());
            let text = input::text(&path, Wanted::Figures).with_context(|| format!("line {line}"))?;
            let found = recorded(&text, at, wanted).with_context(|| format!("line {line}: {}", path.display()))?;
            self.found.extend(found.into_iter().map(|(name, found)| (format!("{name} in line {line}"), found)));
        }
        Ok(())
    }

    /// Frequencies of a place, and dampings.
    fn ring(&mut self, ring: &RingToml) -> Result<()> {
        let (at, percent) = (self.place(&ring.at)?, ring.uncertainty_percent.as_ref());
        let hz = |along| Figure::Ring { at, along };
        let damping = |along| Figure::Damping { at, along };
        let all = [
            ("x_Hz", &ring.x, hz(Direction::X)),
            ("y_Hz", &ring.y, hz(Direction::Y)),
            ("yaw_Hz", &ring.yaw, Figure::YawRing { at }),
            ("x_damping", &ring.x_damping, damping(Direction::X)),
            ("y_damping", &ring.y_damping, damping(Direction::Y)),
        ];
        for (key, value, figure) in self.some("x_Hz or y_Hz", &ring.at, all)? {
            // The percentage is the frequencies'.
            let is_damping = matches!(figure, Figure::Damping { .. });
            let (legal, percent) = if is_damping { (0.001..=0.9, None) } else { (1.0..=5000.0, percent) };
            self.add(key, value, legal, figure, percent)?;
        }
        Ok(())
    }

    /// Adds a measurement: its key, value, legal values, figure, and uncertainty if the file has one.
    fn add(
        &mut self,
        key: &str,
        value: &Spanned<f64>,
        legal: RangeInclusive<f64>,
        figure: Figure,
        percent: Option<&Spanned<f64>>,
    ) -> Result<()> {
        let measured = self.number(key, value, legal)?;
        self.has_part(value, &figure)?;
        let uncertainty = self.percent(percent)?.unwrap_or(figure.usual_uncertainty());
        let kind = match figure {
            Figure::BeltMass => key.to_owned(),
            Figure::Pluck { .. } => "pluck".to_owned(),
            Figure::Weight(_) => "weight".to_owned(),
            Figure::Slip { .. } => "slip".to_owned(),
            Figure::Deflection { .. } | Figure::Diagonal { .. } => format!("push {key}"),
            _ => format!("ring {key}"),
        };
        self.found.push((self.name(&kind, value), Measurement { figure, measured, uncertainty }));
        Ok(())
    }

    /// Whether the machine has what was measured.
    fn has_part(&self, value: &Spanned<f64>, figure: &Figure) -> Result<()> {
        let (line, machine) = (self.line(value), self.machine.name());
        match figure.lacks(self.machine, self.params) {
            Some(part) => bail!("line {line}: a {machine} has no {part}"),
            None => Ok(()),
        }
    }

    /// A belt by its number, from 1; the first without one.
    fn belt(&self, belt: Option<&Spanned<i64>>) -> Result<usize> {
        let Some(belt) = belt else { return Ok(0) };
        let belts = self.machine.belts().len();
        let place = usize::try_from(*belt.get_ref()).ok().filter(|number| (1..=belts).contains(number));
        let line = self.line(belt);
        place.map(|number| number - 1).with_context(|| {
            format!("line {line}: belt = {} is not one of the machine's belts, 1 to {belts}", belt.get_ref())
        })
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

    fn percent(&self, percent: Option<&Spanned<f64>>) -> Result<Option<f64>> {
        let percent = percent.map(|percent| self.number("uncertainty_percent", percent, 0.01..=50.0)).transpose()?;
        Ok(percent.map(|percent| percent / 100.0))
    }

    fn place(&self, at: &Spanned<[f64; 2]>) -> Result<Place> {
        let [x, y] = *at.get_ref();
        let origin = match self.frame {
            Frame::Gcode => self.reach.origin(),
            Frame::Motor1 => Place::flat(0.0, 0.0),
        };
        let place = self.reach.at(x + origin.x, y + origin.y);
        if !self.reach.has(place) {
            let [x0, x1] = self.reach.x.map(|v| v - origin.x);
            let [y0, y1] = self.reach.y.map(|v| v - origin.y);
            let line = self.line(at);
            bail!("line {line}: at = [{x}, {y}] is outside the reach: x {x0:.2} to {x1:.2}, y {y0:.2} to {y1:.2}");
        }
        Ok(place)
    }

    /// The measurements that a place has, at least one.
    fn some<'v, const N: usize>(
        &self,
        wanted: &str,
        at: &Spanned<[f64; 2]>,
        all: [(&'static str, &'v Option<Spanned<f64>>, Figure); N],
    ) -> Result<Vec<(&'static str, &'v Spanned<f64>, Figure)>> {
        let has = |(key, value, figure): (_, &'v Option<Spanned<f64>>, _)| Some((key, value.as_ref()?, figure));
        let some: Vec<_> = all.into_iter().filter_map(has).collect();
        ensure!(!some.is_empty(), "line {}: expected {wanted} beside this place", self.line(at));
        Ok(some)
    }
}

/// Frequency and damping of the strongest mode of each axis in the answer of `corehbot resonance`. The recording was
/// made at this place. It is the recording with this name, or the only one of an axis.
fn recorded(text: &str, at: Place, wanted: Option<&str>) -> Result<Vec<(String, Measurement)>> {
    let json: Value = serde_json::from_str(text).context("it is not the --json of `corehbot resonance`")?;
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mut found = Vec::new();
    for axis in list(&json["axes"]) {
        let (along, letter) = match axis["axis"].as_str() {
            Some("X") => (Direction::X, "x"),
            Some("Y") => (Direction::Y, "y"),
            _ => continue,
        };
        let mut recordings = list(&axis["recordings"]);
        let name = |recording: &Value| recording["file"].as_str().unwrap_or_default().to_owned();
        match wanted {
            Some(wanted) => recordings.retain(|recording| name(recording) == wanted),
            None if recordings.len() > 1 => {
                let names: Vec<String> = recordings.iter().map(name).collect();
                bail!("it has several recordings of {letter}; name one as `recording`: {}", names.join(", "));
            }
            None => {}
        }
        for recording in recordings {
            let modes = list(&recording["fit"]["modes"]);
            let number = |mode: &Value, key: &str| mode[key].as_f64().filter(|number| number.is_finite());
            let part = |mode: &&Value| number(mode, "part").unwrap_or_default();
            let Some(mode) = modes.iter().max_by(|a, b| part(a).total_cmp(&part(b))) else { continue };
            let name = |key: &str| format!("resonance {letter}{key}");
            if let Some(measured) = number(mode, "frequency_Hz").filter(|hz| (1.0..=5000.0).contains(hz)) {
                let own = number(mode, "frequency_error_Hz").unwrap_or_default() / measured;
                let (figure, uncertainty) = (Figure::Ring { at, along }, hypot(RECORDED, own));
                found.push((name("_Hz"), Measurement { figure, measured, uncertainty }));
            }
            if let Some(measured) = number(mode, "damping_ratio").filter(|ratio| (0.001..=0.9).contains(ratio)) {
                let figure = Figure::Damping { at, along };
                let uncertainty = figure.usual_uncertainty();
                found.push((name("_damping"), Measurement { figure, measured, uncertainty }));
            }
        }
    }
    if let Some(wanted) = wanted.filter(|_| found.is_empty()) {
        bail!("it has no mode of a recording {wanted} of x or y");
    }
    ensure!(!found.is_empty(), "it has no mode of x or y (`corehbot resonance FILE.csv... --json` writes such a file)");
    Ok(found)
}
