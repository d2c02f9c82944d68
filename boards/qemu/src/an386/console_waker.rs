//! The waker of the Console's task: whoever has news for the Console asks for a poll of it.

use core::cell::RefCell;
use core::task::Waker;

use critical_section::Mutex;

static CONSOLE_WAKER: Mutex<RefCell<Option<Waker>>> = Mutex::new(RefCell::new(None));

/// Keeps the waker of the Console's task, which has the same one at each poll.
pub fn register(waker: &Waker) {
    critical_section::with(|section| {
        CONSOLE_WAKER.borrow_ref_mut(section).get_or_insert_with(|| waker.clone());
    });
}

/// Asks for a poll of the Console.
pub fn wake_console() {
    critical_section::with(|section| {
        if let Some(waker) = CONSOLE_WAKER.borrow_ref(section).as_ref() {
            waker.wake_by_ref();
        }
    });
}
