//! The table of commands: a file each, with all of a command.
//!
//! | part of a file | is |
//! |---|---|
//! | `ENTRY` | codes, rules for words, the line of docs/reference/gcode.md, and examples with their answers |
//! | `carry_out` | its effect: at once, or awaited. The result is its answer |
//!
//! Words of an answer stand in the same file ([`Words`](crate::machine::answers::words::Words)). Several commands of
//! one kind are rows of one file, with names of their own.

use super::{conditions, silent};
use crate::gcode::{Command, Entry, Example, Line, Mark, Row, TableCommand, parse_with};
use crate::machine::answers::answer::Answer;
use crate::machine::apart::apart;
use crate::machine::bed::{
    bed_height, bed_mesh, hand_screws, mesh_point, mesh_use, print_area, print_objects, probe_pin, repeatability,
    screw_levelling, screw_place, servo,
};
use crate::machine::heat::{
    cold_limit, controller_fan, fan_speed, fan_turns, heat_targets, heater_model, heater_self_test, heater_tuning,
    heaters_by_name, heaters_reached, power_off, temperature_wait, temperatures,
};
use crate::machine::homing::home;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::messages::{auto_reports, endstops, firmware, line_number, message, position};
use crate::machine::motors::{
    belt_alignment, diagnosis, driver_current, driver_mode, hybrid_threshold, motor_power, stall_threshold,
    stepper_buzz,
};
use crate::machine::ports::PortSet;
use crate::machine::print::{
    at_once, await_user, debug_flags, filament, layer_words, object, pause_print, power_loss, print_marks, print_words,
    progress, upload,
};
use crate::machine::probe::reach::{NO_PROBE, has_probe};
use crate::machine::resonance::commands as resonances;
use crate::machine::setup::{
    all_settings, input_shaper, machine_record, plain_settings, pressure_advance, storage, velocity_limit,
};
use crate::machine::states::States;
use crate::machine::travel::{
    dwell, feed_percent, finish, flow_percent, home_offsets, inches, modes, move_lines, park, plane, quick_stop,
    recovery, retract, retraction_settings, saved_places, set_position, soft_endstops, tool, z_shift,
};
use crate::port::Wake;
use core::marker::PhantomData;
use core::pin::pin;

/// The rows of a file: `ENTRY`, unless the list names others.
macro_rules! rows {
    ($file:ident) => {
        &[$file::ENTRY]
    };
    ($file:ident ($($row:ident),*)) => {
        &[$($file::$row),*]
    };
}

/// The list, from which all tables are made.
macro_rules! list {
    (
        at_once { $($once:ident $(($($row:ident),*))?,)* }
        awaited { $($awaited:ident $(($($line:ident),*))?,)* }
    ) => {
        /// The rows of each file.
        const AT_ONCE: &[&[Entry]] = &[$(rows!($once $(($($row),*))?)),*];
        const AWAITED: &[&[Entry]] = &[$(rows!($awaited $(($($line),*))?)),*];

        impl<P: PortSet, W: Wake> Effects<P, W> {
            const OF_FILES: [Effect<P, W>; AT_ONCE.len()] = [$($once::carry_out),*];
        }

        /// Carries out a command of a file that waits. `place` is its place among their rows.
        async fn carry_out_awaited<'a, P: PortSet, W: Wake>(
            main_loop: &mut MainLoop<'_, P, W>,
            states: &mut States,
            command: &TableCommand<'a>,
            mut place: usize,
        ) -> Result<Answer<'a>, Interrupt> {
            $({
                const ROWS: &[Entry] = rows!($awaited $(($($line),*))?);
                if place < ROWS.len() {
                    return apart(pin!($awaited::carry_out(main_loop, states, command))).await;
                }
                place -= ROWS.len();
            })*
            Ok(Answer::Nothing)
        }
    };
}

list! {
    at_once {
        auto_reports,
        cold_limit,
        controller_fan,
        debug_flags,
        driver_current,
        fan_turns,
        firmware,
        flow_percent,
        home_offsets,
        hybrid_threshold,
        inches,
        layer_words(FRAME, VIDEO, LAYERS, CODES),
        line_number,
        message(DISPLAY, HOSTS),
        modes(OF_ALL, OF_EXTRUSION),
        object(ENTRY, EXCLUDE),
        plane,
        position,
        power_loss,
        power_off,
        print_area,
        print_objects,
        progress,
        quick_stop,
        recovery,
        retraction_settings,
        screw_place,
        servo,
        set_position,
        soft_endstops,
        stall_threshold,
        tool,
        upload,
        velocity_limit,
    }
    awaited {
        all_settings,
        at_once(CANCEL, CANCEL_BY_NAME, CONTINUE, ANSWER, STOP, RESTART),
        await_user(WAIT, CHANGE),
        bed_height,
        bed_mesh(ENTRY, WHOLE, BY_NAME),
        belt_alignment,
        diagnosis,
        driver_mode,
        dwell,
        endstops,
        fan_speed(SPEED, OFF),
        feed_percent,
        filament(LENGTHS, LOAD, UNLOAD),
        finish,
        hand_screws,
        heat_targets(HOTEND, BED, CHAMBER),
        heater_model,
        heater_self_test,
        heater_tuning,
        heaters_by_name(TARGET, OFF),
        heaters_reached,
        home,
        input_shaper,
        machine_record(GET, PUT, STORE),
        mesh_point(CHANGE, GO_OVER),
        mesh_use(ENTRY, CLEAR, OUTPUT, PROFILE),
        motor_power(ON, OFF),
        park,
        pause_print(PAUSE, PARK, RESUME, PAUSE_BY_NAME, RESUME_BY_NAME, CLEAR),
        plain_settings(OF_AXES, OF_MACHINE, CORNERS, PID_OF_HOTEND, PID_OF_BED),
        pressure_advance(LINEAR_ADVANCE, PRESSURE_ADVANCE, BY_NAME),
        print_marks,
        print_words(START, END),
        probe_pin(OUT, IN),
        repeatability,
        resonances(SENSOR, SAMPLES, TEST, CALIBRATE),
        retract(AWAY, BACK),
        saved_places(SAVE, RETURN, SAVE_STATE, RESTORE_STATE),
        screw_levelling(ENTRY, BY_NAME),
        stepper_buzz,
        storage(ENTRY, CHECK),
        temperature_wait,
        temperatures,
        z_shift(BABYSTEP, OFFSET),
    }
}

