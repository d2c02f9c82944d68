//! The reports of resonance tests.

use super::settings_report::report_shaper;
use crate::accelerometer::SensorFault;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::resonance_answer::{Mode, RawSample, ResonanceAnswer, Suggested, SweepAxis};
use crate::machine::numbers::{Thousandths, shortest};
use crate::settings::HomedAxis;

const fn name(axis: SweepAxis) -> char {
    match axis {
        SweepAxis::X => 'X',
        SweepAxis::Y => 'Y',
        SweepAxis::A => 'A',
        SweepAxis::B => 'B',
    }
}

/// The line of an answer.
pub(in crate::machine) fn report_resonance(to: &mut ReplyWriter<'_>, answer: &ResonanceAnswer) {
    match *answer {
        ResonanceAnswer::NoSensor => to.say(text!("echo:no accelerometer configured (accelerometer.kind)")),
        ResonanceAnswer::Swept(axis) => {
            to.say(text!("echo:swept {}; no accelerometer configured, nothing was measured", name(axis)));
        }
        ResonanceAnswer::Weaker { accel_per_hz, limit } => to.say(text!(
            "echo:ACCEL_PER_HZ reduced to {}: the machine allows {} mm/s2",
            shortest(accel_per_hz),
            shortest(limit)
        )),
        ResonanceAnswer::TooWeak { limit } => to.say(text!(
            "echo:sweep ignored: the machine allows {} mm/s2, too little for it. Lower SWEEPING_ACCEL or FREQ_END",
            shortest(limit)
        )),
        ResonanceAnswer::TooFast { speed, most } => to.say(text!(
            "echo:sweep ignored: it reaches {} mm/s, the machine allows {}. Lower SWEEPING_ACCEL",
            speed.to_num::<u32>(),
            shortest(most)
        )),
        ResonanceAnswer::NoRoom { axis, least, most, reach } => {
            let axis = match axis {
                HomedAxis::X => 'X',
                HomedAxis::Y => 'Y',
                HomedAxis::Z => 'Z',
            };
            let [least, most, from, until] = [least, most, reach.least, reach.most].map(Thousandths);
            to.say(text!(
                "echo:sweep ignored: it takes {axis} from {least} to {most}, the tool reaches {from} to {until}. Move \
                it to the middle first"
            ));
        }
        ResonanceAnswer::Failed(kind, fault) => {
            let kind = kind.name();
            match fault {
                SensorFault::Absent => to.say(text!("echo:this board has no connector for an accelerometer")),
                SensorFault::WrongId(id) => {
                    to.say(text!("echo:no {kind}: its identity reads {id:#04x}. Check plug, cable and kind"));
                }
                SensorFault::Register => to.say(text!("echo:{kind}: a register does not keep its value")),
                SensorFault::Overflow => to.say(text!("echo:{kind}: samples were lost")),
                SensorFault::Silent => to.say(text!("echo:{kind} gives no samples. Check its cable")),
                SensorFault::Stuck => to.say(text!("echo:{kind} gives the same sample all the time")),
            }
        }
        ResonanceAnswer::Noisy(kind, [x, y, z]) => to.say(text!(
            "echo:{} is too noisy at rest: x {x} y {y} z {z} mm/s2. Check its cable and the fans",
            kind.name()
        )),
        ResonanceAnswer::Sensor { kind, rate, noise: [x, y, z] } => {
            let kind = kind.name();
            to.say(text!("Accelerometer 0: {kind}, rate {rate}, noise x {x} y {y} z {z} mm/s2"));
        }
        // Klipper's form (adxl345.py), with whole mm/s^2.
        ResonanceAnswer::RawHead => to.say(text!("#time,accel_x,accel_y,accel_z")),
        ResonanceAnswer::Raw(RawSample { us, axes: [x, y, z] }) => {
            to.say(text!("{}.{:06},{x},{y},{z}", us / 1_000_000, us % 1_000_000));
        }
        ResonanceAnswer::Found { axis, modes, shaper } => {
            let axis = name(axis);
            for Mode { centihertz, damping, fit_error } in modes.into_iter().flatten() {
                let (hertz, rest) = (centihertz / 100, centihertz % 100);
                to.say(text!(
                    "resonance {axis}: {hertz}.{rest:02} Hz damping 0.{damping:03} (fit error 0.{fit_error:03})"
                ));
            }
            if let Some(Suggested { shaper, percent, most }) = shaper {
                report_shaper(to, axis, shaper);
                to.say(text!(
                    "echo:it leaves {percent} %, at up to {} mm/s2. Send the line to set it",
                    most.to_num::<u32>()
                ));
            }
            match modes {
                [None, _] => to.say(text!("echo:resonance {axis}: no peak within the sweep")),
                [Some(_), None] => to.say(text!("echo:one mode only")),
                [Some(_), Some(_)] => {}
            }
        }
    }
}
