//! The probe over the simulated bed, as M119 reports it.

use super::talk::talk_to;
use corehbot::connectors::ConnectorName;
use corehbot::settings::Settings;

/// A prototype with a probe.
fn probing() -> Settings {
    let mut settings = Settings::prototype();
    settings.probe_plug.connector = ConnectorName::lit("PROBE");
    settings
}

#[test]
fn the_probe_is_reported_as_it_touches_the_bed() {
    let lines = ["M119", "G1 Z0", "M400", "M119", "G1 Z1", "M400", "M119"];
    let (heard, outcome, _) = talk_to(&probing(), Some([100.0, 100.0, 5.0]), &lines);
    assert!(!outcome.halted);
    let states: Vec<_> = heard.iter().filter(|line| line.starts_with("z_probe")).collect();
    assert_eq!(states, ["z_probe: open", "z_probe: TRIGGERED", "z_probe: open"]);
}
