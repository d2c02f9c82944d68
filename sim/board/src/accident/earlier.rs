//! Earlier: friction on a motor was `MOTOR,N[,S[,MS]]` before there was one grammar. Old commands still say so.

use super::error::AccidentError;
use super::table::Family;

/// The text of today, if this one is of the earlier form: it has commas, and no `@`.
///
/// # Errors
/// It has not two to four parts, or no legal number of ms.
pub(super) fn today(text: &str) -> Result<Option<String>, AccidentError> {
    if text.contains('@') || !text.contains(',') {
        return Ok(None);
    }
    let (motor, force, from, ms) = match text.split(',').map(str::trim).collect::<Vec<_>>()[..] {
        [motor, force] => (motor, force, "0", None),
        [motor, force, from] => (motor, force, from, None),
        [motor, force, from, ms] => (motor, force, from, Some(ms)),
        _ => return Err(AccidentError::Brake(text.to_owned())),
    };
    if motor.is_empty() {
        return Err(AccidentError::Brake(text.to_owned()));
    }
    let lasts = match ms {
        Some(ms) => {
            let ms = ms.parse::<f64>().map_err(|_| AccidentError::time(ms, Family::Belts))?;
            format!("+{}s", ms / 1000.0)
        }
        None => String::new(),
    };
    Ok(Some(format!("rub:{motor}:{force}@{from}s{lasts}")))
}
