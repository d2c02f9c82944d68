//! The lines of G34 and G35, in Marlin's words (G34_M422.cpp, G35.cpp).

use crate::machine::answers::reply_writer::ReplyWriter;
use crate::machine::answers::screw_answer::ScrewAnswer;
use crate::machine::numbers::Thousandths;
use crate::units::Mm;

/// The line of an answer.
pub(in crate::machine) fn report_screws(to: &mut ReplyWriter<'_>, answer: &ScrewAnswer) {
    match *answer {
        ScrewAnswer::Round(round) => to.say(text!("G34 Iteration: {round}")),
        ScrewAnswer::Heights(heights, count) => {
            for (first, height) in heights.iter().take(count).enumerate() {
                for (second, other) in heights.iter().take(count).enumerate().skip(first + 1) {
                    let (a, b, difference) = (first + 1, second + 1, Thousandths(height.saturating_sub(*other)));
                    to.say(text!("{a}:{b}={difference}"));
                }
            }
        }
        ScrewAnswer::Done { rounds, of, left, is_level } => {
            if is_level {
                to.say(text!("Target accuracy achieved."));
            }
            to.say(text!("Did {rounds} of {of}"));
            // Nothing has measured what the last turns did.
            let when = if is_level { "" } else { " before the last turns" };
            to.say(text!("Accuracy: {}{when}", Thousandths(left)));
        }
        ScrewAnswer::Corner { corner, higher, pitch, is_clockwise } => {
            let (name, distance) = (corner.name(), higher.saturating_abs());
            let minutes = turns_in_minutes(distance, pitch);
            let (turns, minutes) = (minutes / 60, minutes % 60);
            let direction = if is_clockwise { "CW" } else { "CCW" };
            let distance = Thousandths(distance);
            to.say(text!("Turn {name} {direction} by {turns} turns and {minutes} minutes ({distance}mm)"));
        }
    }
}

/// Turns of a thread for a way, in sixtieths, cut off.
fn turns_in_minutes(way: Mm, pitch: Mm) -> i64 {
    way.to_bits().saturating_mul(60) / pitch.to_bits().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_cut_off_to_whole_minutes() {
        let turns = |way: &str, pitch: &str| {
            let [way, pitch] = [way, pitch].map(|number| Mm::from_num(number.parse::<f64>().unwrap()));
            let minutes = turns_in_minutes(way, pitch);
            (minutes / 60, minutes % 60)
        };
        assert_eq!(turns("0.25", "0.7"), (0, 21));
        assert_eq!(turns("0.43", "0.7"), (0, 36));
        assert_eq!(turns("1.05", "0.5"), (2, 6));
        assert_eq!(turns("0", "0.5"), (0, 0));
    }
}
