//! Examples in the help of every command, by the words that call it.

use clap::Command;

/// The words of each command, and what to type for frequent wishes.
pub type Examples = [(&'static str, &'static [&'static str])];

/// The lines of a command's examples.
#[must_use]
pub fn of(examples: &Examples, words: &str) -> Option<&'static [&'static str]> {
    examples.iter().find(|(known, _)| *known == words).map(|(_, lines)| *lines)
}

/// The command with examples in its help and in the help of all commands within it.
#[must_use]
pub fn with_examples(command: Command, examples: &Examples, words: &str) -> Command {
    let within: Vec<_> = command.get_subcommands().map(|within| within.get_name().to_owned()).collect();
    let command = within.iter().fold(command, |command, name| {
        let words = if words.is_empty() { name.clone() } else { format!("{words} {name}") };
        command.mut_subcommand(name, |within| with_examples(within, examples, &words))
    });
    match of(examples, words) {
        Some(lines) => command.after_help(format!("Examples:\n  {}", lines.join("\n  "))),
        None => command,
    }
}

/// What is wrong with the examples of a program: a command without any, or an example that it does not take.
#[must_use]
pub fn faults(command: &Command, examples: &Examples) -> Vec<String> {
    let (mut found, mut faults) = (Vec::new(), Vec::new());
    all(command, "", &mut found);
    let program = command.get_name();
    for words in &found {
        let Some(lines) = of(examples, words) else {
            faults.push(format!("`{program} {words}` has no example"));
            continue;
        };
        for line in lines {
            let typed = line.split(" > ").next().unwrap_or_default();
            if !line.starts_with(&format!("{program} {words}")) {
                faults.push(format!("`{line}` is no example of `{words}`"));
            }
            if let Err(error) = command.clone().try_get_matches_from(typed.split(' ')) {
                faults.push(format!("{line}: {error}"));
            }
        }
    }
    if found.len() != examples.len() {
        faults.push(format!("{} examples of {} commands", examples.len(), found.len()));
    }
    faults
}

/// The words of a command and of all within it.
fn all(command: &Command, words: &str, found: &mut Vec<String>) {
    found.push(words.to_owned());
    for within in command.get_subcommands().filter(|within| within.get_name() != "help") {
        all(within, format!("{words} {}", within.get_name()).trim_start(), found);
    }
}
