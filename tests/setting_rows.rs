//! The rows of all settings: each id once, each key once, each setting in one row.

use corehbot::gcode::Command;
use corehbot::machine::parse;
use corehbot::settings::Settings;
use corehbot::settings::plain::{CODES, CONDITIONS, Owner, condition, letters};
use corehbot::settings::rows::{Field, Key, Value, ValueKind, Visitor};
use corehbot::settings::table::{NEXT_ID, described};
use std::collections::BTreeSet;

#[derive(Default)]
struct All(Vec<(Key, Value)>);

impl Visitor for All {
    fn visit(&mut self, key: Key, field: &mut dyn Field) {
        self.0.push((key, field.get()));
    }
}

fn all(mut settings: Settings) -> Vec<(Key, Value)> {
    let mut all = All::default();
    settings.visit(&mut all);
    all.0
}

#[test]
fn every_id_is_that_of_one_row_and_the_next_is_free() {
    let ids: Vec<u16> = described().map(|(row, _)| row.id).collect();
    let different: BTreeSet<u16> = ids.iter().copied().collect();
    assert_eq!(ids.len(), different.len(), "an id is used once; {NEXT_ID} is free");
    assert_eq!(different.last().map(|last| last + 1), Some(NEXT_ID));
}

#[test]
fn rows_are_visited_as_they_are_listed_and_keys_are_different() {
    let visited = all(Settings::prototype());
    let listed = described().flat_map(|(row, _)| (0..row.tables.len()).map(move |part| (row.id, part)));
    let seen = visited.iter().map(|(key, _)| (key.row.id, usize::from(key.part)));
    assert!(seen.eq(listed));
    let mut keys: Vec<String> = visited.iter().map(|(key, _)| key.to_string()).collect();
    let lists = ["belt.phases", "homing.order", "motors.names"];
    keys.retain(|key| !lists.contains(&key.as_str()));
    assert_eq!(keys.len(), keys.iter().collect::<BTreeSet<_>>().len());
    assert!(keys.len() > 190, "{}", keys.len());
}

#[test]
fn every_row_says_what_it_means() {
    for (row, text) in described() {
        let meaning = text.meaning.concat();
        assert!(meaning.trim().ends_with(['.', '\'']), "{}: {meaning}", row.leaf);
        assert!(meaning.split_whitespace().count() <= 70, "{}: {meaning}", row.leaf);
        if let ValueKind::Fixed(bits) = text.kind {
            assert!(bits <= 32, "{}", row.leaf);
        }
    }
}

/// Every bit of the settings is in some row: the rows can change all of them.
#[test]
fn settings_are_what_their_rows_say() {
    struct Copy<'a>(std::slice::Iter<'a, (Key, Value)>);
    impl Visitor for Copy<'_> {
        fn visit(&mut self, key: Key, field: &mut dyn Field) {
            let (other, value) = self.0.next().unwrap();
            assert_eq!(key, *other);
            assert!(*value == Value::Absent || field.set(value), "{key}");
        }
    }
    let prototype = Settings::prototype();
    let value = serde_json::to_value(prototype).unwrap();
    let mut leaves = Vec::new();
    numbers(&value, &mut leaves, "");
    // Each number and switch in turn.
    for path in &leaves {
        let mut other = value.clone();
        let place = other.pointer_mut(path).unwrap();
        *place = match &*place {
            serde_json::Value::Bool(is) => (!is).into(),
            // In the row of a motor -1 cannot become -2.
            serde_json::Value::Number(number) if number.as_i64() == Some(-1) => 0.into(),
            serde_json::Value::Number(number) => (number.as_i64().unwrap() ^ 1).into(),
            _ => continue,
        };
        let Ok(changed) = serde_json::from_value::<Settings>(other) else { continue };
        let values = all(changed);
        assert_ne!(values, all(prototype), "{path} is in no row");
        let mut copied = prototype;
        copied.visit(&mut Copy(values.iter()));
        assert_eq!(copied, changed, "{path}");
    }
    assert!(leaves.len() > 180, "{}", leaves.len());
}

fn numbers(value: &serde_json::Value, into: &mut Vec<String>, path: &str) {
    match value {
        serde_json::Value::Number(_) | serde_json::Value::Bool(_) => into.push(path.to_owned()),
        serde_json::Value::Array(items) => {
            items.iter().enumerate().for_each(|(at, item)| numbers(item, into, &format!("{path}/{at}")));
        }
        serde_json::Value::Object(fields) => {
            fields.iter().for_each(|(key, field)| numbers(field, into, &format!("{path}/{key}")));
        }
        serde_json::Value::Null | serde_json::Value::String(_) => {}
    }
}

/// A line sets a plain setting while moves wait, and tells no other part than the owner of its code.
#[test]
fn no_other_part_keeps_a_copy_of_a_plain_setting() {
    let before = Settings::prototype();
    let mut count = 0;
    for code in CODES {
        let mut changed = before;
        changed.visit_code(*code, &mut |_, field| {
            let Value::Number(number) = field.get() else { return };
            count += usize::from(field.set(&Value::Number(number + 1)));
        });
        let resolution = |s: &Settings| s.axes.map(|axis| axis.steps_per_mm);
        let kept = |s: &Settings| (s.drivers, s.shapers, s.advance, s.belt);
        assert!(changed.is_built_as(&before) && kept(&changed) == kept(&before), "M{code}");
        let owner = condition(*code).owner;
        assert_eq!(changed.thermal != before.thermal, owner == Owner::Heaters, "M{code}");
        assert_eq!(resolution(&changed) != resolution(&before), owner == Owner::Motors, "M{code}");
        assert_eq!(changed.home_offsets() != before.home_offsets(), owner == Owner::Origins, "M{code}");
        assert_eq!(changed.probe.offset != before.probe.offset, owner == Owner::Probe, "M{code}");
    }
    assert!(count >= 25, "{count}");
}

#[test]
fn a_code_with_a_condition_has_rows_and_letters_of_its_own() {
    for condition in CONDITIONS {
        assert!(CODES.contains(&condition.code), "M{}", condition.code);
        let all: Vec<_> = letters(condition.code).flat_map(|letters| letters.split('/')).collect();
        assert_eq!(all.len(), all.iter().collect::<BTreeSet<_>>().len(), "M{}", condition.code);
    }
    for code in CODES {
        let is_plain = matches!(
            parse(format!("M{code}").as_bytes()),
            Command::Table(command) if command.is('M', *code)
        );
        assert!(is_plain, "M{code} has no row in the table of commands");
    }
}
