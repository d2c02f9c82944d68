//! Templates: a new machine file is the prototype's, which has and explains every key. The values come from an example
//! of that kind of machine, and the connectors from the board.

use anyhow::{Context as _, Result};
use corehbot::connectors::{BoardConnectors, ConnectorName};
use corehbot::motors::MotorName;
use corehbot::settings::Wiring;
use toml::{Table, Value};

/// The file that shows every key.
const PROTOTYPE: &str = include_str!("../../examples/machines/prototype.toml");

/// The kinds of machines that there is an example of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// One closed belt, four motors: the prototype.
    Corehbot,
    /// The same with two drivers, two motors on each.
    CorehbotTwoDrivers,
    /// The same with a third screw.
    CorehbotThreeScrews,
    /// Two belts that cross, two motors.
    Corexy,
    /// A CoreXY with four motors.
    AwdCorexy,
    /// One belt around an H, two motors.
    Hbot,
    /// The head moves in X and Z on two motors, the bed in Y.
    Corexz,
    /// Every axis is moved by all of four motors.
    Corexyz,
    /// Every axis is moved by all of three motors.
    CorexyzThree,
    /// A motor each for X and Y, and two screws that lift the bed.
    Cartesian,
    /// The head moves in X and Z, the bed in Y, a motor each.
    CartesianXz,
    /// A portal with a motor on each side.
    DualY,
    /// A CoreXY with pulleys of two sizes.
    CoreUnequal,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Corehbot,
        Self::CorehbotTwoDrivers,
        Self::CorehbotThreeScrews,
        Self::Corexy,
        Self::AwdCorexy,
        Self::Hbot,
        Self::Corexz,
        Self::Corexyz,
        Self::CorexyzThree,
        Self::Cartesian,
        Self::CartesianXz,
        Self::DualY,
        Self::CoreUnequal,
    ];

    /// Its name, which is its example's, except for the prototype.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corehbot => "corehbot",
            Self::CorehbotTwoDrivers => "corehbot-two-drivers",
            Self::CorehbotThreeScrews => "corehbot-three-screws",
            Self::Corexy => "corexy",
            Self::AwdCorexy => "awd-corexy",
            Self::Hbot => "hbot",
            Self::Corexz => "corexz",
            Self::Corexyz => "corexyz",
            Self::CorexyzThree => "corexyz-three",
            Self::Cartesian => "cartesian",
            Self::CartesianXz => "cartesian-xz",
            Self::DualY => "dual-y",
            Self::CoreUnequal => "core-unequal",
        }
    }

    /// Its example.
    const fn example(self) -> &'static str {
        match self {
            Self::Corehbot => PROTOTYPE,
            Self::CorehbotTwoDrivers => include_str!("../../examples/machines/corehbot-two-drivers.toml"),
            Self::CorehbotThreeScrews => include_str!("../../examples/machines/corehbot-three-screws.toml"),
            Self::Corexy => include_str!("../../examples/machines/corexy.toml"),
            Self::AwdCorexy => include_str!("../../examples/machines/awd-corexy.toml"),
            Self::Hbot => include_str!("../../examples/machines/hbot.toml"),
            Self::Corexz => include_str!("../../examples/machines/corexz.toml"),
            Self::Corexyz => include_str!("../../examples/machines/corexyz.toml"),
            Self::CorexyzThree => include_str!("../../examples/machines/corexyz-three.toml"),
            Self::Cartesian => include_str!("../../examples/machines/cartesian.toml"),
            Self::CartesianXz => include_str!("../../examples/machines/cartesian-xz.toml"),
            Self::DualY => include_str!("../../examples/machines/dual-y.toml"),
            Self::CoreUnequal => include_str!("../../examples/machines/core-unequal.toml"),
        }
    }
}

