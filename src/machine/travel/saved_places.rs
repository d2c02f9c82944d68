//! G60, G61, SAVE_GCODE_STATE, RESTORE_GCODE_STATE: places and modes that a line saves, and a later one brings back.

use super::moves::Moves;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Nature, Number, Verdict, Words, flaw_of_pairs};
use crate::machine::state::saved_states::{Key, SavedState};
use crate::settings::Range;
use crate::units::{Feed, Mm};

/// Marlin's Q goes back, as G61 does.
pub(in crate::machine) const SAVE: Entry = Entry::g("Motion", &[60])
    .judge(|_, text| if Words::new(text).any(|word| word.letter == b'Q') { Verdict::Unknown } else { Verdict::InOrder })
    .grammar(&Grammar::numbers(b"S"))
    .does("S D", "saves the place of the tool as 0 or 1 (S); D forgets it")
    .examples(&[("G60", &[]), ("G60 S1", &[]), ("G60 S2", &["echo:G60 ignored: S2 is out of range (0 to 1)"])]);

pub(in crate::machine) const RETURN: Entry = Entry::g("Motion", &[61])
    .nature(Nature::Move)
    .grammar(&Grammar::numbers(b"SF"))
    .does("S X Y Z F", "goes back to it, along the named axes or all; a number is an offset; filament stays")
    .examples(&[
        ("G61", &["echo:ignored: nothing is saved by that name"]),
        ("G61 S1 X", &["echo:ignored: nothing is saved by that name"]),
    ]);

pub(in crate::machine) const SAVE_STATE: Entry = Entry::name("Motion", &["SAVE_GCODE_STATE"])
    .judge(|_, text| words(text).err().into())
    .does("NAME=", "saves modes, F, G92, E and the place; the newest four are kept")
    .examples(&[("SAVE_GCODE_STATE NAME=BEFORE", &[]), ("SAVE_GCODE_STATE", &[])]);

pub(in crate::machine) const RESTORE_STATE: Entry = Entry::name("Motion", &["RESTORE_GCODE_STATE"])
    .nature(Nature::Move)
    .judge(|_, text| words(text).err().into())
    .does("NAME= MOVE= MOVE_SPEED=", "brings them back, with MOVE=1 the tool too; M220 and M221 stay")
    .examples(&[
        ("RESTORE_GCODE_STATE NAME=x", &["echo:ignored: nothing is saved by that name"]),
        ("RESTORE_GCODE_STATE MOVE=yes", &["echo:line ignored: \"MOVE=yes\" is not a name with = and a number"]),
    ]);

/// The slots of G60.
const SLOTS: Range<u16> = Range { least: 0, most: 1 };

/// The name, or Klipper's for none; MOVE and MOVE_SPEED, in mm/s.
#[inline(never)]
fn words(text: &[u8]) -> Result<(&[u8], [Option<Number>; 2]), Flaw<'_>> {
    let (mut name, mut numbers): (&[u8], _) = (b"default", [None; 2]);
    let flaw = flaw_of_pairs(text, &["MOVE", "MOVE_SPEED", "NAME"], &mut |pair| {
        if pair.place == 2 {
            name = pair.value;
        }
        pair.put_number(&mut numbers)
    });
    flaw.map_or(Ok((name, numbers)), Err)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (key, numbers) = if command.code() == 0 {
        let Ok((name, numbers)) = words(command.text()) else { return Ok(Answer::Nothing) };
        (Key::of_name(name), numbers)
    } else {
        let code = if command.code() == 60 { "G60" } else { "G61" };
        let slot = command.number(b'S').unwrap_or_default();
        let Some(slot) = states.clamps.whole_of([code, "S"], slot, SLOTS, None) else { return Ok(Answer::Nothing) };
        (Key::of_slot(slot), [None; 2])
    };
    if command.code() == 60 || command.is_named("SAVE_GCODE_STATE") {
        if command.has(b'D') && command.code() == 60 {
            states.saved.forget(key);
        } else {
            states.saved.save(key, SavedState::of(&states.modal, &main_loop.commanded));
        }
        return Ok(Answer::Nothing);
    }
    let Some(saved) = states.saved.get(key) else {
        return Ok(Answer::Line(packed!("echo:ignored: nothing is saved by that name")));
    };
    if command.code() == 61 {
        return go_back(main_loop, states, command, &saved).await;
    }
    states.modal = states.modal.restored(&saved.modal);
    saved.put_counts(&mut main_loop.commanded);
    let [moves, speed] = numbers;
    if moves.is_none_or(|number| number == Number::ZERO) {
        return Ok(Answer::Nothing);
    }
    let speed = speed.map(|speed| Feed::saturating_from_num(speed.value())).filter(|speed| *speed > Feed::ZERO);
    Moves { main_loop, states }.visit(saved.place.map(Some), speed.unwrap_or(saved.modal.feed)).await
}

/// G61.
async fn go_back<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
    saved: &SavedState,
) -> Result<Answer<'static>, Interrupt> {
    let (flags, words) = (command.flags(), command.axes());
    let names_none = !(flags.x || flags.y || flags.z);
    let feed = states.clamps.feed(&states.modal, command.number(b'F')).unwrap_or(states.modal.feed);
    let place_of = |at: Mm, is_named: bool, offset: Option<Number>| {
        let offset = offset.map_or(Mm::ZERO, |offset| states.modal.length(offset));
        (names_none || is_named).then(|| at.saturating_add(offset))
    };
    let [x, y, z] = saved.place;
    let place = [place_of(x, flags.x, words.x), place_of(y, flags.y, words.y), place_of(z, flags.z, words.z)];
    Moves { main_loop, states }.visit(place, feed).await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_has_a_name_and_may_be_gone_back_to() {
        let none: &[u8] = b"default";
        assert_eq!(words(b""), Ok((none, [None; 2])));
        let move_words = [Some(Number::from(1)), Some(Number::from(50))];
        assert_eq!(words(b" NAME=PAUSE MOVE=1 MOVE_SPEED=50"), Ok((b"PAUSE".as_slice(), move_words)));
        assert_eq!(words(b" name=\"a b\""), Ok((b"a b".as_slice(), [None; 2])));
        assert!(words(b" NAME").is_err() && words(b" MOVE_SPEED=fast").is_err());
    }
}
