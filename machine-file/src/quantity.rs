//! Quantities: a number of the file becomes a value in its legal range, or an error that says what is legal.

use super::MachineFileError;
use corehbot::settings::{AxisEnd, Range, ranges};
use corehbot::units::{
    Celsius, Hertz, JoulesPerKelvin, Mm, MmPerSec, MmPerSec2, Ratio, Seconds, StepsPerMm, Watts, WattsPerKelvin,
};
use std::fmt::Display;

/// A kind of quantity: its legal range, and how it comes from a number that is not NaN.
pub(super) struct Kind<T> {
    pub range: Range<T>,
    pub convert: fn(f64) -> T,
}

pub(super) const RESOLUTION: Kind<StepsPerMm> =
    Kind { range: ranges::STEPS_PER_MM, convert: StepsPerMm::saturating_from_num::<f64> };
pub(super) const SPEED: Kind<MmPerSec> = Kind { range: ranges::SPEED, convert: MmPerSec::saturating_from_num::<f64> };
pub(super) const LEAST_SPEED: Kind<MmPerSec> =
    Kind { range: Range { least: MmPerSec::ZERO, most: ranges::SPEED.most }, ..SPEED };
pub(super) const ACCELERATION: Kind<MmPerSec2> =
    Kind { range: ranges::ACCELERATION, convert: MmPerSec2::saturating_from_num::<f64> };
pub(super) const AXIS_LENGTH: Kind<Mm> = Kind { range: ranges::AXIS_LENGTH, convert: Mm::saturating_from_num::<f64> };
pub(super) const BED_EDGE: Kind<Mm> = Kind { range: ranges::BED_EDGE, ..AXIS_LENGTH };
pub(super) const HOMING_ADVANCE: Kind<Mm> = Kind { range: ranges::HOMING_ADVANCE, ..AXIS_LENGTH };
pub(super) const LIMP_LIFT: Kind<Mm> = Kind { range: ranges::LIMP_LIFT, ..AXIS_LENGTH };
pub(super) const PAUSE_RETRACT: Kind<Mm> = Kind { range: ranges::PAUSE_RETRACT, ..AXIS_LENGTH };
pub(super) const PAUSE_LIFT: Kind<Mm> = Kind { range: ranges::PAUSE_LIFT, ..AXIS_LENGTH };
pub(super) const PRELOAD: Kind<Mm> = Kind { range: ranges::PRELOAD, ..AXIS_LENGTH };
pub(super) const TOLERANCE: Kind<Mm> = Kind { range: ranges::TOLERANCE, ..AXIS_LENGTH };
pub(super) const BACK_OFF: Kind<Mm> = Kind { range: ranges::BACK_OFF, ..AXIS_LENGTH };
pub(super) const BAUD: Kind<u32> =
    Kind { range: ranges::BAUD, convert: |baud| if baud.fract() == 0.0 { baud as u32 } else { 0 } };
pub(super) const FREQUENCY: Kind<Hertz> = Kind { range: ranges::FREQUENCY, convert: Hertz::saturating_from_num::<f64> };
pub(super) const BELT_SPAN: Kind<Mm> =
    Kind { range: Range { least: Mm::ZERO, most: ranges::BELT_SPAN.most }, ..AXIS_LENGTH };
pub(super) const MOTOR_FREQUENCY: Kind<Hertz> = Kind { range: ranges::MOTOR_FREQUENCY, ..FREQUENCY };
pub(super) const DAMPING: Kind<Ratio> = Kind { range: ranges::DAMPING, convert: Ratio::saturating_from_num::<f64> };
pub(super) const CRUISE_RATIO: Kind<Ratio> = Kind { range: ranges::CRUISE_RATIO, ..DAMPING };
pub(super) const ADVANCE: Kind<Seconds> = Kind { range: ranges::ADVANCE, convert: Seconds::saturating_from_num::<f64> };
pub(super) const ADVANCE_WINDOW: Kind<Seconds> = Kind { range: ranges::ADVANCE_WINDOW, ..ADVANCE };
pub(super) const LOOKAHEAD_TIME: Kind<Seconds> = Kind { range: ranges::LOOKAHEAD_TIME, ..ADVANCE };
pub(super) const PATIENCE: Kind<u16> =
    Kind { range: Range { least: 0, most: ranges::PATIENCE_MS.most }, convert: |ms| ms as u16 };
