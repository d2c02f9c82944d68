//! Access to the registers of the core.

/// The registers of the core, and its FIFOs, by the offset from its base.
pub trait Registers: Copy {
    /// Reads a word. A read of GRXSTSP or of a FIFO takes what it reads.
    fn read(self, offset: u32) -> u32;

    /// Writes a word.
    fn write(self, offset: u32, value: u32);

    /// Sets bits of a register beside those that it has.
    fn set(self, offset: u32, bits: u32) {
        self.write(offset, self.read(offset) | bits);
    }

    /// Clears bits of a register.
    fn clear(self, offset: u32, bits: u32) {
        self.write(offset, self.read(offset) & !bits);
    }
}
