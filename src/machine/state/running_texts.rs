//! Texts that are carried out: lines with a name, in place of one line of a host. A text may call others.
//!
//! ```text
//!   host's line ── call ──▶ frame ──▶ its lines, one after the other ──▶ the host's ok
//!                             └─ call ──▶ frame (three at most, none twice)
//! ```
//!
//! A line that is kept without `ok` holds the frames: lines of other hosts come, and may run texts of their own above.

use super::modal::Modal;
use heapless::Vec;

/// Texts that call each other.
const DEPTH: usize = 3;

/// Bytes of the words of all calls: some ten temperatures.
const WORDS: usize = 192;

/// What is carried out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::machine) enum Body {
    /// A text of the owner: the places of its first and of its next line among the board's texts.
    Own { first: u16, next: u16 },
    /// START_PRINT as it is built in, and its next step.
    Start(u8),
    /// END_PRINT.
    End(u8),
}

/// A text that is carried out.
#[derive(Clone, Copy)]
struct Frame {
    body: Body,
    /// Where the words of its call begin.
    words: u16,
    /// The modes before it.
    modal: Modal,
}

/// The texts that are carried out, the innermost last.
pub(in crate::machine) struct RunningTexts {
    frames: Vec<Frame, DEPTH>,
    words: Vec<u8, WORDS>,
    /// So many of them wait for a line that is kept.
    held: usize,
    /// They were called by CANCEL_PRINT: the job has ended, and they move and heat all the same.
    pub is_of_cancel: bool,
}

impl RunningTexts {
    pub const fn new() -> Self {
        Self { frames: Vec::new(), words: Vec::new(), held: 0, is_of_cancel: false }
    }

    /// Whether the next line is one of a text.
    pub fn is_running(&self) -> bool {
        self.frames.len() > self.held
    }

    /// Whether a text waits for a line that is kept, and none runs.
    pub fn is_held(&self) -> bool {
        self.held > 0 && self.frames.len() == self.held
    }

    /// The line that is kept is one of a text, if one runs.
    pub fn hold(&mut self) {
        self.held = self.frames.len();
    }

    /// That line goes on.
    pub const fn take_up(&mut self) {
        self.held = 0;
    }

    /// All of them end before their last line.
    pub fn stop(&mut self) {
        *self = Self::new();
    }

    /// The same if the print has ended that they are lines of.
    pub fn stop_if(&mut self, is_ended: bool) {
        if is_ended {
            self.stop();
        }
    }

    /// Whether no other can be called.
    pub fn is_full(&self) -> bool {
        self.frames.is_full()
    }

    /// Whether a text with that first line is being carried out.
    pub fn runs(&self, at: usize) -> bool {
        self.frames.iter().any(|frame| matches!(frame.body, Body::Own { first, .. } if usize::from(first) == at))
    }

    /// A word of a call that is about to be made; false if there is no room for it.
    pub fn add_word(&mut self, key: &[u8], value: &[u8]) -> bool {
        let begin = self.words.len();
        let fits = [key, b"=", value, b"\n"].into_iter().all(|part| self.words.extend_from_slice(part).is_ok());
        if !fits {
            self.words.truncate(begin);
        }
        fits
    }

    /// Where the words of the next call begin.
    pub fn words_begin(&self) -> usize {
        self.words.len()
    }

    /// A call is not made.
    pub fn drop_words(&mut self, begin: usize) {
        self.words.truncate(begin);
    }

    /// A text begins. Its words were added from `begin` on.
    pub fn call(&mut self, body: Body, begin: usize, modal: &Modal) {
        let _ = self.frames.push(Frame { body, words: begin as u16, modal: *modal });
    }

    /// The value of a key, of the words from `begin` on.
    pub fn word_from(&self, begin: usize, key: &[u8]) -> Option<&[u8]> {
        let words = self.words.get(begin..)?.split(|byte| *byte == b'\n');
        words.into_iter().find_map(|word| word.strip_prefix(key)?.strip_prefix(b"="))
    }

    /// The same of the call of the innermost text.
    pub fn word(&self, key: &[u8]) -> Option<&[u8]> {
        self.word_from(usize::from(self.frames.last()?.words), key)
    }

    /// The innermost text, unless it is held.
    pub fn innermost(&mut self) -> Option<&mut Body> {
        if self.is_running() { self.frames.last_mut().map(|frame| &mut frame.body) } else { None }
    }

    /// The innermost text is over; returns the modes before it.
    pub fn end(&mut self) -> Option<Modal> {
        let Frame { words, modal, .. } = self.frames.pop()?;
        self.words.truncate(usize::from(words));
        Some(modal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_call_each_other_three_deep_and_each_has_its_own_words() {
        let (mut texts, modal) = (RunningTexts::new(), Modal::new());
        for depth in 0..3_u16 {
            let begin = texts.words_begin();
            assert!(!texts.is_full() && texts.add_word(b"BED", [b'0' + depth as u8].as_slice()));
            texts.call(Body::Own { first: depth * 10, next: depth * 10 }, begin, &modal);
            assert_eq!(texts.word(b"BED"), Some([b'0' + depth as u8].as_slice()));
        }
        assert!(texts.is_full() && texts.runs(10) && !texts.runs(30));
        assert_eq!((texts.word(b"BE"), texts.word(b"ED")), (None, None));
        assert!(texts.end().is_some() && texts.word(b"BED") == Some(b"1"));
        texts.stop();
        assert!(!texts.is_running() && texts.word(b"BED").is_none());
    }

    #[test]
    fn a_text_that_is_held_lets_another_run() {
        let (mut texts, modal) = (RunningTexts::new(), Modal::new());
        texts.call(Body::Start(3), 0, &modal);
        texts.hold();
        assert!(!texts.is_running() && texts.is_held() && texts.innermost().is_none());
        texts.call(Body::End(0), 0, &modal);
        assert!(texts.is_running() && !texts.is_held());
        assert_eq!(texts.innermost(), Some(&mut Body::End(0)));
        assert!(texts.end().is_some() && texts.is_held());
        texts.take_up();
        assert_eq!(texts.innermost(), Some(&mut Body::Start(3)));
    }

    #[test]
    fn words_beyond_the_room_are_refused_whole() {
        let mut texts = RunningTexts::new();
        while texts.add_word(b"KEY", &[b'1'; 24]) {}
        assert_eq!(texts.words_begin() % 29, 0);
        assert_eq!(texts.word_from(29, b"KEY"), Some(&[b'1'; 24][..]));
    }
}
