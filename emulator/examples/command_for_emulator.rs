//! The `corehbot` command, for tests in which it is a host of the image. A test cannot name a program of another
//! package, but it can name an example. An example is built with the tests, and not with the emulator. All examples lie
//! in one folder, so its name says for whom it is.

use std::process::ExitCode;

fn main() -> ExitCode {
    corehbot_cli::cli::main()
}
