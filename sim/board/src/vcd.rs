//! The same events as a VCD file, for GTKWave and PulseView: one step and one dir wire a motor.
//!
//! The timescale is one tick (100 ns). A step pulse is drawn one tick wide: the real one is shorter, and
//! one tick is the most that cannot run into the next event. Events at the same tick share a pulse.

use ::vcd::{IdCode, TimescaleUnit, Value, Writer};
use corehbot::motors::{MOTORS, Motor, MotorName, MotorSet};
use std::io::{self, Write};

/// Writes events as a VCD file.
///
/// An I/O error is kept and returned by [`finish`](Self::finish), so that a sink need not fail.
pub struct VcdWriter<W: Write> {
    out: Writer<W>,
    step: [IdCode; MOTORS],
    dir: [IdCode; MOTORS],
    high: MotorSet,
    forward: MotorSet,
    tick: u64,
    error: Option<io::Error>,
}

impl<W: Write> VcdWriter<W> {
    /// Writes the header and all wires low.
    ///
    /// # Errors
    /// The output's error.
    pub fn new(out: W, names: &[MotorName; MOTORS]) -> io::Result<Self> {
        let mut out = Writer::new(out);
        out.comment("CoreH-bot step events; the tick is motion time")?;
        out.timescale(100, TimescaleUnit::NS)?;
        out.add_module("corehbot")?;
        let mut step = [IdCode::FIRST; MOTORS];
        let mut dir = step;
        for (i, name) in names.iter().enumerate().take_while(|(_, name)| !name.is_none()) {
            step[i] = out.add_wire(1, &format!("{name}_step"))?;
            dir[i] = out.add_wire(1, &format!("{name}_dir"))?;
        }
        out.upscope()?;
        out.enddefinitions()?;
        out.timestamp(0)?;
        let columns = names.iter().take_while(|name| !name.is_none()).count();
        for id in step.into_iter().take(columns).chain(dir.into_iter().take(columns)) {
            out.change_scalar(id, Value::V0)?;
        }
        Ok(Self { out, step, dir, high: MotorSet::NONE, forward: MotorSet::NONE, tick: 0, error: None })
    }

    /// One instant in which `steps` move, each forward or backward.
    pub fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        if self.error.is_none() {
            self.error = self.draw(tick, steps, forward).err();
        }
    }

    /// Ends the last pulse and the file.
    ///
    /// # Errors
    /// The first error that the output reported.
    pub fn finish(mut self) -> io::Result<()> {
        if let Some(error) = self.error.take() {
            return Err(error);
        }
        self.fall()?;
        self.out.timestamp(self.tick + 1)?;
        self.out.flush()
    }

    fn draw(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) -> io::Result<()> {
        if tick > self.tick {
            self.fall()?;
            if tick > self.tick {
                self.time(tick)?;
            }
        }
        let turned = MotorSet(self.forward.0 ^ forward.0);
        change(&mut self.out, &self.dir, turned, forward)?;
        change(&mut self.out, &self.step, steps.without(self.high), steps)?;
        self.forward = forward;
        self.high = self.high.with(steps);
        Ok(())
    }

    /// Ends the pulse that is drawn, one tick after its begin.
    fn fall(&mut self) -> io::Result<()> {
        if self.high.is_empty() {
            return Ok(());
        }
        self.time(self.tick + 1)?;
        change(&mut self.out, &self.step, self.high, MotorSet::NONE)?;
        self.high = MotorSet::NONE;
        Ok(())
    }

    fn time(&mut self, tick: u64) -> io::Result<()> {
        self.tick = tick;
        self.out.timestamp(tick)
    }
}

fn change<W: Write>(
    out: &mut Writer<W>,
    wires: &[IdCode; MOTORS],
    which: MotorSet,
    values: MotorSet,
) -> io::Result<()> {
    for (id, motor) in wires.iter().zip(Motor::ALL) {
        if which.has(motor) {
            out.change_scalar(*id, values.has(motor))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use corehbot::motors::prototype;

    fn body(events: &[(u64, u8, u8)]) -> Vec<String> {
        let mut bytes = Vec::new();
        let mut writer = VcdWriter::new(&mut bytes, &prototype::NAMES).unwrap();
        for &(tick, steps, forward) in events {
            writer.event(tick, MotorSet(steps), MotorSet(forward));
        }
        writer.finish().unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("$timescale 100 ns $end"));
        assert!(text.contains("$var wire 1 ! m1_step $end"));
        let (_, body) = text.split_once("$enddefinitions $end").unwrap();
        body.lines().skip(1).skip_while(|l| *l == "#0" || l.starts_with('0')).map(str::to_owned).collect()
    }

    #[test]
    fn a_pulse_lasts_one_tick() {
        assert_eq!(
            body(&[(5, 1, 1), (100, 1, 0)]),
            ["#5", "1\"", "1!", "#6", "0!", "#100", "0\"", "1!", "#101", "0!", "#102"]
        );
    }

    #[test]
    fn a_pulse_ends_where_the_next_event_begins() {
        assert_eq!(body(&[(5, 1, 0), (6, 4, 0)]), ["#5", "1!", "#6", "0!", "1%", "#7", "0%", "#8"]);
    }
}
