//! A machine with a probe over a bed, and where its nozzle is.

use super::life::{Life, live_with};
use corehbot::connectors::ConnectorName;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::Desk;

/// The motors of the Z screws.
pub const SCREWS: [usize; 2] = [4, 5];

/// Where the machine stands at the start, homed.
pub const START: [i32; 3] = [100, 100, 50];

/// A machine with a switch as its probe.
pub fn with_probe(mut s: Settings) -> Settings {
    s.probe_plug.connector = ConnectorName::lit("PROBE");
    s.probe.kind = ProbeKind::Switch;
    s.probe.samples = 1;
    s
}

/// A life over such a bed.
pub fn over(s: &Settings, bed: &BedSetup, storage: &mut Eeprom, body: impl FnOnce(&mut Life<'_>)) {
    over_with(s, bed, storage, 1, body);
}

/// The same with so many hosts.
pub fn over_with(s: &Settings, bed: &BedSetup, storage: &mut Eeprom, hosts: usize, body: impl FnOnce(&mut Life<'_>)) {
    let mut desk = Desk::new(hosts);
    desk.bed = Some(Box::new(BedPlant::new(s, bed)));
    live_with(s, Some(START.map(Mm::from_num)), (&mut desk, hosts), storage, body);
}

/// z of the nozzle, by the steps since the start.
pub fn real_z(life: &Life<'_>, s: &Settings) -> f64 {
    f64::from(START[2]) + f64::from(life.counts()[SCREWS[0]]) / s.axes.z.steps_per_mm.to_num::<f64>()
}
