//! Density: the text of a file with spectra, as Klipper's TEST_RESONANCES and SHAPER_CALIBRATE write it.
//!
//! `freq,psd_x,psd_y,psd_z,psd_xyz` has one spectrum. A file of several sensors or places has a sum of each,
//! `freq,NAME,NAME`. With `shapers:` behind them the values are over frequency already (Klipper,
//! `calibrate_shaper.py`). Frequencies have one digit behind the point, so their distance comes from the last one.

use crate::recording::Flaw;
use crate::spectrum::{Density, Spectrum};

/// Begin of the first line.
const HEAD: &str = "freq,";

/// The columns of a file with one spectrum.
const ONE: [&str; 4] = ["psd_x", "psd_y", "psd_z", "psd_xyz"];

/// Fewest frequencies, and the distance of theirs that can be: windows of 0.05 to 5 s.
const FEWEST: usize = 30;
const STEPS_HZ: std::ops::RangeInclusive<f64> = 0.2..=20.0;

/// Whether a text is such a file.
#[must_use]
pub fn is_density(text: &str) -> bool {
    let line = text.trim_start_matches('\u{feff}').lines().find(|line| !line.trim().is_empty());
    line.is_some_and(|line| line.trim_start_matches(['#', ' ']).to_ascii_lowercase().starts_with(HEAD))
}

/// Reads the spectra with their names; a single one has none.
///
/// # Errors
/// It is no spectrum, or one that would mislead.
pub fn read(text: &str) -> Result<Vec<(String, Density)>, Flaw> {
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate();
    let mut lines = lines.map(|(i, line)| (i + 1, line.trim())).filter(|(_, line)| !line.is_empty());
    let (_, header) = lines.next().ok_or(Flaw::Empty)?;
    let words: Vec<&str> = header.split(',').skip(1).map(|word| word.trim().trim_matches('"')).collect();
    let end = words.iter().position(|word| word.starts_with("shapers:"));
    let names = words.get(..end.unwrap_or(words.len())).unwrap_or_default();
    let (mut hz, mut columns) = (Vec::new(), vec![Vec::new(); names.len()]);
    for (number, line) in lines.filter(|(_, line)| !line.starts_with('#')) {
        let mut values = line.split(',').map(str::trim);
        hz.push(value(number, values.next().unwrap_or_default())?);
        for (i, column) in columns.iter_mut().enumerate() {
            let word = values.next().ok_or(Flaw::Columns(number, i + 1, names.len() + 1))?;
            column.push(value(number, word)?);
        }
    }
    let step_hz = match (hz.first(), hz.last()) {
        (Some(first), Some(last)) if hz.len() >= FEWEST && *first == 0.0 => last / (hz.len() - 1) as f64,
        _ => return Err(Flaw::Frequencies),
    };
    let is_even = hz.iter().enumerate().all(|(i, hz)| (hz - i as f64 * step_hz).abs() <= 0.11);
    if !STEPS_HZ.contains(&step_hz) || !is_even {
        return Err(Flaw::Frequencies);
    }
    let is_normalised = end.is_some();
    if names == ONE
        && let Ok([x, y, z, sum]) = <[Vec<f64>; 4]>::try_from(columns.clone())
    {
        return Ok(vec![(
            String::new(),
            Density { spectrum: Spectrum { step_hz, axes: [x, y, z], sum }, is_normalised },
        )]);
    }
    let made = |(name, sum): (&&str, Vec<f64>)| {
        let spectrum = Spectrum { step_hz, axes: [const { Vec::new() }; 3], sum };
        ((*name).to_owned(), Density { spectrum, is_normalised })
    };
    Ok(names.iter().zip(columns).map(made).collect())
}

fn value(line: usize, word: &str) -> Result<f64, Flaw> {
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
    value.ok_or_else(|| Flaw::Number(line, word.chars().take(30).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(header: &str, row: impl Fn(usize) -> String) -> String {
        (0..129).fold(format!("{header}\n"), |text, i| format!("{text}{:.1}{}\n", i as f64 * 1.5625, row(i)))
    }

    #[test]
    fn files_of_klipper_are_read() {
        let one = read(&text("freq,psd_x,psd_y,psd_z,psd_xyz", |i| format!(",{i}.0e+01,2,3,{i}.5"))).unwrap();
        let [(name, density)] = &one[..] else { panic!("{one:?}") };
        assert!(name.is_empty() && !density.is_normalised && (density.spectrum.step_hz - 1.5625).abs() < 1e-3);
        assert_eq!((density.spectrum.axes[0][7], density.spectrum.sum[7]), (70.0, 7.5));
        let header = "freq,psd_x,psd_y,psd_z,psd_xyz,shapers:,zv(48.8),mzv(50.2)";
        assert!(read(&text(header, |_| ",1,2,3,6,,0.5,0.4".to_owned())).unwrap()[0].1.is_normalised);
        let two = read(&text("freq,adxl345:a,\"beacon\",shapers:,zv(48.8)", |_| ",1,2,,0.5".to_owned())).unwrap();
        assert_eq!(two.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["adxl345:a", "beacon"]);
        assert!(two[1].1.spectrum.axes[0].is_empty() && two[1].1.spectrum.sum[0] == 2.0);
    }

    #[test]
    fn what_would_mislead_is_refused() {
        let header = "freq,psd_x,psd_y,psd_z,psd_xyz";
        assert_eq!(read(""), Err(Flaw::Empty));
        assert_eq!(read(&format!("{header}\n")), Err(Flaw::Frequencies));
        assert_eq!(read(&text(header, |_| ",1,2".to_owned())), Err(Flaw::Columns(2, 3, 5)));
        assert_eq!(read(&text(header, |_| ",1,nan,2,3".to_owned())), Err(Flaw::Number(2, "nan".to_owned())));
        let uneven = text(header, |_| ",1,2,3,6".to_owned()).replace("\n78.1,", "\n79.0,");
        assert_eq!(read(&uneven), Err(Flaw::Frequencies));
    }
}
