//! The Z probe.

use super::states::States;
use crate::gcode::{Number, ProbeCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::probe_answer::ProbeAnswer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::probe::deploy::set_servo;
use crate::machine::probe::reach::{has_probe, nozzle_for};
use crate::machine::probe::repeatability::Repeatability;
use crate::machine::probe::touch::{AfterTouch, find_bed, set_out, touch_again, touch_bed};
use crate::machine::state::clamps::Clamps;
use crate::machine::state::modal::Modal;
use crate::port::Wake;
use crate::settings::{ProbeKind, Range};
use crate::units::Mm;

/// Touches of M48 (Marlin, M48.cpp).
const TOUCHES: Range<u16> = Range { least: 4, most: 50 };

/// The same without P.
const USUAL_TOUCHES: u16 = 10;

/// What M48 tells (V).
const VERBOSITY: Range<u16> = Range { least: 0, most: 4 };

/// The shortest pulse of a servo in us, at 0 degrees, and the length of 180 degrees in addition. From the first on, a
/// number is a length (Marlin, servo.h).
const SHORTEST: u16 = 544;
const HALF_TURN: u16 = 1856;

/// Angles and lengths of a servo.
const SERVO: Range<u16> = Range { least: 0, most: SHORTEST + HALF_TURN };

/// Carries out a command of the probe.
pub(super) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &ProbeCommand,
) -> Result<Answer<'static>, Interrupt> {
    if !has_probe(main_loop) {
        return Ok(Answer::Probe(ProbeAnswer::None));
    }
    let States { modal, clamps, .. } = states;
    match *command {
        ProbeCommand::Touch { at: named, stays_out } => {
            let at = match place(main_loop, modal, named) {
                Ok(at) => at,
                Err(none) => return Ok(none.into()),
            };
            if named != [None; 2] {
                tell_of_home_offsets(main_loop);
            }
            let end = if stays_out { AfterTouch::Out } else { AfterTouch::In };
            let height = touch_bed(main_loop, Some(at), end).await?;
            main_loop.tell(Answer::Probe(ProbeAnswer::Bed { at, height }));
            Ok(Answer::Position { real: false })
        }
        ProbeCommand::Repeatability { at: named, touches, verbosity, other } => {
            let touches = whole(clamps, "P", touches, TOUCHES, USUAL_TOUCHES);
            let verbosity = whole(clamps, "V", verbosity, VERBOSITY, 1);
            if clamps.refuses_line() {
                return Ok(Answer::Nothing);
            }
            match place(main_loop, modal, named) {
                Ok(at) => {
                    if named != [None; 2] {
                        tell_of_home_offsets(main_loop);
                    }
                    repeat(main_loop, at, touches, verbosity).await?;
                }
                Err(none) => return Ok(none.into()),
            }
            Ok(match other {
                Some(b'L') => Answer::NotObeyed("M48", b"L"),
                Some(_) => Answer::NotObeyed("M48", b"S"),
                None => Answer::Nothing,
            })
        }
        ProbeCommand::Servo { servo, order } => Ok(order_servo(main_loop, clamps, servo, order)),
        ProbeCommand::Deploy => {
            main_loop.finish().await?;
            set_out(main_loop, AfterTouch::Out).await?;
            Ok(Answer::Nothing)
        }
        ProbeCommand::Quick(is_quick) => {
            main_loop.probing.set_quick(is_quick.unwrap_or(main_loop.probing.is_quick()));
            Ok(Answer::Probe(ProbeAnswer::Quick(main_loop.probing.is_quick())))
        }
        ProbeCommand::Stow => {
            main_loop.finish().await?;
            set_out(main_loop, AfterTouch::In).await?;
            Ok(Answer::Nothing)
        }
    }
}

/// A whole number of M48.
fn whole(clamps: &mut Clamps, letter: &'static str, number: Option<Number>, range: Range<u16>, usual: u16) -> u16 {
    number.and_then(|number| clamps.whole_of(["M48", letter], number, range, None)).unwrap_or(usual)
}

