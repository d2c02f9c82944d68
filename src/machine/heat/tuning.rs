//! Tuning: M303 finds out how a heater behaves, and with U1 takes it over.

use super::heating::{LINE_MS, await_readings, model_of, report_wait};
use super::self_test::await_self_test;
use crate::connectors::Heater;
use crate::gcode::Number;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::numbers::shortest;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::machine::state::waiting::Waiting;
use crate::port::{Storage, Wake};
use crate::settings::{HeaterSettings, Pid, Range, ranges};
use crate::status::{Tuned, Tuning, TuningFailure};
use crate::text::Packed;
use crate::units::{Celsius, JoulesPerKelvin, Ratio, Seconds, WattsPerKelvin};
use core::pin::pin;

/// M303 without C, and its range: the relay experiment throws the first swing away.
const CYCLES: u16 = 5;
const CYCLE_RANGE: Range<u16> = Range { least: 3, most: 20 };

/// Closer to a room's temperature there is no oscillation.
const LEAST_TARGET: Celsius = Celsius::const_from_int(40);

/// The words of M303, M306 T.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct TuningWords {
    /// E: 0 the hotend, -1 the bed, -2 the chamber; `None` for another number.
    pub heater: Option<Heater>,
    /// S, in degrees Celsius.
    pub target: Option<Number>,
    /// C: swings.
    pub cycles: Option<Number>,
    /// U: whether to use the result.
    pub applies: bool,
}

/// M303.
pub(in crate::machine) async fn tune<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    words: &TuningWords,
) -> Result<Answer<'static>, Interrupt> {
    let TuningWords { heater, target, cycles, applies } = *words;
    let heater = match model_of(&main_loop.settings.thermal, heater) {
        Ok(heater) => heater,
        Err(line) => return Ok(Answer::Line(line)),
    };
    await_readings(main_loop, Heater::ALL.map(|other| other == heater)).await?;
    if let Some(why) = main_loop.heat.refusal(heater, &main_loop.settings.thermal) {
        main_loop.say(text!("echo:M303 ignored: {why}"));
        return Ok(Answer::Said);
    }
    if main_loop.heat.believed(heater).is_none() {
        return Ok(Answer::Line(packed!("echo:M303 ignored: there is no reading")));
    }
    let range = Range { least: Celsius::ZERO, most: main_loop.settings.thermal.heater(heater).most };
    // Marlin's defaults (M303.cpp); the chamber gets the bed's.
    let default = Number::from(if heater == Heater::Hotend { 150 } else { 70 });
    let target = clamps.near_of(["M303", "S"], target.unwrap_or(default), range, None);
    let cycles = cycles.map_or(Some(CYCLES), |cycles| clamps.whole_of(["M303", "C"], cycles, CYCLE_RANGE, None));
    let (Some(target), Some(cycles)) = (target, cycles) else { return Ok(Answer::Nothing) };
    if target < LEAST_TARGET {
        return Ok(Answer::Line(packed!("echo:M303 ignored: S is the temperature to tune at, 40 or more")));
    }
    main_loop.finish().await?;
    main_loop.say(text!("PID Autotune start"));
    main_loop.pauses.begin(Waiting::Tuning);
    let image = main_loop.storage.image();
    main_loop.heat.test_before_heating(&main_loop.settings.thermal, image);
    await_self_test(main_loop).await?;
    main_loop.heat.tune(heater, target, cycles as u8);
    let found = apart(pin!(await_tuning(main_loop, heater))).await;
    main_loop.pauses.end();
    // Done, failed or ended by M108, M410: in any case it is over.
    main_loop.heat.set_target(heater, Celsius::ZERO);
    main_loop.heat.send_orders(&main_loop.settings.thermal);
    let tuned = match found? {
        Ok(tuned) => tuned,
        Err(failure) => return Ok(Answer::Line(way_out(failure))),
    };
    if applies {
        apply(&tuned, main_loop.heat_settings().heater_mut(heater));
        main_loop.heat.baselines().forget(heater);
    }
    main_loop.tell(|to, _| report_tuned(to, heater, &tuned));
    Ok(if applies {
        Answer::Nothing
    } else {
        Answer::Line(packed!("echo:settings are unchanged; M303 U1 uses the result"))
    })
}

