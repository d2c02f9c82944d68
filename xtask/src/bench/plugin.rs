//! The plugin: compiled by the C compiler when it has changed, and its counts read back.

use super::contexts::Context;
use super::octopus::PlainStep;
use super::rooms::Room;
use super::waits::LINE;
use crate::checkout::run;
use crate::image_code::Code;
use crate::qemu::Watcher;
use anyhow::{Context as _, Result, bail};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Its source.
const SOURCE: &str = include_str!("plugin.c");

/// Entries of the map of rooms: a byte for each half word of the first 512 KiB of flash and of RAM.
const PLACES: usize = 1 << 19;

/// A plugin that is ready to be loaded.
pub struct Plugin {
    library: PathBuf,
    map: PathBuf,
    handlers: BTreeMap<Context, u64>,
    /// Flash lines of the Octopus's step interrupt, of its code and of its constants.
    lines: [BTreeSet<u64>; 2],
}

/// Executions at an address, in a context and for a room.
pub struct Spot {
    /// The running context.
    pub context: Context,
    /// The room it worked for; `None` in a context outside of all rooms.
    pub room: Option<Room>,
    /// Where.
    pub address: u64,
    /// How often.
    pub count: u64,
    /// How often it led elsewhere than to the next instruction.
    pub taken: u64,
}

/// The plugin's counts, from the first byte of the host on.
#[derive(Default)]
pub struct Counts {
    /// Every address that was executed.
    pub spots: Vec<Spot>,
    /// How often each context was entered, and the most instructions from its entry to its return.
    pub entries: BTreeMap<Context, (u64, u64)>,
    /// The most instructions for a room from a context's entry to its return.
    pub most: BTreeMap<(Context, Room), u64>,
    /// Flash lines that were in neither cache, of code and of constants. In the step interrupt they are the Octopus's.
    pub missed: BTreeMap<Context, [u64; 2]>,
    /// Answers to lines, and the instructions from the last byte of the line to the first of its answer.
    pub answers: (u64, u64),
}

impl Plugin {
    /// Compiles it if need be, and makes the map of rooms of an image. In the caches, the step interrupt of that image
    /// has the flash lines of another's, `step`.
    pub fn prepare(code: &Code<'_>, step: &PlainStep, folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
        let mut map = vec![0; PLACES];
        for address in code.addresses() {
            let place = (address >> 29 & 1) << 18 | (address & 0x7_FFFF) >> 1;
            map[place as usize] = code.author(address, Room::of)?.room.map_or(0, |room| room as u8);
        }
        let map_path = folder.join("rooms");
        std::fs::write(&map_path, map)?;
        let mut handlers = BTreeMap::new();
        for context in Context::BUSY.into_iter().filter(|context| *context != Context::Waiting) {
            handlers.insert(context, code.handler(context.vector())?);
        }
        let lines = [step.lines.clone(), step.constants.clone()];
        Ok(Self { library: compile(folder)?, map: map_path, handlers, lines })
    }

    /// One that leaves its counts in `out`.
    pub fn watcher(&self, out: &Path) -> Result<Watcher> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).context("cannot open a port")?;
        let mut plugin = format!(
            "{},map={},out={},tell={}",
            self.library.display(),
            self.map.display(),
            out.display(),
            listener.local_addr()?.port()
        );
        for (context, handler) in &self.handlers {
            write!(plugin, ",handler={:x}:{handler:x}:{:x}", context.vector(), context.priority())?;
        }
        write!(plugin, ",steps={:x}", Context::Steps.vector())?;
        for (kind, lines) in ["line", "constant"].into_iter().zip(&self.lines) {
            for line in lines {
                write!(plugin, ",{kind}={:x}", line * LINE)?;
            }
        }
        for context in [Context::Idle, Context::Steps, Context::Generator] {
            write!(plugin, ",aside={:x}", context.vector())?;
        }
        let [asked, answered] = [Context::Received, Context::Transmitted].map(Context::vector);
        let [console, waiting] = [Context::Console, Context::Waiting].map(Context::vector);
        write!(plugin, ",start={asked:x},asked={asked:x},answered={answered:x},split={console:x}:{waiting:x}")?;
        Ok(Watcher { plugin, listener })
    }
}

fn compile(folder: &Path) -> Result<PathBuf> {
    let (source, library) = (folder.join("plugin.c"), folder.join("plugin.so"));
    let is_current = library.exists() && std::fs::read_to_string(&source).is_ok_and(|text| text == SOURCE);
    if !is_current {
        std::fs::write(&source, SOURCE)?;
        let mut command = Command::new("cc");
        command.args(["-O2", "-Wall", "-Wextra", "-shared", "-fPIC", "-o"]).arg(&library).arg(&source);
        if let Err(error) = run(command) {
            // So that an old one is not mistaken for current.
            let _ = std::fs::remove_file(&library);
            return Err(error.context("the plugin needs a C compiler"));
        }
    }
    Ok(library)
}

impl Counts {
    /// Reads the plugin's file.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).context("the plugin left no counts")?;
        let mut counts = Self::default();
        for line in text.lines() {
            counts.take(line).with_context(|| format!("the plugin's counts are damaged: {line}"))?;
        }
        Ok(counts)
    }

    fn take(&mut self, line: &str) -> Result<()> {
        let (kind, numbers) = line.split_once(' ').context("no numbers")?;
        let numbers: Vec<u64> = numbers.split(' ').map(str::parse).collect::<Result<_, _>>()?;
        let context = |vector| Context::of_vector(vector).context("an unknown context");
        match (kind, &*numbers) {
            ("answers", &[count, sum]) => self.answers = (count, sum),
            ("context", &[vector, entries, longest]) => {
                self.entries.insert(context(vector)?, (entries, longest));
            }
            ("missed", &[vector, code, constants]) => {
                self.missed.insert(context(vector)?, [code, constants]);
            }
            ("most", &[vector, room, most]) => {
                if let Some(room) = Room::numbered(room) {
                    self.most.insert((context(vector)?, room), most);
                }
            }
            ("at", &[vector, room, address, count, taken]) => {
                let (context, room) = (context(vector)?, Room::numbered(room));
                self.spots.push(Spot { context, room, address, count, taken });
            }
            _ => bail!("an unknown line"),
        }
        Ok(())
    }
}
