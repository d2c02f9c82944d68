//! A job: G-code and a machine in, step events out.

use super::emulator::Emulator;
use super::{dump, line, log};
use anyhow::{Context as _, Result, bail};
use corehbot::settings::Settings;
use corehbot::surface::Mesh;
use corehbot::units::Mm;
use corehbot_host::output::Outputs;
use corehbot_host::stop::Stop;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::Host;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Largest job file; the board reads as much (boards/qemu, job.rs).
const LARGEST_BLOB: usize = 4096;

/// The print.
pub struct Job {
    /// The text of the file.
    pub gcode: String,
    /// The machine.
    pub settings: Settings,
    /// Where the tool is at start, as if homed.
    pub start: Option<[Mm; 3]>,
    /// The mesh that z follows, of five by five points.
    pub mesh: Option<Mesh>,
    /// The board's patience with a silent host, in ms of its own time, which runs on without us: half a second of it
    /// may pass while we fetch a line.
    pub patience_ms: u16,
}

/// For a host that falls silent: while the board waits, its time is some 60 times as slow as ours.
pub const SCALED_PATIENCE_MS: u16 = 50;

/// A plugin of the emulator that watches.
pub struct Watcher {
    /// The emulator's option that loads it.
    pub plugin: String,
    /// Where it calls before the emulator starts, to tell of every byte that the board has heard.
    pub listener: TcpListener,
}

/// The result of a print.
pub struct Outcome {
    /// Step events.
    pub events: u64,
    /// Motion time of the last one.
    pub ticks: u64,
    /// Digest of the trace.
    pub sha256: String,
    /// The board's log.
    pub log: Vec<String>,
    /// Warnings of the printer.
    pub warnings: Vec<String>,
    /// How long it took on this computer.
    pub wall: Duration,
    /// The processors' time of the emulator.
    pub taken: Duration,
}

impl Job {
    /// Has `host` talk to `image` until the host is done.
    pub fn converse(&self, image: &Path, host: &mut dyn Host) -> Result<()> {
        self.talk(image, None, |stream| line::talk(stream, host, None)).map(|_| ())
    }

    /// Prints on `image`, and writes the step events to `trace` if wanted.
    pub fn run(&self, image: &Path, trace: Option<&Path>) -> Result<Outcome> {
        let mut host = FileHost::new(&self.gcode);
        let mut outcome = self.talk(image, trace, |stream| line::talk(stream, &mut host, None))?;
        outcome.warnings = host.warnings().iter().map(ToString::to_string).collect();
        match host.failure() {
            Some(failure) => bail!("the print failed at {failure}"),
            None => Ok(outcome),
        }
    }

    /// Lets `host` print under a watcher.
    pub fn watch(&self, image: &Path, trace: &Path, watcher: &Watcher, host: &mut dyn Host) -> Result<Outcome> {
        self.emulate(image, Some(trace), Some(&watcher.plugin), |stream| {
            let (heard, _) = watcher.listener.accept().context("the plugin does not call")?;
            line::talk(stream, host, Some(heard))
        })
    }

    /// Has `talk` talk to the board until it asks the board to end.
    pub fn talk(
        &self,
        image: &Path,
        trace: Option<&Path>,
        talk: impl FnOnce(&mut TcpStream) -> Result<()>,
    ) -> Result<Outcome> {
        self.emulate(image, trace, None, talk)
    }

    fn emulate(
        &self,
        image: &Path,
        trace: Option<&Path>,
        plugin: Option<&str>,
        talk: impl FnOnce(&mut TcpStream) -> Result<()>,
    ) -> Result<Outcome> {
        let begin = Instant::now();
        let folder = Folder::new()?;
        let mut blob = [0; LARGEST_BLOB];
        let settings = Settings { patience_ms: self.patience_ms, ..self.settings };
        let mesh = self.mesh.map(|mesh| {
            let rows: [[i16; 5]; 5] =
                std::array::from_fn(|row| std::array::from_fn(|column| mesh.heights().get(column, row)));
            (rows, [mesh.first(), mesh.last()], mesh.fade())
        });
        let blob =
            postcard::to_slice(&(&settings, self.start, mesh), &mut blob).context("the settings are too large")?;
        std::fs::write(folder.file("settings"), blob)?;
        let mut emulator = Emulator::start(image, folder.path(), plugin)?;
        let talk = talk(emulator.line());
        // A board that panics hangs up; its last words say more than that.
        let taken = emulator.end(talk.is_ok())?;
        talk?;
        let mut outputs = Outputs::new([], Stop::default());
        let out = trace.map(|path| outputs.open(path)).transpose()?;
        let dumped = dump::convert(&folder.file("trace"), out, (&self.settings).into())?;
        outputs.keep()?;
        Ok(Outcome {
            events: dumped.trace.events,
            ticks: dumped.ticks,
            sha256: dumped.trace.sha256,
            log: log::decode(image, &folder.file("log"))?,
            warnings: Vec::new(),
            wall: begin.elapsed(),
            taken,
        })
    }
}

/// A folder for one run, gone when it is over.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self> {
        static RUNS: AtomicU32 = AtomicU32::new(0);
        let run = RUNS.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("corehbot-qemu-{}-{run}", std::process::id()));
        std::fs::create_dir(&path).with_context(|| format!("cannot create {}", path.display()))?;
        Ok(Self(path))
    }

    fn path(&self) -> &Path {
        &self.0
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A remaining folder lies among temporary files, where the system removes it.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
