//! The test: from the first sample to the last step.
//!
//! Shaping is off only in the sweep itself; the drop of the motion behind it, after M410 as well, brings it back. A
//! sensor that fails ends the sweep by a brake, and the tool goes back to where it was.

use super::choice::{Search, Suggested};
use super::listen::{AT_ONCE, Listener, MOST_NOISE, RawSample};
use super::modes::{MOST as MOST_MODES, Mode, modes, shaken};
use super::no_result::NoResult;
use super::plan::{Refusal, SweepAxis, SweepWords, extremes, refusal, wanted, weaken};
use super::response::{Response, step_hz};
use crate::accelerometer::SensorFault;
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::apart::apart;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::sweep::sweep as start_sweep;
use crate::machine::numbers::shortest;
use crate::machine::ports::PortSet;
use crate::machine::reports::settings_report::report_shaper;
use crate::machine::state::clamps::Clamps;
use crate::machine::states::tell_clamps;
use crate::motion::{Sweep, Target};
use crate::port::{Accelerometer, EndstopSet, Wake};
use crate::settings::{Shaper, Shapers};
use crate::units::{Hertz, Instant, Mm};
use core::ops::RangeInclusive;
use core::pin::pin;
use heapless::Vec;

/// Rest before the noise counts, and its time: the sensor starts in some ms.
const NOISE_MS: u32 = 1000;

/// What hears a sensor.
struct Session {
    /// `None` before it starts, and on a machine without a sensor.
    listener: Option<Listener>,
    response: Response,
    /// Samples are told to the host, with their time from then.
    told_from: Option<Instant>,
    /// Samples that were taken.
    taken: u32,
    /// Why the sensor is not heard any more.
    fault: Option<SensorFault>,
}

/// The end of hearing, besides a fault of the sensor.
enum Until {
    Time(Instant),
    /// So many samples, or the end of a pause.
    Taken(u32),
    /// The tool rests.
    Rest,
}

impl Session {
    const fn new() -> Self {
        Self { listener: None, response: Response::new(), told_from: None, taken: 0, fault: None }
    }

    /// From now on the tool is swept.
    fn begin(&mut self, sweep: &Sweep, now: Instant, is_told: bool) {
        if let Some(listener) = &mut self.listener {
            listener.begin(sweep, now);
        }
        self.told_from = is_told.then_some(now);
        self.taken = 0;
    }
}

/// M955, and M956: so many samples of the resting tool.
pub(in crate::machine) async fn examine_sensor<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    samples: Option<u32>,
) -> Result<Answer<'static>, Interrupt> {
    main_loop.finish().await?;
    let Some(kind) = main_loop.settings.accelerometer.kind else {
        return Ok(Answer::Line(packed!("echo:no accelerometer configured (accelerometer.kind)")));
    };
    let mut session = Session::new();
    let heard = hear_resting(main_loop, &mut session, samples).await;
    main_loop.accelerometer.stop();
    heard?;
    match (session.fault, &session.listener) {
        (Some(fault), _) => main_loop.say(text!("echo:{}", NoResult::Failed(kind, fault))),
        (None, Some(listener)) if samples.is_none() => {
            let (kind, rate, [x, y, z]) = (kind.name(), listener.rate(), listener.noise.deviation());
            main_loop.say(text!("Accelerometer 0: {kind}, rate {rate}, noise x {x} y {y} z {z} mm/s2"));
        }
        _ => return Ok(Answer::Nothing),
    }
    Ok(Answer::Said)
}

/// Says the first line of Klipper's raw data (adxl345.py).
fn tell_raw_head<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    main_loop.say(text!("#time,accel_x,accel_y,accel_z"));
}

async fn hear_resting<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    session: &mut Session,
    samples: Option<u32>,
) -> Result<(), Interrupt> {
    hear_noise(main_loop, session, SweepAxis::X).await?;
    let Some(samples) = samples.filter(|_| session.fault.is_none()) else { return Ok(()) };
    tell_raw_head(main_loop);
    session.begin(&Sweep::NONE, main_loop.now(), true);
    apart(pin!(hear(main_loop, session, Until::Taken(samples)))).await
}

