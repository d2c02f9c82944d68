//! Description: a machine as its file has it, in the table `[twin]`: the routing of its belts, and its numbers.
//!
//! A file without a routing has the one that fits the rows of its motors. Rows do not tell everything. An H-bot's
//! motors turn like a CoreXY's. Two drivers in series may turn the four motors of a CoreH-bot. A bed that moves in y
//! turns its motor as a bar does.

use crate::params::{Params, Parts, ROWS};
use crate::routing::separate_belts::Row;
use crate::routing::{Machine, Own};

/// A machine's belts and numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// The routing, if the file names one.
    pub routing: Option<Routing>,
    /// The numbers.
    pub params: Params,
}

/// By the motors' rows.
impl From<Params> for Description {
    fn from(params: Params) -> Self {
        Self { routing: None, params }
    }
}

/// A routing by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Routing {
    /// A machine with a table.
    Table(Machine),
    /// A belt for each motor, by its row.
    Straight,
    /// The same, with a bed that moves in y.
    MovingBed,
}

impl Routing {
    /// The word that leaves the routing to the motors' rows.
    pub const AUTO: &'static str = "auto";

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        Machine::ALL.into_iter().map(Self::Table).chain([Self::Straight, Self::MovingBed])
    }

    /// Its name in a file.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Table(machine) => machine.key(),
            Self::Straight => "straight",
            Self::MovingBed => "moving-bed",
        }
    }

    /// The routing of a name.
    #[must_use]
    pub fn of(key: &str) -> Option<Self> {
        Self::all().find(|routing| routing.key() == key)
    }
}

impl Description {
    /// The machine with belt motors that turn like these rows for x, y and z, each divided by its multiple. `None` if
    /// no belts do that: nothing moves x or y.
    #[must_use]
    pub fn machine(&self, rows: &[Row]) -> Option<Machine> {
        match self.routing {
            Some(Routing::Table(machine)) => Some(machine),
            Some(Routing::Straight) => Own::new(rows, false).map(Machine::Own),
            Some(Routing::MovingBed) => Own::new(rows, true).map(Machine::Own),
            None => by_rows(rows),
        }
    }
}

/// A list with a number too many or too few for a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongList {
    /// Its key.
    pub key: &'static str,
    /// Numbers in it.
    pub listed: usize,
    /// The machine.
    pub machine: Machine,
    /// How many of these parts the machine has.
    pub parts: (usize, Parts),
}

impl std::fmt::Display for WrongList {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { key, listed, machine, parts: (count, parts) } = self;
        write!(f, "twin.{key} has {listed} numbers, and the {} has {count} {parts}", machine.name())?;
        f.write_str("; one number is for all of them")
    }
}

impl std::error::Error for WrongList {}

/// Whether each list of numbers has one for every part of the machine.
///
/// # Errors
/// The first list that has not.
pub fn check_lists(machine: Machine, params: &Params) -> Result<(), WrongList> {
    for row in &ROWS {
        let Some(parts) = (row.field)(&mut params.clone()).parts() else { continue };
        let count = match parts {
            Parts::Belts => machine.belts().len(),
            Parts::Spans => machine.span_names().len(),
            Parts::Motors => machine.motors().len(),
            Parts::Axes => 2,
        };
        let listed = row.values(params).values().len();
        if listed > 1 && listed != count {
            return Err(WrongList { key: row.key, listed, machine, parts: (count, parts) });
        }
    }
    Ok(())
}

fn by_rows(rows: &[Row]) -> Option<Machine> {
    let mut sorted = rows.to_vec();
    sorted.sort_unstable();
    if sorted == [[-1, -1, 0], [-1, 1, 0], [1, -1, 0], [1, 1, 0]] {
        return Some(Machine::CoreHBot);
    }
    // Motors may turn either way.
    let mut lines: Vec<Row> = rows.iter().map(|row| (*row).max(row.map(|entry| -entry))).collect();
    lines.sort_unstable();
    match lines[..] {
        [[1, -1, 0], [1, 1, 0]] => Some(Machine::CoreXy),
        [[1, -1, 0], [1, -1, 0], [1, 1, 0], [1, 1, 0]] => Some(Machine::AwdCoreXy),
        [[1, -1, -1], [1, -1, 1], [1, 1, -1], [1, 1, 1]] => Some(Machine::CoreXyz),
        // Carlyle's A, B and C.
        [[1, -1, 1], [1, 1, -1], [1, 1, 1]] => Some(Machine::CoreXyzThree),
        _ => Own::new(rows, false).filter(|_| !rows.is_empty()).map(Machine::Own),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_name_the_machine_and_a_file_names_what_rows_do_not() {
        let auto = Description::default();
        let of = |rows: &[Row]| auto.machine(rows).unwrap().key();
        assert_eq!(of(&[[-1, 1, 0], [-1, -1, 0], [1, -1, 0], [1, 1, 0]]), "corehbot");
        // One turned round: the four cannot be one closed belt.
        assert_eq!(of(&[[-1, 1, 0], [-1, -1, 0], [1, -1, 0], [-1, -1, 0]]), "awd-corexy");
        assert_eq!(of(&[[1, 1, 0], [-1, 1, 0]]), "corexy");
        assert_eq!(of(&[[1, 1, 1], [1, -1, 1], [-1, -1, 1], [-1, 1, 1]]), "corexyz");
        assert_eq!(of(&[[1, 1, 1], [1, -1, 1], [-1, -1, 1]]), "corexyz-three");
        assert_eq!(of(&[[1, 0, 0], [0, 1, 0], [0, 1, 0]]), "straight");
        assert_eq!(of(&[[1, 0, 1], [1, 0, -1], [0, 1, 0]]), "moving-bed");
        assert_eq!(auto.machine(&[]), None);
        let named = |key: &str| Description { routing: Routing::of(key), ..Description::default() };
        assert_eq!(named("hbot").machine(&[[1, 1, 0], [1, -1, 0]]), Some(Machine::HBot));
        assert_eq!(named("moving-bed").machine(&[[1, 0, 0], [0, 1, 0]]).unwrap().key(), "moving-bed");
        assert!(Routing::all().all(|routing| Routing::of(routing.key()) == Some(routing)));
    }
}
