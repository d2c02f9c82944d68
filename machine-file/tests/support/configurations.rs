//! Properties for any bytes at all: as a configuration of Klipper, as the answers of a printer with Marlin, as Marlin's
//! source, and as a config.g. The fuzzer and the property tests share one body.

use corehbot_machine_file::klipper::{self, Config, Files};
use corehbot_machine_file::marlin::{self, Firmware, Given, Kinematics};
use corehbot_machine_file::{Translation, configuration_h, file_kind, parse, reprap};

/// One file, which includes nothing but itself.
struct One<'t>(&'t str);

impl Files for One<'_> {
    fn matching(&mut self, _: &str, pattern: &str) -> Vec<String> {
        if klipper::matches(pattern, "printer.cfg") { vec!["printer.cfg".to_owned()] } else { Vec::new() }
    }

    fn read(&mut self, _: &str) -> Result<String, String> {
        Ok(self.0.to_owned())
    }
}

/// Reads the bytes as all of them. The first byte chooses a board and the kinematics.
pub fn any(data: &[u8]) {
    let (choice, bytes) = data.split_first().map_or((0, data), |(first, rest)| (usize::from(*first), rest));
    let text = file_kind::text_of(bytes);
    let board = corehbot_boards::entries().nth(choice % 8).map(|entry| entry.board.connectors);
    let kinematics = Kinematics::ALL.get(choice / 8);
    check(&marlin::translate("x", &text, Given { board, kinematics }));
    let _ = (marlin::is_report(&text), Firmware::heard(&text));
    // Two of eight times, because they take as long as all others.
    match choice % 8 {
        0 => check(&configuration_h::translate(&[("x", &text)], Given { board, kinematics })),
        1 => check(&reprap::translate("x", &text, Given { board, kinematics })),
        _ => {}
    }
    let _ = (configuration_h::is_configuration(&text), reprap::is_config(&text));
    if let Ok(config) = Config::read("printer.cfg", &mut One(&text))
        && let Ok(done) = klipper::translate(&config, board)
    {
        let keys: usize = done.report.sections.iter().map(|section| section.keys.len()).sum();
        assert_eq!(keys, config.entries.len(), "a verdict for every key");
        check(&done);
    }
}

/// The file is TOML, it is the machine that was promised, and every part is counted.
fn check(done: &Translation) {
    assert!(toml::from_str::<toml::Table>(&done.text).is_ok(), "{}", done.text);
    assert_eq!(done.machine.is_some(), parse(&done.text).is_ok(), "{}", done.text);
    let keys: usize = done.report.sections.iter().map(|section| section.keys.len()).sum();
    let counted: usize = done.report.counts().iter().map(|(_, count)| count).sum();
    assert!(counted >= keys && !done.report.to_string().is_empty());
}
