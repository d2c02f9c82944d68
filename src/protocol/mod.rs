//! The host protocol: bytes become verified lines, and replies become whole lines.
//!
//! The dialect is Marlin's, as OctoPrint, Printrun, Cura and Repetier-Host speak it: the host sends a line, perhaps
//! numbered and with a checksum, and waits for `ok`. A resend request repairs damage. This room does not know the
//! meaning of a line, except for M110, which sets the line number, and for the emergency commands, which act as they
//! arrive.
//!
//! Rule: everything that [`Receiver::next_line`] returns gets exactly one `ok`, and nothing else does.

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
mod sorting;
mod syntax;

pub use action::{ACTION, Action};
pub use emergency::Emergency;
pub use framing::CAPACITY as LONGEST_LINE;
pub use numbering::ResendReason;
pub use receiver::{Incoming, Receiver};
pub use reply::{BUSY, BUSY_PAUSED, Echo, NoRoom, Replies};
pub use silence::Activity;
pub use sorting::Owed;
