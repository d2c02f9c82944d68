//! The stream of moves: into the look-ahead, and out of it at the right time.
//!
//! ```text
//!   command ── plan ──▶ look-ahead ── release ──▶ move queue ──▶ step generator
//!                        waiting                   queued
//!                          └── feed_throttle: how much of the feed ── release_policy: what may leave now
//! ```
//!
//! The Console calls [`motion`] when a command moves, and at every turn to hand moves on. The two other files decide from
//! times alone and touch nothing.
//!
//! | word | means |
//! |---|---|
//! | waiting | moves in the look-ahead, whose speeds may still change |
//! | queued | moves that have left it and are not stepped yet |
//! | final | a move whose speeds no later move can change |
//! | dry | so little is queued that a move leaves though it is not final |
//! | underrun | a move followed one that had left dry: the host was too slow |
//! | share | the part of the commanded feed that a host which cannot keep up gets |
//! | gathering | the machine rests, and moves are added before the motion begins |

pub(in crate::machine) mod feed_throttle;
pub(in crate::machine) mod motion;
pub(in crate::machine) mod release_policy;
