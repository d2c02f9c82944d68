//! Pages of the belt's twin: files that show a played path, without any network, in the style of a print's page.

pub mod ripple;

use crate::print::HEAD;
use crate::viewer;
use anyhow::{Context as _, Result};
use corehbot_twin::contour::trail::Beside;
use corehbot_twin::geometry::workspace;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::params::Params;
use corehbot_twin::queries::Setup;
use corehbot_twin::queries::resonance::Resonance;
use corehbot_twin::routing::{Belt, Machine};
use corehbot_twin::run::report::Report;
use corehbot_twin::run::watch::Watch;
use corehbot_twin::steps::TICKS_PER_SECOND;
use serde::Serialize;
use std::io::Write;

/// All pages that show no print: the style of the viewer, its charts, and a script of each.
const FRAME: &str = include_str!("twin/frame.html");

/// What the scripts have in common.
const SHARED: &str = include_str!("twin/shared.js");

/// The script of a played path (`twin run`).
const RUN: &str = include_str!("twin/run.js");

/// The script of `twin resonance`.
const RESONANCE: &str = include_str!("twin/resonance.js");

/// The places for the style, the shared script, the data, and the page's own script.
const MARKS: [&str; 4] = ["/*STYLE*/\n", "/*SHARED*/\n", "/*DATA*/", "/*PAGE*/\n"];

/// Lines that are drawn; of a longer path neighbours are drawn as one.
const MOST_LINES: usize = 200_000;

/// Columns and rows of the maps.
const GRID: usize = 9;

#[derive(Serialize)]
struct Data<'a> {
    file: &'a str,
    machine: &'static str,
    report: &'a Report,
    reach_x: [f64; 2],
    reach_y: [f64; 2],
    /// Seconds a bin of the curves.
    bin_s: f64,
    /// Greatest error of each bin in mm.
    error: Vec<f64>,
    spans: Vec<Curve>,
    torques: Vec<Curve>,
    /// Of all motors together on the frame, in mN m.
    motors_torque: Curve,
    /// Displacement of a soft frame in x and y, in um; nothing of a rigid one.
    frame: Vec<Curve>,
    path: Path,
    trail: Trail,
    resonance: Resonance,
}

/// The least (if reported) and the greatest value of a quantity in each bin.
#[derive(Serialize)]
struct Curve {
    name: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    low: Vec<f64>,
    high: Vec<f64>,
}

/// Ends of lines in mm, and the greatest error on each.
#[derive(Serialize)]
struct Path {
    x: Vec<f64>,
    y: Vec<f64>,
    error_um: Vec<f64>,
}

/// The nearest places of the line, and the tool's way from there.
#[derive(Serialize)]
struct Trail {
    x: Vec<f64>,
    y: Vec<f64>,
    off_x_um: Vec<f64>,
    off_y_um: Vec<f64>,
}

/// Writes the page of a path that was played on a machine with these numbers; `file` is its name.
///
/// # Errors
/// The error from `out`, or no motor holds the machine.
pub fn write(
    out: &mut impl Write,
    file: &str,
    (machine, params): (Machine, &Params),
    report: &Report,
    watch: &Watch,
) -> Result<()> {
    let reach = workspace(machine, params);
    let freedom = Freedom { idlers: true, rotors: true, ..Freedom::default() };
    let setup = Setup { machine, params: params.clone(), tool: reach.centre(), freedom };
    let bins = &watch.series.bins;
    // Tension at rest of each span's belt.
    let belts = machine.belts();
    let of_belt = |(belt, run): (usize, &Belt)| vec![params.preload_n.of(belt); run.spans.len()];
    let at_rest: Vec<f64> = belts.iter().enumerate().flat_map(of_belt).collect();
    let rest = |span: usize| at_rest.get(span).copied().unwrap_or(0.0);
    let span = |(i, name): (usize, &str)| Curve {
        name: name.to_owned(),
        low: bins.iter().map(|bin| bin.tensions_n.get(i).map_or(rest(i), |range| range[0])).map(fine).collect(),
        high: bins.iter().map(|bin| bin.tensions_n.get(i).map_or(rest(i), |range| range[1])).map(fine).collect(),
    };
    let torque = |(i, motor): (usize, u8)| Curve {
        name: motor.to_string(),
        low: Vec::new(),
        high: bins.iter().map(|bin| bin.forces_n.get(i).map_or(0.0, |f| f * params.radius_mm(i))).map(fine).collect(),
    };
    let motors = |end: usize| bins.iter().map(|bin| bin.motors_torque_n_mm[end]).map(fine).collect();
    let moved = |(axis, name): (usize, &str)| Curve {
        name: name.to_owned(),
        low: Vec::new(),
        high: bins.iter().map(|bin| fine(1000.0 * bin.frame_mm[axis])).collect(),
    };
    let frame = ["x", "y"].into_iter().enumerate().filter(|_| watch.frame_mm.is_some());
    let spans = machine.span_names().into_iter().enumerate();
    let data = Data {
        file,
        machine: machine.name(),
        report,
        reach_x: reach.x,
        reach_y: reach.y,
        bin_s: watch.series.bin_ticks as f64 / TICKS_PER_SECOND,
        error: bins.iter().map(|bin| (bin.error_mm * 1e5).round() / 1e5).collect(),
        spans: spans.map(span).collect(),
        torques: machine.motors().into_iter().enumerate().map(torque).collect(),
        motors_torque: Curve { name: "all".to_owned(), low: motors(0), high: motors(1) },
        frame: frame.map(moved).collect(),
        path: path(watch),
        trail: trail(watch),
        resonance: Resonance::new(&setup, GRID, GRID)?,
    };
    fill(out, RUN, &data).context("cannot write the report")
}

