//! Heaters without a reading, or with one that cannot be right. Each command that needs a reading waits for the first
//! one, a wait ends, and a refusal stops nothing but the heat.

use crate::common::deaf::Deaf;
use corehbot::connectors::Heater;
use corehbot::port::NoStorage;
use corehbot::settings::{Control, HeaterModel, Settings, Thermistor};
use corehbot::units::{JoulesPerKelvin, Mm, Seconds, TICKS_PER_MS, Watts, WattsPerKelvin};
use corehbot_rig::plant::{Couplings, Plant, PlantConstants, SensorFault, Thermistor as Real};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, World};

/// A machine with a hotend and a bed.
fn machine() -> Settings {
    let mut settings = Settings::prototype();
    for heater in [Heater::Hotend, Heater::Bed] {
        settings.thermal.heater_mut(heater).is_fitted = true;
    }
    settings
}

/// What a machine said, and when it gave its last `ok`, in ms; whether it halted, and what is left of its heat.
struct Talk {
    heard: Vec<String>,
    ms: u64,
    is_halted: bool,
    plant: Option<Box<Plant>>,
}

impl Talk {
    fn has(&self, part: &str) -> bool {
        self.heard.iter().any(|line| line.contains(part))
    }
}

/// Says lines from the first moment on, each after the `ok` of the one before, until all are answered.
fn talk(
    settings: &Settings,
    mut desk: Box<Desk>,
    lines: &[&str],
    most_s: u64,
    broken: impl FnOnce(&mut Plant),
) -> Talk {
    let drivers = Drivers::new();
    let (start, mut sink) = (Some([100, 100, 50].map(Mm::from_num)), Deaf);
    let mut world = World::new(&mut desk, settings, start, NoStorage, &drivers, &mut sink);
    broken(world.heat().plant().unwrap());
    let (begun, mut heard, mut partial) = (world.now(), Vec::<String>::new(), Vec::new());
    for line in lines {
        world.wires()[0].put(format!("{line}\n").into_bytes());
        let mut is_answered = false;
        while !is_answered && !world.status().is_halted() {
            let s = (world.now() - begun) / u64::from(TICKS_PER_MS) / 1000;
            assert!(s < most_s, "{line} waits for ever: {heard:?}");
            world.poll();
            partial.extend(world.wires()[0].heard());
            while let Some(end) = partial.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = partial.drain(..=end).collect();
                let line = String::from_utf8(line).unwrap().trim_end().to_owned();
                is_answered |= line.starts_with("ok");
                heard.push(line);
            }
            if !is_answered {
                world.advance();
            }
        }
    }
    let (ms, is_halted) = ((world.now() - begun) / u64::from(TICKS_PER_MS), world.status().is_halted());
    Talk { heard, ms, is_halted, plant: world.take_plant() }
}

/// A desk with these true values.
fn desk(truth: PlantConstants) -> Box<Desk> {
    let mut desk = Desk::new(1);
    desk.heat.truth = Some(truth);
    desk
}

/// A room that is colder than any sensor may read.
fn arctic() -> PlantConstants {
    PlantConstants { ambient_celsius: -16.0, ..PlantConstants::prototype() }
}

/// A PT1000 in the bed, where the settings name an NTC.
fn platinum() -> PlantConstants {
    let mut truth = PlantConstants::prototype();
    truth.bed.sensor.thermistor = Real::Platinum;
    truth
}

/// Reproducer: no reading counted as the coldest temperature there is, so the machine waited for 0 C from above.
#[test]
fn a_wait_in_the_first_line_ends() {
    for (line, most_ms) in [
        ("M190 S0", 50),
        ("M109 S0", 50),
        ("M109 S20", 100),
        ("M190 S24", 100),
        ("M116", 50),
        ("M191 S30", 50),
        ("M109 R25", 4000),
        ("M190 R0", 62_000),
        ("M190 S26", 60_000),
    ] {
        let talk = talk(&machine(), Desk::new(1), &[line], 100, |_| {});
        assert!(talk.ms <= most_ms && !talk.is_halted, "{line}: {} ms, {:?}", talk.ms, talk.heard);
        assert!(!talk.has("//action") && !talk.has("stays at"), "{line}: {:?}", talk.heard);
    }
}

