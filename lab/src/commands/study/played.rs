//! Played: the file with the steps for samples, read when the first sample is computed.
//!
//! G-code goes through the firmware, which takes its time; the first line of a journal and the table of finished
//! samples do not wait for it.

use anyhow::Result;
use corehbot_host::input::Plate;
use corehbot_host::printer::Printer;
use corehbot_host::stop::Stop;
use corehbot_questions::source::Source;
use std::path::PathBuf;
use std::sync::OnceLock;

/// G-code or a step trace.
pub(in crate::commands) struct Played {
    file: PathBuf,
    plate: Plate,
    printer: Printer,
    source: OnceLock<Box<Source>>,
}

impl Played {
    /// A file for this printer; it is not read yet.
    pub(in crate::commands) const fn new(file: PathBuf, plate: Plate, printer: Printer) -> Self {
        Self { file, plate, printer, source: OnceLock::new() }
    }

    /// Reads it, unless it was read before.
    ///
    /// # Errors
    /// The file is neither, the print failed, or it was stopped.
    pub(super) fn load(&self, stop: &Stop) -> Result<()> {
        if self.source.get().is_none() {
            let source = Source::read(&self.file, self.plate, &self.printer, stop)?;
            self.source.get_or_init(|| Box::new(source));
        }
        Ok(())
    }

    /// Its steps, if it was read.
    pub(super) fn source(&self) -> Option<&Source> {
        self.source.get().map(Box::as_ref)
    }
}