/// Rows without an effect of their own: the parser makes another command of them.
const WITHOUT_EFFECT: &[&[Entry]] = &[conditions::ROWS, move_lines::ROWS, silent::ROWS];

/// Carries out a command, and returns its answer.
type Effect<P, W> = for<'m, 'a> fn(&mut MainLoop<'m, P, W>, &mut States, &TableCommand<'a>) -> Answer<'a>;

/// The effects of the commands that act at once, in the order of their rows.
struct Effects<P, W>(PhantomData<(P, W)>);

impl<P: PortSet, W: Wake> Effects<P, W> {
    const ALL: [Effect<P, W>; ROWS_AT_ONCE] = {
        let mut effects = [Self::OF_FILES[0]; ROWS_AT_ONCE];
        let (mut place, mut file) = (0, 0);
        while file < AT_ONCE.len() {
            let mut row = 0;
            while row < AT_ONCE[file].len() {
                effects[place] = Self::OF_FILES[file];
                place += 1;
                row += 1;
            }
            file += 1;
        }
        effects
    };
}

const fn count(mut files: &[&[Entry]]) -> usize {
    let mut count = 0;
    while let [file, others @ ..] = files {
        count += file.len();
        files = others;
    }
    count
}

const ROWS_AT_ONCE: usize = count(AT_ONCE);

/// The rows without what an image does not need.
static ROWS: [Row; ROWS_AT_ONCE + count(AWAITED) + count(WITHOUT_EFFECT)] = {
    let mut rows = [AT_ONCE[0][0].row(); ROWS_AT_ONCE + count(AWAITED) + count(WITHOUT_EFFECT)];
    let (mut place, mut lists) = (0, [AT_ONCE, AWAITED, WITHOUT_EFFECT].as_slice());
    while let [files, other_lists @ ..] = lists {
        let mut files = *files;
        while let [file, other_files @ ..] = files {
            let mut entries = *file;
            while let [entry, others @ ..] = entries {
                rows[place] = entry.row();
                place += 1;
                entries = others;
            }
            files = other_files;
        }
        lists = other_lists;
    }
    rows
};

/// Carries out a command of the table, after what its row asks for.
pub(in crate::machine) async fn carry_out<'a, P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    states: &mut States,
    command: &TableCommand<'a>,
) -> Result<Answer<'a>, Interrupt> {
    if command.has_mark(Mark::NeedsProbe) && !has_probe(main_loop) {
        return Ok(NO_PROBE);
    }
    if command.has_mark(Mark::AfterRest) {
        main_loop.finish().await?;
    }
    let Some(effect) = Effects::<P, W>::ALL.get(command.place()) else {
        let place = command.place() - ROWS_AT_ONCE;
        return apart(pin!(carry_out_awaited(main_loop, states, command, place))).await;
    };
    Ok(effect(main_loop, states, command))
}

/// Every row.
fn entries() -> impl Iterator<Item = &'static Entry> {
    AT_ONCE.iter().chain(AWAITED).chain(WITHOUT_EFFECT).copied().flatten()
}

/// The command of a line.
///
/// Never fails: an unknown command is [`Command::Unknown`].
#[must_use]
pub fn parse(line: &[u8]) -> Command<'_> {
    parse_with(&ROWS, line)
}

/// Every row for people. Not for images: the texts would be in them.
pub fn described() -> impl Iterator<Item = Line> {
    entries().map(Entry::line)
}

/// The codes that are known, as letters and numbers.
pub fn codes() -> impl Iterator<Item = (char, u16)> {
    let codes = |line: Line| line.codes.1.iter().map(move |number| (line.codes.0, *number));
    entries().map(Entry::line).flat_map(codes)
}

/// The names that are known.
pub fn names() -> impl Iterator<Item = &'static str> {
    entries().map(Entry::line).flat_map(|line| line.names).copied()
}

/// Lines with their answers.
pub fn examples() -> impl Iterator<Item = Example> {
    entries().flat_map(Entry::its_examples)
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_code_and_every_name_stands_once() {
        assert_eq!(codes().count(), codes().collect::<BTreeSet<_>>().len());
        assert_eq!(names().count(), names().collect::<BTreeSet<_>>().len());
    }
}
