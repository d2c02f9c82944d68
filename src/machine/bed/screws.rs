//! G34: the screws of z are levelled by the probe. What it says are Marlin's words (G34_M422.cpp).
//!
//! A round of G34 probes the bed at a point for each screw, and turns each screw's motor by the height of the bed there
//! (`kinematics::heights_at_screws`). The reference point, where z was found, keeps its height, so z and a mesh stay
//! valid. The next round judges the turns: if the screws are not clearly nearer to level than before, the turns are
//! taken back and the job ends. A direction is never reversed by itself.
//!
//! Play of the screws does not count: all of them go down together before each touch.

use crate::gcode::Number;
use crate::kinematics::{FitError, Place, SCREWS, heights_at_screws};
use crate::machine::answers::answer::Answer;
use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::main_loop::trim::turn_screw;
use crate::machine::numbers::Thousandths;
use crate::machine::ports::PortSet;
use crate::machine::probe::reach::nozzle_for;
use crate::machine::probe::touch::{AfterTouch, touch_bed};
use crate::machine::state::clamps::Clamps;
use crate::machine::state::job::JobEnd;
use crate::machine::state::level::LevelFailure;
use crate::machine::states::tell_clamps;
use crate::motion::{from_f32, to_f32};
use crate::motors::Motor;
use crate::port::Wake;
use crate::settings::{HomedAxis, Range, Settings, WholePlace};
use crate::units::{Mm, Ratio, Steps};
use fixed::types::I32F32;
use heapless::Vec;

/// The words of G34.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(in crate::machine) struct LevelWords {
    /// I: measurements, each followed by a correction unless it is the last one.
    pub rounds: Option<Number>,
    /// T: the difference in mm between screws that is level enough.
    pub within: Option<Number>,
    /// A: the share of a measured difference that is corrected.
    pub share: Option<Number>,
    /// E: the probe stays out between its points.
    pub keeps_out: bool,
}

/// Rounds of G34 without I, and their range; the accuracy without T, and its range; and the share without A: Marlin's
/// (Configuration_adv.h, `Z_STEPPER_ALIGN_ITERATIONS`, `_ACC`, `_AMP`; G34_M422.cpp).
const ROUNDS: u16 = 5;
const ROUND_RANGE: Range<u16> = Range { least: 1, most: 30 };
const WITHIN: Mm = const { Mm::lit("0.02") };
const WITHIN_RANGE: Range<Mm> = Range { least: const { Mm::lit("0.01") }, most: Mm::ONE };
const SHARE: Ratio = Ratio::const_from_int(1);
const SHARE_RANGE: Range<Ratio> = Range { least: const { Ratio::lit("0.5") }, most: Ratio::const_from_int(2) };

/// The greatest turn of a screw in a round, and the steepest bed in parts of the distance of two screws. Beyond them a
/// screw has come off, or the probe is wrong. Marlin refuses 5 % (G34_M422.cpp).
const MOST_TURN: Mm = Mm::const_from_int(2);
const MOST_GRADE: f32 = 0.05;

/// The greatest difference that may be left in tenths of the one before; with an error of 30 % in the distance of the
/// screws, 4 tenths are left.
const MOST_LEFT_TENTHS: i64 = 7;

/// What G34 levels.
struct Screws {
    motors: Vec<Motor, SCREWS>,
    places: Vec<Place, SCREWS>,
    points: Vec<Place, SCREWS>,
    reference: Place,
}

/// The finding of a round, in mm.
struct Finding {
    /// The bed's height at each screw.
    heights: [f32; SCREWS],
    /// Its height at the reference.
    reference: f32,
    /// The greatest difference between screws.
    spread: Mm,
}

impl Screws {
    fn new(s: &Settings, reference: [Mm; 2]) -> Self {
        let motors = s.screw_motors();
        let places = |of: fn(&crate::settings::Screw) -> WholePlace| {
            s.screws.iter().take(motors.len()).map(|screw| place(of(screw))).collect()
        };
        let (at, points) = (places(|screw| screw.place), places(|screw| screw.point));
        Self { motors, places: at, points, reference: reference.map(mm_to_f32) }
    }

    fn find(&self, heights: &[f32]) -> Result<Finding, FitError> {
        let (heights, reference) = heights_at_screws(&self.places, &self.points, heights, self.reference)?;
        let fitted = || heights.iter().take(self.motors.len()).copied();
        let (least, most) = (fitted().fold(f32::MAX, f32::min), fitted().fold(f32::MIN, f32::max));
        Ok(Finding { heights, reference, spread: f32_to_mm(most - least) })
    }

