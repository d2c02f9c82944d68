//! Answers that depend on the mechanism.

use super::lines::Lines;
use super::print::{Steps, machines};
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::check::Checker;
use corehbot_sim::limits::Limits;
use corehbot_sim::world::run;

/// The answer to a line of a machine that stands at 10, 20, 5.
pub fn answers(s: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().map(|line| (*line).to_owned()).collect();
    let mut host = Lines::new(lines);
    let mut steps = Steps { checker: Checker::new(s, &Limits::new(s, None, "")), counts: [0; MOTORS], events: 0 };
    run(s, Some([10, 20, 5].map(Mm::from_num)), &mut host, &mut steps).unwrap();
    host.heard.retain(|line| line != "ok" && line != "start" && !line.starts_with("echo:busy"));
    host.heard
}

#[test]
fn positions_are_said_with_the_coordinates_of_the_machine() {
    let counted = |name: &str| {
        let (_, s) = machines().into_iter().find(|(file, _)| file == name).unwrap();
        answers(&s, &["G1 X11 F3000", "M400", "M114 R"]).last().unwrap().clone()
    };
    let at = "X:11.00 Y:20.00 Z:5.00 E:0.00 Count";
    let closed = "X:11.00 Y:20.00 Z:5.00 E:0.00 C:0.00 Count";
    assert_eq!(counted("prototype"), format!("{closed} A:2480 B:-720 Z:4000"));
    assert_eq!(counted("corexy"), format!("{at} A:2480 B:-720 Z:2000"));
    assert_eq!(counted("corexyz"), format!("{at} A:2880 B:-320 C:-2080 D:1120"));
    assert_eq!(counted("corexyz-three"), format!("{at} A:2880 B:-320 C:-2080"));
    assert_eq!(counted("corexz"), format!("{at} A:1280 B:480 Y:1600"));
    assert_eq!(counted("cartesian"), format!("{at} Y:2000 X:880 Z:4000"));
}

/// Settings that were stored on another machine are left where they are, and that is said. Older settings of this one
/// count then.
#[test]
fn stored_settings_of_another_mechanism_are_not_used() {
    let mut eeprom = corehbot_sim::eeprom::Eeprom::blank();
    let mut ask = |s: &Settings, lines: &[&str]| {
        let lines = lines.iter().map(|line| (*line).to_owned()).collect();
        let mut host = Lines::new(lines);
        let mut steps = Steps { checker: Checker::new(s, &Limits::new(s, None, "")), counts: [0; MOTORS], events: 0 };
        corehbot_sim::world::run_with(s, None, &mut eeprom, &mut [&mut host], &mut steps).unwrap();
        host.heard
    };
    let (here, there) =
        (Settings::prototype(), Settings { mechanism: machines()[2].1.mechanism, ..Settings::prototype() });
    assert_ne!(here.mechanism, there.mechanism);
    assert!(ask(&here, &["M203 X123", "M500"]).iter().any(|said| said.starts_with("echo:Settings Stored")));
    let heard = ask(&there, &["M203"]);
    let why = "echo:storage slot A not used: for a machine with another mechanism";
    assert!(heard.iter().any(|said| said == why), "{heard:?}");
    assert!(heard.iter().any(|said| said.starts_with("  M203 X300")), "{heard:?}");
    assert!(ask(&here, &["M203"]).iter().any(|said| said.starts_with("  M203 X123")));
    ask(&there, &["M203 X222", "M500"]);
    for (machine, slot, speed) in [(&here, "B", "  M203 X123"), (&there, "A", "  M203 X222")] {
        let heard = ask(machine, &["M501", "M203"]);
        let why = format!("echo:storage slot {slot} not used: for a machine with another mechanism");
        assert!(heard.contains(&why), "{heard:?}");
        assert!(heard.iter().any(|said| said.starts_with(speed)), "{heard:?}");
    }
}
