//! Status: with which exit status a command ends.

/// All went well.
pub(crate) const DONE: u8 = 0;

/// The print failed, or a file is not a machine.
pub(crate) const FAILED: u8 = 1;

/// Nothing was begun; clap ends with the same status.
pub(crate) const UNUSABLE: u8 = 2;
