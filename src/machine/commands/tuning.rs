//! Tuning: M303 finds out how a heater behaves, and with U1 takes it over.

use super::heating::LINE_MS;
use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::console::{Console, PortSet};
use crate::machine::interrupt::Interrupt;
use crate::machine::state::waiting::Waiting;
use crate::port::{Clock, Pend};
use crate::settings::{HeaterSettings, Pid, Range, ranges};
use crate::status::{Tuned, Tuning};
use crate::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, WattsPerKelvin};

/// M303 without C, and its range: the relay experiment throws the first swing away.
const CYCLES: u8 = 5;
const CYCLE_RANGE: Range<u16> = Range { least: 3, most: 20 };

impl<P: PortSet, W: Pend> Console<'_, P, W> {
    /// M303.
    pub(in crate::machine) async fn tune(
        &mut self,
        heater: Option<Heater>,
        target: Option<Number>,
        cycles: Option<Number>,
        applies: bool,
    ) -> Result<Answer<'static>, Interrupt> {
        let heater = match self.model_of(heater) {
            Ok(heater) => heater,
            Err(answer) => return Ok(answer),
        };
        if self.link.status().heat().measured(heater).is_none() {
            return Ok(Answer::Line("echo:M303 ignored: there is no reading"));
        }
        let range = Range { least: Celsius::ZERO, most: self.settings.thermal.heater(heater).most };
        // Marlin's defaults (M303.cpp), for the chamber too.
        let default = Number::from(if heater == Heater::Hotend { 150 } else { 70 });
        let target = self.clamps.near(["M303", "S"], target.unwrap_or(default), range);
        if target == Celsius::ZERO {
            return Ok(Answer::Line("echo:M303 ignored: S is the temperature to tune at"));
        }
        let cycles = cycles.map_or(CYCLES, |cycles| self.clamps.whole(["M303", "C"], cycles, CYCLE_RANGE) as u8);
        self.tell_clamps().await?;
        self.finish().await?;
        self.tell(Answer::Line("PID Autotune start")).await?;
        self.pauses.begin(Waiting::Tuning);
        self.test_before_heating();
        self.await_self_test().await?;
        self.heat_orders.tune(heater, target, cycles);
        let found = self.await_tuning(heater).await;
        self.pauses.end();
        // Done, failed or ended by M108, M410: in any case it is over.
        self.heat_orders.heat(heater, Celsius::ZERO);
        self.send_orders();
        let Some(tuned) = found? else {
            return Ok(Answer::Line(
                "PID Autotune failed! It was ended, or the temperature did not swing as it should",
            ));
        };
        if applies {
            apply(&tuned, self.settings.thermal.heater_mut(heater));
            self.heat_orders.note_settings();
        }
        self.tell(Answer::Tuned(heater, tuned)).await?;
        Ok(if applies { Answer::Nothing } else { Answer::Line("echo:nothing is changed, M303 U1 uses what it finds") })
    }

    /// Waits for the end of a tuning; `None` if it failed, or M108 ended it.
    async fn await_tuning(&mut self, heater: Heater) -> Result<Option<Tuned>, Interrupt> {
        // The first state that is told is that of an earlier tuning.
        let status = self.link.status();
        while !self.heat_orders.is_empty() {
            self.turn().await?;
        }
        let begun = status.heat().periods();
        let (mut next_line, mut cycle) = (self.ports.clock.now(), 0);
        while !self.pauses.is_over() {
            let now = self.ports.clock.now();
            if now >= next_line {
                next_line = next_line.after_ms(LINE_MS);
                self.tell(Answer::Heating(None)).await?;
            }
            if status.heat().periods().wrapping_sub(begun) > 2 {
                match status.heat().tuning() {
                    Tuning::Done => return Ok(Some(status.heat().tuned())),
                    Tuning::Cycle(done) => {
                        if core::mem::replace(&mut cycle, done) != done {
                            self.tell(Answer::TuningCycle(heater, done)).await?;
                        }
                    }
                    Tuning::None | Tuning::Failed => return Ok(None),
                }
            }
            self.turn().await?;
        }
        Ok(None)
    }
}

/// Takes over what M303 has found. The two lags cannot be told apart, so each gets half. A loss to the part fan that
/// was not found stays.
fn apply(tuned: &Tuned, heater: &mut HeaterSettings) {
    let lag = ranges::LAG.clamp(Seconds::from_bits(tuned.lag / 2));
    heater.model.capacity = ranges::CAPACITY.clamp(JoulesPerKelvin::from_bits(tuned.capacity));
    heater.model.loss = ranges::LOSS.clamp(WattsPerKelvin::from_bits(tuned.loss));
    if tuned.fan_loss > 0 {
        heater.model.fan_loss = WattsPerKelvin::from_bits(tuned.fan_loss).min(ranges::LOSS.most);
    }
    (heater.model.heater_lag, heater.model.sensor_lag) = (lag, lag);
    let [p, i, d] = [tuned.p, tuned.i, tuned.d].map(|gain| ranges::GAIN.clamp(Ratio::from_bits(gain)));
    heater.pid = Pid { p, i, d };
}
