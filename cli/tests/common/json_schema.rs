//! Whether a value is of a JSON Schema: of draft 7 the keywords that the schema of machine files has. One that is not
//! known here fails. A whole validator (jsonschema) would be 37 crates and minutes of compiling.

use regex_lite::Regex;
use serde_json::Value;

/// Whether `value` is of `schema`.
pub fn is_of(schema: &Value, value: &Value) -> bool {
    let keywords = schema.as_object().unwrap();
    keywords.iter().all(|(keyword, said)| match keyword.as_str() {
        "$schema" | "title" | "description" | "default" => true,
        "type" => is_of_type(said.as_str().unwrap(), value),
        "enum" => said.as_array().unwrap().contains(value),
        "anyOf" => said.as_array().unwrap().iter().any(|schema| is_of(schema, value)),
        "minimum" => value.as_f64().is_none_or(|v| v >= said.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|v| v <= said.as_f64().unwrap()),
        "exclusiveMinimum" => value.as_f64().is_none_or(|v| v > said.as_f64().unwrap()),
        "pattern" => value.as_str().is_none_or(|text| Regex::new(said.as_str().unwrap()).unwrap().is_match(text)),
        "items" => value.as_array().is_none_or(|items| items.iter().all(|item| is_of(said, item))),
        "minItems" => value.as_array().is_none_or(|items| items.len() as u64 >= said.as_u64().unwrap()),
        "maxItems" => value.as_array().is_none_or(|items| items.len() as u64 <= said.as_u64().unwrap()),
        "required" => {
            let mut names = said.as_array().unwrap().iter().map(|name| name.as_str().unwrap());
            value.as_object().is_none_or(|fields| names.all(|name| fields.contains_key(name)))
        }
        "properties" => value
            .as_object()
            .is_none_or(|fields| fields.iter().all(|(key, v)| said.get(key).is_none_or(|schema| is_of(schema, v)))),
        "patternProperties" => value.as_object().is_none_or(|fields| {
            let matching = |(key, v): (&String, &Value)| matching(said, key).all(|schema| is_of(schema, v));
            fields.iter().all(matching)
        }),
        "additionalProperties" => {
            let (known, patterns) = (&schema["properties"], &schema["patternProperties"]);
            let is_known = |key: &String| known.get(key).is_some() || matching(patterns, key).next().is_some();
            let is_other = |v: &Value| *said != false && is_of(said, v);
            value.as_object().is_none_or(|fields| fields.iter().all(|(key, v)| is_known(key) || is_other(v)))
        }
        unknown => panic!("{unknown} is no keyword that this knows"),
    })
}

/// The schemas with a pattern that a key matches.
fn matching<'s>(patterns: &'s Value, key: &'s str) -> impl Iterator<Item = &'s Value> {
    let all = patterns.as_object().into_iter().flatten();
    all.filter(move |(pattern, _)| Regex::new(pattern).unwrap().is_match(key)).map(|(_, schema)| schema)
}

fn is_of_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        // 1.0 is one, too.
        "integer" => value.as_f64().is_some_and(|v| v.fract() == 0.0),
        unknown => panic!("{unknown} is no type"),
    }
}
