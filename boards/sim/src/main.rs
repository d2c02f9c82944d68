//! The `corehbot` command.

fn main() -> std::process::ExitCode {
    corehbot_sim::cli::main()
}
