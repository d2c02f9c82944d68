//! Fans at a frequency of their own, and their tachometers, on the image.

use crate::common::{Bench, MS, bench_of, firmware, heated, print_on};
use corehbot::settings::{Settings, Tachometer};
use corehbot_emulator::heat_pins::{Climate, Mishap};
use corehbot_emulator::run::Seen;
use corehbot_emulator::watch::End;
use corehbot_emulator::wiring::Pin;

fn talk(settings: Settings, gcode: &str, climate: Climate) -> Seen {
    let seen = print_on(&firmware(), gcode, &Bench { climate, ..bench_of(settings) });
    assert!(seen.gaps.found.is_empty(), "{:?}", seen.gaps.found);
    assert!(seen.resets.is_empty(), "{:?}", seen.resets);
    seen
}

/// FAN0 (TIM1), FAN1 (TIM9) and FAN3 (TIM4): half of the time on, at the frequency that the machine names. FAN2 and
/// FAN4 have the frequency of FAN3, whose timer they share.
#[test]
fn a_fan_runs_at_the_frequency_of_its_timer() {
    const HZ: [u16; 3] = [4000, 1000, 2000];
    let mut settings = heated();
    for fan in &mut settings.thermal.fans {
        fan.role = corehbot::settings::FanRole::Commanded;
        fan.kick_ms = 0;
    }
    [settings.fans[0].frequency, settings.fans[1].frequency, settings.fans[3].frequency] = HZ;
    let begin = "M106 P0 S127.5\nM106 P1 S127.5\nM106 P2 S127.5\nM106 P3 S127.5\n";
    let edges = [200, 1200].map(|ms| talk(settings, &format!("{begin}G4 P{ms}\n"), Climate::default()).heat.fan_edges);
    // A second more.
    let more: [u32; 6] = std::array::from_fn(|fan| edges[1][fan] - edges[0][fan]);
    println!("{more:?}");
    for (fan, hz) in [(0, HZ[0]), (1, HZ[1]), (2, HZ[2]), (3, HZ[2])] {
        let rate = f64::from(more[fan]) / 2.0 / f64::from(hz);
        assert!((rate - 1.0).abs() < 0.03, "FAN{fan}: {more:?}");
    }
    assert_eq!(more[4..], [0, 0]);
    let seen = talk(settings, &format!("{begin}G4 P300\n"), Climate::default());
    let last = seen.heat.samples.last().unwrap();
    assert!((0..4).all(|fan| (last.fans[fan] - 0.5).abs() < 0.01), "{:?}", last.fans);
}

/// The machine with a tachometer of the hotend's fan at E1DET (PG13).
fn with_tachometer() -> (Settings, (usize, Pin)) {
    let mut settings = heated();
    settings.fans[1].tachometer = Tachometer::at("E1DET").unwrap();
    (settings, (1, Pin::new('G', 13)))
}

/// The hotend is warm, so its fan runs: 4800 turns a minute and two pulses each.
#[test]
fn a_tachometers_pulses_are_counted() {
    let (settings, tachometer) = with_tachometer();
    let climate = Climate { start: Some([100.0, 25.0]), tachometer: Some(tachometer), ..Climate::default() };
    let seen = talk(settings, "G4 P4500\nM123\nM122\n", climate);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    let told = seen.line.said.iter().find_map(|line| line.strip_prefix("E0:")).expect("a report");
    let (turns, rest) = told.split_once(' ').unwrap();
    assert!((4740..=4830).contains(&turns.parse::<i32>().unwrap()), "{told}");
    assert_eq!(rest, "RPM E0@:255");
    assert!(seen.line.said.iter().any(|line| line.starts_with("echo:fans E0:4") && line.ends_with(" E0@:255")));
}

#[test]
fn a_hotend_fan_that_stops_halts_the_machine() {
    let (settings, tachometer) = with_tachometer();
    let stalls = Mishap { after: 3000 * MS, what: |faults| faults.hotend_fan_broken = true };
    let climate = Climate { start: Some([100.0, 25.0]), mishap: Some(stalls), tachometer: Some(tachometer) };
    let seen = talk(settings, "G4 P12000\nM105\n", climate);
    assert!(seen.line.said.iter().any(|line| line.contains("FAN1: fan stands still [E12]")), "{:?}", seen.line.said);
}
