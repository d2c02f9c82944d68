//! Habits of a computer on the USB cable: how it uses the cable and the port.

/// What the computer does beside its conversation.
#[derive(Clone, Copy, Default, Debug)]
pub struct UsbHabits {
    /// It opens the port and closes it so often before.
    pub openings: usize,
    /// When the cable is pulled, and plugged in again, in ns. The next conversation begins then.
    pub pulled: Option<(u64, u64)>,
}
