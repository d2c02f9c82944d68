//! The test: from the first sample to the last step.
//!
//! Shaping is off only in the sweep itself; the drop of the motion behind it, after M410 as well, brings it back. A
//! sensor that fails ends the sweep by a brake, and the tool goes back to where it was.

use super::choice::Search;
use super::listen::{AT_ONCE, Listener, MOST_NOISE};
use super::modes::{modes, shaken};
use super::plan::{refusal, wanted, weaken};
use super::response::{Response, step_hz};
use crate::accelerometer::SensorFault;
use crate::gcode::{SweepAxis, SweepWords};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::resonance_answer::{ResonanceAnswer, Suggested};
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::sweep::sweep as start_sweep;
use crate::machine::ports::PortSet;
use crate::machine::state::clamps::Clamps;
use crate::motion::{Sweep, Target};
use crate::port::{Accelerometer, EndstopSet, Pend};
use crate::settings::{Shaper, Shapers};
use crate::units::{Instant, Mm};
use core::pin::pin;

/// Rest before the noise counts, and its time: the sensor starts in some ms.
const NOISE_MS: u32 = 1000;

/// M955.
pub(in crate::machine) async fn examine_sensor<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
) -> Result<ResonanceAnswer, Interrupt> {
    main_loop.finish().await?;
    let mut response = Response::new();
    let Some(kind) = main_loop.settings.accelerometer.kind else { return Ok(ResonanceAnswer::NoSensor) };
    let heard = apart(pin!(hear_noise(main_loop, SweepAxis::X, &mut response))).await;
    main_loop.accelerometer.stop();
    Ok(match heard? {
        Ok(listener) => ResonanceAnswer::Sensor { kind, rate: listener.rate(), noise: listener.noise.deviation() },
        Err(fault) => ResonanceAnswer::Failed(kind, fault),
    })
}

/// M956: so many samples of the resting tool.
pub(in crate::machine) async fn tell_samples<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    count: u32,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    let Some(kind) = main_loop.settings.accelerometer.kind else {
        return Ok(Answer::Resonance(ResonanceAnswer::NoSensor));
    };
    let told = tell(main_loop, count).await;
    main_loop.accelerometer.stop();
    Ok(told?.err().map_or(Answer::Nothing, |fault| Answer::Resonance(ResonanceAnswer::Failed(kind, fault))))
}

async fn tell<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    count: u32,
) -> Result<Result<(), SensorFault>, Interrupt> {
    let mut response = Response::new();
    let mut listener = match apart(pin!(hear_noise(main_loop, SweepAxis::X, &mut response))).await? {
        Ok(listener) => listener,
        Err(fault) => return Ok(Err(fault)),
    };
    main_loop.reply(Answer::Resonance(ResonanceAnswer::RawHead)).await?;
    let begin = main_loop.now();
    listener.begin(&Sweep::NONE, begin);
    let mut told = 0;
    while told < count && !main_loop.pauses.is_over() {
        main_loop.poll().await?;
        match apart(pin!(hear(main_loop, &mut listener, &mut response, Some(begin)))).await? {
            Ok(taken) => told += taken,
            Err(fault) => return Ok(Err(fault)),
        }
    }
    Ok(Ok(()))
}

/// TEST_RESONANCES.
pub(in crate::machine) async fn test_resonances<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    words: &SweepWords,
) -> Result<Answer<'static>, Interrupt> {
    if main_loop.job.is_under_way() {
        return Ok(Answer::Line(packed!("echo:sweep ignored: a print is under way")));
    }
    main_loop.finish().await?;
    if main_loop.homed.lacks_one_of([true, true, false]) {
        return Ok(Answer::NotHomed);
    }
    let mut sweep = wanted(&main_loop.settings, words, clamps);
    if clamps.refuses_line() {
        return Ok(Answer::Nothing);
    }
    let limit = sweep.brake;
    let weaker = ResonanceAnswer::Weaker { accel_per_hz: sweep.accel_per_hz, limit };
    let weaker = match weaken(&mut sweep) {
        None => return Ok(Answer::Resonance(ResonanceAnswer::TooWeak { limit })),
        Some(false) => None,
        Some(true) => Some(match weaker {
            ResonanceAnswer::Weaker { limit, .. } => {
                ResonanceAnswer::Weaker { accel_per_hz: sweep.accel_per_hz, limit }
            }
            other => other,
        }),
    };
    if let Some(refused) = refusal(main_loop, words.axis, &sweep).await? {
        return Ok(Answer::Resonance(refused));
    }
    if let Some(weaker) = weaker {
        main_loop.reply(Answer::Resonance(weaker)).await?;
    }
    main_loop.power_up(main_loop.motion.groups().fitted()).await?;
    let place = main_loop.motion.end_mm();
    let mut response = Response::new();
    let tested = test(main_loop, words.axis, sweep, &mut response, words.wants_raw).await;
    main_loop.accelerometer.stop();
    let tested = tested?;
    go_back(main_loop, place).await?;
    let blocks = match tested {
        Tested::Heard { blocks_a_second } => blocks_a_second,
        Tested::Answer(answer) => return Ok(Answer::Resonance(answer)),
    };
    let ends = [sweep.from, sweep.to].map(|hertz| hertz.to_bits() as f32 / 65_536.0);
    let step = step_hz(blocks);
    let ends = shaken(step, ends);
    let found = modes(&response, step, &ends);
    let base = shaper_of(&main_loop.settings.shapers, words.axis).filter(|_| words.chooses);
    let shaper = match base.filter(|_| !found.is_empty()) {
        Some(base) => {
            let mut search = Search::new(&response, step, &ends);
            while search.step() {
                main_loop.poll().await?;
            }
            let chosen = search.found();
            let shaper = chosen.shaper(base);
            let percent = (chosen.left * 100.0 + 0.5) as u8;
            Some(Suggested { shaper, percent, most: chosen.most_acceleration() })
        }
        None => None,
    };
    let modes = [0, 1].map(|place| found.get(place).copied());
    Ok(Answer::Resonance(ResonanceAnswer::Found { axis: words.axis, modes, shaper }))
}

