//! Problems: all errors and warnings of a machine file.

use super::reader::Given;
use super::{Machine, MachineFileError, Place, together, unreached, unwise};
use std::fmt::{self, Display};
use toml::de::DeTable;

/// Something in a machine file that should be otherwise.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Problem {
    /// Where in the file, if it is at one place.
    pub place: Option<Place>,
    /// The file is not a machine with this problem, or commands refuse a place that it names. Otherwise it is a
    /// warning.
    pub is_error: bool,
    /// The problem in words.
    pub text: String,
}

impl Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_error { "error" } else { "warning" };
        match self.place {
            Some(place) => write!(f, "{place}: {kind}: {}", self.text),
            None => write!(f, "{kind}: {}", self.text),
        }
    }
}

/// The machine of a file, if it is one, and every problem, from top to bottom. Problems of several keys are checked
/// when each key is legal.
#[must_use]
pub fn problems(text: &str) -> (Option<Machine>, Vec<Problem>) {
    let (machine, mut found) = search(text);
    found.sort_by_key(|problem| problem.place.map(|place| (place.line, place.column)));
    (machine, found)
}

fn search(text: &str) -> (Option<Machine>, Vec<Problem>) {
    let (_, wrong) = DeTable::parse_recoverable(text);
    if !wrong.is_empty() {
        return (None, wrong.into_iter().map(|error| problem(text, &MachineFileError::Syntax(error))).collect());
    }
    let given = match Given::read(text) {
        Ok(given) if given.errors.is_empty() => given,
        Ok(given) => return (None, given.errors.iter().map(|error| problem(text, error)).collect()),
        Err(error) => return (None, vec![problem(text, &error)]),
    };
    let has_screws = given.has("screws");
    match together(given) {
        Ok(machine) => {
            let said = |is_error: bool| {
                move |(key, said): (String, String)| Problem { place: Place::of_key(text, &key), is_error, text: said }
            };
            let unreached = unreached::places(&machine.settings, has_screws).into_iter().map(said(true));
            let unwise = unwise::warnings(&machine).into_iter().map(said(false));
            let found = unreached.chain(unwise).collect();
            (Some(machine), found)
        }
        Err(error) => (None, vec![problem(text, &error)]),
    }
}

fn problem(text: &str, error: &MachineFileError) -> Problem {
    Problem { place: error.place(text), is_error: true, text: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> Vec<String> {
        problems(text).1.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn every_wrong_key_is_told_at_its_place() {
        let text = "keepalive_s = 99\ncolour = 1\n[axis.x]\nlength = 5\n[axes.x]\n max_sped = 5\n length = 0\n\
                    [motors]\nm1 = \"M 0\"\n[mechanism]\nm1 = [2, 1, 0]\n";
        let said = said(text);
        let starts: Vec<_> = said.iter().map(|line| line.split(' ').next().unwrap()).collect();
        assert_eq!(starts.len(), 7, "{said:?}");
        for place in ["1:15:", "2:1:", "3:2:", "6:2:", "7:11:", "9:6:", "11:6:"] {
            assert!(starts.contains(&place), "{place} in {said:?}");
        }
        assert!(said.contains(&"7:11: error: axes.x.length = 0 is outside 1 to 5000".to_owned()), "{said:?}");
        assert!(said.iter().any(|line| line.ends_with("did you mean `max_speed`?")));
    }

    #[test]
    fn what_follows_from_another_error_is_not_told() {
        // Without its resolution y would differ from x.
        let text = "[axes]\nx = { steps_per_mm = 100 }\ny = { steps_per_mm = 100, length = 0 }";
        assert_eq!(said(text), ["3:36: error: axes.y.length = 0 is outside 1 to 5000"]);
        let text = "[axes.x]\nsteps_per_mm = 100\n";
        assert_eq!(said(text), ["1:2: error: x and y share motors: their steps_per_mm must be equal"]);
    }

    /// Reproducer: a gantry with drivers of two kinds had no errors.
    #[test]
    fn motors_of_an_axis_with_other_microsteps_are_an_error_at_their_key() {
        let gantry = "[mechanism]\nm11 = [1, 1, 0]\nm4 = [1, -1, 0]\nm1 = [1, 1, 1]\nm8 = [0, 0, 1]\nz1 = [0, 0, 1]\n\
                      z2 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n[drivers.z]\ncurrent_ma = 800\nmicrosteps = 32\n\
                      [axes.z]\nsteps_per_mm = 80\n";
        let text = "11:14: error: motors m1 and m8 move the same axis with 16 and 32 microsteps, so one moves further than \
                    the other: set drivers.belt.microsteps and drivers.z.microsteps alike";
        assert_eq!(said(gantry), [text]);
        assert_eq!(said(&format!("{gantry}[drivers.belt]\nmicrosteps = 32\n")), [""; 0]);
        // Screws alone have the drivers of z, whatever they are called.
        assert_eq!(said(&gantry.replace("m1 = [1, 1, 1]", "m1 = [0, 0, 1]")), [""; 0]);
        let unequal = include_str!("../../examples/machines/core-unequal.toml");
        assert_eq!(said(unequal), [""; 0]);
    }

    #[test]
    fn what_is_no_toml_is_told() {
        let said = said("keepalive_s = \n[axes.x]\nlength = 1 2\n");
        assert!(said.len() == 2 && said[0].starts_with("1:15: error: "), "{said:?}");
        assert!(said[1].starts_with("3:"), "{said:?}");
    }

    #[test]
    fn a_row_over_two_lines_ends_the_search() {
        assert_eq!(said("[mechanism]\nm1 = [2,\n 0, 0]\nm4 = [3, 0, 0]").len(), 1);
    }

    #[test]
    fn a_machine_without_a_fault_is_one() {
        let (machine, found) = problems("board = \"octopus\"\n[heaters.hotend]\nis_fitted = true");
        assert!(machine.is_some() && found.is_empty(), "{found:?}");
    }
}
