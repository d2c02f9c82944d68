//! Prints: pauses, waits for the user, the end of a job, uploads, progress.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`job`] | every end of a print that leaves the machine usable |
//! | [`pause`], [`parking`], [`park_words`] | to the pause and back |
//! | [`detour`] | lines in a pause that are not the print's |
//! | [`named_texts`] | the owner's texts, and those that are built in |

pub(in crate::machine) mod at_once;
pub(in crate::machine) mod await_user;
pub(in crate::machine) mod debug_flags;
pub(in crate::machine) mod detour;
pub(in crate::machine) mod filament;
pub(in crate::machine) mod job;
pub(in crate::machine) mod layer_words;
pub(in crate::machine) mod named_texts;
pub(in crate::machine) mod object;
pub(in crate::machine) mod park_words;
pub(in crate::machine) mod parking;
pub(in crate::machine) mod pause;
pub(in crate::machine) mod pause_print;
pub(in crate::machine) mod power_loss;
pub(in crate::machine) mod print_marks;
pub(in crate::machine) mod print_words;
pub(in crate::machine) mod progress;
pub(in crate::machine) mod upload;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
