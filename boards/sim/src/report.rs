//! Report: one page that shows the tool path, speed and load of a print, without any network.
//!
//! The page is a template; what is drawn stands in it as one JSON object. The path, the bulk of it, is
//! packed to 12 bytes a point and base64, so the page stays below 2 MB however long the print.

use crate::path::{Point, ToolPath};
use crate::summary::Summary;
use crate::tally::Figures;
use corehbot::settings::Settings;
use corehbot::units::TICKS_PER_SECOND;
use serde::Serialize;

/// The page; [`MARK`] stands where the data goes.
const TEMPLATE: &str = include_str!("report.html");

/// Where the data goes.
const MARK: &str = "/*DATA*/";

/// x, y and z as fractions of their range (u16), ms since the start (u32), speed as a fraction (u8), whether
/// filament went forward (u8); little-endian.
const POINT_BYTES: usize = 12;

#[derive(Serialize)]
struct Data<'a> {
    summary: &'a Summary,
    /// Reachable space in mm.
    size: [f64; 3],
    /// Least and greatest value of each coordinate of the path.
    range: [[f32; 2]; 3],
    /// The speed that the fraction 255 means.
    top_speed: f32,
    /// Points of the path, packed.
    path: String,
    /// Seconds a bin of the curves.
    bin_s: f64,
    /// Mean and peak speed of each bin in mm/s, and events a second.
    speed: Vec<f64>,
    peak: Vec<f64>,
    rate: Vec<u64>,
}

/// The page.
///
/// # Errors
/// None that is known: the data is numbers and text.
pub fn render(summary: &Summary, figures: &Figures, settings: &Settings) -> serde_json::Result<String> {
    let range = range(&figures.path);
    let top_speed = figures.path.points().iter().map(|p| p.speed).fold(1.0, f32::max);
    let bin_s = figures.series.bin_ticks() as f64 / f64::from(TICKS_PER_SECOND);
    let bins = figures.series.bins();
    let data = Data {
        summary,
        size: [settings.axes.x, settings.axes.y, settings.axes.z].map(|a| a.length.to_num()),
        range,
        top_speed,
        path: base64(&pack(&figures.path, range, top_speed)),
        bin_s,
        speed: bins.iter().map(|b| tenth(f64::from(b.path) / bin_s)).collect(),
        peak: bins.iter().map(|b| tenth(b.peak_speed.into())).collect(),
        rate: bins.iter().map(|b| (f64::from(b.events) / bin_s).round() as u64).collect(),
    };
    // A file name with "</script>" in it must not end the script.
    let json = serde_json::to_string(&data)?.replace('<', "\\u003c");
    Ok(TEMPLATE.replacen(MARK, &json, 1))
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

fn range(path: &ToolPath) -> [[f32; 2]; 3] {
    let mut range = [[f32::INFINITY, f32::NEG_INFINITY]; 3];
    for point in path.points() {
        for ([least, most], value) in range.iter_mut().zip(point.at) {
            *least = least.min(value);
            *most = most.max(value);
        }
    }
    if path.points().is_empty() { [[0.0, 0.0]; 3] } else { range }
}

fn pack(path: &ToolPath, range: [[f32; 2]; 3], top_speed: f32) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(path.points().len() * POINT_BYTES);
    for &Point { at, speed, tick, is_printing } in path.points() {
        for (value, [least, most]) in at.into_iter().zip(range) {
            let fraction = if most > least { (value - least) / (most - least) } else { 0.0 };
            bytes.extend_from_slice(&((fraction * 65535.0).round() as u16).to_le_bytes());
        }
        let ms = tick / u64::from(TICKS_PER_SECOND / 1000);
        bytes.extend_from_slice(&u32::try_from(ms).unwrap_or(u32::MAX).to_le_bytes());
        bytes.push((speed / top_speed * 255.0).round() as u8);
        bytes.push(u8::from(is_printing));
    }
    bytes
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_as_the_rfc_says() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn the_template_has_one_place_for_data_and_needs_no_network() {
        assert_eq!(TEMPLATE.matches(MARK).count(), 1);
        assert!(!TEMPLATE.contains("http://") && !TEMPLATE.contains("https://"));
    }
}
