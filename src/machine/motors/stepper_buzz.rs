//! STEPPER_BUZZ: one motor moves alone, a little to and fro.

use super::buzz::buzz;
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Absent, Flaw, Named, Nature, Part, flaw_of_pairs};
use crate::motors::MotorName;

/// Klipper's name for a motor that shows itself.
const NAME: &str = "STEPPER_BUZZ";

pub(in crate::machine) const ENTRY: Entry = Entry::name("Motors and drivers", &[NAME])
    .nature(Nature::Work)
    .judge(|_, text| motors(text).err().into())
    .does("STEPPER= FREE=", "one motor alone, 1 mm to and fro ([belt](../explanation/belt/one-motor.md))")
    .examples(&[
        ("STEPPER_BUZZ STEPPER=m1", &["echo:m1 moved 1.000 mm to and fro; held: m4 m11; free: m8; home again"]),
        ("STEPPER_BUZZ STEPPER=m4 FREE=m8", &["echo:m4 moved 1.000 mm to and fro; held: m1 m11; free: m8; home again"]),
        ("STEPPER_BUZZ STEPPER=z2", &["echo:z2 moved 1.000 mm to and fro; held: z1; free: none; home again"]),
        ("STEPPER_BUZZ stepper=e0", &["echo:e0 moved 1.000 mm to and fro; held: none; free: none; home again"]),
        (
            "STEPPER_BUZZ STEPPER=m1 FREE=z1",
            &["echo:STEPPER_BUZZ ignored: m1 would strain its belt; FREE= is one of m8"],
        ),
        (
            "STEPPER_BUZZ STEPPER=m1 FREE=m1",
            &["echo:STEPPER_BUZZ ignored: m1 would strain its belt; FREE= is one of m8"],
        ),
        (
            "STEPPER_BUZZ STEPPER=m9",
            &["echo:STEPPER_BUZZ ignored: there is no motor m9; STEPPER= is one of m1 m4 m8 m11 z1 z2 e0"],
        ),
        ("STEPPER_BUZZ", &["echo:STEPPER_BUZZ ignored: there is no motor ; STEPPER= is one of m1 m4 m8 m11 z1 z2 e0"]),
        ("STEPPER_BUZZ STEPPER=stepper_x", &["echo:STEPPER_BUZZ ignored: there is no motor stepper_x"]),
        ("STEPPER_BUZZ m1", &["echo:line ignored: \"m1\" is not a name with = and a number"]),
    ]);

/// STEPPER: the motor, the empty name if it is missing; FREE: a motor of its belt that has no power meanwhile. They are
/// the names of motors in the machine's file.
#[inline(never)]
fn motors(text: &[u8]) -> Result<(MotorName, Option<MotorName>), Flaw<'_>> {
    let (mut motor, mut free) = (MotorName::NONE, None);
    let flaw = flaw_of_pairs(text, &["STEPPER", "FREE"], &mut |pair| {
        let Some(known) = core::str::from_utf8(pair.value).ok().and_then(MotorName::new) else {
            return Some(Flaw::Absent(Absent { command: Named::Name(NAME), part: Part::Motor, which: pair.value }));
        };
        match pair.place {
            0 => motor = known,
            1 => free = Some(known),
            _ => return Some(pair.flaw()),
        }
        None
    });
    flaw.map_or(Ok((motor, free)), Err)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { notices, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let Ok((motor, free)) = motors(command.text()) else { return Ok(Answer::Nothing) };
    buzz(main_loop, notices, motor, free).await
}
