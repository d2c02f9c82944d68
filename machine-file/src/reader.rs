//! Reader: from the keys of a file to settings. All that is wrong with single keys is found in one pass.

use crate::error::MachineFileError;
use crate::keys::{self, BOARD, FULL_STEPS, Of, ROTATION_DISTANCE, find, is_table, join, names_in, numbered, routings};
use crate::texts::{NamedText, TEXTS, checked};
use crate::value;
use corehbot::connectors::BoardConnectors;
use corehbot::kinematics::SCREWS;
use corehbot::motors::{MOTORS, MotorName, prototype};
use corehbot::settings::rows::{Field, Key, Value, ValueKind, Visitor};
use corehbot::settings::{Bed, Belt, Endstop, HomedAxis, MachineName, PHASES, Range, Screw, Settings, Wiring, ranges};
use corehbot::units::Mm;
use corehbot_boards as boards;
use corehbot_twin::description::{Description, Routing};
use std::collections::BTreeMap;
use toml::{Table, Value as Toml};

/// The content of a file.
#[derive(Default)]
pub(crate) struct Given {
    /// The name of the machine.
    pub name: Option<String>,
    /// The names of its motors.
    motors: [MotorName; MOTORS],
    /// The board that it names.
    pub board: Option<&'static BoardConnectors>,
    /// Values by the ids of their rows and by parts.
    values: BTreeMap<(u16, usize), Value>,
    /// Numbers that no setting has: by their keys.
    pub numbers: BTreeMap<String, f64>,
    /// The machine for the belt's twin.
    pub twin: Description,
    /// The owner's texts.
    pub texts: Vec<NamedText>,
    /// Every key that was given.
    paths: Vec<String>,
    /// Errors, key by key.
    pub errors: Vec<MachineFileError>,
}

impl Given {
    /// Reads a file. Errors in single keys are in `errors`.
    ///
    /// # Errors
    /// If it is not TOML.
    pub fn read(text: &str) -> Result<Self, MachineFileError> {
        let file: Table = toml::from_str(text).map_err(MachineFileError::Syntax)?;
        let mut given = Self { motors: motor_names(&file), ..Self::default() };
        given.table(&file, "");
        given.name = file.get("name").and_then(Toml::as_str).map(str::to_owned);
        Ok(given)
    }

    /// Whether the file has this key, or one in the table of this name.
    pub fn has(&self, path: &str) -> bool {
        self.paths.iter().any(|given| given.strip_prefix(path).is_some_and(|r| r.is_empty() || r.starts_with('.')))
    }

    fn table(&mut self, table: &Table, path: &str) {
        for (name, toml) in table {
            let inner = join(path, name);
            if inner == TEXTS {
                self.paths.push(inner);
                self.texts(toml);
                continue;
            }
            match (find(&numbered(&inner, &self.motors)), toml) {
                (Some(known), _) => {
                    self.paths.push(inner.clone());
                    let read = self.key(&inner, known.of, toml);
                    self.errors.extend(read.err());
                }
                (None, Toml::Table(table)) if is_table(&numbered(&inner, &self.motors)) => {
                    // An empty table says something too: a mechanism without motors.
                    self.paths.push(inner.clone());
                    self.table(table, &inner);
                }
                (None, other) if is_table(&numbered(&inner, &self.motors)) => {
                    self.errors.push(MachineFileError::kind(&inner, "a table of keys", other));
                }
                (None, _) => self.errors.push(MachineFileError::Unknown {
                    what: "field",
                    key: inner,
                    name: name.clone(),
                    known: names_in(path, &self.motors),
                }),
            }
        }
    }

    /// The table of the owner's texts.
    fn texts(&mut self, toml: &Toml) {
        let Toml::Table(table) = toml else {
            return self.errors.push(MachineFileError::kind(TEXTS, "a table of texts", toml));
        };
        let mut given = Vec::new();
        for (name, toml) in table {
            match toml {
                Toml::String(text) => given.push((name.clone(), text.clone())),
                other => self.errors.push(MachineFileError::kind(&join(TEXTS, name), "lines in quotes", other)),
            }
        }
        let (texts, errors) = checked(&given);
        self.texts = texts;
        self.errors.extend(errors.into_iter().map(MachineFileError::Text));
    }

    fn key(&mut self, path: &str, of: Of, toml: &Toml) -> Result<(), MachineFileError> {
        match of {
            Of::Setting { row, text, part } => {
                // Where a switch may sit depends on its end and on the length of its axis.
                let value = value::value(path, toml, text.kind, row.legal(part))?;
                self.values.insert((row.id, part), value);
            }
            Of::List { row, text } => {
                let Toml::Array(items) = toml else {
                    return Err(MachineFileError::kind(path, "a list", toml));
                };
                if let ValueKind::Choice(_) = text.kind
                    && items.len() != row.tables.len()
                {
                    return Err(MachineFileError::Length { key: path.to_owned(), wanted: row.tables.len() });
                }
                if items.len() > row.tables.len() {
                    return Err(MachineFileError::TooLong { key: path.to_owned(), most: row.tables.len() });
                }
                for (part, item) in items.iter().enumerate() {
                    let value = value::value(path, item, text.kind, row.legal(part))?;
                    self.values.insert((row.id, part), value);
                }
            }
            Of::Other(other) if other.name == BOARD => {
                let Toml::String(word) = toml else {
                    return Err(MachineFileError::kind(path, "a name in quotes", toml));
                };
                let keys: Vec<_> = boards::all().map(|board| board.key).collect();
                self.board = boards::all().nth(value::choice(path, word, &keys)?);
            }
            Of::Other(other) if other.name == FULL_STEPS => {
                let legal = value::FULL_STEPS.spec().legal;
                let number = value::number(path, toml, ValueKind::Whole, legal)?;
                self.numbers.insert(path.to_owned(), number as f64);
            }
            Of::Twin(row) => {
                let values = value::each(path, toml, row)?;
                (row.field)(&mut self.twin.params).set(values);
            }
            Of::Routing => {
                let Toml::String(word) = toml else {
                    return Err(MachineFileError::kind(path, "a name in quotes", toml));
                };
                value::choice(path, word, &routings())?;
                self.twin.routing = Routing::of(word);
            }
            Of::Other(_) => {
                self.numbers.insert(path.to_owned(), value::float(path, toml)?);
            }
        }
        Ok(())
    }

