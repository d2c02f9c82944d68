//! The grammar: every row, every earlier spelling, every error.

use super::*;
use corehbot::connectors::Heater;
use corehbot_rig::plant::{PlantConstants, PlantFaults};

/// WHAT, WHERE, how much, direction, begin and duration.
type Told = (&'static str, String, Option<f64>, i8, f64, Option<f64>);

fn told(accident: &Accident) -> Told {
    let Accident { row, name, how, direction, at_s, lasts_s, .. } = accident;
    (row.word, name.clone(), *how, *direction, *at_s, *lasts_s)
}

fn read(text: &str) -> Result<Told, String> {
    text.parse().map(|accident| told(&accident)).map_err(|error: AccidentError| error.to_string())
}

fn wrong(text: &str) -> String {
    read(text).expect_err(text)
}

/// Places of a row, in a machine with belts.
fn places(row: &Row) -> Vec<&'static str> {
    let named: Vec<_> = row.names().collect();
    if named.is_empty() { vec!["m8", "7"] } else { named }
}

#[test]
fn every_row_is_read_and_written_and_read_again() {
    for row in &ROWS {
        for place in places(row) {
            let [least, most] = row.how.map_or([0.0; 2], |how| how.bounds);
            let hows = if row.how.is_some() {
                vec![format!(":{least}"), format!(":{most}"), String::new()]
            } else {
                vec![String::new()]
            };
            for how in hows {
                for lasts in if row.can_end { &["", "+2.5m"][..] } else { &[""] } {
                    let text = format!("{}:{place}{how}@1.5h{lasts}", row.word);
                    // A motor rubs with no force or more.
                    let accident: Accident = text.parse().unwrap_or_else(|error| panic!("{text}: {error}"));
                    assert_eq!((accident.row.word, accident.row.family, accident.at_s), (row.word, row.family, 5400.0));
                    let again: Accident = accident.to_string().parse().unwrap();
                    assert_eq!(told(&again), told(&accident), "{text}: {accident}");
                    assert_eq!(again.to_string(), accident.to_string());
                }
            }
        }
    }
}

/// Two rows with one word and one place, or one that does nothing, would be found here.
#[test]
fn no_row_hides_another_and_each_of_heat_changes_the_plant() {
    let healthy = PlantFaults::none(&PlantConstants::prototype());
    for row in &ROWS {
        for place in places(row) {
            let same = ROWS.iter().filter(|other| other.word == row.word && other.names().any(|name| name == place));
            assert!(same.count() <= 1, "{}:{place}", row.word);
            let accident: Accident = format!("{}:{place}@0s", row.word).parse().unwrap();
            assert_eq!(accident.row.family, row.family, "{}:{place}", row.word);
            let mut faults = healthy.clone();
            accident.happen(&mut faults);
            let is_changed = format!("{faults:?}") != format!("{healthy:?}");
            assert_eq!(is_changed, matches!(row.family, Family::Heat | Family::Supply), "{}:{place}", row.word);
            let settings = corehbot::settings::Settings::prototype();
            assert_eq!(accident.probe_fault(&settings).is_some(), row.family == Family::Probe, "{}", row.word);
        }
        // What is said of a HOW are its bounds.
        if let Some(how) = row.how {
            let says = how.says.replace(',', "");
            assert!(how.bounds.iter().all(|bound| says.contains(&bound.abs().to_string())), "{}: {says}", row.word);
            assert!(how.usual.is_none_or(|usual| (how.bounds[0]..=how.bounds[1]).contains(&usual)), "{}", row.word);
        }
    }
    let sum: usize = Family::ALL.map(|family| Row::of(family).count()).iter().sum();
    assert_eq!(sum, ROWS.len());
}

