//! The `corehbot` command.

fn main() -> std::process::ExitCode {
    corehbot_cli::cli::main()
}