    /// Whether a finding is what loose screws or a wrong probe give.
    fn is_too_steep(&self, found: &Finding) -> bool {
        let pairs = || self.places.iter().zip(found.heights);
        pairs().enumerate().any(|(number, ([x, y], height))| {
            pairs().skip(number + 1).any(|([other_x, other_y], other)| {
                // At least as long as the way, which gives a steep bed no excuse: the sum is at most 1.42 times it.
                let way = ((x - other_x).abs()).max((y - other_y).abs());
                (height - other).abs() > MOST_GRADE * way
            })
        })
    }
}

fn place(place: WholePlace) -> Place {
    [f32::from(place.x), f32::from(place.y)]
}

fn mm_to_f32(mm: Mm) -> f32 {
    to_f32(Steps::from_bits(mm.to_bits()))
}

fn f32_to_mm(mm: f32) -> Mm {
    Mm::from_bits(from_f32(mm).to_bits())
}

/// G34.
pub(in crate::machine) async fn level_screws<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    clamps: &mut Clamps,
    words: &LevelWords,
) -> Result<Answer<'static>, Interrupt> {
    let LevelWords { rounds, within, share, keeps_out } = *words;
    let rounds = rounds.map_or(Some(ROUNDS), |asked| clamps.whole_of(["G34", "I"], asked, ROUND_RANGE, None));
    let within = within.map_or(Some(WITHIN), |asked| clamps.plain_of(["G34", "T"], asked, WITHIN_RANGE, None));
    let share = share.map_or(Some(SHARE), |asked| clamps.near_of(["G34", "A"], asked, SHARE_RANGE, None));
    let (Some(rounds), Some(within), Some(share)) = (rounds, within, share) else { return Ok(Answer::Nothing) };
    let screws = Screws::new(&main_loop.settings, main_loop.settings.probe_home());
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Ok(Answer::NotHomed);
    }
    if screws.motors.len() < 2 {
        return Ok(Answer::Line(packed!("echo:G34 ignored: a single motor moves z")));
    }
    if !main_loop.settings.screws.iter().take(screws.motors.len()).all(|screw| screw.is_known()) {
        return Ok(Answer::Line(packed!("echo:G34 ignored: a screw or its point has no place. Set them by M422")));
    }
    // With any heights: whether there is a fit depends on the places alone. So it is refused before a move.
    if screws.find(&[0.0; SCREWS][..screws.points.len()]).is_err() {
        return Ok(Answer::Line(packed!(
            "echo:G34 ignored: its points do not show a tilt between the screws. Place them by M422"
        )));
    }
    // All of them before the first touch, so that the tool does not stop half-way.
    for point in &screws.points {
        if let Err(place) = nozzle_for(&main_loop.settings, point.map(f32_to_mm)) {
            tell_clamps(main_loop, clamps);
            return Ok(place.answer(main_loop));
        }
    }
    let end = if keeps_out { AfterTouch::Out } else { AfterTouch::In };
    let mut before: Option<(Mm, [i32; SCREWS])> = None;
    let mut done = 0;
    let (mut left, mut is_level) = (Mm::ZERO, false);
    while done < rounds && !is_level {
        done += 1;
        main_loop.say(text!("G34 Iteration: {done}"));
        let mut heights: Vec<f32, SCREWS> = Vec::new();
        for place in 0..screws.points.len() {
            let Some(point) = screws.points.get(place).copied() else { break };
            let height = touch_bed(main_loop, Some(point.map(f32_to_mm)), end).await?;
            let _ = heights.push(mm_to_f32(height));
        }
        // The same places as before, so there is a fit.
        let Ok(found) = screws.find(&heights) else { break };
        let (heights, count) = (found.heights.map(f32_to_mm), screws.motors.len());
        main_loop.reply(Answer::words(&|to, _| report_heights(to, heights.get(..count).unwrap_or(&heights)))).await?;
        left = found.spread;
        is_level = left <= within;
        if is_level {
            break;
        }
        let failure = match before {
            Some((was, turned)) if left.to_bits() * 10 > was.to_bits() * MOST_LEFT_TENTHS => {
                turn(main_loop, &screws, turned.map(|steps| -steps)).await?;
                Some(LevelFailure::NotNearer { was, now: left })
            }
            _ if screws.is_too_steep(&found) || left > MOST_TURN => Some(LevelFailure::TooFar { now: left }),
            _ => None,
        };
        if let Some(why) = failure {
            main_loop.job.note_end(JobEnd::NotLevel(why));
            return Err(Interrupt::EndJob);
        }
        let turns =
            turns(&main_loop.settings, &screws, &found, to_f32(Steps::from_bits(I32F32::from(share).to_bits())));
        turn(main_loop, &screws, turns).await?;
        before = Some((left, turns));
    }
    main_loop.homed.note_level(is_level);
    tell_clamps(main_loop, clamps);
    if is_level {
        main_loop.say(text!("Target accuracy achieved."));
    }
    main_loop.say(text!("Did {done} of {rounds}"));
    // Nothing has measured what the last turns did.
    let when = if is_level { "" } else { " before the last turns" };
    main_loop.say(text!("Accuracy: {}{when}", Thousandths(left)));
    Ok(Answer::Said)
}