/// TEST_RESONANCES.
pub(in crate::machine) async fn test_resonances<P: PortSet, W: Wake>(
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
    let Some(is_weaker) = weaken(&mut sweep) else {
        return Ok(refuse(main_loop, clamps, Refusal::TooWeak { limit }));
    };
    let extremes = extremes(main_loop, &sweep).await?;
    if let Some(refused) = refusal(main_loop, words.axis, &extremes) {
        return Ok(refuse(main_loop, clamps, refused));
    }
    if is_weaker {
        let (accel_per_hz, limit) = (shortest(sweep.accel_per_hz), shortest(limit));
        main_loop.say(text!("echo:ACCEL_PER_HZ reduced to {accel_per_hz}: the machine allows {limit} mm/s2"));
    }
    main_loop.power_up(main_loop.motion.groups().fitted()).await?;
    let place = main_loop.motion.end_mm();
    let mut session = Session::new();
    let tested = test(main_loop, words, &sweep, &mut session).await;
    main_loop.accelerometer.stop();
    let tested = tested?;
    go_back(main_loop, place).await?;
    if let Some(none) = tested {
        tell_clamps(main_loop, clamps);
        main_loop.say(text!("echo:{none}"));
        return Ok(Answer::Said);
    }
    let heard = Heard::new(&session, &sweep);
    let base = shaper_of(&main_loop.settings.shapers, words.axis);
    let mut search = base.filter(|_| words.chooses && !heard.modes.is_empty()).map(|base| (base, heard.search()));
    while search.as_mut().is_some_and(|(_, search)| search.step()) {
        main_loop.poll().await?;
    }
    let shaper = search.map(|(base, search)| search.found().suggested(base));
    let modes = heard.both_modes();
    tell_clamps(main_loop, clamps);
    main_loop.tell(|to, _| report_found(to, words.axis.name(), modes, shaper));
    Ok(Answer::Said)
}

/// Says why a sweep is not made, as the answer.
fn refuse<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    why: Refusal,
) -> Answer<'static> {
    tell_clamps(main_loop, clamps);
    main_loop.say(text!("echo:sweep ignored: {why}"));
    Answer::Said
}

/// The modes, the highest peak first, and the shaper if there is to be one.
fn report_found(to: &mut ReplyWriter<'_>, axis: char, modes: [Option<Mode>; MOST_MODES], shaper: Option<Suggested>) {
    for Mode { centihertz, damping, fit_error } in modes.into_iter().flatten() {
        let (hertz, rest) = (centihertz / 100, centihertz % 100);
        to.say(text!("resonance {axis}: {hertz}.{rest:02} Hz damping 0.{damping:03} (fit error 0.{fit_error:03})"));
    }
    if let Some(Suggested { shaper, percent, most }) = shaper {
        report_shaper(to, axis, shaper);
        let most = most.to_num::<u32>();
        to.say(text!("echo:it leaves {percent} %, at up to {most} mm/s2. Send the line to set it"));
    }
    match modes {
        [None, _] => to.say(text!("echo:resonance {axis}: no peak within the sweep")),
        [Some(_), None] => to.say(text!("echo:one mode only")),
        [Some(_), Some(_)] => {}
    }
}

/// What was heard of a sweep.
struct Heard<'s> {
    response: &'s Response,
    /// Hz from one frequency to the next.
    step: f32,
    /// The numbers of the frequencies that count.
    ends: RangeInclusive<usize>,
    modes: Vec<Mode, MOST_MODES>,
}

impl<'s> Heard<'s> {
    #[inline(never)]
    fn new(session: &'s Session, sweep: &Sweep) -> Self {
        let response = &session.response;
        let step = step_hz(session.listener.as_ref().map_or(0.0, Listener::blocks_a_second));
        let hertz = |hertz: Hertz| hertz.to_bits() as f32 / 65_536.0;
        let ends = shaken(step, [hertz(sweep.from), hertz(sweep.to)]);
        let modes = modes(response, step, &ends);
        Self { response, step, ends, modes }
    }

    fn search(&self) -> Search<'s> {
        Search::new(self.response, self.step, &self.ends)
    }

    fn both_modes(&self) -> [Option<Mode>; MOST_MODES] {
        let mut modes = [None; MOST_MODES];
        for (mode, found) in modes.iter_mut().zip(&self.modes) {
            *mode = Some(*found);
        }
        modes
    }
}