    /// Applies the file to the prototype.
    ///
    /// # Errors
    /// Keys that do not go together.
    pub fn settings(&self) -> Result<Settings, MachineFileError> {
        let mut s = Settings::prototype();
        s.wiring = self.board.map_or(s.wiring, Wiring::usual);
        if self.has("mechanism") {
            // Motors that it does not list are not fitted. Rows do not show one belt from two, and the name is another.
            s.mechanism.rows = Default::default();
            s.belt.is_closed = false;
            // Its screws are where it says, or nowhere.
            s.screws = [Screw::UNKNOWN; SCREWS];
            s.name = MachineName::NONE;
        }
        if self.has("belt.phases") {
            s.belt.phases = [Belt::NO_PHASE; PHASES];
        }
        if self.has("motors.names") {
            s.motor_names = [MotorName::NONE; MOTORS];
        }
        if self.has("corner.junction_deviation") && self.has("corner.square_corner") {
            return Err(MachineFileError::Corner);
        }
        let has_position = ["x", "y", "z"].map(|axis| self.has(&format!("homing.{axis}.position")));
        s.visit(&mut Put(&self.values));
        // By default the bed equals the tool's reach, and a switch sits at the end of its axis.
        let bed = s.bed;
        s.bed = Bed { z_offset: bed.z_offset, ..Bed::of_reach(s.reach(HomedAxis::X), s.reach(HomedAxis::Y)) };
        for (key, place, given) in [
            ("bed.width", &mut s.bed.width, bed.width),
            ("bed.depth", &mut s.bed.depth, bed.depth),
            ("bed.left", &mut s.bed.left, bed.left),
            ("bed.front", &mut s.bed.front, bed.front),
        ] {
            if self.has(key) {
                *place = given;
            }
        }
        let reaches = HomedAxis::ALL.map(|axis| s.reach(axis));
        let ends = &mut s.endstops;
        for (((axis, endstop), reach), has_position) in
            [("x", &mut ends.x), ("y", &mut ends.y), ("z", &mut ends.z)].into_iter().zip(reaches).zip(has_position)
        {
            endstop_of(axis, endstop, reach, has_position)?;
        }
        Ok(s)
    }

    /// A number of an axis that no setting has.
    pub fn number(&self, axis: &str, name: &'static str) -> Option<f64> {
        debug_assert!([ROTATION_DISTANCE, FULL_STEPS].contains(&name));
        self.numbers.get(&format!("axes.{axis}.{name}")).copied()
    }
}

/// Puts an endstop without a position at its end of the axis, and checks the position of another one, and the axis.
fn endstop_of(axis: &str, e: &mut Endstop, reach: Range<Mm>, has_position: bool) -> Result<(), MachineFileError> {
    let Range { least, most } = reach;
    if most > ranges::PLACE.most {
        let (key, length) = (format!("axes.{axis}.length"), most - least);
        let value = keys::shortest(length.to_bits(), Mm::FRAC_NBITS);
        let legal = format!("1 to {}, as the axis begins at {least}", ranges::PLACE.most - least);
        return Err(MachineFileError::Range { key, value, legal });
    }
    if !has_position {
        e.position = e.end.of(reach);
        return Ok(());
    }
    let legal = e.end.positions(reach);
    if legal.holds(e.position) {
        return Ok(());
    }
    let (key, value) = (format!("homing.{axis}.position"), keys::shortest(e.position.to_bits(), Mm::FRAC_NBITS));
    Err(MachineFileError::Range { key, value, legal: format!("{} to {}", legal.least, legal.most) })
}

/// The names that a file gives its motors; the prototype's if it gives none.
fn motor_names(file: &Table) -> [MotorName; MOTORS] {
    let Some(listed) = file.get("motors").and_then(|motors| motors.get("names")).and_then(Toml::as_array) else {
        return prototype::NAMES;
    };
    let mut names = [MotorName::NONE; MOTORS];
    for (name, item) in names.iter_mut().zip(listed) {
        // A wrong name is an error of its own.
        *name = item.as_str().and_then(MotorName::new).unwrap_or(MotorName::NONE);
    }
    names
}

/// Puts values into the settings.
struct Put<'g>(&'g BTreeMap<(u16, usize), Value>);

impl Visitor for Put<'_> {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        if let Some(value) = self.0.get(&(key.row.id, key.part.into())) {
            // It was checked when it was read.
            let _ = field.set(value);
        }
    }
}
