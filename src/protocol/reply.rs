//! Replies: every text of the protocol, and the output ring.
//!
//! A line goes into the ring whole or not at all, and so do the lines of one resend request. An `ok` with a temperature
//! report in the middle has ended prints (OctoPrint issue 4671). A byte that is not UTF-8 ends printcore's reading
//! thread, so only text is sent. The firmware's own is printable ASCII.
//!
//! Hosts act on the beginning of a line, and on some words anywhere in it. The fixed texts here avoid every such word
//! that is not meant; a test checks this.
//!
//! Full: [`NoRoom`], nothing is written, the caller tries again later. Empty: nothing is sent. Lines that a command
//! says on its way do not wait: those without room go into another ring, and this one is [held](Replies::hold) until
//! they are sent.

use core::fmt::{self, Write};

use heapless::Deque;

use super::numbering::ResendReason;

/// Bytes held: 89 ms at 115200 baud. A longer answer waits for room, and motion goes on meanwhile.
const CAPACITY: usize = 1024;

/// Sent while a line is being carried out. A host that reads `busy:` keeps waiting.
pub const BUSY: &str = "echo:busy: processing";

/// Sent while a line waits for the user.
pub const BUSY_PAUSED: &str = "echo:busy: paused for user";

/// Characters of an unknown command in its reply.
const ECHOED: usize = 60;

/// Bytes of a line, for room that is given in lines: Marlin's MAX_CMD_SIZE, which hosts know.
const LINE: usize = 96;

/// The lines do not fit now; nothing was written. Try again when some have been sent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NoRoom;

impl fmt::Display for NoRoom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        put!(f, "no room for the reply")
    }
}

impl core::error::Error for NoRoom {}

/// Lines on their way to the host.
pub struct Replies {
    bytes: Deque<u8, CAPACITY>,
    /// Lines of another ring follow, and none is added here.
    is_held: bool,
}

impl Default for Replies {
    fn default() -> Self {
        Self::new()
    }
}

impl Replies {
    /// Nothing to send.
    #[must_use]
    pub const fn new() -> Self {
        Self { bytes: Deque::new(), is_held: false }
    }

