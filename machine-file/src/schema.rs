//! The schema of machine files, for editors. Keys with their units, kinds, ranges and meanings come from the rows of
//! all settings. Defaults come from the prototype.

use crate::keys::{
    ALL, BOARD, FULL_STEPS, OF_MOTOR, Of, Other, ROUTING_MEANING, about, fraction, named, names_of, routings, shortest,
};
use crate::texts::TEXTS;
use crate::thermistor;
use crate::value;
use crate::written;
use corehbot::motors::prototype;
use corehbot::settings::rows::{Legal, Text, ValueKind};
use corehbot::settings::{SHEETS, Settings, ranges};
use corehbot_twin::description::Routing;
use corehbot_twin::params::{MOST_PARTS, Range, Row as TwinRow};
use serde_json::{Map, Value, json};

/// The schema, as JSON Schema draft 7: editors for TOML know no newer one (Taplo).
#[must_use]
pub fn schema() -> Value {
    let defaults = serde_json::to_value(written::table(&Settings::prototype())).unwrap_or_default();
    let mut root = table("");
    for known in ALL.iter() {
        let mut schema = match known.of {
            Of::Setting { row, text, part } => described(text, of_kind(text.kind, row.legal(part))),
            Of::List { row, text } => {
                let item = of_kind(text.kind, row.legal(0));
                let least = if matches!(text.kind, ValueKind::Choice(_)) { row.tables.len() } else { 0 };
                let list = json!({ "type": "array", "items": item, "minItems": least, "maxItems": row.tables.len() });
                described(text, list)
            }
            Of::Other(other) => of_other(other),
            Of::Twin(row) => of_twin(row),
            Of::Routing => {
                json!({ "type": "string", "enum": routings(), "default": Routing::AUTO, "description": ROUTING_MEANING })
            }
        };
        // A motor that a file with a mechanism leaves out is not fitted, so its row has no default.
        if !known.path.starts_with("mechanism.")
            && let Some(default) = named(&known.path, &prototype::NAMES)
                .unwrap_or_default()
                .split('.')
                .try_fold(&defaults, |table, key| table.get(key))
        {
            insert(&mut schema, "default", default.clone());
        }
        match known.path.split_once(".#0") {
            Some((name, "")) => of_any_motor(&mut root, name, &schema),
            Some((name, key)) => of_any_driver(&mut root, name, key, &schema),
            None => {}
        }
        let is_of_driver = known.path.starts_with("drivers.#");
        if let Some(path) = named(&known.path, &prototype::NAMES).filter(|_| !is_of_driver) {
            put(&mut root, &path, "", schema);
        }
    }
    let mut texts = table(TEXTS);
    insert(&mut texts, "patternProperties", json!({ r"^[A-Z_][A-Z0-9_]{0,23}$": { "type": "string" } }));
    if let Some(tables) = root.get_mut("properties").and_then(Value::as_object_mut) {
        tables.insert(TEXTS.to_owned(), texts);
    }
    insert(&mut root, "$schema", json!("http://json-schema.org/draft-07/schema#"));
    insert(&mut root, "title", json!("Machine file of CoreH-bot firmware"));
    root
}

fn insert(schema: &mut Value, key: &str, value: Value) {
    if let Some(schema) = schema.as_object_mut() {
        schema.insert(key.to_owned(), value);
    }
}

/// A table without keys.
fn table(path: &str) -> Value {
    let mut table = json!({ "type": "object", "additionalProperties": false, "properties": {} });
    if let Some(about) = about(path) {
        insert(&mut table, "description", json!(about));
    }
    table
}

/// Puts the schema of a key into its tables.
fn put(schema: &mut Value, path: &str, above: &str, key: Value) {
    let Some(keys) = schema.get_mut("properties").and_then(Value::as_object_mut) else { return };
    match path.split_once('.') {
        None => drop(keys.insert(path.to_owned(), key)),
        Some((name, inner)) => {
            let above = crate::keys::join(above, name);
            put(keys.entry(name).or_insert_with(|| table(&above)), inner, &above, key);
        }
    }
}

/// Motors may have other names than the prototype's.
fn of_any_motor(root: &mut Value, name: &str, schema: &Value) {
    let mut schema = schema.clone();
    if let Some(keys) = schema.as_object_mut() {
        keys.remove("default");
    }
    if let Some(tables) = root.get_mut("properties").and_then(Value::as_object_mut) {
        let motors = tables.entry(name).or_insert_with(|| table(name));
        insert(motors, "patternProperties", json!({ MOTOR_NAME: schema }));
    }
}

/// The same of tables. Groups of drivers have other keys, so these are the tables that have no properties of their own.
fn of_any_driver(root: &mut Value, name: &str, key: &str, schema: &Value) {
    let Some(tables) = root.get_mut("properties").and_then(Value::as_object_mut) else { return };
    let drivers = tables.entry(name).or_insert_with(|| table(name));
    if drivers["additionalProperties"] == false {
        insert(drivers, "additionalProperties", table(OF_MOTOR));
    }
    put(&mut drivers["additionalProperties"], key.trim_start_matches('.'), OF_MOTOR, schema.clone());
}

/// The pattern of motors' names.
const MOTOR_NAME: &str = "^[A-Za-z0-9]{1,4}$";

