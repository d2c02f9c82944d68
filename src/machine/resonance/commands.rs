//! M955, M956, TEST_RESONANCES, SHAPER_CALIBRATE: resonances, measured by an accelerometer at the tool.

use super::plan::{SweepAxis, SweepWords};
use super::test::{examine_sensor, test_resonances};
use super::{Answer, Entry, Interrupt, MainLoop, PortSet, States, TableCommand, Wake};
use crate::gcode::{Flaw, Grammar, Nature, Number, flaw_of_pairs};
use crate::machine::apart::apart;
use crate::text::is_word;
use core::pin::pin;

pub(in crate::machine) const SENSOR: Entry = Entry::m("Resonances", &[955])
    .grammar(&Grammar::numbers(b""))
    .does("", "the accelerometer, its rate, and its noise while the tool rests")
    .examples(&[("M955", &["echo:no accelerometer configured (accelerometer.kind)"])]);

pub(in crate::machine) const SAMPLES: Entry = Entry::m("Resonances", &[956])
    .grammar(&Grammar::numbers(b"S").not_negative(b"S"))
    .does("S", "so many samples of the accelerometer, 1000 without S, as Klipper's raw data")
    .examples(&[("M956 S10", &["echo:no accelerometer configured (accelerometer.kind)"])]);

const ALL: &str = "AXIS= FREQ_START= FREQ_END= ACCEL_PER_HZ= HZ_PER_SEC= SWEEPING_ACCEL= SWEEPING_PERIOD= OUTPUT=";

pub(in crate::machine) const TEST: Entry = Entry::name("Resonances", &["TEST_RESONANCES"])
    .nature(Nature::Work)
    .judge(|_, text| sweep(text, false).err().into())
    .does(
        ALL,
        "shakes the tool along X, Y, A (1,-1) or B (1,1) where it stands, and tells frequency and damping of its \
            resonances ([resonance](../explanation/resonance.md))",
    )
    .examples(&[
        (
            "TEST_RESONANCES AXIS=1,1 FREQ_START=90 FREQ_END=95",
            &[
                "echo:ACCEL_PER_HZ reduced to 48: the machine allows 5000 mm/s2",
                "echo:swept B; no accelerometer configured, nothing was measured",
            ],
        ),
        ("TEST_RESONANCES AXIS=Z", &["echo:line ignored: \"AXIS=Z\" is not a name with = and a number"]),
        (
            "TEST_RESONANCES FREQ_START=1",
            &["echo:TEST_RESONANCES ignored: FREQ_START=1 is out of range (5 to 150), stays 5"],
        ),
    ]);

pub(in crate::machine) const CALIBRATE: Entry = Entry::name("Resonances", &["SHAPER_CALIBRATE"])
    .nature(Nature::Work)
    .judge(|_, text| sweep(text, true).err().into())
    .does(ALL, "TEST_RESONANCES, and the line that sets a shaper for it (M593), which is not carried out")
    .examples(&[(
        "SHAPER_CALIBRATE AXIS=X FREQ_START=50 FREQ_END=55 ACCEL_PER_HZ=20",
        &["echo:swept X; no accelerometer configured, nothing was measured"],
    )]);

/// The axis; Klipper has names of axes, and directions for diagonals.
fn axis(value: &[u8]) -> Option<SweepAxis> {
    const AXES: [(&[u8], SweepAxis); 6] = [
        (b"X", SweepAxis::X),
        (b"Y", SweepAxis::Y),
        (b"A", SweepAxis::A),
        (b"B", SweepAxis::B),
        (b"1,-1", SweepAxis::A),
        (b"1,1", SweepAxis::B),
    ];
    AXES.into_iter().find(|(name, _)| is_word(value, name)).map(|(_, axis)| axis)
}

/// A sweep in Klipper's words. Those that are for its own files and chips are left out.
#[inline(never)]
fn sweep(text: &[u8], chooses: bool) -> Result<SweepWords, Flaw<'_>> {
    const NAMES: [&str; 8] =
        ["FREQ_START", "FREQ_END", "ACCEL_PER_HZ", "HZ_PER_SEC", "SWEEPING_ACCEL", "SWEEPING_PERIOD", "AXIS", "OUTPUT"];
    let mut sweep = SweepWords { chooses, ..SweepWords::default() };
    let mut numbers = [None; 6];
    let flaw = flaw_of_pairs(text, &NAMES, &mut |pair| {
        match pair.place {
            6 => match axis(pair.value) {
                Some(axis) => sweep.axis = axis,
                None => return Some(pair.flaw()),
            },
            7 => sweep.wants_raw = is_word(pair.value, b"RAW_DATA"),
            _ => {}
        }
        pair.put_number(&mut numbers)
    });
    let [from, to, accel_per_hz, hz_per_s, swing, period] = numbers;
    flaw.map_or(Ok(SweepWords { from, to, accel_per_hz, hz_per_s, swing, period, ..sweep }), Err)
}

pub(in crate::machine) async fn carry_out<P: PortSet, W: Wake>(
    main_loop: &mut MainLoop<'_, P, W>,
    States { clamps, .. }: &mut States,
    command: &TableCommand<'_>,
) -> Result<Answer<'static>, Interrupt> {
    let samples = match command.code() {
        955 => None,
        956 => Some(command.number(b'S').map_or(1000, Number::to_u32)),
        _ => {
            let words = sweep(command.text(), command.is_named("SHAPER_CALIBRATE")).unwrap_or_default();
            return apart(pin!(test_resonances(main_loop, clamps, &words))).await;
        }
    };
    examine_sensor(main_loop, samples).await
}
