//! Values: readers of words on the command line.

/// A reader of a number within a range.
pub fn number(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse::<f64>() {
        Ok(v) if (least..=most).contains(&v) => Ok(v),
        _ => Err(format!("`{text}` is not a number from {least} to {most}")),
    }
}