/// The text of a new machine file.
///
/// # Errors
/// An example is not a machine file, or has a key that the prototype lacks: tests make sure that this does not happen.
pub fn file(kind: Kind, board: &BoardConnectors, has_heaters: bool) -> Result<String> {
    let example: Table = kind.example().parse()?;
    let mut text = Text(PROTOTYPE.lines().skip_while(|line| !line.is_empty()).map(str::to_owned).collect());
    for (key, value) in &example {
        match value {
            // Motors are listed below.
            Value::Table(_) if ["mechanism", "motors"].contains(&key.as_str()) => {}
            Value::Table(table) => text.set_table(key, table)?,
            _ => text.set("", key, value)?,
        }
    }
    if !example.contains_key("belt") {
        text.set("belt", "closed", &false.into())?;
    }
    if example.contains_key("mechanism") && !example.contains_key("screws") {
        // Its screws are nowhere until someone has measured them.
        text.remove_tables("screws.1", "screws.4");
    }
    if !example.contains_key("bed") {
        // The bed is the tool's reach.
        for (side, axis) in [("width", "x"), ("depth", "y")] {
            let axis = example.get("axes").and_then(|axes| axes.get(axis));
            if let Some(length) = axis.and_then(|axis| axis.get("length")) {
                text.set("bed", side, length)?;
            }
        }
    }
    for (header, comment) in comments(kind.example()) {
        text.set_comment(header, &comment);
    }
    if has_heaters {
        for heater in ["heaters.hotend", "heaters.bed"] {
            text.set(heater, "is_fitted", &true.into())?;
        }
    }
    text.set("", "board", &board.key.into())?;
    let given = |table: &str, key: &str| example.get(table).and_then(|table| table.get(key));
    if let Some(names) = given("motors", "names") {
        text.set("motors", "names", names)?;
    }
    let mut last = MotorName::NONE;
    for (motor, name) in crate::load(kind.example())?.motors() {
        if let Some(row) = given("mechanism", name.as_str()) {
            let socket = board.sockets.get(motor.index()).map_or("", ConnectorName::as_str).into();
            for (table, value) in [("mechanism", row), ("motors", &socket)] {
                text.make_room(table, name.as_str(), last.as_str());
                text.set(table, name.as_str(), value)?;
            }
            last = name;
        } else {
            text.remove("mechanism", name.as_str());
            text.remove("motors", name.as_str());
        }
    }
    let ends = Wiring::usual(board).endstops;
    for (axis, plug) in [("x", ends.x), ("y", ends.y), ("z", ends.z)] {
        text.set("endstops", axis, &plug.connector.as_str().into())?;
    }
    let head = format!(
        "#:schema ./machine.schema.json\n\
         # A machine for the {}: every key, at its default where the kind of machine asks for nothing else. Lengths are mm,\n\
         # speeds mm/s, accelerations mm/s2. `corehbot config check` checks it; `corehbot config schema` writes the schema, by\n\
         # which an editor explains the keys.\n",
        board.name,
    );
    Ok(head + &text.0.join("\n") + "\n")
}

/// The comments right above the headers of tables, except the mechanism's: its rows are explained in the prototype.
fn comments(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut comment = Vec::new();
    let mut found = Vec::new();
    for line in text.lines() {
        match line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            Some(header) if !comment.is_empty() && header != "mechanism" => {
                found.push((header, std::mem::take(&mut comment)));
            }
            _ if line.starts_with('#') => comment.push(line),
            _ => comment.clear(),
        }
    }
    found
}

/// The lines of a machine file in which each key has a line and each table a header.
struct Text(Vec<String>);

impl Text {
    /// The lines of a table, its header apart; of the root with an empty name.
    fn table(&self, name: &str) -> Option<std::ops::Range<usize>> {
        let is_header = |line: &String| line.starts_with('[');
        let header = format!("[{name}]");
        let start = if name.is_empty() { 0 } else { 1 + self.0.iter().position(|line| *line == header)? };
        let length = self.0[start..].iter().position(is_header).unwrap_or(self.0.len() - start);
        Some(start..start + length)
    }

