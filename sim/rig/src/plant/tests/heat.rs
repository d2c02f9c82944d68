//! Where the heat goes.

use super::*;

/// Nothing leaves: all heat stays in the hotend's three lumps and the bed's two.
fn closed() -> PlantConstants {
    let mut c = PlantConstants::prototype();
    c.hotend.block_to_air_watt_per_kelvin = 0.0;
    c.hotend.block_to_air_rise_watt_per_kelvin_sq = 0.0;
    c.hotend.sink_to_air_watt_per_kelvin = 0.0;
    c.hotend.hotend_fan_watt_per_kelvin = 0.0;
    c.bed.plate_to_air_watt_per_kelvin = 0.0;
    c
}

fn joules(plant: &Plant) -> [f64; 2] {
    let (c, ambient) = (&plant.constants, plant.constants.ambient_celsius);
    let (h, b) = (&plant.hotend, &plant.bed);
    [
        c.hotend.cartridge_joule_per_kelvin * (h.cartridge - ambient)
            + c.hotend.block_joule_per_kelvin * (h.block - ambient)
            + c.hotend.sink_joule_per_kelvin * (h.sink - ambient),
        c.bed.mat_joule_per_kelvin * (b.mat - ambient) + c.bed.plate_joule_per_kelvin * (b.plate - ambient),
    ]
}

#[test]
fn a_closed_plant_keeps_its_energy() {
    let mut plant = Plant::new(&closed());
    run(&mut plant, &Drive { hotend: 0.75, bed: 0.5, ..Drive::IDLE }, 60);
    // 30 W and 250 W for 60 s.
    let heated = joules(&plant);
    assert_near(heated[0], 1800.0, 1e-6);
    assert_near(heated[1], 15_000.0, 1e-6);
    run(&mut plant, &Drive::IDLE, 3600);
    assert_near(joules(&plant)[0], heated[0], 1e-6);
    assert_near(joules(&plant)[1], heated[1], 1e-6);
    // It has evened out: 1800 J in 37.8 J/K, 15,000 J in 1700 J/K.
    assert_near(plant.hotend_celsius(), 25.0 + 1800.0 / 37.8, 0.3);
    assert_near(plant.bed_celsius(), 25.0 + 15_000.0 / 1700.0, 1e-6);
}

#[test]
fn at_rest_the_power_is_what_leaves() {
    for (part_fan, flow_mm3_s) in [(0.0, 0.0), (1.0, 0.0), (0.0, 15.0)] {
        let mut plant = prototype();
        plant.step(&Drive { hotend: 0.4, bed: 0.5, part_fan, flow_mm3_s, ..Drive::IDLE }, 4.0 * 3600.0);
        let above = plant.hotend_celsius() - 25.0;
        // Heatbreak and sink in series: 0.0208 and 0.05 + 0.45 W/K.
        let sink = 0.0208 * 0.5 / (0.0208 + 0.5);
        let loss = (0.05 + 5e-5 * above + 0.05 * part_fan + 0.0023 * flow_mm3_s + sink) * above;
        assert_near(loss, 16.0, 1e-6);
        // 250 W through 3.5 W/K, and through 40 W/K before that.
        assert_near(plant.bed_celsius(), 25.0 + 250.0 / 3.5, 1e-6);
        assert_near(plant.hottest_celsius(), plant.hotend_celsius() + 16.0 / 1.5, 1e-6);
    }
}

#[test]
fn what_has_long_been_hot_stays_so_on_the_power_that_leaves() {
    let mut plant = Plant::hot(&PlantConstants::prototype(), 215.0, 60.0);
    let watt = (0.05 + 5e-5 * 190.0 + 0.0208 * 0.5 / (0.0208 + 0.5)) * 190.0;
    let drive = Drive { hotend: watt / 40.0, bed: 3.5 * 35.0 / 500.0, ..Drive::IDLE };
    let before = plant.hottest_celsius();
    plant.step(&drive, 600.0);
    assert_near(plant.hotend_celsius(), 215.0, 1e-6);
    assert_near(plant.hottest_celsius(), before, 1e-6);
    assert_near(plant.bed_celsius(), 60.0, 1e-6);
}

#[test]
fn the_hotend_loses_as_much_as_others_have_measured() {
    let mut plant = prototype();
    plant.step(&Drive { hotend: 0.05, ..Drive::IDLE }, 3600.0);
    // Close to the room: 0.07 W/K.
    assert_near(2.0 / (plant.hotend_celsius() - 25.0), 0.07, 0.002);
    // At 215 C some 15 W of the 40.
    plant.step(&Drive { hotend: 0.375, ..Drive::IDLE }, 3600.0);
    assert_near(plant.hotend_celsius(), 215.0, 3.0);
}

#[test]
fn what_is_heated_without_end_burns() {
    let mut plant = prototype();
    run(&mut plant, &Drive { hotend: 1.0, ..Drive::IDLE }, 600);
    assert!(plant.hotend_celsius() > 400.0, "{}", plant.hotend_celsius());
    assert!(plant.hottest_celsius() > plant.hotend_celsius() + 20.0);
    let reading = plant.sample(Sensor::Hotend0).unwrap();
    assert!((1..600).contains(&reading), "{reading}");
}

#[test]
fn the_heat_sink_stays_cool_with_its_fan_and_only_then() {
    let hold = Drive { hotend: 0.37, ..Drive::IDLE };
    let mut plant = prototype();
    run(&mut plant, &hold, 1200);
    assert!(plant.sink_celsius() < 40.0, "{}", plant.sink_celsius());
    run(&mut plant, &Drive { hotend_fan: 0.0, ..hold }, 1800);
    assert!(plant.sink_celsius() > 70.0, "{}", plant.sink_celsius());
}

