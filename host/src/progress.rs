//! Watched: progress of long work, and a host that shows it and can be stopped.

use crate::say::note;
use crate::stop::Stop;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// A bar on a terminal, and no bar elsewhere.
pub fn progress_bar(length: u64, of: &'static str) -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template(&format!("{{wide_bar}} {{pos}}/{{len}} {of}, {{eta}} left")) {
        bar.set_style(style);
    }
    bar
}

/// Progress of pieces of work of known weights, which may go on at the same time: a bar on a terminal. Elsewhere a line
/// says how long it takes, once this is known and worth a line.
pub struct Progress {
    bar: ProgressBar,
    state: Mutex<State>,
}

/// How far the pieces are.
struct State {
    /// Weight of each piece, and its done part, of 1.
    pieces: Vec<(f64, f64)>,
    /// When the first piece went on after its preparations, which must not count as slow work.
    begin: Option<Instant>,
    is_told: bool,
}

/// Parts of its bar.
const PARTS: f64 = 1000.0;

/// An estimate is told once this part of the work is done, of 1.
const KNOWN_AFTER: f64 = 0.05;

/// A shorter rest is not worth a line.
const WORTH: Duration = Duration::from_secs(20);

impl Progress {
    /// Pieces of these weights.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let pieces = weights.into_iter().map(|weight| (weight, 0.0)).collect();
        let bar = progress_bar(PARTS as u64, "thousandths");
        Self { bar, state: Mutex::new(State { pieces, begin: None, is_told: false }) }
    }

    /// A part, of 1, of a piece is done.
    pub fn set(&self, piece: usize, part: f64) {
        let Ok(mut state) = self.state.lock() else { return };
        if let Some((_, done)) = state.pieces.get_mut(piece) {
            *done = part;
        }
        let done = state.done();
        self.bar.set_position((done * PARTS) as u64);
        let elapsed = state.begin.get_or_insert_with(Instant::now).elapsed();
        if self.bar.is_hidden() && done > KNOWN_AFTER && !state.is_told {
            state.is_told = true;
            let left = state.left(elapsed);
            if left > WORTH {
                note(format_args!("corehbot: about {} left", HumanDuration(left)));
            }
        }
    }

    /// The done part of all pieces, of 1.
    #[must_use]
    pub fn done(&self) -> f64 {
        self.state.lock().map_or(0.0, |state| state.done())
    }

    /// Does a piece. `work` gets a function that takes the done part, of 1, and returns whether to continue.
    pub fn piece<T, E>(
        &self,
        piece: usize,
        stop: &Stop,
        work: impl FnOnce(&mut dyn FnMut(f64) -> bool) -> Result<T, E>,
    ) -> Result<T, E> {
        let result = work(&mut |part| {
            self.set(piece, part);
            !stop.is_set()
        })?;
        self.set(piece, 1.0);
        Ok(result)
    }
}

impl State {
    /// The done part of all pieces, of 1.
    fn done(&self) -> f64 {
        let whole: f64 = self.pieces.iter().map(|(weight, _)| weight).sum();
        self.pieces.iter().map(|(weight, done)| weight * done).sum::<f64>() / whole
    }

    /// The rest takes this long, if the done part took so long.
    fn left(&self, elapsed: Duration) -> Duration {
        let done = self.done();
        elapsed.mul_f64((1.0 - done) / done)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A host that shows its progress, and that can be stopped.
pub struct Watched<'s> {
    host: FileHost,
    bar: ProgressBar,
    stop: &'s Stop,
}

impl<'s> Watched<'s> {
    /// With a bar, if there is a terminal.
    pub fn new(host: FileHost, stop: &'s Stop) -> Self {
        let bar = progress_bar(host.commands(), "commands");
        Self { host, bar, stop }
    }

    /// Takes the bar away.
    pub fn finish(self) -> FileHost {
        self.bar.finish_and_clear();
        self.host
    }
}

impl Host for Watched<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.host.send(out);
        let answered = self.host.answered();
        // A position a command would cost more than the command.
        if answered.is_multiple_of(64) {
            self.bar.set_position(answered);
        }
    }

    fn clock(&mut self, tick: u64) {
        self.host.clock(tick);
    }

    fn interject(&mut self, out: &mut Vec<u8>) {
        self.host.interject(out);
    }

    fn sent(&self) -> Option<(u32, u16, &str)> {
        self.host.sent()
    }

    fn hear(&mut self, line: &str) {
        self.host.hear(line);
    }

    fn is_done(&self) -> bool {
        self.host.is_done() || self.stop.is_set()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_all_pieces() {
        let progress = Progress::new([2.0, 1.0, 1.0]);
        let left_s = |elapsed_s| progress.state.lock().unwrap().left(Duration::from_secs(elapsed_s)).as_secs_f64();
        // A weight of 1 in 10 s: 30 s for the other 3.
        progress.set(0, 0.5);
        assert!((left_s(10) - 30.0).abs() < 1e-6, "{}", left_s(10));
        // A weight of 2.5 in 25 s.
        progress.set(0, 1.0);
        progress.set(1, 0.5);
        assert!((left_s(25) - 15.0).abs() < 1e-6, "{}", left_s(25));
    }
}
