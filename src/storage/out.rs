//! Out: bytes that are written one behind the other.

/// A place for bytes, and how far it is written.
pub(super) struct Out<'a> {
    bytes: &'a mut [u8],
    at: usize,
}

impl<'a> Out<'a> {
    pub const fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Writes bytes behind those so far. What does not fit is not written, and then nothing else is.
    pub fn put(&mut self, bytes: &[u8]) {
        if let Some(place) = self.bytes.get_mut(self.at..self.at + bytes.len()) {
            place.copy_from_slice(bytes);
        }
        self.at += bytes.len();
    }

    /// The bytes written; `None` if they did not fit.
    pub fn written(self) -> Option<&'a [u8]> {
        let Self { bytes, at } = self;
        bytes.get(..at)
    }
}
