//! Notices: messages that a host gets once, and not with every line that causes them.

use heapless::Vec;

/// Missing parts that are reported to hosts in one print. A print names a few: fans and tools of another machine.
const MOST_ABSENT: usize = 16;

/// A message that a host gets once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Notice {
    /// A target lay beyond the edge.
    Edge,
    /// An axis moved before it was homed.
    MotionBeforeHoming,
    /// Words of M205 do not count.
    Corners,
    /// There are no heaters.
    NoHeaters,
    /// There is no hotend, but another heater.
    NoHotend,
    /// There is no bed, but another heater.
    NoBed,
    /// The hotend is too cold for filament to move.
    Cold,
    /// Motors of one belt print that are not aligned.
    NotAligned,
}

/// The notices that were given.
#[derive(Debug)]
pub(in crate::machine) struct Notices {
    edge: bool,
    motion_before_homing: bool,
    corners: bool,
    no_heaters: bool,
    no_hotend: bool,
    no_bed: bool,
    cold: bool,
    not_aligned: bool,
    /// Words for parts that are not there (`gcode::Absent::key`).
    absent: Vec<u32, MOST_ABSENT>,
}

impl Notices {
    /// No notice was sent yet.
    pub const fn new() -> Self {
        Self {
            edge: false,
            motion_before_homing: false,
            corners: false,
            no_heaters: false,
            no_hotend: false,
            no_bed: false,
            cold: false,
            not_aligned: false,
            absent: Vec::new(),
        }
    }

    const fn given(&mut self, notice: Notice) -> &mut bool {
        match notice {
            Notice::Edge => &mut self.edge,
            Notice::MotionBeforeHoming => &mut self.motion_before_homing,
            Notice::Corners => &mut self.corners,
            Notice::NoHeaters => &mut self.no_heaters,
            Notice::NoHotend => &mut self.no_hotend,
            Notice::NoBed => &mut self.no_bed,
            Notice::Cold => &mut self.cold,
            Notice::NotAligned => &mut self.not_aligned,
        }
    }

    /// Whether a notice is still to be given; from now on it counts as given.
    pub const fn give(&mut self, notice: Notice) -> bool {
        !core::mem::replace(self.given(notice), true)
    }

    /// Whether a word for a missing part has not been reported yet; from now on it counts as reported. After
    /// [`MOST_ABSENT`] of them no more are reported.
    pub fn give_absent(&mut self, key: u32) -> bool {
        !self.absent.contains(&key) && self.absent.push(key).is_ok()
    }

    /// Has a notice given again when it is next true.
    pub const fn renew(&mut self, notice: Notice) {
        *self.given(notice) = false;
    }

    /// Another print begins: its notices are sent again.
    pub fn renew_for_print(&mut self) {
        self.renew_for_position();
        let told_of_prints = [Notice::Corners, Notice::NoHotend, Notice::NoBed, Notice::Cold, Notice::NotAligned];
        for notice in told_of_prints {
            self.renew(notice);
        }
        self.absent.clear();
    }

    /// The position is not known any more.
    pub const fn renew_for_position(&mut self) {
        self.renew(Notice::Edge);
        self.renew(Notice::MotionBeforeHoming);
    }
}