    /// The line of a key.
    fn line(&self, table: &str, key: &str) -> Option<usize> {
        let is_key = |line: &&String| line.split_once('=').is_some_and(|(name, _)| name.trim() == key);
        let mut lines = self.table(table)?;
        lines.find(|at| self.0.get(*at).as_ref().is_some_and(is_key))
    }

    fn set(&mut self, table: &str, key: &str, value: &Value) -> Result<()> {
        let line = self.line(table, key).with_context(|| format!("prototype.toml has no {table}.{key}"))?;
        self.0[line] = format!("{key} = {value}");
        Ok(())
    }

    fn set_table(&mut self, name: &str, table: &Table) -> Result<()> {
        for (key, value) in table {
            match value {
                Value::Table(inner) => self.set_table(&format!("{name}.{key}"), inner)?,
                _ => self.set(name, key, value)?,
            }
        }
        Ok(())
    }

    /// A line for a key that has none yet, behind the line of another key.
    fn make_room(&mut self, table: &str, key: &str, behind: &str) {
        if let (None, Some(line)) = (self.line(table, key), self.line(table, behind)) {
            self.0.insert(line + 1, format!("{key} ="));
        }
    }

    fn remove(&mut self, table: &str, key: &str) {
        if let Some(line) = self.line(table, key) {
            self.0.remove(line);
        }
    }

    /// Removes the tables from one to another, with the comment above them and the blank line below.
    fn remove_tables(&mut self, first: &str, last: &str) {
        let (Some(first), Some(last)) = (self.table(first), self.table(last)) else { return };
        let header = first.start - 1;
        let above = self.0[..header].iter().rev().take_while(|line| line.starts_with('#')).count();
        let keys = self.0[last.clone()].iter().rposition(|line| line.contains('=')).map_or(0, |at| at + 1);
        let end = (last.start + keys + 1).min(self.0.len());
        self.0.drain(header - above..end);
    }

    /// Puts another comment above the header of a table.
    fn set_comment(&mut self, table: &str, comment: &[&str]) {
        let Some(lines) = self.table(table) else { return };
        let header = lines.start - 1;
        let above = self.0[..header].iter().rev().take_while(|line| line.starts_with('#')).count();
        self.0.splice(header - above..header, comment.iter().map(|line| (*line).to_owned()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::Of;
    use crate::{Problem, load, problems};
    use corehbot::motors::{Motor, prototype};

    impl Text {
        /// Puts lines behind the last key of a table.
        fn append(&mut self, table: &str, new: [String; 2]) {
            let range = self.table(table).unwrap_or_else(|| panic!("write the header [{table}] first"));
            let end = range.start + self.0[range].iter().rposition(|line| line.contains('=')).map_or(0, |at| at + 1);
            self.0.splice(end..end, new);
        }
    }

    /// The prototype's file with the keys that it lacks, each at its default with its meaning above it, at the end of
    /// its table. The comment on the board names all of them.
    fn completed(text: &str) -> String {
        let mut lines = Text(text.lines().map(str::to_owned).collect());
        let default = crate::written::table(&corehbot::settings::Settings::prototype());
        for known in crate::keys::ALL.iter() {
            let (table, key) = known.path.rsplit_once('.').unwrap_or(("", &known.path));
            let of_twin = match known.of {
                Of::Twin(row) => {
                    let none = row.is_list().then(|| Value::Array(Vec::new()));
                    let default = row.default.map(crate::value::float_toml).or(none);
                    default.map(|default| (crate::schema::twin_meaning(row), default))
                }
                Of::Routing => Some((crate::keys::ROUTING_MEANING.to_owned(), "auto".into())),
                _ => None,
            };
            if let (Some((meaning, value)), None) = (of_twin, lines.line(table, key)) {
                lines.append(table, [format!("# {meaning}"), format!("{key} = {value}")]);
            }
            let (Of::Setting { text, .. } | Of::List { text, .. }) = known.of else { continue };
            let value = known.path.split('.').try_fold(None, |found: Option<&Value>, part| {
                found.map_or_else(|| default.get(part), |table| table.get(part)).map(Some)
            });
            let (Some(Some(value)), None) = (value, lines.line(table, key)) else { continue };
            lines.append(table, [format!("# {}", crate::schema::meaning(text)), format!("{key} = {value}")]);
        }
        let (begin, end) = ("# The board: ", ", or sim (");
        let boards: Vec<_> = corehbot_boards::entries().map(|entry| entry.board.connectors.key).collect();
        let comment = lines.0.iter_mut().find(|line| line.starts_with(begin)).unwrap();
        *comment = [begin, &boards.join(", "), end, comment.split_once(end).unwrap().1].concat();
        lines.0.join("\n") + "\n"
    }

    #[test]
    fn the_prototypes_file_has_every_key() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machines/prototype.toml");
        let whole = completed(PROTOTYPE);
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(path, &whole).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap(), whole, "BLESS=1 writes the keys and boards that it lacks");
        // One that it lacks is written at the end of its table, and read back.
        let without = PROTOTYPE.replace("limp_lift = 10\n", "");
        let again = completed(&without);
        assert!(again.contains("\nphases = []\n# How far z is raised"), "{again}");
        assert!(again.contains(" Unit: mm.\nlimp_lift = 10\n"), "{again}");
        assert_eq!(load(&again).unwrap(), load(PROTOTYPE).unwrap());
    }

    #[test]
    fn every_example_is_a_kind() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machines");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut names: Vec<_> = files
            .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
            .map(|path| path.file_stem().unwrap().to_str().unwrap().replace("prototype", "corehbot"))
            .collect();
        names.sort();
        let mut kinds: Vec<_> = Kind::ALL.iter().map(|kind| kind.name().to_owned()).collect();
        kinds.sort();
        assert_eq!(names, kinds);
    }

