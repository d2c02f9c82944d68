//! The waker of the Console's task: whoever has news for the Console asks for a poll of it.

use core::task::Waker;

use embassy_sync::waitqueue::AtomicWaker;

static CONSOLE_WAKER: AtomicWaker = AtomicWaker::new();

/// Keeps the waker of the Console's task.
pub fn register(waker: &Waker) {
    CONSOLE_WAKER.register(waker);
}

/// Asks for a poll of the Console. Not for the Stepper, which no critical section of `critical_section` holds off.
pub fn wake_console() {
    CONSOLE_WAKER.wake();
}