/// Writes a page with its style, its data and its script in it.
///
/// # Errors
/// The error from `out`, or the frame has no places for them.
pub fn fill(out: &mut impl Write, script: &'static str, data: &impl Serialize) -> Result<()> {
    // A file name with "</script>" in it must not end the script.
    let json = serde_json::to_string(data)?.replace('<', "\\u003c");
    let (style, shared) = (viewer::style(), [&viewer::shared(), SHARED].concat());
    out.write_all(HEAD.as_bytes())?;
    let mut rest = FRAME;
    for (mark, text) in MARKS.into_iter().zip([&style, &shared, &json, script]) {
        let (before, behind) = rest.split_once(mark).with_context(|| format!("the page has no place for {mark}"))?;
        out.write_all(before.as_bytes())?;
        out.write_all(text.as_bytes())?;
        rest = behind;
    }
    out.write_all(rest.as_bytes())?;
    Ok(out.flush()?)
}

/// Writes the page of frequencies alone; `model` names the parts that may move besides the tool.
///
/// # Errors
/// The error from `out`.
pub fn write_resonance(
    out: &mut impl Write,
    (machine, model): (Machine, &'static str),
    resonance: &Resonance,
) -> Result<()> {
    #[derive(Serialize)]
    struct Data<'a> {
        machine: &'static str,
        model: &'static str,
        resonance: &'a Resonance,
    }
    fill(out, RESONANCE, &Data { machine: machine.name(), model, resonance }).context("cannot write the report")
}

/// Two decimals.
fn fine(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn trail(watch: &Watch) -> Trail {
    let places = &watch.contour.trail.places;
    let all = |of: fn(&Beside) -> f64, digits: f64| places.iter().map(|p| (of(p) * digits).round() / digits).collect();
    let um = |of: fn(&Beside) -> f64| places.iter().map(|p| (of(p) * 1e4).round() / 10.0).collect();
    Trail { x: all(|p| p.at[0], 1e3), y: all(|p| p.at[1], 1e3), off_x_um: um(|p| p.off[0]), off_y_um: um(|p| p.off[1]) }
}

fn path(watch: &Watch) -> Path {
    let (vertices, errors) = (&watch.contour.vertices, &watch.contour.errors_mm);
    let together = vertices.len().div_ceil(MOST_LINES).max(1);
    let mut path = Path { x: Vec::new(), y: Vec::new(), error_um: Vec::new() };
    for (some, errors) in vertices.chunks(together).zip(errors.chunks(together)) {
        let Some(last) = some.last() else { continue };
        path.x.push((last.at[0] * 1000.0).round() / 1000.0);
        path.y.push((last.at[1] * 1000.0).round() / 1000.0);
        let worst = errors.iter().copied().fold(0.0_f32, f32::max);
        path.error_um.push((f64::from(worst) * 1e4).round() / 10.0);
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_has_a_place_for_each_part_and_scripts_need_no_network() {
        assert_eq!(MARKS.map(|mark| FRAME.matches(mark).count()), [1; 4]);
        assert!(MARKS.map(|mark| FRAME.find(mark)).is_sorted());
        for script in [SHARED, RUN, RESONANCE] {
            assert!(!["http://", "https://", "fetch(", "</script", "<!--"].iter().any(|word| script.contains(word)));
        }
    }
}