/// M48: each touch counts by itself, unlike those of G30. So the deviation is that of the probe.
async fn repeat<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    at: [Mm; 2],
    touches: u16,
    verbosity: u16,
) -> Result<(), Interrupt> {
    if verbosity > 0 {
        main_loop.tell(Answer::Probe(ProbeAnswer::Test));
    }
    find_bed(main_loop, Some(at)).await?;
    let mut found = Repeatability::default();
    for number in 1..=touches {
        let height = touch_again(main_loop).await?;
        found.add(height);
        if verbosity > 1 {
            main_loop.reply(Answer::Probe(ProbeAnswer::Sample { number, of: touches, height })).await?;
        }
    }
    set_out(main_loop, AfterTouch::In).await?;
    let finished = ProbeAnswer::Finished { spread: found.spread(), is_verbose: verbosity > 0 };
    main_loop.tell(Answer::Probe(finished));
    Ok(())
}

/// M280.
fn order_servo<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    servo: Option<Number>,
    order: Option<Number>,
) -> Answer<'static> {
    if main_loop.settings.probe.kind != ProbeKind::BlTouch || servo.is_some_and(|servo| servo != Number::ZERO) {
        return Answer::Line(packed!("echo:M280 ignored: the only servo is P0, of a BLTouch"));
    }
    let Some(order) = order else {
        let angle = |micros: u16| ((u32::from(micros - SHORTEST) * 180 + 928) / u32::from(HALF_TURN)) as u16;
        return Answer::Probe(ProbeAnswer::Servo(main_loop.probing.servo().map(angle)));
    };
    if order == Number::from(-1) {
        set_servo(main_loop, None);
    } else if let Some(order) = clamps.whole_of(["M280", "S"], order, SERVO, None) {
        let of_angle = |angle: u16| SHORTEST + (u32::from(angle.min(180)) * u32::from(HALF_TURN) / 180) as u16;
        set_servo(main_loop, Some(if order < SHORTEST { of_angle(order) } else { order }));
        // Its pin may be out or in now: the next touch puts it out again.
        main_loop.probing.note_out(false);
    }
    Answer::Nothing
}

/// A place of the probe is the machine's, as in Marlin: M206 does not count in it, and the host gets to know.
pub(super) fn tell_of_home_offsets<P: PortSet, W: Wake>(main_loop: &mut MainLoop<'_, P, W>) {
    let [x, y, _] = main_loop.settings.home_offsets();
    if [x, y] != [Mm::ZERO; 2] {
        main_loop.say(text!("echo:places of the probe are the machine's: M206 does not count in X and Y"));
    }
}

/// Why a place is not touched.
enum NoPlace {
    /// An axis is not homed.
    NotHomed,
    /// It is out of reach; the answer says what is not.
    OutOfReach(ProbeAnswer),
}

impl From<NoPlace> for Answer<'static> {
    fn from(none: NoPlace) -> Self {
        match none {
            NoPlace::NotHomed => Self::NotHomed,
            NoPlace::OutOfReach(answer) => Self::Probe(answer),
        }
    }
}

/// The place of the probe that the words mean, by default its own, if it can touch there.
fn place<P: PortSet, W: Wake>(
    main_loop: &MainLoop<'_, P, W>,
    modal: &Modal,
    words: [Option<Number>; 2],
) -> Result<[Mm; 2], NoPlace> {
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Err(NoPlace::NotHomed);
    }
    let s = &*main_loop.settings;
    let ([x, y, ..], offset, [wanted_x, wanted_y]) = (main_loop.motion.end_mm(), s.probe.offset, words);
    let of = |at: Mm, offset: Mm, word: Option<Number>| {
        word.map_or_else(|| at.saturating_add(offset), |number| modal.length(number))
    };
    let at = [of(x, offset.x, wanted_x), of(y, offset.y, wanted_y)];
    nozzle_for(s, at).map(|_| at).map_err(NoPlace::OutOfReach)
}
