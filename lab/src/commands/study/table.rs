//! Table: samples as CSV, a row each, in their order.
//!
//! A number is the shortest one that reads back to the same bits, and a missing figure is empty. The last column says
//! why a row has no figures.

use super::plan::{Sample, Study};
use std::io::{self, Write};

/// Writes the table.
///
/// # Errors
/// The error from `out`.
pub(super) fn write(out: &mut impl Write, study: &Study, samples: &[Sample]) -> io::Result<()> {
    let figures: Vec<&str> = study.figures().collect();
    let keys: Vec<&str> = study.keys.iter().map(String::as_str).collect();
    writeln!(out, "{},error", [&["sample", "machine"], &keys[..], &figures].concat().join(","))?;
    for sample in samples {
        let Some(point) = study.point(sample.number) else { continue };
        write!(out, "{},{}", sample.number, point.machine.key())?;
        for value in point.values {
            write!(out, ",{value}")?;
        }
        match &sample.outcome {
            Ok(figures) => {
                for figure in figures {
                    write!(out, ",{}", figure.map(|figure| figure.to_string()).unwrap_or_default())?;
                }
                writeln!(out, ",")?;
            }
            Err(error) => {
                let empty = ",".repeat(figures.len());
                writeln!(out, "{empty},{}", quoted(error))?;
            }
        }
    }
    out.flush()
}

/// As RFC 4180 has texts that may have commas in them.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
