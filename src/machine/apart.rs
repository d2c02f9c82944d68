//! Futures that are polled by a function of their own.

use core::future::Future;
use core::pin::Pin;
use core::task::{Context, Poll};

/// A future whose `poll` is not inlined into that of the caller. Its state then lies near the pointer that it is polled
/// by, so most of it is reached by instructions of two bytes instead of four.
pub(in crate::machine) struct Apart<'a, F>(Pin<&'a mut F>);

/// Polls a pinned future by a function of its own.
pub(in crate::machine) const fn apart<F: Future>(future: Pin<&mut F>) -> Apart<'_, F> {
    Apart(future)
}

impl<F: Future> Future for Apart<'_, F> {
    type Output = F::Output;

    #[inline(never)]
    fn poll(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<F::Output> {
        self.0.as_mut().poll(context)
    }
}