#[test]
fn the_sensor_follows_with_its_lag() {
    let mut plant = hot(200.0);
    plant.hotend_sensor = Thermometer::at(100.0);
    let c = plant.constants.hotend.sensor.clone();
    // Held at 200 C: after one time constant 1/e of the difference is left. 3 Ohm are 0.1 C.
    for _ in 0..240 {
        plant.hotend_sensor.step(&c, SensorFault::None, 200.0, 25.0, 0.005);
    }
    let share = plant.hotend_sensor.share(&c, SensorFault::None, 4700.0);
    let ohm = 4700.0 * share / (1.0 - share);
    assert_near(ohm, Thermistor::semitec_104gt2().ohm(200.0 - 100.0 / core::f64::consts::E), 3.0);
}

#[test]
fn one_long_step_is_as_good_as_many_short_ones() {
    let drive = Drive { hotend: 0.8, bed: 1.0, part_fan: 0.3, flow_mm3_s: 4.0, ..Drive::IDLE };
    let (mut long, mut short) = (prototype(), prototype());
    for _ in 0..30 {
        long.step(&drive, 1.0);
        run(&mut short, &drive, 1);
        assert_near(long.hotend_celsius(), short.hotend_celsius(), 1e-9);
        assert_near(long.bed_celsius(), short.bed_celsius(), 1e-9);
        assert_near(long.hottest_celsius(), short.hottest_celsius(), 1e-9);
        assert_eq!(long.sample(Sensor::Hotend0), short.sample(Sensor::Hotend0));
    }
}

#[test]
fn parts_of_5_ms_are_short_enough() {
    let drive = Drive { hotend: 1.0, bed: 1.0, ..Drive::IDLE };
    let (mut plant, mut fine) = (prototype(), prototype());
    for _ in 0..60 {
        plant.step(&drive, 1.0);
        for _ in 0..10_000 {
            fine.step(&drive, 1e-4);
        }
        assert_near(plant.hotend_celsius(), fine.hotend_celsius(), 0.02);
        assert_near(plant.bed_celsius(), fine.bed_celsius(), 0.02);
    }
}

#[test]
fn no_time_and_no_number_change_nothing() {
    let mut plant = hot(100.0);
    let heat = Drive { hotend: 1.0, ..Drive::IDLE };
    for seconds in [0.0, -1.0, f64::NAN] {
        plant.step(&heat, seconds);
    }
    assert_eq!((plant.hotend_celsius(), plant.hottest_celsius()), (100.0, hot(100.0).hottest_celsius()));
    // A duty that is NaN counts as 0, and one above 1 as 1.
    let (mut nan, mut off) = (hot(100.0), hot(100.0));
    run(&mut nan, &Drive { hotend: f64::NAN, ..Drive::IDLE }, 1);
    run(&mut off, &Drive::IDLE, 1);
    assert_eq!(nan.hotend_celsius(), off.hotend_celsius());
    let (mut two, mut one) = (hot(100.0), hot(100.0));
    run(&mut two, &Drive { hotend: 2.0, ..Drive::IDLE }, 1);
    run(&mut one, &heat, 1);
    assert_eq!(two.hotend_celsius(), one.hotend_celsius());
}

/// 300 W into 5 W/K hold 60 K above the room, independent of the parts between; half of it half.
#[test]
fn a_chamber_comes_to_what_its_power_and_losses_say() {
    let mut constants = PlantConstants::prototype();
    constants.chamber = Some(ChamberConstants::usual());
    for (chamber, celsius) in [(1.0, 85.0), (0.5, 55.0)] {
        let mut plant = Plant::new(&constants);
        plant.step(&Drive { chamber, ..Drive::IDLE }, 6.0 * 3600.0);
        assert_near(plant.chamber_celsius(), celsius, 0.05);
        let sample = f64::from(plant.sample(Sensor::Hotend1).unwrap()) / 65_536.0;
        let ohm = 4700.0 * sample / (1.0 - sample);
        assert_near(ohm, Thermistor::NTC_100K_B3950.ohm(celsius), 0.01 * ohm);
    }
    assert_eq!(prototype().sample(Sensor::Hotend1), None, "the prototype has none");
}

/// The heat flows between the parts, by hand: 2 W/K between plate and air, 3.5 W/K from the plate and 5 from the air to
/// the room.
#[test]
fn things_that_are_coupled_share_their_heat() {
    let mut constants = PlantConstants::prototype();
    constants.chamber = Some(ChamberConstants::usual());
    constants.couplings.bed_chamber = 2.0;
    let mut plant = Plant::new(&constants);
    plant.step(&Drive { bed: 0.5, ..Drive::IDLE }, 12.0 * 3600.0);
    let air = plant.chamber_celsius();
    // Air: 2 (plate - air) = 5 (air - 25). Plate: 250 W = 3.5 (plate - 25) + 2 (plate - air).
    let above = 250.0 / (3.5 + 2.0 * 5.0 / 7.0);
    assert_near(plant.bed_celsius(), 25.0 + above, 0.05);
    assert_near(air, 25.0 + above * 2.0 / 7.0, 0.05);
}

#[test]
fn a_cold_plate_takes_heat_out_of_the_bed() {
    let mut plant = Plant::hot(&PlantConstants::prototype(), 25.0, 60.0);
    plant.lay_plate(20.0, 0.25);
    assert_near(plant.bed_celsius(), (60.0 + 0.25 * 20.0) / 1.25, 1e-9);
}
