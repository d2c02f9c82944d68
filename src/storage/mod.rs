//! Storage: the settings as records in non-volatile memory that survive a power cut at any byte.
//!
//! Two slots hold a record each. A save writes the slot that does not hold the newest settings, so these stay whole
//! until the new record is whole. A checksum over all of a record decides whether it is. Sequence numbers tell which of
//! two is the newer one, and saving in turns halves the wear.
//!
//! An image has a place for its own record ([`machine_of`]): the machine of this board until another one is stored.
//!
//! Next to it an image has the owner's texts (`texts`), for which settings have no room.
//!
//! The last page has notes (`notes`): the last self-test of the heaters that was passed, and the load that a mm of
//! strain takes of belt motors. It also has what hotend and bed take and move when they are healthy. `map` says where
//! everything lies.

mod machine;
mod machine_block;
mod map;
mod mesh;
mod notes;
mod out;
mod payload;
mod record;
mod slots;
mod texts;

pub use machine::{machine_in, record_of, stored_machine};
pub use machine_block::{
    BLOCK, MARK, blank_block, board_of, boards_of, choose_board, clear_machine, machine_of, put_machine,
};
pub use map::{NEEDED, PAGE, STRIDE};
pub use mesh::{
    MOST_STORED, MeshFate, MeshNotSaved, MeshRejected, StoredMesh, follow_settings, forget_mesh, is_of_others,
    load_mesh, machine_of as mesh_machine, save_mesh,
};
pub use notes::{baseline, belt_loads, note_baseline, note_belt_loads, note_passed_test, passed_test};
pub use payload::Unknown;
pub use record::{FORMAT, LONGEST, Receipt, Rejected};
pub use slots::{SaveError, Slot, Stored, Survey, is_present, save, save_with, survey, survey_with};
pub use texts::{
    Gap, LONGEST_TEXTS, MOST_VALUE, TEXT_BLOCK, TEXT_MARK, blank_texts, is_value, line_at, put_texts, split_at_gap,
    text_named, texts_of,
};
