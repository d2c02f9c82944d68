//! Parameters as a table of their keys, for files and JSON: a missing key has its nominal value.

use super::{Each, Params, ROWS, Row};
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::ser::SerializeMap as _;
use serde::{Deserialize, Serialize, Serializer};

impl Serialize for Params {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for row in &ROWS {
            let values = row.values(self);
            if !values.values().is_empty() {
                map.serialize_entry(row.key, &values)?;
            }
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Params {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = Params;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table of numbers")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Params, A::Error> {
                let mut params = Params::default();
                while let Some(Known(row)) = entries.next_key()? {
                    let values: Each = entries.next_value()?;
                    let field = (row.field)(&mut params);
                    if values.values().len() != 1 && !field.is_list() {
                        return Err(de::Error::custom(format!("{} is one number", row.key)));
                    }
                    field.set(values);
                }
                Ok(params)
            }
        }
        deserializer.deserialize_map(Table)
    }
}

/// The row of a key.
struct Known(&'static Row);

/// By its own, so that an unknown key is reported at its place.
impl<'de> Deserialize<'de> for Known {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Key;
        impl Visitor<'_> for Key {
            type Value = Known;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("the key of a number")
            }

            fn visit_str<E: de::Error>(self, key: &str) -> Result<Known, E> {
                let row = Row::of(key).map(Known);
                row.ok_or_else(|| de::Error::custom(format!("unknown number `{key}`; [twin] has a row for each")))
            }
        }
        deserializer.deserialize_identifier(Key)
    }
}
