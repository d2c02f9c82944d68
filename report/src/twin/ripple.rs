//! The picture of `twin ripple`: a map of speed and angle as SVG, with its scale.

use anyhow::{Context as _, Result};
use corehbot_twin::math::{ln, powf};
use corehbot_twin::queries::ripple::Ripple;
use std::fmt::Write as _;
use std::io::Write;

/// Colours from calm to loud (viridis, as on the pages), darkest first.
const COLOURS: [&str; 10] =
    ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];

/// Left, top, width and height of the map.
const MAP: [f64; 4] = [62.0, 34.0, 560.0, 288.0];

/// The scale begins at this part of the greatest value at the lowest: a factor of a hundred.
const LEAST_PART: f64 = 0.01;

/// Distances of the marks on both axes, in mm/s and degrees.
const MARKS: [f64; 2] = [50.0, 45.0];

/// Writes the map.
///
/// # Errors
/// The error from `out`.
pub fn write(out: &mut impl Write, ripple: &Ripple) -> Result<()> {
    let text = draw(ripple).context("cannot draw the map")?;
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).context("cannot write the map")
}

/// Colours over the logarithm of the amplitude.
struct Scale {
    low: f64,
    high: f64,
}

impl Scale {
    fn of(ripple: &Ripple) -> Self {
        let all = || ripple.across_um.iter().flatten().copied();
        let high = all().fold(f64::MIN_POSITIVE, f64::max);
        let low = all().fold(high, f64::min).max(LEAST_PART * high).min(high / 1.01);
        Self { low, high }
    }

    fn level(&self, um: f64) -> usize {
        let part = ln(um.max(self.low) / self.low) / ln(self.high / self.low);
        ((part * COLOURS.len() as f64) as usize).min(COLOURS.len() - 1)
    }

    /// The least amplitude of a level.
    fn from(&self, level: usize) -> f64 {
        self.low * powf(self.high / self.low, level as f64 / COLOURS.len() as f64)
    }
}

fn draw(ripple: &Ripple) -> Result<String, std::fmt::Error> {
    let [left, top, width, height] = MAP;
    let scale = Scale::of(ripple);
    let speeds = &ripple.speeds_mm_s;
    let (first, last) = (speeds.first().copied().unwrap_or(0.0), speeds.last().copied().unwrap_or(1.0));
    let cell = width / speeds.len().max(1) as f64;
    let row = height / ripple.angles_deg.len().max(1) as f64;
    let across = |speed: f64| left + cell / 2.0 + (width - cell) * (speed - first) / (last - first).max(1e-9);
    let down = |angle: f64| top + row / 2.0 + height * angle / 180.0;
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 380\" font-family=\"sans-serif\" font-size=\"12\">"
    )?;
    writeln!(svg, "<rect width=\"720\" height=\"380\" fill=\"#fff\"/>")?;
    let at = &ripple.at;
    let (name, x, y) = (corehbot_twin::routing::Machine::name_of(at.machine), at.x_mm, at.y_mm);
    let title = format!("Amplitude of the ripple across the wall, {name} at ({x:.0}, {y:.0}) mm");
    writeln!(svg, "<title>{title}</title>\n<text x=\"{left}\" y=\"20\">{title}</text>")?;
    // Runs of one colour along a row are one rectangle, and all of one colour one path.
    let mut paths = vec![String::new(); COLOURS.len()];
    for (i, line) in ripple.across_um.iter().enumerate() {
        let levels: Vec<usize> = line.iter().map(|um| scale.level(*um)).collect();
        let mut begin = 0;
        for run in levels.chunk_by(|a, b| a == b) {
            let level = run.first().copied().unwrap_or(0);
            let (x, y) = (left + cell * begin as f64, top + row * i as f64);
            if let Some(path) = paths.get_mut(level) {
                let long = cell * run.len() as f64;
                write!(path, "M{x:.1} {y:.1}h{long:.1}v{row:.1}h-{long:.1}z")?;
            }
            begin += run.len();
        }
    }
    for (path, colour) in paths.iter().zip(COLOURS).filter(|(path, _)| !path.is_empty()) {
        writeln!(svg, "<path fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\".3\" d=\"{path}\"/>")?;
    }
    let mut speed = (first / MARKS[0]).ceil() * MARKS[0];
    while speed <= last {
        let (x, y) = (across(speed), top + height);
        writeln!(svg, "<path stroke=\"#333\" d=\"M{x:.1} {y}v4\"/>")?;
        writeln!(svg, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{speed}</text>", y + 17.0)?;
        speed += MARKS[0];
    }
    for angle in (0..4).map(|i| f64::from(i) * MARKS[1]) {
        let y = down(angle) + 4.0;
        writeln!(svg, "<text x=\"{:.1}\" y=\"{y:.1}\" text-anchor=\"end\">{angle}\u{b0}</text>", left - 6.0)?;
    }
    let middle = left + width / 2.0;
    writeln!(svg, "<text x=\"{middle}\" y=\"{:.1}\" text-anchor=\"middle\">speed, mm/s</text>", top + height + 36.0)?;
    let turned = top + height / 2.0;
    writeln!(
        svg,
        "<text transform=\"translate(18 {turned})rotate(-90)\" text-anchor=\"middle\">direction of travel from x to y</text>"
    )?;
    let x = left + width + 14.0;
    for (level, colour) in COLOURS.iter().enumerate() {
        let step = height / COLOURS.len() as f64;
        let y = top + height - step * (level + 1) as f64;
        writeln!(svg, "<rect x=\"{x}\" y=\"{y:.1}\" width=\"14\" height=\"{step:.1}\" fill=\"{colour}\"/>")?;
        let from = scale.from(level);
        let digits = if from < 1.0 { 2 } else { 1 };
        writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\">{from:.digits$}</text>", x + 18.0, y + step + 4.0)?;
    }
    writeln!(svg, "<text x=\"{x}\" y=\"{:.1}\">um</text>", top - 6.0)?;
    writeln!(svg, "</svg>")?;
    Ok(svg)
}
