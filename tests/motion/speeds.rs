//! The speeds of a released move, read back from its fractions and times.

use corehbot::motion::{Move, WHOLE};

/// At its begin, the greatest, and at its end: `length`s a second. The longest of its phases shows the greatest best.
pub fn speeds(m: &Move, length: f64) -> [f64; 3] {
    let mean = |way: f64, time: u64| way * length / (time as f64 / 65536.0 / 1e7);
    let part = |fraction: u32| f64::from(fraction) / f64::from(WHOLE);
    let (rise, fall) = (part(m.accelerated), 1.0 - part(m.cruised));
    let level = 1.0 - rise - fall;
    let peak = if level > rise.max(fall) {
        mean(level, m.cruise.0)
    } else if rise > fall {
        mean(rise, m.accelerate.0) * (2.0 - part(m.entry_share))
    } else {
        mean(fall, m.decelerate.0) * (2.0 - part(m.exit_share))
    };
    let end = |share: u32| peak * part(share) / (2.0 - part(share));
    let entry = if m.accelerate.0 == 0 { peak } else { end(m.entry_share) };
    [entry, peak, if m.decelerate.0 == 0 { peak } else { end(m.exit_share) }]
}
