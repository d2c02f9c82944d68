//! The desk: what a world stands on, and what of it outlives a restart.

use super::ZShifts;
use crate::accelerometer::SensorTruth;
use crate::accident::Accident;
use crate::belt::BeltPlant;
use crate::heat_plant::HeatSetup;
use crate::mesh_log::MeshLog;
use crate::ports::{Shared, Wire};
use crate::wiring_mistakes::Plugs;
use corehbot::app::Memory;
use corehbot::motors::EndstopSet;
use corehbot::port::BoardFacts;
use corehbot::surface::Mesh;
use corehbot_machine_file::{NamedText, body};
use corehbot_rig::bed::BedPlant;
use corehbot_rig::plant::Plant;

/// Facts of the simulated board.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimBoard {
    /// Its owner's texts.
    pub texts: &'static [u8],
}

impl SimBoard {
    /// A board with these texts, for as long as the program runs.
    #[must_use]
    pub fn of(texts: &[NamedText]) -> Self {
        Self { texts: Box::leak(body(texts).into_boxed_slice()) }
    }
}

impl BoardFacts for SimBoard {
    fn texts(&self) -> &'static [u8] {
        self.texts
    }
}

/// The base of a [`World`](super::World), which outlives it.
pub struct Desk {
    pub(super) memory: Memory,
    pub(super) shared: Shared,
    pub(super) wires: Vec<Wire>,
    /// The switches that are connected.
    pub endstops: EndstopSet,
    /// The bed of a machine with a probe; without it, a flat one. It keeps its state across a restart.
    pub bed: Option<Box<BedPlant>>,
    /// The probe's accidents, by time.
    pub probe_accidents: Vec<Accident>,
    /// The mesh that the firmware has of it, which z follows.
    pub mesh: Option<Mesh>,
    /// What a mesh does, if that is asked for.
    pub mesh_log: Option<Box<MeshLog>>,
    /// Shifts of z that were made, or are to be made again.
    pub z_shifts: ZShifts,
    /// The belt plant on the motors; without it, a rigid machine. It keeps its state across a restart.
    pub belt: Option<Box<BeltPlant>>,
    /// What hangs on drivers and inputs, if it is not what belongs there.
    pub plugs: Option<Plugs>,
    /// The accelerometer of a machine that has one; without it, a usual one.
    pub sensor: Option<SensorTruth>,
    /// The heaters' true values, and their accidents.
    pub heat: HeatSetup,
    /// The facts of the board.
    pub board: SimBoard,
    /// Whether a homed axis beyond its end ends the program: in tests. Otherwise
    /// [`World::beyond`](super::World::beyond) tells of it.
    pub is_strict: bool,
    /// The heat left by an earlier world; without it, everything is as warm as the room.
    pub plant: Option<Box<Plant>>,
}

impl Desk {
    /// A desk with `lines` serial lines.
    #[must_use]
    pub fn new(lines: usize) -> Box<Self> {
        let wires = std::iter::repeat_with(Wire::default).take(lines).collect();
        let (memory, shared) = (Memory::new(), Shared::default());
        let heat = HeatSetup::default();
        Box::new(Self {
            memory,
            shared,
            wires,
            endstops: EndstopSet::SWITCHES,
            bed: None,
            probe_accidents: Vec::new(),
            mesh: None,
            board: SimBoard::default(),
            is_strict: true,
            mesh_log: None,
            z_shifts: ZShifts::default(),
            belt: None,
            plugs: None,
            sensor: None,
            heat,
            plant: None,
        })
    }

    /// Its serial lines carry so many bytes to their hosts in a second.
    pub fn slow_down(&self, bytes: u32) {
        self.wires.iter().for_each(|wire| wire.slow_down(bytes));
    }

    /// The same at a time in ticks.
    #[must_use]
    pub fn at(lines: usize, now: u64) -> Box<Self> {
        let desk = Self::new(lines);
        desk.shared.now.set(now);
        desk
    }
}