#[test]
fn the_first_report_has_the_first_reading() {
    let said = talk(&machine(), Desk::new(1), &["M105"], 10, |_| {});
    let report = said.heard.last().unwrap();
    assert!(report.starts_with("ok T:25.0") || report.starts_with("ok T:24.9"), "{report}");
    assert!(report.contains(" B:2") && said.ms < 100, "{report}");
    // Filament too: a hotend that is hot after a reset extrudes from the first line on.
    let mut desk = desk(PlantConstants::prototype());
    desk.plant = Some(Box::new(Plant::hot(&PlantConstants::prototype(), 210.0, 25.0)));
    let said = talk(&machine(), desk, &["G1 E2 F600"], 10, |_| {});
    assert!(!said.has("cold extrusion"), "{:?}", said.heard);
}

#[test]
fn m303_in_the_first_line_tunes() {
    let said = talk(&machine(), Desk::new(1), &["M303 E0 S100 C3"], 3000, |_| {});
    assert!(said.has("PID Autotune finished!") && !said.has("ignored"), "{:?}", said.heard);
}

/// A sensor that is open from the start on: a command that needs it says so within a second, in words and not in
/// numbers.
#[test]
fn a_sensor_without_a_reading_is_told_in_words() {
    let open = |plant: &mut Plant| plant.faults().bed_sensor = SensorFault::Open;
    let said = talk(&machine(), Desk::new(1), &["M105", "G4 P100"], 10, open);
    let report = said.heard.iter().find(|line| line.starts_with("ok T:")).unwrap();
    assert!(report.contains(" B:open /0.00") && report.starts_with("ok T:2") && said.ms < 1000, "{report}");
    let told = "bed: sensor open or unplugged [E01]: plug its sensor in, or mend the wire";
    assert_eq!(said.heard.iter().filter(|line| **line == format!("echo:heating is refused, {told}")).count(), 1);
    let said = talk(&machine(), Desk::new(1), &["M303 E-1 S60", "M140 S60", "M190 S0", "M109 S20", "M122"], 20, open);
    for line in ["M303", "M140"] {
        assert!(said.has(&format!("echo:{line} ignored: {told}")), "{line}: {:?}", said.heard);
    }
    assert!(said.has("echo:heater bed has no reading, target 0.00 C"), "{:?}", said.heard);
    assert!(said.ms < 2000 && !said.is_halted && !said.has("//action"), "{:?}", said.heard);
    for line in ["M190 S60", "M190 R30"] {
        let said = talk(&machine(), Desk::new(1), &[line], 20, open);
        assert!(said.has("heaters are off: bed has no reading. Check its sensor"), "{line}: {:?}", said.heard);
        assert!(said.ms < 1500 && !said.is_halted, "{line}: {} ms", said.ms);
    }
}

/// Reproducer: a printer at -16 C, and one with another kind of sensor than set, halted at each start and refused what
/// mends that.
#[test]
fn a_reading_that_cannot_be_right_refuses_heat_and_nothing_else() {
    let lines = [
        "M115",
        "M503",
        "M119",
        "M105",
        "G28 X Y",
        "G1 X50 F3000",
        "M204 P1500",
        "M400",
        "M114",
        "M104 S200",
        "M140 S60",
        "M303 E-1 S60",
        "M122",
    ];
    for (truth, heaters, told) in [
        (arctic(), &["hotend", "bed"][..], "colder than its sensor may read (MINTEMP) (-1"),
        (platinum(), &["bed"][..], "hotter than it may get (MAXTEMP) ("),
    ] {
        let mut plant = None;
        // Twice on one printer: a reset is no cure, and does no harm.
        for _ in 0..2 {
            let mut desk = desk(truth.clone());
            desk.plant = plant.take();
            let said = talk(&machine(), desk, &lines, 60, |_| {});
            assert!(!said.is_halted && !said.has("Error") && !said.has("//action"), "{:?}", said.heard);
            for heater in heaters {
                let line = if *heater == "bed" { "M140" } else { "M104" };
                assert!(said.has(&format!("echo:{line} ignored: {heater}: {told}")), "{heater}: {:?}", said.heard);
                let once = format!("echo:heating is refused, {heater}: {told}");
                assert_eq!(said.heard.iter().filter(|line| line.starts_with(&once)).count(), 2, "with M122's");
            }
            assert!(said.has("and the sensor's kind (thermistor)") || said.has("set the sensor's kind (thermistor)"));
            assert!(said.has("X:50.00 ") && said.has("Cap:"), "{:?}", said.heard);
            plant = said.plant;
        }
        let mut cold = desk(truth.clone());
        cold.plant = plant;
        let said = talk(&machine(), cold, &["M190 S60"], 60, |_| {});
        let why = format!("echo:print ended, heaters are off: bed: {told}");
        assert!(said.heard.iter().any(|line| line.starts_with(&why)) && !said.is_halted, "{:?}", said.heard);
    }
}