pub(super) const SETTLING: Kind<u16> = Kind { range: ranges::SETTLING_MS, ..PATIENCE };
pub(super) const PHASE: Kind<u16> = Kind {
    range: Range { least: 0, most: ranges::PHASE.most - 1 },
    convert: |phase| if phase.fract() == 0.0 { phase as u16 } else { u16::MAX },
};
pub(super) const KEEPALIVE: Kind<u8> = Kind { range: ranges::KEEPALIVE_S, convert: |s| s as u8 };

pub(super) const HOTEND: Kind<Celsius> = Kind { range: ranges::HOTEND, convert: Celsius::saturating_from_num::<f64> };
pub(super) const BED: Kind<Celsius> = Kind { range: ranges::BED, ..HOTEND };
pub(super) const MIN_EXTRUDE: Kind<Celsius> = Kind { range: ranges::MIN_EXTRUDE, ..HOTEND };
pub(super) const COLD_END: Kind<Celsius> = Kind { range: ranges::COLD_END, ..HOTEND };
pub(super) const LOST: Kind<Celsius> = Kind { range: ranges::LOST, ..HOTEND };
pub(super) const OFF_RISE: Kind<Celsius> = Kind { range: ranges::OFF_RISE, ..HOTEND };
pub(super) const OVERSHOOT: Kind<Celsius> = Kind { range: ranges::OVERSHOOT, ..HOTEND };
pub(super) const POWER: Kind<Watts> = Kind { range: ranges::POWER, convert: Watts::saturating_from_num::<f64> };
pub(super) const CAPACITY: Kind<JoulesPerKelvin> =
    Kind { range: ranges::CAPACITY, convert: JoulesPerKelvin::saturating_from_num::<f64> };
pub(super) const LOSS: Kind<WattsPerKelvin> =
    Kind { range: ranges::LOSS, convert: WattsPerKelvin::saturating_from_num::<f64> };
pub(super) const LEAST_LOSS: Kind<WattsPerKelvin> =
    Kind { range: Range { least: WattsPerKelvin::ZERO, most: ranges::LOSS.most }, ..LOSS };
pub(super) const FILAMENT: Kind<WattsPerKelvin> = Kind { range: ranges::FILAMENT, ..LOSS };
pub(super) const LAG: Kind<Seconds> = Kind { range: ranges::LAG, ..ADVANCE };
pub(super) const GAIN: Kind<Ratio> = Kind { range: ranges::GAIN, ..DAMPING };
pub(super) const HEATING: Kind<Ratio> = Kind { range: ranges::HEATING, ..DAMPING };
pub(super) const MAX_DUTY: Kind<Ratio> = Kind { range: ranges::MAX_DUTY, ..DAMPING };
pub(super) const PART: Kind<Ratio> = Kind { range: Range { least: Ratio::ZERO, most: Ratio::ONE }, ..DAMPING };

/// Where a switch at that end of an axis may sit.
pub(super) fn endstop_position(end: AxisEnd, length: Mm) -> Kind<Mm> {
    Kind { range: ranges::endstop_position(end, length), ..AXIS_LENGTH }
}

/// Puts a whole number of the file, if there is one, in the place of the default.
pub(super) fn put_whole<T: PartialOrd + Copy + Display + Into<f64> + TryFrom<u16>>(
    slot: &mut T,
    key: &str,
    value: Option<f64>,
    range: Range<T>,
) -> Result<(), MachineFileError> {
    let Some(value) = value else { return Ok(()) };
    // A saturated or cut number is no longer the one in the file.
    let whole = T::try_from(value as u16).ok().filter(|whole| (*whole).into() == value && range.holds(*whole));
    let legal = || format!("the whole numbers {} to {}", range.least, range.most);
    *slot = whole.ok_or_else(|| MachineFileError::Range { key: key.to_owned(), value, legal: legal() })?;
    Ok(())
}

/// Puts a value of the file, if there is one, in the place of the default.
pub(super) fn put<T: PartialOrd + Copy + Display>(
    slot: &mut T,
    key: &str,
    value: Option<f64>,
    kind: &Kind<T>,
) -> Result<(), MachineFileError> {
    if let Some(value) = value {
        *slot = quantity(key, value, kind)?;
    }
    Ok(())
}

pub(super) fn quantity<T: PartialOrd + Copy + Display>(
    key: &str,
    value: f64,
    kind: &Kind<T>,
) -> Result<T, MachineFileError> {
    let Kind { range, convert } = kind;
    // Conversions saturate, which leaves an illegal value illegal, but they have no answer to NaN.
    match (!value.is_nan()).then(|| convert(value)) {
        Some(legal) if range.holds(legal) => Ok(legal),
        _ => {
            let legal = format!("{} to {}", range.least, range.most);
            Err(MachineFileError::Range { key: key.to_owned(), value, legal })
        }
    }
}
