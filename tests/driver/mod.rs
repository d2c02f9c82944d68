//! The drivers' room against a bus that answers as a test wants.

mod bench;
mod changes;
mod proof;
mod spi;
mod watch;
