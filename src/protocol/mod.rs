//! The host protocol: bytes become lines that may be trusted, and answers become whole lines.
//!
//! The dialect is that of Marlin, as OctoPrint, Printrun, Cura and Repetier-Host speak it: the host sends
//! a line, perhaps numbered and with a checksum, and waits for `ok`. Damage is repaired by a resend
//! dialogue. This room does not know what a line means, except for M110, which sets the line number,
//! and for the emergency commands, which act as they arrive.
//!
//! Rule: everything that [`Receiver::next_line`] returns is answered with exactly one `ok`, and nothing
//! else is.

mod action;
mod checksum;
mod emergency;
mod framing;
mod numbering;
mod receiver;
mod reply;
mod request;
mod ring;
mod silence;
mod syntax;

pub use action::{ACTION, Action};
pub use emergency::Emergency;
pub use numbering::ResendReason;
pub use receiver::{Incoming, Receiver};
pub use reply::{BUSY, BUSY_PAUSED, Echo, NoRoom, Replies};
pub use silence::Activity;
