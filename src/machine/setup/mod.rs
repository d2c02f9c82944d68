//! Setup: settings as lines set them, and where they are kept.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`plain`], [`plain_words`] | numbers of rows of `settings`, taken if all are legal |
//! | [`rules`] | the rules of some of these codes: M92, M203, M205, M301, M304 |
//! | [`stored`] | memory that survives without power: M500, M501, M502, M504 |
//! | [`kept_mesh`], [`mesh_news`] | the mesh of the bed there, too: M500, M501, M420 L |
//!
//! `crate::settings` defines a setting and its legal range, `crate::storage` its record. The values of M207 and M208
//! are not stored. `reports::settings_report` writes each setting as the line that sets it.

pub(in crate::machine) mod all_settings;
pub(in crate::machine) mod input_shaper;
pub(in crate::machine) mod kept_mesh;
pub(in crate::machine) mod machine_record;
mod mesh_news;
pub(in crate::machine) mod plain;
pub(in crate::machine) mod plain_settings;
pub(in crate::machine) mod plain_words;
pub(in crate::machine) mod pressure_advance;
pub(in crate::machine) mod rules;
pub(in crate::machine) mod storage;
pub(in crate::machine) mod stored;
pub(in crate::machine) mod velocity_limit;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
