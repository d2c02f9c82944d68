//! The `corehbot-emulator` command.

fn main() -> std::process::ExitCode {
    corehbot_emulator::cli::main()
}
