//! A machine that homes z by its probe, 1.5 mm below the nozzle, over a flat bed.

use crate::common::heated::heated;
use crate::common::life::{Life, live_with};
use crate::common::on_bed::with_probe;
use corehbot::motors::EndstopSet;
use corehbot::port::NoStorage;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::world::Desk;

/// The machine.
pub fn machine(kind: ProbeKind) -> Settings {
    let mut s = with_probe(heated());
    (s.probe.kind, s.probe.homes_z) = (kind, true);
    (s.probe.offset.x, s.probe.offset.z) = (Mm::from_num(-40), Mm::from_num(-1.5));
    s
}

/// Its life from the start, where no axis is homed.
pub fn begin(s: &Settings, body: impl FnOnce(&mut Life<'_>)) {
    begin_over(s, &BedSetup::of(s), body);
}

/// The same over such a bed.
pub fn begin_over(s: &Settings, bed: &BedSetup, body: impl FnOnce(&mut Life<'_>)) {
    live_on_desk(s, bed, Desk::new(1), body);
}

/// The same with these inputs alone.
pub fn begin_with(s: &Settings, inputs: EndstopSet, body: impl FnOnce(&mut Life<'_>)) {
    let mut desk = Desk::new(1);
    desk.endstops = inputs;
    live_on_desk(s, &BedSetup::of(s), desk, body);
}

fn live_on_desk(s: &Settings, bed: &BedSetup, mut desk: Box<Desk>, body: impl FnOnce(&mut Life<'_>)) {
    desk.bed = Some(Box::new(BedPlant::new(s, bed)));
    live_with(s, None, (&mut desk, 1), NoStorage, body);
}