    /// Forgets all lines.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.is_held = false;
    }

    /// Whether lines of another ring follow: until they are sent, there is no room here.
    pub const fn hold(&mut self, is_held: bool) {
        self.is_held = is_held;
    }

    /// Adds one line and its line end. Control characters become `?`, line ends too.
    ///
    /// # Errors
    /// [`NoRoom`] if the whole line does not fit.
    pub fn line(&mut self, args: fmt::Arguments<'_>) -> Result<(), NoRoom> {
        self.whole(|replies| replies.append(args))
    }

    /// The oldest unsent bytes, as many as are contiguous; empty if there are none.
    #[must_use]
    pub fn pending(&self) -> &[u8] {
        self.bytes.as_slices().0
    }

    /// Whether bytes wait to be sent.
    #[must_use]
    pub fn has_pending(&self) -> bool {
        !self.bytes.is_empty()
    }

    /// Whether nothing waits to be sent, neither here nor behind it.
    #[must_use]
    pub fn are_sent(&self) -> bool {
        self.bytes.is_empty() && !self.is_held
    }

    /// Forgets the oldest `count` bytes, because they have been sent.
    pub fn sent(&mut self, count: usize) {
        for _ in 0..count {
            if self.bytes.pop_front().is_none() {
                return;
            }
        }
    }

    /// Bytes that may be added.
    #[must_use]
    pub const fn room(&self) -> usize {
        if self.is_held { 0 } else { CAPACITY - self.bytes.len() }
    }

    /// `ok`: the line was accepted.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn ok(&mut self) -> Result<(), NoRoom> {
        self.line(format_args!("ok"))
    }

    /// `ok` with the number of the line, if it had one, and the moves and bytes that still fit. Marlin's form
    /// (queue.cpp, ADVANCED_OK), which windowed hosts read.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn advanced_ok(&mut self, line: Option<i32>, moves: usize, bytes: usize) -> Result<(), NoRoom> {
        let lines = bytes / LINE;
        match line {
            Some(line) => self.line(format_args!("ok N{line} P{moves} B{lines}")),
            None => self.line(format_args!("ok P{moves} B{lines}")),
        }
    }

    /// Asks for the line after `last` in three lines; the third is the refused line's `ok`.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn resend(&mut self, reason: ResendReason, last: i32) -> Result<(), NoRoom> {
        // Marlin's words (language.h) tell hosts that the error is not fatal.
        let what = match reason {
            ResendReason::LineNumber => packed!("Line Number is not Last Line Number+1"),
            ResendReason::ChecksumMismatch => packed!("checksum mismatch"),
            ResendReason::NoChecksum => packed!("No Checksum with line number"),
        };
        self.whole(|replies| {
            replies.append(format_args!("Error:{what}, Last Line: {last}"))?;
            replies.append(format_args!("Resend: {}", i64::from(last) + 1))?;
            replies.append(format_args!("ok"))
        })
    }

    /// The question to a silent host: a request for the line after `last` without an error, because none is known. Its
    /// `ok` replaces the one of a lost line, or a lost `ok`.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn question(&mut self, last: i32) -> Result<(), NoRoom> {
        self.whole(|replies| {
            replies.append(format_args!("Resend: {}", i64::from(last) + 1))?;
            replies.append(format_args!("ok"))
        })
    }

    /// Replies to M110, with the line number if it asked for it.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn line_number(&mut self, report: Option<i32>) -> Result<(), NoRoom> {
        self.whole(|replies| {
            if let Some(number) = report {
                replies.append(format_args!("Line: {number}"))?;
            }
            replies.append(format_args!("ok"))
        })
    }

    /// Replies to a line that is too long, with `ok`.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn too_long(&mut self) -> Result<(), NoRoom> {
        self.whole(|replies| {
            replies.append(format_args!("echo:Line too long, ignored"))?;
            replies.append(format_args!("ok"))
        })
    }

    /// Replies to an unknown command, with `ok`. The beginning of the text is echoed, with its colons and quotes as
    /// `?`, because hosts act on ` T:` or `Cap:`.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn unknown(&mut self, text: &[u8]) -> Result<(), NoRoom> {
        self.whole(|replies| {
            replies.append(format_args!("echo:Unknown command: \"{}\"", Echo(text)))?;
            replies.append(format_args!("ok"))
        })
    }

    /// Reports that a line is still being carried out.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn busy(&mut self) -> Result<(), NoRoom> {
        self.line(format_args!("{BUSY}"))
    }

    /// Reports that a line waits for the user.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn paused(&mut self) -> Result<(), NoRoom> {
        self.line(format_args!("{BUSY_PAUSED}"))
    }

    /// The first line after a reset.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn start(&mut self) -> Result<(), NoRoom> {
        self.line(format_args!("start"))
    }

    /// The reply to everything after an emergency stop; there is no `ok` any more.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn killed(&mut self) -> Result<(), NoRoom> {
        self.line(format_args!("Error:Printer halted. kill() called! Send M999 or reset"))
    }

    /// The same after a fault, with its name.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn killed_by(&mut self, fault: impl fmt::Display) -> Result<(), NoRoom> {
        self.line(format_args!("Error:Printer halted. kill() called! ({fault}) Send M999 or reset"))
    }

    /// The same after a fault with a line of its own, as hosts know it from Marlin.
    ///
    /// # Errors
    /// [`NoRoom`]
    pub fn killed_after(&mut self, fault: impl fmt::Display) -> Result<(), NoRoom> {
        self.whole(|replies| {
            replies.append(format_args!("Error:{fault}"))?;
            replies.append(format_args!("Error:Printer halted. kill() called! Send M999 or reset"))
        })
    }

    /// Runs `write`, and undoes it if it needs more room than there is.
    fn whole(&mut self, write: impl FnOnce(&mut Self) -> fmt::Result) -> Result<(), NoRoom> {
        let length = self.bytes.len();
        if !self.is_held && write(self).is_ok() {
            return Ok(());
        }
        self.bytes.truncate(length);
        Err(NoRoom)
    }

    fn append(&mut self, args: fmt::Arguments<'_>) -> fmt::Result {
        Line(&mut self.bytes).write_fmt(args)?;
        self.bytes.push_back(b'\n').map_err(|_| fmt::Error)
    }
}

/// A line being written.
struct Line<'a>(&'a mut Deque<u8, CAPACITY>);

impl Write for Line<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.bytes().try_for_each(|byte| {
            // Tabs are between the heights of a table (M420 T1).
            let byte = if matches!(byte, b' '..=b'~' | b'\t' | 0x80..) { byte } else { b'?' };
            self.0.push_back(byte).map_err(|_| fmt::Error)
        })
    }
}

/// The beginning of a host's text, made harmless: printable ASCII only, and no colon or quotes, because hosts act on `
/// T:` or `Cap:`.
#[derive(Clone, Copy, Debug)]
pub struct Echo<'a>(pub &'a [u8]);

impl fmt::Display for Echo<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for &byte in self.0.iter().take(ECHOED) {
            f.write_char(match byte {
                b':' | b'"' => '?',
                b' '..=b'~' => byte as char,
                b'\t' => ' ',
                _ => '?',
            })?;
        }
        Ok(())
    }
}