#[test]
fn a_bed_with_its_true_kind_of_sensor_set_heats() {
    let mut settings = machine();
    settings.thermal.heater_mut(Heater::Bed).thermistor = Thermistor::PT1000;
    let said = talk(&settings, desk(platinum()), &["M190 S40", "M105"], 900, |_| {});
    let (_, bed) = said.heard.last().unwrap().split_once(" B:").unwrap();
    let celsius: f64 = bed.split(' ').next().unwrap().parse().unwrap();
    assert!((celsius - 40.0).abs() < 1.1, "{celsius}");
    assert!(!said.is_halted && !said.has("refused"), "{:?}", said.heard);
}

/// A machine with a weak bed in a chamber, which creeps on at full power as the chamber warms.
fn weak_bed(noise: f64, flow: f64) -> (Settings, PlantConstants) {
    let mut settings = machine();
    for heater in [Heater::Bed, Heater::Chamber] {
        let fitted = settings.thermal.heater_mut(heater);
        (fitted.is_fitted, fitted.control) = (true, Control::Pid);
    }
    let bed = settings.thermal.heater_mut(Heater::Bed);
    bed.power = Watts::from_num(220);
    bed.model = HeaterModel {
        capacity: JoulesPerKelvin::from_num(1057),
        loss: WattsPerKelvin::from_num(2.4),
        heater_lag: Seconds::from_num(8),
        sensor_lag: Seconds::from_num(6),
        ..bed.model
    };
    let mut truth = PlantConstants { ambient_celsius: 14.0, ..PlantConstants::prototype() };
    truth.converter.noise_lsb = noise;
    truth.bed.heater.nominal_watt = 220.0;
    truth.bed.plate_to_air_watt_per_kelvin = 2.5;
    truth.couplings = Couplings { hotend_bed: 0.03, hotend_chamber: 0.01, bed_chamber: flow };
    truth.chamber = Some(corehbot_rig::plant::ChamberConstants::usual());
    let share = 1075.0 / (truth.bed.mat_joule_per_kelvin + truth.bed.plate_joule_per_kelvin);
    truth.bed.mat_joule_per_kelvin *= share;
    truth.bed.plate_joule_per_kelvin *= share;
    truth.bed.mat_to_plate_watt_per_kelvin *= share;
    (settings, truth)
}

/// Lines that end in a wait for the bed, which is in vain: the job ends with that reason, and the machine goes on.
fn wait_in_vain((settings, truth): (Settings, PlantConstants), lines: &[&str], target: i32) {
    let said = talk(&settings, desk(truth), lines, 9000, |_| {});
    assert!(!said.is_halted, "{lines:?}: {:?}", said.heard.iter().rev().take(4).collect::<Vec<_>>());
    let ended = said.heard.iter().find(|line| line.contains("print ended")).unwrap();
    let reason = format!("does not reach {target} C");
    assert!(ended.contains("bed stays at 7") && ended.contains(&reason), "{lines:?}: {ended}");
}

/// Reproducer: a bed at full power, 4 C below a target that it cannot reach, was a reading that stands still (E06).
#[test]
fn a_target_that_a_bed_cannot_reach_is_told_as_that() {
    for (noise, flow) in [(0.0, 1.3), (0.1, 1.2), (0.3, 1.4)] {
        wait_in_vain(weak_bed(noise, flow), &["M190 S79"], 79);
    }
}

/// Reproducer: a target farther away halted the machine (E08): the guard counted from another reading than the wait. It
/// did so after four minutes where the bed came to rest on the first 60 % of the way.
#[test]
fn a_target_far_above_what_a_bed_can_reach_is_told_as_that_before_a_guard_halts_the_machine() {
    for (target, noise, flow) in [(85, 0.3, 1.3), (120, 0.0, 1.3)] {
        wait_in_vain(weak_bed(noise, flow), &[&format!("M190 S{target}")], target);
    }
    // Time has passed before the wait begins, with a target for which more is allowed.
    wait_in_vain(weak_bed(0.1, 1.3), &["M140 S90", "G4 S1500", "M190 S110"], 110);
}
