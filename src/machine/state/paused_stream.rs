//! The program in a pause, as its own stream has sent it: what it has set since the pause began, without what buttons
//! and scripts have set.
//!
//! A line of the stream is told from another one in three ways:
//!
//! - It is of the print's host, and has a number if the lines that printed had one. OctoPrint and Pronterface number
//!   the lines of a file, and no line of a button.
//! - It is in no detour. A detour is what a button or a script sends around its moves: from G91 to G90, or from M83 to
//!   M82 or back. At the end of a detour, the modes, E and F are those before it.
//! - It is not G28, and no line of a text with a name.
//!
//! Modes (G90, G91, M82, M83, G20, planes) are those before the pause: no file changes them there for good.

use super::commanded::Commanded;
use super::modal::Modal;
use super::program::{Dynamics, Program};
use crate::gcode::{ArcWords, AxisWords, Command, MoveCommand};

/// G28.
const HOME: u16 = 28;

/// G91, G90, M83, M82.
const RELATIVE: (char, u16) = ('G', 91);
const ABSOLUTE: (char, u16) = ('G', 90);
const RELATIVE_EXTRUSION: (char, u16) = ('M', 83);
const ABSOLUTE_EXTRUSION: (char, u16) = ('M', 82);
const MODES: [(char, u16); 4] = [RELATIVE, ABSOLUTE, RELATIVE_EXTRUSION, ABSOLUTE_EXTRUSION];

/// Which lines of the print's host are not the stream's for now.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Detour {
    None,
    /// G91 until G90.
    Moves,
    /// M82 or M83, whose flag this is, until the other one.
    Filament(bool),
    /// Lines of another sender have come.
    Foreign,
}

/// The program, and the detour; they count in a pause.
#[derive(Clone, Copy, Debug)]
pub(in crate::machine) struct PausedStream {
    /// The program as far as the stream has come.
    program: Option<Program>,
    detour: Detour,
    /// Lines of the print have numbers.
    is_numbered: bool,
    /// The line that is carried out is one of a text with a name.
    is_in_text: bool,
}

impl PausedStream {
    /// Nothing was printed.
    pub const fn new() -> Self {
        Self { program: None, detour: Detour::None, is_numbered: false, is_in_text: false }
    }

    /// A line of the print has a number, or has none.
    pub const fn note_number(&mut self, has_number: bool) {
        self.is_numbered = has_number;
    }

    /// The next line is one of a text with a name, or is not.
    pub const fn note_text(&mut self, is_in_text: bool) {
        self.is_in_text = is_in_text;
    }

    /// A pause begins.
    pub const fn begin(&mut self, program: Program) {
        (self.program, self.detour) = (Some(program), Detour::None);
    }

    /// The program as far as the stream has come.
    pub const fn program(&self) -> Option<&Program> {
        self.program.as_ref()
    }

    /// The same, because the machine's zero has moved.
    pub const fn program_mut(&mut self) -> Option<&mut Program> {
        self.program.as_mut()
    }

    /// Whether a line of the print's host, with or without a number, may be one of the stream.
    pub const fn may_hold(&self, has_number: bool) -> bool {
        (has_number || !self.is_numbered) && !self.is_in_text
    }

    /// Whether a line of the print's host is in a detour.
    pub fn is_away(&self) -> bool {
        self.detour != Detour::None
    }

    /// Whether a line that prints now is the stream's. In a detour it is a button's, unless the detour has the mode of
    /// the stream: nobody can tell one who sends M83 in a file with M83.
    pub fn may_print(&self) -> bool {
        self.program.is_some_and(|program| match self.detour {
            Detour::None | Detour::Foreign => true,
            Detour::Moves => !program.modal.absolute,
            Detour::Filament(is_absolute) => is_absolute == program.modal.absolute_extrusion,
        })
    }

    /// A line that is not the stream's is carried out.
    pub fn note_foreign(&mut self, command: &Command<'_>) {
        let is_of_program = match command {
            Command::Move(_) => true,
            Command::Table(command) => command.is_of_program(),
            _ => false,
        };
        if is_of_program {
            self.detour = Detour::Foreign;
        }
    }

    /// Whether lines of another sender have come since the last line of the stream.
    pub fn take_foreign(&mut self) -> bool {
        let is_foreign = self.detour == Detour::Foreign;
        if is_foreign {
            self.detour = Detour::None;
        }
        is_foreign
    }

    /// A line of the stream, or of a detour, was carried out and has led there. True if it has ended a detour.
    pub fn note_own(&mut self, command: &Command<'_>, modal: &Modal, commanded: &Commanded, limits: &Dynamics) -> bool {
        let before = self.detour;
        let is_extrusion_absolute = self.program.is_some_and(|program| program.modal.absolute_extrusion);
        self.detour = match (before, mode_of(command)) {
            (_, Some(RELATIVE)) => Detour::Moves,
            (Detour::Moves, Some(ABSOLUTE)) => Detour::None,
            (Detour::None, Some(RELATIVE_EXTRUSION)) => Detour::Filament(false),
            (Detour::None, Some(ABSOLUTE_EXTRUSION)) if self.program.is_some() && !is_extrusion_absolute => {
                Detour::Filament(true)
            }
            (Detour::Filament(false), Some(ABSOLUTE_EXTRUSION))
            | (Detour::Filament(true), Some(RELATIVE_EXTRUSION)) => Detour::None,
            _ => before,
        };
        let Some(program) = &mut self.program else { return false };
        match command {
            // In a detour of the filament, moves may be the stream's; those with filament are a button's.
            Command::Move(MoveCommand::Line { to, .. } | MoveCommand::Arc(ArcWords { to, .. }))
                if before != Detour::Moves && (before == Detour::None || to.e.is_none()) =>
            {
                follow(&mut program.commanded, to, commanded);
            }
            Command::Table(command) if command.is('G', HOME) => return false,
            _ => {}
        }
        if (before, self.detour) == (Detour::None, Detour::None) {
            program.modal.feed = modal.feed;
            program.commanded = counting(&program.commanded, commanded);
            program.dynamics = *limits;
        }
        before != Detour::None && self.detour == Detour::None
    }
}

/// The code of a line that changes a mode which a detour is known by.
fn mode_of(command: &Command<'_>) -> Option<(char, u16)> {
    let Command::Table(command) = command else { return None };
    MODES.into_iter().find(|(letter, number)| command.is(*letter, *number))
}

/// A program that stands where `at` does, and counts as `counts`: E, its zero, a retraction.
pub(in crate::machine) const fn counting(at: &Commanded, counts: &Commanded) -> Commanded {
    let mut program = *counts;
    program.count_filament_as(at);
    program.go_to(at.position());
    program
}

/// A program has sent the axes with these words to where `other` is.
fn follow(commanded: &mut Commanded, words: &AxisWords, other: &Commanded) {
    let [x, y, z, e] = commanded.position();
    let [other_x, other_y, other_z, _] = other.position();
    let of = |word: Option<_>, at, other| if word.is_some() { other } else { at };
    commanded.go_to([of(words.x, x, other_x), of(words.y, y, other_y), of(words.z, z, other_z), e]);
}
