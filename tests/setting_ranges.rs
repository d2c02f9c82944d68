//! Every number among the settings has a greatest legal value, and a least one: a new setting without a range is found
//! here.

use corehbot::settings::{Advance, CornerRule, Settings, ShaperKind};
use corehbot::units::{Hertz, Mm, MmPerSec, Seconds};
use serde_json::Value;

/// The paths of all numbers.
fn numbers(value: &Value, path: &str, into: &mut Vec<String>) {
    match value {
        Value::Number(_) => into.push(path.to_owned()),
        Value::Array(items) => items.iter().enumerate().for_each(|(i, v)| numbers(v, &format!("{path}/{i}"), into)),
        Value::Object(fields) => fields.iter().for_each(|(key, v)| numbers(v, &format!("{path}/{key}"), into)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// Settings with all that may be 0 to switch it off set to something.
fn settings() -> Settings {
    let mut s = Settings::prototype();
    (s.shapers.x.kind, s.shapers.y.kind) = (ShaperKind::Mzv, ShaperKind::Ei);
    for shaper in [&mut s.shapers.x, &mut s.shapers.y] {
        (shaper.span, shaper.motor_frequency) = (Mm::from_num(800), Hertz::from_num(200));
    }
    s.advance = Advance { time: Seconds::from_num(0.05), window: Some(Seconds::from_num(0.03)) };
    (s.min_feed, s.min_travel) = (MmPerSec::from_num(1), MmPerSec::from_num(1));
    s
}

/// The same with another number at a path; `None` if it does not fit into its type.
fn with(settings: &Settings, path: &str, number: i64) -> Option<Settings> {
    let mut value = serde_json::to_value(settings).unwrap();
    *value.pointer_mut(path).unwrap() = number.into();
    serde_json::from_value(value).ok()
}

/// The first of these numbers that fits.
fn changed(settings: &Settings, path: &str, numbers: &[i64]) -> Settings {
    numbers.iter().find_map(|number| with(settings, path, *number)).unwrap()
}

const GREATEST: [i64; 6] =
    [i64::MAX, u32::MAX as i64, i32::MAX as i64, u16::MAX as i64, i16::MAX as i64, u8::MAX as i64];
const LEAST: [i64; 4] = [i64::MIN, i32::MIN as i64, i16::MIN as i64, 0];

/// Numbers that are legal with any value; and numbers with 0 as a legal value, which usually switches something off.
const ANY: [&str; 1] = ["stall_threshold"];
const MAY_BE_0: [&str; 29] = [
    "z_jerk",
    "quiet",
    "retries",
    "own",
    "Sheet",
    "preload",
    "limp_lift",
    "phases",
    "settling_ms",
    "homing_advance",
    "period_ms",
    "fan_loss",
    "ptc",
    "p",
    "i",
    "d",
    "kick_ms",
    "fan_run_on_s",
    "min_feed",
    "min_travel",
    "keepalive_s",
    "patience_ms",
    "hold_percent",
    "hybrid_threshold",
    "span",
    "damping",
    "motor_frequency",
    "fade",
    "hop",
];

fn is_one_of(path: &str, names: &[&str]) -> bool {
    path.split('/').any(|part| names.contains(&part))
}

fn check_all(s: &Settings) {
    assert_eq!(s.check_machine(), Ok(()));
    let mut paths = Vec::new();
    numbers(&serde_json::to_value(s).unwrap(), "", &mut paths);
    // The mechanism has its own checks and tests.
    paths.retain(|path| !path.starts_with("/mechanism"));
    assert!(paths.len() > 60, "{}", paths.len());
    for path in &paths {
        let most = changed(s, path, &GREATEST).check();
        assert_eq!(most.is_err(), !is_one_of(path, &ANY), "{path} at its greatest: {most:?}");
        let least = changed(s, path, &LEAST);
        let may_be_0 = [&ANY[..], &MAY_BE_0].iter().any(|names| is_one_of(path, names))
            || path.starts_with("/advance/time")
            || path.starts_with("/fans/")
            || (path.starts_with("/thermal/fans") && path.contains("/least"))
            || path.starts_with("/minimum_cruise_ratio");
        let is_unsigned = least == with(s, path, 0).unwrap();
        assert_eq!(least.check().is_ok(), may_be_0 && is_unsigned, "{path} at its least: {:?}", least.check());
    }
}

#[test]
fn no_number_among_the_settings_is_without_a_range() {
    let mut s = settings();
    for rule in CornerRule::all() {
        s.corner = rule;
        check_all(&s);
    }
}