#[test]
fn one_word_of_two_families_is_told_by_its_place() {
    let family = |text: &str| text.parse::<Accident>().map(|accident| (accident.row.family, accident.place)).unwrap();
    assert_eq!(family("loose@1s"), (Family::Heat, Place::Heater(Heater::Hotend)));
    assert_eq!(family("loose:bed@1s"), (Family::Heat, Place::Heater(Heater::Bed)));
    assert_eq!(family("loose:m1@1s"), (Family::Belts, Place::PartOfBelts));
    assert_eq!(family("loose:m1:+15N@1s+2s"), (Family::Belts, Place::PartOfBelts));
}

#[test]
fn places_and_numbers_may_be_left_out() {
    let (hotend, m8) = ("hotend".to_owned(), "m8".to_owned());
    assert_eq!(read("open@60s"), Ok(("open", hotend, None, 0, 60.0, None)));
    assert_eq!(read("stuck-on:bed@10m"), Ok(("stuck-on", "bed".to_owned(), None, 0, 600.0, None)));
    assert_eq!(read("fan-dead:part@0s"), Ok(("fan-dead", "part".to_owned(), None, 0, 0.0, None)));
    assert_eq!(read("converter@2m"), Ok(("converter", "machine".to_owned(), None, 0, 120.0, None)));
    assert_eq!(read("stuck@60s"), read("stuck:probe@1m"));
    assert_eq!(read("seized:m8@20s"), Ok(("seized", m8.clone(), None, 0, 20.0, None)));
    assert_eq!(
        read(" seized : 7 : 35 N @ 1m + 500s "),
        Ok(("seized", "7".to_owned(), Some(35.0), 0, 60.0, Some(500.0)))
    );
    assert_eq!(read("loose:m8@0s+2.5s"), Ok(("loose", m8.clone(), Some(10.0), 0, 0.0, Some(2.5))));
    assert_eq!(read("loose:m8:-15@3s"), Ok(("loose", m8.clone(), Some(-15.0), -1, 3.0, None)));
    assert_eq!(read("loose:m8:+15N@3s"), Ok(("loose", m8.clone(), Some(15.0), 1, 3.0, None)));
    // A pulley that holds nothing, either way.
    assert_eq!(read("loose:m8:0@3s"), Ok(("loose", m8.clone(), Some(0.0), 0, 3.0, None)));
    assert_eq!(read("jump:m8@3s"), Ok(("jump", m8.clone(), Some(1.0), 0, 3.0, None)));
    assert_eq!(read("jump:m8:-2@3s"), Ok(("jump", m8.clone(), Some(-2.0), -1, 3.0, None)));
    assert_eq!(read("cord:m8:30%@1h"), Ok(("cord", m8.clone(), Some(30.0), 0, 3600.0, None)));
    assert_eq!(read("rub:m8@3s"), Ok(("rub", m8, Some(15.0), 0, 3.0, None)));
}

#[test]
fn brakes_are_read_as_they_were_once_written() {
    let rub = |name: &str, force, at_s, lasts_s| Ok(("rub", name.to_owned(), Some(force), 0, at_s, lasts_s));
    assert_eq!(read("m11,5"), rub("m11", 5.0, 0.0, None));
    assert_eq!(read("m1,40,2.5"), rub("m1", 40.0, 2.5, None));
    assert_eq!(read("m8, 40, 2.5, 30"), rub("m8", 40.0, 2.5, Some(0.03)));
    assert_eq!(read("m11,170,57.36,14"), read("rub:m11:170N@57.36s+0.014s"));
    let text = "m11,170,57.36,14".parse::<Accident>().unwrap().text;
    assert_eq!(text, "rub:m11:170@57.36s+0.014s");
    let form = "is not MOTOR,N[,S[,MS]], which is rub:MOTOR:N@TIME[+TIME] today";
    assert_eq!(wrong("m1,2,3,4,5"), format!("`m1,2,3,4,5` {form}"));
    assert_eq!(wrong(",3"), format!("`,3` {form}"));
    assert_eq!(wrong("m1,-3"), "`-3` is not a force of 0 to 10,000 N");
    assert!(wrong("m1,3,-1").starts_with("`-1s` is not a motion time: "));
    assert!(wrong("m1,3,2,long").starts_with("`long` is not a motion time: "));
    assert!(wrong("m1,3,2,0").starts_with("`+0s` ends the accident as it begins"));
}

