//! Editing: what is wrong with a machine file, for an editor that shows it in the line.

use anyhow::{Context as _, Result};
use corehbot::connectors::Output;
use corehbot_machine_file as machine_file;
use corehbot_machine_file::template::{self, Kind};
use serde::Serialize;

#[derive(Serialize)]
struct Found {
    /// From 1; `None` if the problem is at no one place.
    line: Option<usize>,
    column: Option<usize>,
    is_error: bool,
    text: String,
}

/// All problems, from top to bottom, as JSON.
#[must_use]
pub fn problems(text: &str) -> String {
    let (_, problems) = machine_file::problems(text);
    let found = problems.into_iter().map(|problem| Found {
        line: problem.place.map(|place| place.line),
        column: problem.place.map(|place| place.column),
        is_error: problem.is_error,
        text: problem.text,
    });
    serde_json::to_string(&found.collect::<Vec<_>>()).unwrap_or_default()
}

/// Names of the boards that a new file can be for, as JSON.
#[must_use]
pub fn boards() -> String {
    let names: Vec<_> = corehbot_boards::all().map(|board| board.key).collect();
    serde_json::to_string(&names).unwrap_or_default()
}

/// A new file for a board, with heaters if it has outputs for them.
///
/// # Errors
/// No such board.
pub fn template(board: &str) -> Result<String> {
    let board = corehbot_boards::called(board).with_context(|| format!("there is no board {board}"))?;
    let has_heaters = [Output::Bed, Output::He0].into_iter().all(|output| board.outputs.has(output));
    template::file(Kind::Corehbot, board, has_heaters)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_has_its_line() {
        let found: serde_json::Value = serde_json::from_str(&problems("[axes.x]\nmax_sped = 5\n")).unwrap();
        assert_eq!((&found[0]["line"], &found[0]["is_error"]), (&2.into(), &true.into()));
        assert!(found[0]["text"].as_str().unwrap().contains("did you mean `max_speed`?"));
        assert_eq!(problems("name = \"mine\""), "[]");
    }

    #[test]
    fn a_new_file_has_no_error_for_any_board_and_heats_where_the_board_can() {
        let names: Vec<String> = serde_json::from_str(&boards()).unwrap();
        for name in &names {
            let text = template(name).unwrap();
            let (machine, problems) = machine_file::problems(&text);
            assert!(machine.is_some() && problems.iter().all(|problem| !problem.is_error), "{name}");
            assert_eq!(text.contains("is_fitted = true"), name != "nucleo", "{name}");
        }
    }
}