    #[test]
    fn a_new_file_is_the_example_plugged_into_the_board() {
        for board in corehbot_boards::all() {
            for kind in Kind::ALL {
                let text = file(kind, board, false).unwrap();
                let (machine, found) = problems(&text);
                let is_error = |problem: &Problem| problem.is_error;
                assert!(!found.iter().any(is_error), "{kind:?} on {}: {found:?}\n{text}", board.key);
                let machine = machine.unwrap();
                let mut settings = machine.settings;
                let example = load(kind.example()).unwrap();
                for motor in Motor::ALL.into_iter().filter(|motor| !settings.mechanism.fitted().has(*motor)) {
                    assert!(
                        !text.contains(&format!("\n{} = ", settings.name_of(motor))),
                        "{kind:?} has no {}",
                        settings.name_of(motor)
                    );
                }
                let mut wiring = Wiring::usual(board);
                // Motors beyond the prototype's have the next sockets.
                let sockets = wiring.motors.iter_mut().zip(board.sockets).zip(Motor::ALL).skip(prototype::COUNT);
                for ((plug, socket), _) in sockets.filter(|(_, motor)| settings.mechanism.fitted().has(*motor)) {
                    plug.connector = *socket;
                }
                assert_eq!((machine.board, settings.wiring), (Some(board), wiring));
                settings.wiring = example.wiring;
                assert_eq!(settings, example, "{kind:?} on {}", board.key);
            }
        }
    }

    #[test]
    fn a_new_file_says_what_the_example_says() {
        let text = file(Kind::Corexy, &corehbot_boards::octopus::CONNECTORS, true).unwrap();
        assert!(text.contains("\n# One screw of 8 mm lead.\n[axes.z]\n") && !text.contains("Two ball screws M12x4"));
        assert!(text.contains("\nm8 = [1, -1, 0]\n") && text.contains("\nm8 = \"M4\"\n"), "{text}");
        assert!(text.contains("name = \"CoreXY\"") && text.contains("rotation_distance"));
    }
}
