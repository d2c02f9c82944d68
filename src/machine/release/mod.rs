//! Release: when moves leave the look-ahead, and the share of the feed for a slow host.
//!
//! Both files decide from times and counts alone and touch nothing; `main_loop::motion` asks them and moves the moves.
//!
//! | file | decides |
//! |---|---|
//! | [`policy`] | when motion begins, and which moves may leave then |
//! | [`feed_throttle`] | the share of the feed that the stream allows |
//!
//! | word | means |
//! |---|---|
//! | final | a move with speeds that no later move can change |
//! | dry | so little is queued that a move leaves though it is not final |
//! | underrun | a move followed one that had left dry: the host was too slow |
//! | share | the part of the commanded feed for a host that cannot keep up |
//! | gathering | the machine rests, and moves are added before the motion begins |

pub(in crate::machine) mod feed_throttle;
pub(in crate::machine) mod policy;