/// The meaning of a setting in one line, with its unit.
pub(crate) fn meaning(text: &Text) -> String {
    let meaning = text.meaning.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    match text.unit {
        "" => meaning,
        unit => format!("{meaning} Unit: {unit}."),
    }
}

fn described(text: &Text, mut schema: Value) -> Value {
    let mut meaning = meaning(text);
    if !meaning.ends_with('.') {
        meaning.push('.');
    }
    insert(&mut schema, "description", json!(meaning));
    schema
}

fn of_kind(kind: ValueKind, legal: Legal) -> Value {
    match kind {
        ValueKind::Fixed(_) => number("number", kind, legal),
        ValueKind::Whole => number("integer", kind, legal),
        ValueKind::Place => number("integer", kind, Legal { most: legal.most - 1, ..legal }),
        ValueKind::OfMotor => number("integer", kind, Legal { may_be_zero: false, ..legal }),
        ValueKind::Auto(_) => {
            let number = number("number", kind, Legal { may_be_zero: false, ..legal });
            json!({ "anyOf": [{ "type": "string", "enum": ["auto"] }, number] })
        }
        ValueKind::Switch => json!({ "type": "boolean" }),
        ValueKind::Choice(name) => json!({ "type": "string", "enum": names_of(name) }),
        ValueKind::Name => json!({ "type": "string" }),
        ValueKind::MotorName => json!({ "type": "string", "pattern": MOTOR_NAME }),
        ValueKind::Plug => json!({ "type": "string", "pattern": r"^(|!?[\x22-\x7e]{1,8})$" }),
        ValueKind::Connector => json!({ "type": "string", "pattern": r"^[\x22-\x7e]{0,8}$" }),
        ValueKind::Thermistor => {
            let of_range = |legal: Legal| number("integer", ValueKind::Whole, legal);
            let numbers = json!({
                "type": "object",
                "additionalProperties": false,
                "required": ["ohms", "beta"],
                "properties": {
                    "ohms": of_range(ranges::OHMS.spec().legal),
                    "beta": of_range(ranges::BETA.spec().legal),
                    "cubic": of_range(thermistor::cubic_legal()),
                },
            });
            let pair = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 });
            let points = json!({
                "type": "object",
                "additionalProperties": false,
                "required": [thermistor::POINTS],
                "properties": { "points": { "type": "array", "items": pair, "minItems": 3, "maxItems": 3 } },
            });
            let names = SHEETS.map(|sheet| sheet.name);
            json!({ "anyOf": [{ "type": "string", "enum": names }, numbers, points] })
        }
        ValueKind::MotorRow => {
            let most = corehbot::kinematics::MOST_MULTIPLE;
            let item = json!({ "type": "integer", "minimum": -most, "maximum": most });
            json!({ "type": "array", "items": item, "minItems": 3, "maxItems": 4 })
        }
    }
}

/// A number from the least to the most, as short as they can be said.
fn number(name: &str, kind: ValueKind, legal: Legal) -> Value {
    let least = if legal.may_be_zero { 0 } else { legal.least };
    let [least, most] = [least, legal.most].map(|bits| value::float_toml(shortest(bits, fraction(kind))));
    let mut schema = Map::from_iter([("type".to_owned(), json!(name))]);
    for (key, end) in [("minimum", least), ("maximum", most)] {
        schema.insert(key.to_owned(), serde_json::to_value(end).unwrap_or_default());
    }
    Value::Object(schema)
}

/// The meaning of a number of the twin in one line, with unit and source.
pub(crate) fn twin_meaning(row: &TwinRow) -> String {
    let unit = if row.unit().is_empty() { String::new() } else { format!(" Unit: {}.", row.unit()) };
    let source = if row.default.is_some() { "Source" } else { "Default" };
    format!("{}.{unit} {source}: {}.", row.meaning, row.source)
}

fn of_twin(row: &TwinRow) -> Value {
    let (kind, least) = if row.range == Range::Count { ("integer", 1) } else { ("number", 0) };
    let mut number = json!({ "type": kind, "minimum": least, "maximum": TwinRow::MOST as u64 });
    if row.range == Range::Positive {
        insert(&mut number, "exclusiveMinimum", json!(0));
    }
    let mut schema = if row.is_list() {
        let list = json!({ "type": "array", "items": number.clone(), "maxItems": MOST_PARTS });
        json!({ "anyOf": [number, list] })
    } else {
        number
    };
    if let Some(default) = row.default {
        insert(&mut schema, "default", serde_json::to_value(value::float_toml(default)).unwrap_or_default());
    }
    insert(&mut schema, "description", json!(twin_meaning(row)));
    schema
}

fn of_other(other: &Other) -> Value {
    let mut schema = match other.name {
        BOARD => json!({ "type": "string", "enum": corehbot_boards::all().map(|board| board.key).collect::<Vec<_>>() }),
        FULL_STEPS => number("integer", ValueKind::Whole, value::FULL_STEPS.spec().legal),
        // Its range depends on other keys.
        _ => json!({ "type": "number", "exclusiveMinimum": 0 }),
    };
    insert(&mut schema, "description", json!(other.meaning));
    schema
}
