//! Handover: start-up puts a value in its place, and one interrupt handler uses it from then on.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU8, Ordering};

/// Nothing is there yet.
const EMPTY: u8 = 0;
/// The value is there and not in use.
const FREE: u8 = 1;
/// A context holds a reference to the value, or fills the place.
const IN_USE: u8 = 2;

/// A place for one value. Empty it is all zeros, so it costs no flash.
pub struct Handover<T> {
    value: UnsafeCell<MaybeUninit<T>>,
    state: AtomicU8,
}

// SAFETY: a reference to the value exists only while `state` is IN_USE. Only one context at a time can change EMPTY or
// FREE to IN_USE; a caller that finds another state panics. The value moves between contexts, hence `T: Send`.
unsafe impl<T: Send> Sync for Handover<T> {}

impl<T> Default for Handover<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> Handover<T> {
    /// An empty place.
    pub const fn new() -> Self {
        Self { value: UnsafeCell::new(MaybeUninit::uninit()), state: AtomicU8::new(EMPTY) }
    }

    /// Fills the place.
    ///
    /// # Panics
    /// If it was filled before.
    pub fn fill(&self, value: T) {
        assert_eq!(self.state.swap(IN_USE, Ordering::Acquire), EMPTY, "a handle is given out twice");
        // SAFETY: the state was EMPTY and is IN_USE, so no other reference exists.
        unsafe { (*self.value.get()).write(value) };
        self.state.store(FREE, Ordering::Release);
    }

    /// Works with the value, without asking whether it is there and free: for a handler in which a dozen instructions
    /// are many.
    ///
    /// # Safety
    /// The place was filled before, and the caller cannot interrupt any context that works with the value, itself
    /// included.
    #[inline(always)]
    pub unsafe fn with_alone<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        // SAFETY: the value is there, and by the caller's word this is the only reference.
        work(unsafe { (*self.value.get()).assume_init_mut() })
    }

    /// Works with the value.
    ///
    /// # Panics
    /// If there is no value yet, or if the caller has interrupted a context that works with it.
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        assert_eq!(self.state.swap(IN_USE, Ordering::Acquire), FREE, "a handle is missing or shared");
        // SAFETY: the state was FREE, so the value is there. It is IN_USE now, so no other reference exists.
        let result = work(unsafe { (*self.value.get()).assume_init_mut() });
        self.state.store(FREE, Ordering::Release);
        result
    }
}
