//! M290, SET_GCODE_OFFSET: the offset of z, shifted while moves are under way.

use super::moves::Moves;
use super::z_offset::Shift;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Nature, Number, flaw_of_pairs};

pub(in crate::machine) const BABYSTEP: Entry = Entry::m("Offsets", &[290])
    .nature(Nature::Mode)
    .works_if(|command| matches!(babystep(command), Asked::For(Shift::Live { by: Some(_), .. })))
    .grammar(&Grammar::numbers(b"ZSP"))
    .does("Z S P, R", "shifts Z by Z or S while moves are under way; P0 does not keep it; or reports")
    .examples(&[
        ("M290 Z0.05", &[]),
        ("M290 S-0.05 P0", &[]),
        ("M290 Z0.05 R", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
        ("M290", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
        ("M290 Z5", &["echo:M290 Z5 is out of range, set to 2"]),
        ("M290 X0.05", &["echo:M290 X is not supported by this firmware"]),
    ]);

pub(in crate::machine) const OFFSET: Entry = Entry::name("Offsets", &[OFFSET_NAME])
    .nature(Nature::Mode)
    .works_if(|command| matches!(offset(command.text()), Ok(Asked::For(Shift::Kept { moves: true, .. }))))
    .judge(|_, text| offset(text).err().into())
    .does("Z= Z_ADJUST= MOVE=", "the kept offset of Z, at its next move or at once (MOVE=1); or reports")
    .examples(&[
        ("SET_GCODE_OFFSET Z=-0.1", &[]),
        ("SET_GCODE_OFFSET Z_ADJUST=0.1 MOVE=1 MOVE_SPEED=5", &[]),
        ("SET_GCODE_OFFSET X=0 Y=0 Z=0", &[]),
        ("SET_GCODE_OFFSET", &["echo:Babystep Z0.00", "echo:Z offset 0"]),
        ("SET_GCODE_OFFSET Y_ADJUST=1", &["echo:SET_GCODE_OFFSET Y_ADJUST is not supported by this firmware"]),
        ("SET_GCODE_OFFSET Z=9", &["echo:ignored: the offset of Z would be out of range (-5 to 5 mm)"]),
        ("SET_GCODE_OFFSET Z", &["echo:line ignored: \"Z\" is not a name with = and a number"]),
    ]);

const OFFSET_NAME: &str = "SET_GCODE_OFFSET";

/// What a line asks for.
enum Asked {
    For(Shift),
    /// The offset of another axis, which has none.
    Other(&'static str),
}

/// M290. Z counts before S, and a report makes no move (Marlin, M290.cpp). X and Y have no such offset.
fn babystep(command: &TableCommand<'_>) -> Asked {
    for (letter, name) in [(b'X', "X"), (b'Y', "Y")] {
        if command.has(letter) {
            return Asked::Other(name);
        }
    }
    let [z, s, kept] = command.numbers(b"ZSP");
    let by = z.or(s).filter(|_| !command.has(b'R'));
    Asked::For(Shift::Live { by, is_kept: kept != Some(Number::ZERO) })
}

/// Words of SET_GCODE_OFFSET: its own, and from [`OTHERS`] on those of axes without an offset. Others are ignored.
const NAMES: [&str; 9] = ["Z", "Z_ADJUST", "MOVE", "X", "Y", "E", "X_ADJUST", "Y_ADJUST", "E_ADJUST"];
const OTHERS: usize = 3;

/// SET_GCODE_OFFSET. MOVE_SPEED is not obeyed: z moves as fast as its limits allow.
#[inline(never)]
fn offset(text: &[u8]) -> Result<Asked, Flaw<'_>> {
    let (mut numbers, mut other) = ([None; NAMES.len()], None);
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        let flaw = pair.put_number(&mut numbers);
        // 0 is what the machine has.
        let number = numbers.get(pair.place).copied().flatten().filter(|number| *number != Number::ZERO);
        if flaw.is_none() && pair.place >= OTHERS && number.is_some() {
            // The words behind it do not count.
            other = NAMES.get(pair.place);
            return Some(pair.flaw());
        }
        flaw
    });
    if let Some(other) = other {
        return Ok(Asked::Other(other));
    }
    let [to, by, moves, ..] = numbers;
    let moves = moves.is_some_and(|number| number != Number::ZERO);
    flaw.map_or(Ok(Asked::For(Shift::Kept { to, by, moves })), Err)
}

/// They wait for nothing but power.
pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let (code, asked) = match command.code() {
        290 => ("M290", Ok(babystep(command))),
        _ => (OFFSET_NAME, offset(command.text())),
    };
    match asked {
        Ok(Asked::For(shift)) => Moves { main_loop, states }.offset_z(shift).await,
        Ok(Asked::Other(axis)) => Ok(Answer::NotObeyed(code, axis.as_bytes())),
        Err(_) => Ok(Answer::Nothing),
    }
}
