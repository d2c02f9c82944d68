//! A machine as a machine file, which [`parse`](super::parse) reads back to the bit.

use crate::keys::{ALL, Of, named};
use crate::value::toml;
use corehbot::kinematics::multiple;
use corehbot::motors::Motor;
use corehbot::settings::Settings;
use corehbot::settings::rows::{Field, Key, Value, Visitor};
use std::collections::BTreeMap;
use toml::{Table, Value as Toml};

/// The text of a machine file, with every key.
///
/// # Errors
/// If the text cannot be made, which no value of [`Settings`] brings about.
pub fn written(machine: &Settings) -> anyhow::Result<String> {
    Ok(toml::to_string(&table(machine))?)
}

/// Every setting by its key, in the tables of a machine file, as JSON.
#[must_use]
pub fn keyed(machine: &Settings) -> serde_json::Value {
    serde_json::to_value(table(machine)).unwrap_or_default()
}

/// The keys and values of a machine file.
pub(crate) fn table(machine: &Settings) -> Table {
    let values = values(machine);
    let value = |id: u16, part: usize| values.get(&(id, part));
    let mut file = Table::new();
    for known in ALL.iter() {
        let Some(path) = named(&known.path, &machine.motor_names) else { continue };
        let found = match known.of {
            Of::Setting { row, text, part } => value(row.id, part).and_then(|value| toml(value, text.kind)),
            Of::List { row, text } => {
                let values = (0..row.tables.len()).map_while(|part| value(row.id, part));
                // Values from the first unknown one on are left out.
                let known = values.take_while(|value| !is_unknown(&known.path, value));
                Some(Toml::Array(known.filter_map(|value| toml(value, text.kind)).collect()))
            }
            Of::Other(_) | Of::Twin(_) | Of::Routing => None,
        };
        if let Some(found) = found {
            put(&mut file, &path, found);
        }
    }
    // Motors that are not listed are not fitted.
    if let Some(Toml::Table(rows)) = file.get_mut("mechanism") {
        for (motor, row) in Motor::ALL.into_iter().zip(machine.mechanism.rows) {
            if multiple(row) == 0 {
                rows.remove(machine.name_of(motor).as_str());
            }
        }
    }
    file
}

/// Whether a value of a list means "none".
fn is_unknown(path: &str, value: &Value) -> bool {
    match value {
        Value::Number(number) => path == "belt.phases" && *number == i64::from(corehbot::settings::Belt::NO_PHASE),
        Value::Text(name) => path == "motors.names" && name.is_empty(),
        Value::Absent => false,
    }
}

/// Puts a value at a path.
fn put(file: &mut Table, path: &str, value: Toml) {
    match path.split_once('.') {
        None => drop(file.insert(path.to_owned(), value)),
        Some((table, inner)) => {
            let table = file.entry(table).or_insert_with(|| Toml::Table(Table::new()));
            if let Toml::Table(table) = table {
                put(table, inner, value);
            }
        }
    }
}

/// All values, by the ids of their rows and by parts.
pub(crate) fn values(machine: &Settings) -> BTreeMap<(u16, usize), Value> {
    struct All(BTreeMap<(u16, usize), Value>);
    impl Visitor for All {
        fn visit(&mut self, key: Key, field: &mut dyn Field) {
            self.0.insert((key.row.id, key.part.into()), field.get());
        }
    }
    let mut all = All(BTreeMap::new());
    machine.clone().visit(&mut all);
    all.0
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;
    use corehbot::settings::{CornerRule, ShaperKind, Thermistor};
    use corehbot::units::{Mm, Ratio, StepsPerMm};

    fn is_read_back(machine: &Settings) {
        let text = written(machine).unwrap();
        let read = parse(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!((read.name.as_deref(), &read.settings), (Some(machine.name.as_str()), machine), "{text}");
    }

    #[test]
    fn every_example_is_read_back_to_the_bit() {
        let examples = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines");
        let files = std::fs::read_dir(examples).unwrap().map(|file| file.unwrap().path());
        let files: Vec<_> = files.filter(|file| file.extension().is_some_and(|end| end == "toml")).collect();
        assert!(files.len() >= 9);
        files.iter().for_each(|file| is_read_back(&super::super::read(file).unwrap().settings));
    }

    #[test]
    fn values_that_no_short_number_makes_are_read_back_too() {
        let mut machine = Settings::prototype();
        machine.axes.e.steps_per_mm += StepsPerMm::DELTA;
        machine.axes.z.length -= Mm::DELTA;
        machine.arc_tolerance += Mm::DELTA;
        machine.minimum_cruise_ratio -= Ratio::DELTA;
        machine.thermal.filament += corehbot::units::WattsPerKelvin::DELTA;
        machine.advance.window = Some(corehbot::units::Seconds::lit("0.04") + corehbot::units::Seconds::DELTA);
        machine.wiring.motors[1].is_reversed = true;
        machine.wiring.endstops.y.is_normally_open = true;
        machine.thermal.heaters.bed.thermistor = Thermistor::Beta { ohms: 98_760, beta: 4321, cubic: 123 };
        machine.corner = CornerRule::SquareCorner(corehbot::units::MmPerSec::lit("5.25"));
        machine.check_machine().unwrap();
        is_read_back(&machine);
        for kind in ShaperKind::all() {
            machine.shapers.x.kind = kind;
            is_read_back(&machine);
        }
        for kind in Thermistor::all() {
            machine.thermal.heaters.hotend.thermistor = kind;
            is_read_back(&machine);
        }
    }
}
