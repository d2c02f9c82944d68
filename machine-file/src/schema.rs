//! The schema of machine files, for editors: keys, units and kinds from the types of `form`, legal ranges from the reader, defaults
//! from the prototype's file.

use super::form::MachineToml;
use super::{MachineFileError, load};
use schemars::generate::SchemaSettings;
use schemars::transform::RestrictFormats;
use serde_json::{Map, Value, json};

/// The file that shows every key at its default.
const PROTOTYPE: &str = include_str!("../../examples/machines/prototype.toml");

/// The schema, as JSON Schema draft 7: editors for TOML know no newer one (Taplo).
#[must_use]
pub fn schema() -> Value {
    // Without references, so that a key may have the range and the default of its place.
    let settings = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true);
    // Formats are names of Rust's types.
    let settings = settings.with_transform(RestrictFormats::default());
    let mut schema = settings.into_generator().into_root_schema_for::<MachineToml>().to_value();
    let defaults = toml::from_str(PROTOTYPE).ok();
    complete(&mut schema, "", defaults.as_ref());
    if let Some(schema) = schema.as_object_mut() {
        schema.insert("title".to_owned(), json!("Machine file of CoreH-bot firmware"));
    }
    schema
}

/// Adds to the schema of the key at `path` what the types do not say, and to those in it.
fn complete(schema: &mut Value, path: &str, default: Option<&toml::Value>) {
    let Some(schema) = schema.as_object_mut() else { return };
    forbid_null(schema);
    if let Some(Value::String(text)) = schema.get_mut("description") {
        // The lines of a comment.
        *text = text.replace('\n', " ");
    }
    if let Some(keys) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        for (key, inner) in keys {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            complete(inner, &path, default.and_then(|table| table.get(key)));
        }
        return;
    }
    // That of a rotation distance depends on other keys.
    if schema.get("type") == Some(&json!("number")) && !schema.contains_key("exclusiveMinimum") {
        add_range(schema, path);
    }
    // A motor that a file with a mechanism leaves out is not fitted, so its row has no default.
    if let Some(default) = default.filter(|_| !path.starts_with("mechanism.")) {
        schema.insert("default".to_owned(), serde_json::to_value(default).unwrap_or_default());
    }
}

/// TOML has no null: a key is left out.
fn forbid_null(schema: &mut Map<String, Value>) {
    if schema.get("default") == Some(&Value::Null) {
        schema.remove("default");
    }
    if let Some(Value::Array(kinds)) = schema.get_mut("type") {
        kinds.retain(|kind| kind != "null");
        if let [kind] = kinds.as_slice() {
            let kind = kind.clone();
            schema.insert("type".to_owned(), kind);
        }
    }
    if let Some(Value::Array(values)) = schema.get_mut("enum") {
        values.retain(|value| !value.is_null());
    }
    let Some(Value::Array(mut kinds)) = schema.remove("anyOf") else { return };
    kinds.retain(|kind| kind.get("type") != Some(&json!("null")));
    match kinds.as_mut_slice() {
        [Value::Object(kind)] => {
            // The description of the key, not that of its type.
            kind.remove("description");
            schema.append(kind);
        }
        _ => drop(schema.insert("anyOf".to_owned(), Value::Array(kinds))),
    }
}

/// What the reader says is legal, if one asks it for what never is.
fn add_range(schema: &mut Map<String, Value>, path: &str) {
    let Err(MachineFileError::Range { key, legal, .. }) = load(&format!("{path} = nan")) else { return };
    let (is_whole, range) = legal.strip_prefix("the whole numbers ").map_or((false, &*legal), |range| (true, range));
    if is_whole {
        schema.insert("type".to_owned(), json!("integer"));
    }
    let ends = range.split_once(" to ").filter(|_| key == path);
    let ends = ends.and_then(|(least, most)| Some((number(least)?, number(most)?)));
    if let Some((least, most)) = ends {
        schema.insert("minimum".to_owned(), least);
        schema.insert("maximum".to_owned(), most);
    }
}

/// A number, as a whole one if it is.
fn number(text: &str) -> Option<Value> {
    text.parse::<i64>().map(Value::from).or_else(|_| text.parse::<f64>().map(Value::from)).ok()
}