/// The shaper of an axis; a diagonal has none.
const fn shaper_of(shapers: &Shapers, axis: SweepAxis) -> Option<Shaper> {
    match axis {
        SweepAxis::X => Some(shapers.x),
        SweepAxis::Y => Some(shapers.y),
        SweepAxis::A | SweepAxis::B => None,
    }
}

/// Sweeps the tool and listens; shaping is on again. Returns why there is nothing to reckon with, if there is nothing.
async fn test<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    words: &SweepWords,
    sweep: &Sweep,
    session: &mut Session,
) -> Result<Option<NoResult>, Interrupt> {
    let kind = main_loop.settings.accelerometer.kind;
    if let Some(kind) = kind {
        hear_noise(main_loop, session, words.axis).await?;
        if let Some(fault) = session.fault {
            return Ok(Some(NoResult::Failed(kind, fault)));
        }
        let noise = session.listener.as_ref().map_or([0; 3], |listener| listener.noise.deviation());
        if noise.iter().any(|noise| *noise >= MOST_NOISE) {
            return Ok(Some(NoResult::Noisy(kind, noise)));
        }
        if words.wants_raw {
            tell_raw_head(main_loop);
        }
    }
    start_sweep(main_loop, *sweep).await?;
    session.begin(sweep, main_loop.now(), words.wants_raw);
    apart(pin!(hear(main_loop, session, Until::Rest))).await?;
    if session.fault.is_some() {
        main_loop.slow_down().await?;
    }
    main_loop.drop_motion().await?;
    Ok(match (kind, session.fault) {
        (Some(kind), Some(fault)) => Some(NoResult::Failed(kind, fault)),
        (Some(_), None) => None,
        (None, _) => Some(NoResult::Swept(words.axis)),
    })
}

/// Starts the sensor, if there is one, and hears its noise for a second.
async fn hear_noise<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    session: &mut Session,
    axis: SweepAxis,
) -> Result<(), Interrupt> {
    let sensor = main_loop.settings.accelerometer;
    let Some(kind) = sensor.kind else { return Ok(()) };
    main_loop.accelerometer.start(kind, sensor.rate);
    session.listener = Some(Listener::new(sensor, axis, main_loop.now()));
    let end = main_loop.now().after_ms(NOISE_MS);
    apart(pin!(hear(main_loop, session, Until::Time(end)))).await
}

/// Takes samples as they come, until an end or a fault. If the host is told and takes them too slowly, the sensor's
/// buffer overflows, which is a fault.
async fn hear<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    session: &mut Session,
    until: Until,
) -> Result<(), Interrupt> {
    while session.fault.is_none() {
        let is_over = match until {
            Until::Time(end) => main_loop.now() >= end,
            Until::Taken(samples) => session.taken >= samples || main_loop.pauses.is_over(),
            Until::Rest => !main_loop.motion.has_motion(),
        };
        if is_over {
            break;
        }
        main_loop.poll().await?;
        let Some(listener) = &mut session.listener else { continue };
        loop {
            let now = main_loop.turn_began();
            let taken = match listener.listen(&mut main_loop.accelerometer, now, &mut session.response) {
                Ok(taken) => taken,
                Err(fault) => {
                    session.fault = Some(fault);
                    break;
                }
            };
            session.taken += taken as u32;
            if let Some(begin) = session.told_from {
                for place in 0..taken {
                    let RawSample { us, axes: [x, y, z] } = listener.raw(place, taken, begin);
                    let (seconds, us) = (us / 1_000_000, us % 1_000_000);
                    main_loop.reply(Answer::words(&|to, _| to.say(text!("{seconds}.{us:06},{x},{y},{z}")))).await?;
                }
            }
            if taken < AT_ONCE {
                break;
            }
        }
    }
    Ok(())
}

/// Brings the tool back to where it was.
async fn go_back<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>, place: [Mm; 4]) -> Result<(), Interrupt> {
    let speed = main_loop.settings.axes.x.max_speed.min(main_loop.settings.axes.y.max_speed);
    main_loop
        .plan(Target { position: place, speed: speed.into(), has_overrides: false, watch: EndstopSet::NONE })
        .await?;
    main_loop.finish().await?;
    main_loop.commanded.stand_at(main_loop.motion.end_mm());
    Ok(())
}
