//! Stop: Ctrl-C and its kin end a run in an orderly way; a second one ends it at once.

use anyhow::Result;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Shells say 128 and the number of the signal of a command that a signal has ended.
const SIGNALLED: u8 = 128;

/// The signal for a pipe without a reader, which Rust ignores: SIGPIPE.
const NO_READER: usize = 13;

/// Whether to stop, and why.
#[derive(Clone, Default, Debug)]
pub struct Stop(Arc<AtomicUsize>);

impl Stop {
    /// Set by SIGINT, SIGTERM and SIGHUP from now on; the second of them ends the process.
    ///
    /// # Errors
    /// If the system does not take the handlers.
    #[cfg(unix)]
    pub fn at_signals() -> Result<Self> {
        use anyhow::Context as _;
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        use std::sync::atomic::AtomicBool;
        let (stop, again) = (Self::default(), Arc::new(AtomicBool::new(false)));
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let number = usize::try_from(signal)?;
            let registered = signal_hook::flag::register_conditional_default(signal, Arc::clone(&again))
                .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&again)))
                .and_then(|_| signal_hook::flag::register_usize(signal, Arc::clone(&stop.0), number));
            registered.context("cannot wait for Ctrl-C")?;
        }
        Ok(stop)
    }

    /// Ctrl-C ends the process here, without a flag before.
    ///
    /// # Errors
    /// The signal handlers could not be installed.
    #[cfg(not(unix))]
    pub fn at_signals() -> Result<Self> {
        Ok(Self::default())
    }

    /// The reader of the output is gone.
    pub fn lose_reader(&self) {
        self.0.store(NO_READER, Ordering::Relaxed);
    }

    /// Whether to stop.
    #[must_use]
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    /// The exit status of a command that was stopped.
    #[must_use]
    pub fn status(&self) -> Option<u8> {
        let signal = u8::try_from(self.0.load(Ordering::Relaxed)).ok()?;
        (signal != 0).then(|| SIGNALLED.saturating_add(signal))
    }
}
