//! G35: how far each hand screw at the corners of the bed is to be turned, in Marlin's words (G35.cpp).

use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Grammar, Mark, Nature};
use crate::machine::numbers::Thousandths;
use crate::machine::probe::reach::{NO_PROBE, has_probe, nozzle_for};
use crate::machine::probe::touch::{AfterTouch, touch_bed};
use crate::settings::Range;
use crate::units::Mm;

/// S is the thread: 30, 40, 50 for M3, M4, M5; one more for a thread that turns the other way.
pub(in crate::machine) const ENTRY: Entry = Entry::g("Motors and drivers", &[35])
    .nature(Nature::Work)
    .mark(Mark::FindsBed)
    .grammar(&Grammar::numbers(b"S"))
    .does("S", "probes the corners of the bed, and says how far to turn each hand screw; thread: 30, 40, 50 is M3..")
    .examples(&[
        ("G35 S40", &["echo:no probe configured, ignored"]),
        ("G35 S60", &["echo:G35 ignored: S is 30, 31, 40, 41, 50 or 51"]),
    ]);

/// Distance of the corners that G35 probes from the edges of the bed. Marlin's example has 20 to 50 mm.
const INSET: Mm = Mm::const_from_int(30);

/// Hand screws by the S of G35: their pitches (ISO 261, coarse) and whether they turn clockwise.
const THREADS: [(i32, Mm); 3] =
    [(3, const { Mm::lit("0.5") }), (4, const { Mm::lit("0.7") }), (5, const { Mm::lit("0.8") })];

/// M3, clockwise (Configuration_adv.h, `TRAMMING_SCREW_THREAD`).
const THREAD: i32 = 30;

/// A corner of the bed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Corner {
    FrontLeft,
    FrontRight,
    BackRight,
    BackLeft,
}

impl Corner {
    /// All of them, one next to the other.
    const ALL: [Self; 4] = [Self::FrontLeft, Self::FrontRight, Self::BackRight, Self::BackLeft];

    /// Marlin's name (Configuration_adv.h, `TRAMMING_POINT_NAME_1`).
    const fn name(self) -> &'static str {
        match self {
            Self::FrontLeft => "Front-Left",
            Self::FrontRight => "Front-Right",
            Self::BackRight => "Back-Right",
            Self::BackLeft => "Back-Left",
        }
    }

    /// Whether it is at the right, and whether it is at the back.
    const fn sides(self) -> [bool; 2] {
        [matches!(self, Self::FrontRight | Self::BackRight), matches!(self, Self::BackRight | Self::BackLeft)]
    }
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    _: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let thread = command.number(b'S').map_or(THREAD, |thread| thread.to_int());
    let known = THREADS.into_iter().find(|(size, _)| *size == thread / 10).filter(|_| matches!(thread % 10, 0 | 1));
    let Some((_, pitch)) = known else {
        return Ok(Answer::Line(packed!("echo:G35 ignored: S is 30, 31, 40, 41, 50 or 51")));
    };
    if !has_probe(main_loop) {
        return Ok(NO_PROBE);
    }
    if main_loop.homed.lacks_one_of([true; 3]) {
        return Ok(Answer::NotHomed);
    }
    let is_reversed = thread % 10 == 1;
    let [x, y] = main_loop.settings.probe_reach(Mm::ZERO);
    let bed = main_loop.settings.bed;
    let inside = |from: Mm, size: Mm, reach: Range<Mm>| {
        let (least, most) = (from.saturating_add(INSET), from.saturating_add(size).saturating_sub(INSET));
        [least, most].map(|at| reach.clamp(at))
    };
    let (columns, rows) = (inside(bed.left, bed.width, x), inside(bed.front, bed.depth, y));
    for (x, y) in columns.into_iter().zip(rows) {
        if let Err(place) = nozzle_for(&main_loop.settings, [x, y]) {
            return Ok(place.answer(main_loop));
        }
    }
    let mut first = None;
    for corner in Corner::ALL {
        let [is_right, is_back] = corner.sides();
        let at = [columns[usize::from(is_right)], rows[usize::from(is_back)]];
        let height = touch_bed(main_loop, Some(at), AfterTouch::In).await?;
        let Some(first) = first else {
            first = Some(height);
            continue;
        };
        let higher = height.saturating_sub(first);
        // As Marlin has it (G35.cpp): a turn clockwise lifts the bed.
        let is_clockwise = (higher < Mm::ZERO) != is_reversed;
        let (name, distance) = (corner.name(), higher.saturating_abs());
        let minutes = turns_in_minutes(distance, pitch);
        let (turns, minutes) = (minutes / 60, minutes % 60);
        let direction = if is_clockwise { "CW" } else { "CCW" };
        let distance = Thousandths(distance);
        main_loop.say(text!("Turn {name} {direction} by {turns} turns and {minutes} minutes ({distance}mm)"));
    }
    Ok(Answer::Line(packed!("echo:Turn the screws, then send G35 again")))
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
