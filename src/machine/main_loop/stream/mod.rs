//! The stream of moves: into the look-ahead, and out of it at the right time.
//!
//! ```text
//!   command ── plan ──▶ look-ahead ── hand_on ──▶ move queue ──▶ step generator
//!                        waiting        ▲          queued
//!                                       └── release: what may leave now, how much of the feed
//! ```
//!
//! A command that moves calls `plan` (in [`plan`]), one that needs the machine at rest `finish` (in [`rest`]), and
//! every turn `feed_motion` (in [`hand_on`]).
//!
//! | word | means |
//! |---|---|
//! | waiting | moves in the look-ahead; their speeds may still change |
//! | queued | moves that have left it and are not stepped yet |
//! | final, dry, underrun, share, gathering | see `release` |

mod hand_on;
mod plan;
mod rest;