#[test]
fn every_fault_of_a_text_is_named() {
    assert_eq!(wrong("open"), "`open` has no time: expected WHAT[:WHERE[:HOW]]@TIME[+TIME], such as open:hotend@60s");
    assert!(wrong("seized:m8:1:2@1s").starts_with("`seized:m8:1:2@1s` has too many parts: expected WHAT"));
    let opne = wrong("opne@60s");
    assert!(opne.starts_with("`opne` is not an accident; expected open, short, frozen, loose, slipped, "), "{opne}");
    assert!(opne.ends_with("fallen, mended; did you mean `open`?"), "{opne}");
    assert!(wrong("sized:m8@1s").ends_with("did you mean `seized`?") && !wrong("kick:m8@1s").contains("did you mean"));
    assert_eq!(wrong("seized@1s"), "seized needs a place: a belt motor or a pulley, such as seized:m8@20s");
    assert_eq!(wrong("open:part@60s"), "`part` is not a place for open: hotend, bed, chamber, second");
    assert_eq!(wrong("open:probe@60s"), "`probe` is not a place for open: hotend, bed, chamber, second");
    assert_eq!(wrong("fan-dead:bed@60s"), "`bed` is not a place for fan-dead: hotend, part");
    assert_eq!(wrong("stuck:m1@60s"), "`m1` is not a place for stuck: probe");
    assert_eq!(wrong("jump:@60s"), "`` is not a place for jump: a belt motor");
    assert_eq!(wrong("open:hotend:5@1s"), "`5` is one part too many: open has a place and a time alone");
    assert_eq!(wrong("seized:m8:-1@1s"), "`-1` is not a force of 0 to 10,000 N");
    assert_eq!(wrong("loose:m8:nan@1s"), "`nan` is not a force of 0 to 10,000 N; a sign before it is one direction");
    assert_eq!(wrong("cord:m8:0%@1s"), "`0%` is not 1 to 100 %");
    for how in ["0", "1.5", "51", "two"] {
        assert_eq!(wrong(&format!("jump:m8:{how}@1s")), format!("`{how}` is not a number of teeth, -50 to 50"));
    }
    for how in ["-0", "+0", "-0N", "-0.0"] {
        let says = format!("`{how}` is 0 with a sign: a direction needs a force of more than 0 N");
        assert_eq!(wrong(&format!("loose:m1:{how}@3s")), says);
    }
    for time in ["60", "-1s", "nans", "infh", "s", "9000h"] {
        let told = "60s, 2.5m, 1h; a year at most";
        assert_eq!(wrong(&format!("open@{time}")), format!("`{time}` is not a time after power-up: {told}"));
        assert_eq!(wrong(&format!("early:probe@{time}")), format!("`{time}` is not a time after power-up: {told}"));
        assert_eq!(wrong(&format!("cord:m8@{time}")), format!("`{time}` is not a motion time: {told}"));
        assert_eq!(wrong(&format!("loose:m8@1s+{time}")), format!("`{time}` is not a motion time: {told}"));
    }
    for word in ["open", "jump:m8", "cord:m8", "early:probe"] {
        let name = word.split(':').next().unwrap();
        assert_eq!(wrong(&format!("{word}@1s+2s")), format!("{name} is for good: it has no second time"));
    }
    // Either would be an accident that does nothing, or something else than its sign says.
    for text in ["seized:7@20s+0s", "loose:m8@1s+ 0m", "seized:m8:35N@1s+0.0s"] {
        let time = text.split_once('+').unwrap().1.trim();
        let says = format!("`+{time}` ends the accident as it begins; leave it out for an accident for good");
        assert_eq!(wrong(text), says);
    }
}