/// The shaper of an axis; a diagonal has none.
const fn shaper_of(shapers: &Shapers, axis: SweepAxis) -> Option<Shaper> {
    match axis {
        SweepAxis::X => Some(shapers.x),
        SweepAxis::Y => Some(shapers.y),
        SweepAxis::A | SweepAxis::B => None,
    }
}

/// What came of a sweep.
enum Tested {
    /// The sensor was heard to its end.
    Heard { blocks_a_second: f32 },
    /// There is nothing to reckon with.
    Answer(ResonanceAnswer),
}

/// Sweeps the tool and listens; shaping is on again.
async fn test<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: SweepAxis,
    sweep: Sweep,
    response: &mut Response,
    wants_raw: bool,
) -> Result<Tested, Interrupt> {
    let kind = main_loop.settings.accelerometer.kind;
    let mut listener = None;
    if let Some(kind) = kind {
        let heard = match apart(pin!(hear_noise(main_loop, axis, response))).await? {
            Ok(listener) => listener,
            Err(fault) => return Ok(Tested::Answer(ResonanceAnswer::Failed(kind, fault))),
        };
        let noise = heard.noise.deviation();
        if noise.iter().any(|noise| *noise >= MOST_NOISE) {
            return Ok(Tested::Answer(ResonanceAnswer::Noisy(kind, noise)));
        }
        if wants_raw {
            main_loop.reply(Answer::Resonance(ResonanceAnswer::RawHead)).await?;
        }
        listener = Some(heard);
    }
    start_sweep(main_loop, sweep).await?;
    let begin = main_loop.now();
    if let Some(listener) = &mut listener {
        listener.begin(&sweep, begin);
    }
    let mut failure = None;
    while main_loop.motion.has_motion() && failure.is_none() {
        main_loop.poll().await?;
        if let Some(listener) = &mut listener {
            failure = apart(pin!(hear(main_loop, listener, response, wants_raw.then_some(begin)))).await?.err();
        }
    }
    if failure.is_some() {
        main_loop.slow_down().await?;
    }
    main_loop.drop_motion().await?;
    Ok(match (failure, kind, listener) {
        (Some(fault), Some(kind), _) => Tested::Answer(ResonanceAnswer::Failed(kind, fault)),
        (None, _, Some(listener)) => Tested::Heard { blocks_a_second: listener.blocks_a_second() },
        _ => Tested::Answer(ResonanceAnswer::Swept(axis)),
    })
}

/// Starts the sensor and hears its noise for a second.
async fn hear_noise<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    axis: SweepAxis,
    response: &mut Response,
) -> Result<Result<Listener, SensorFault>, Interrupt> {
    let sensor = main_loop.settings.accelerometer;
    let Some(kind) = sensor.kind else { return Ok(Err(SensorFault::Absent)) };
    main_loop.accelerometer.start(kind, sensor.rate);
    let mut listener = Listener::new(sensor, axis, main_loop.now());
    let end = main_loop.now().after_ms(NOISE_MS);
    while main_loop.now() < end {
        main_loop.poll().await?;
        if let Err(fault) = apart(pin!(hear(main_loop, &mut listener, response, None))).await? {
            return Ok(Err(fault));
        }
    }
    Ok(Ok(listener))
}

/// Takes all samples that have come. With the time of a begin they are told to the host; if it takes them too slowly,
/// the sensor's buffer overflows, which ends the test. Returns their number.
async fn hear<P: PortSet, W: Pend>(
    main_loop: &mut MainLoop<'_, P, W>,
    listener: &mut Listener,
    response: &mut Response,
    told_from: Option<Instant>,
) -> Result<Result<u32, SensorFault>, Interrupt> {
    let mut count = 0;
    loop {
        let now = main_loop.turn_began();
        let taken = match listener.listen(&mut main_loop.accelerometer, now, response) {
            Ok(taken) => taken,
            Err(fault) => return Ok(Err(fault)),
        };
        count += taken as u32;
        if let Some(begin) = told_from {
            for place in 0..taken {
                let sample = listener.raw(place, taken, begin);
                main_loop.reply(Answer::Resonance(ResonanceAnswer::Raw(sample))).await?;
            }
        }
        if taken < AT_ONCE {
            return Ok(Ok(count));
        }
    }
}

/// Brings the tool back to where it was.
async fn go_back<P: PortSet, W: Pend>(main_loop: &mut MainLoop<'_, P, W>, place: [Mm; 4]) -> Result<(), Interrupt> {
    let speed = main_loop.settings.axes.x.max_speed.min(main_loop.settings.axes.y.max_speed);
    main_loop
        .plan(Target { position: place, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE })
        .await?;
    main_loop.finish().await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(())
}