/// How much higher the bed is at each screw than at those that follow.
fn report_heights(to: &mut ReplyWriter<'_>, heights: &[Mm]) {
    for (first, height) in heights.iter().enumerate() {
        for (second, other) in heights.iter().enumerate().skip(first + 1) {
            let (a, b, difference) = (first + 1, second + 1, Thousandths(height.saturating_sub(*other)));
            to.say(text!("{a}:{b}={difference}"));
        }
    }
}

/// The steps of each motor that level the bed, with its reference at rest.
fn turns(s: &Settings, screws: &Screws, found: &Finding, share: f32) -> [i32; SCREWS] {
    let mut turns = [0; SCREWS];
    for (slot, (motor, height)) in turns.iter_mut().zip(screws.motors.iter().zip(found.heights)) {
        let is_backward = s.mechanism.rows.get(motor.index()).is_some_and(|[.., z, _]| *z < 0);
        let way = f32_to_mm((height - found.reference) * share);
        let steps = (way * s.steps_per_mm(*motor)).wrapping_round().to_num::<i32>();
        *slot = if is_backward { -steps } else { steps };
    }
    turns
}

/// Turns each motor alone. Until all have turned, the reference is not at its height: whoever stops them has to home z.
async fn turn<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    screws: &Screws,
    turns: [i32; SCREWS],
) -> Result<(), Interrupt> {
    let z = HomedAxis::Z as usize;
    main_loop.homed.begin(z);
    main_loop.homed.note_level(false);
    for (motor, by) in screws.motors.iter().zip(turns) {
        let speed = main_loop.settings.homing.z.fast;
        turn_screw(main_loop, *motor, by, speed).await?;
    }
    main_loop.homed.stop();
    main_loop.homed.arrive(z);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motors::prototype::{Z1, Z2};

    fn found(s: &Settings, heights: &[f32]) -> (Screws, Finding) {
        let screws = Screws::new(s, [Mm::from_num(195), Mm::from_num(200)]);
        let found = screws.find(heights).expect("a fit");
        (screws, found)
    }

    #[test]
    fn both_screws_turn_by_half_and_the_reference_stays() {
        let s = Settings::prototype();
        let (screws, finding) = found(&s, &[0.31, -0.17]);
        assert_eq!(screws.motors.as_slice(), [Z1, Z2]);
        // 0.48 mm over 310 mm of points is 0.681290 mm over 440 mm of screws.
        let [first, second, ..] = turns(&s, &screws, &finding, 1.0);
        assert_eq!([first, second], [273, -273]);
        assert_eq!(turns(&s, &screws, &finding, 0.5), [136, -136, 0, 0]);
        assert!((mm_to_f32(finding.spread) - 0.681_290).abs() < 1e-4);
    }

    #[test]
    fn a_motor_that_turns_z_the_other_way_gets_its_own_sign() {
        let mut s = Settings::prototype();
        s.mechanism.rows[Z2.index()] = s.mechanism.rows[Z2.index()].map(|times| -times);
        let (screws, finding) = found(&s, &[0.31, -0.17]);
        assert_eq!(turns(&s, &screws, &finding, 1.0), [273, 273, 0, 0]);
    }

    #[test]
    fn a_bed_that_is_too_steep_is_no_bed() {
        let mut s = Settings::prototype();
        let (screws, finding) = found(&s, &[0.31, -0.17]);
        assert!(!screws.is_too_steep(&finding));
        s.screws[1].place.x = -15;
        s.screws[1].point.x = 45;
        let (screws, finding) = found(&s, &[0.31, -0.17]);
        assert!(screws.is_too_steep(&finding));
    }
}