/// The result. Hosts look for Marlin's words.
fn report_tuned(to: &mut ReplyWriter<'_>, heater: Heater, tuned: &Tuned) {
    let [p, i, d] = [tuned.p, tuned.i, tuned.d].map(|bits| shortest(Ratio::from_bits(bits)));
    to.say(text!("PID Autotune finished!"));
    to.say(text!(" Kp: {p} Ki: {i} Kd: {d}"));
    let capacity = shortest(JoulesPerKelvin::from_bits(tuned.capacity));
    let loss = shortest(WattsPerKelvin::from_bits(tuned.loss));
    let lag = shortest(Seconds::from_bits(tuned.lag));
    to.say(text!("echo:{}: {capacity} J/K, {loss} W/K, lag {lag} s", heater.name()));
    if tuned.ptc > 0 {
        let ptc = shortest(Ratio::from_bits(tuned.ptc));
        to.say(text!("echo:{}: PTC, resistance grows by {ptc} a K", heater.name()));
    }
    if tuned.fan_loss > 0 {
        let fan = shortest(WattsPerKelvin::from_bits(tuned.fan_loss));
        to.say(text!("echo:{}: {fan} W/K more with the part fan", heater.name()));
    }
}

/// Why a tuning failed, and how to continue. Hosts look for Marlin's words.
const fn way_out(failure: Option<TuningFailure>) -> Packed {
    match failure {
        None => packed!("PID Autotune failed! It was ended"),
        Some(TuningFailure::StaysHot) => {
            packed!("PID Autotune failed! It does not cool down: switch off what warms it, or give a higher S")
        }
        Some(TuningFailure::OutOfReach) => {
            packed!("PID Autotune failed! Full power does not reach S: give a lower one, or check heater and supply")
        }
        Some(TuningFailure::NoSwing) => {
            packed!("PID Autotune failed! The temperature does not swing: check how the sensor sits, or give another S")
        }
        Some(TuningFailure::Impossible) => {
            packed!("PID Autotune failed! No heater is like that: set its power (M306 P), check how the sensor sits")
        }
    }
}

/// Waits for the end of a tuning: why it failed, or nothing if M108 ended it.
async fn await_tuning<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    heater: Heater,
) -> Result<Result<Tuned, Option<TuningFailure>>, Interrupt> {
    // The first state reported is still the state of an earlier tuning.
    let status = main_loop.status;
    while !main_loop.heat.are_orders_gone() {
        main_loop.poll().await?;
    }
    let begun = status.heat().periods();
    let (mut next_line, mut cycle, mut is_cooling) = (main_loop.now(), 0, false);
    while !main_loop.pauses.is_over() {
        let now = main_loop.now();
        if now >= next_line {
            next_line = next_line.after_ms(LINE_MS);
            main_loop.reply(Answer::words(&|to, facts| report_wait(to, facts, None))).await?;
        }
        if status.heat().periods().wrapping_sub(begun) > 2 {
            match status.heat().tuning() {
                Tuning::Done => return Ok(Ok(status.heat().tuned())),
                Tuning::DoneWithoutFan => {
                    main_loop
                        .say(text!("echo:with the part fan it does not reach S; its loss to the fan stays as it was"));
                    return Ok(Ok(status.heat().tuned()));
                }
                Tuning::Cooling => {
                    if !core::mem::replace(&mut is_cooling, true) {
                        main_loop.say(text!("echo:too hot to begin, it cools first; M108 ends this wait"));
                    }
                }
                Tuning::Cycle(done) => {
                    if core::mem::replace(&mut cycle, done) != done {
                        main_loop.say(text!("echo:{}: {done} cycles done", heater.name()));
                    }
                }
                Tuning::None => return Ok(Err(None)),
                Tuning::Failed(failure) => return Ok(Err(Some(failure))),
            }
        }
        main_loop.poll().await?;
    }
    Ok(Err(None))
}

/// Takes over the result of M303. The two lags cannot be told apart, so each gets half. A loss to the part fan that was
/// not found stays.
fn apply(tuned: &Tuned, heater: &mut HeaterSettings) {
    let lag = ranges::LAG.clamp(Seconds::from_bits(tuned.lag / 2));
    heater.model.capacity = ranges::CAPACITY.clamp(JoulesPerKelvin::from_bits(tuned.capacity));
    heater.model.loss = ranges::LOSS.clamp(WattsPerKelvin::from_bits(tuned.loss));
    if tuned.fan_loss > 0 {
        heater.model.fan_loss = WattsPerKelvin::from_bits(tuned.fan_loss).min(ranges::LOSS.most);
    }
    (heater.model.heater_lag, heater.model.sensor_lag) = (lag, lag);
    heater.model.ptc = ranges::PTC.clamp(Ratio::from_bits(tuned.ptc));
    let [p, i, d] = [tuned.p, tuned.i, tuned.d].map(|gain| ranges::GAIN.clamp(Ratio::from_bits(gain)));
    heater.pid = Pid { p, i, d };
}
