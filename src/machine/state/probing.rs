//! The probe's state: whether it is out.

/// Whether the probe is out, as far as this firmware has put it out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) struct Probing {
    is_out: bool,
}

impl Probing {
    /// As after a reset: it is in.
    pub const fn new() -> Self {
        Self { is_out: false }
    }

    /// Whether it is out.
    pub const fn is_out(&self) -> bool {
        self.is_out
    }

    /// It was put out, or taken in.
    pub const fn note_out(&mut self, is_out: bool) {
        self.is_out = is_out;
    }
}
