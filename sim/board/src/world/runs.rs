//! Runs: what hosts send is printed to the end, on a machine of any state.

use super::{Desk, Outcome, World};
use crate::any_storage::AnyStorage;
use crate::drivers::Drivers;
use crate::ends::{Host, Sink};
use crate::reach::Beyond;
use corehbot::port::{NoStorage, Storage};
use corehbot::settings::Settings;
use corehbot::units::Mm;

/// Why a run has no outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WorldError {
    /// The printer waits for input and the host is silent, for ten virtual minutes.
    Stalled,
    /// A homed axis went beyond its end.
    Beyond(Beyond),
}

impl std::fmt::Display for WorldError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stalled => f.write_str("printer and host wait for each other"),
            Self::Beyond(beyond) => write!(f, "{beyond}"),
        }
    }
}

impl std::error::Error for WorldError {}

/// With nothing moving and nothing said for this long, nothing will ever happen.
const PATIENCE_MS: u32 = 600_000;

/// Prints what `host` sends on a machine that stands at `start` (x, y, z) as if homed, or somewhere.
///
/// # Errors
/// If printer and host wait for each other, or a homed axis goes beyond its end.
pub fn run(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    host: &mut dyn Host,
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    run_with(settings, start, NoStorage, &mut [host], sink)
}

/// The same with storage, and with several hosts, each on its own serial line. The firmware takes the settings in the
/// storage; the mechanism stays the one of `settings`.
///
/// # Errors
/// If printer and hosts wait for each other, or a homed axis goes beyond its end.
pub fn run_with(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: impl Storage,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    run_on(settings, start, storage, &Drivers::new(), hosts, sink)
}

/// The same on drivers that the caller shares.
///
/// # Errors
/// If printer and host wait for each other, or a homed axis goes beyond its end.
pub fn run_on(
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: impl Storage,
    drivers: &Drivers,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    run_at(&mut Desk::new(hosts.len()), settings, start, storage, drivers, hosts, sink)
}

/// The same at that desk, which has a line for each host.
///
/// # Errors
/// If printer and host wait for each other, or a homed axis goes beyond its end.
pub fn run_at(
    desk: &mut Desk,
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: impl Storage,
    drivers: &Drivers,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    print(desk, settings, start, AnyStorage::of(storage), drivers, hosts, sink)
}

fn print(
    desk: &mut Desk,
    settings: &Settings,
    start: Option<[Mm; 3]>,
    storage: AnyStorage<'_>,
    drivers: &Drivers,
    hosts: &mut [&mut dyn Host],
    sink: &mut dyn Sink,
) -> Result<Outcome, WorldError> {
    let mut world = World::switched_on(desk, settings, start, start, storage, drivers, sink);
    // The caller hears of it by the result, after the whole run.
    world.is_strict = false;
    let mut idle_ms = 0;
    while !(hosts.iter().all(|host| host.is_done()) || world.status().is_halted()) {
        world.poll();
        for (host, wire) in hosts.iter_mut().zip(world.wires()) {
            wire.deliver(*host);
            if host.opens() {
                wire.open();
            }
            wire.carry(world.now());
            host.clock(world.now());
            wire.take(|bytes| host.interject(bytes));
        }
        if world.is_awaiting_hosts() {
            let mut sent = 0;
            for (host, wire) in hosts.iter_mut().zip(world.wires()) {
                let bytes = wire.take(|bytes| host.send(bytes));
                if let Some(command) = host.sent().filter(|_| bytes > 0) {
                    world.read(command);
                }
                sent += bytes;
            }
            if sent > 0 {
                idle_ms = 0;
                continue;
            }
        }
        if world.advance() || world.is_heating() {
            idle_ms = 0;
        } else {
            idle_ms += 1;
            if idle_ms > PATIENCE_MS {
                return Err(WorldError::Stalled);
            }
        }
    }
    world.poll();
    world.end_moves();
    for (host, wire) in hosts.iter_mut().zip(world.wires()) {
        wire.deliver(*host);
    }
    world.beyond().map_or_else(|| Ok(world.outcome()), |beyond| Err(WorldError::Beyond(beyond)))
}
