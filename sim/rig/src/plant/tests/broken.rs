//! Each fault has its described effect, and no other.

use super::*;

/// Full scale: 16 times 4095.
const FULL: Option<u16> = Some(65_520);

const HEAT: Drive = Drive { hotend: 1.0, bed: 1.0, ..Drive::IDLE };

/// The reading of the hotend's sensor at `celsius`, without noise.
fn reads(celsius: f64) -> f64 {
    let ohm = Thermistor::semitec_104gt2().ohm(celsius);
    65_536.0 * ohm / (ohm + 4700.0)
}

fn sample(plant: &mut Plant) -> f64 {
    f64::from(plant.sample(Sensor::Hotend0).unwrap())
}

#[test]
fn wires_off_and_shorted() {
    let mut plant = hot(200.0);
    for (fault, reading) in
        [(SensorFault::Open, FULL), (SensorFault::ShortToSupply, FULL), (SensorFault::ShortToGround, Some(0))]
    {
        plant.faults().hotend_sensor = fault;
        for _ in 0..1000 {
            // Noise only ever pulls a reading off the stop.
            let is = plant.sample(Sensor::Hotend0).unwrap();
            assert!(is.abs_diff(reading.unwrap()) < 16, "{fault:?}: {is}");
        }
        assert_near(f64::from(plant.sample(Sensor::Bed).unwrap()), 62_594.0, 16.0);
    }
    plant.faults().hotend_sensor = SensorFault::None;
    assert_near(sample(&mut plant), reads(200.0), 16.0);
}

#[test]
fn a_frozen_reading_stays_to_the_bit_until_it_thaws() {
    let mut plant = hot(150.0);
    plant.faults().hotend_sensor = SensorFault::Frozen;
    let frozen = plant.sample(Sensor::Hotend0);
    assert_near(f64::from(frozen.unwrap()), reads(150.0), 16.0);
    for _ in 0..500 {
        plant.step(&HEAT, 0.02);
        assert_eq!(plant.sample(Sensor::Hotend0), frozen);
    }
    assert!(plant.hotend_celsius() > 170.0);
    plant.faults().hotend_sensor = SensorFault::None;
    assert!(sample(&mut plant) < f64::from(frozen.unwrap()) - 100.0);
    plant.faults().hotend_sensor = SensorFault::Frozen;
    assert_ne!(plant.sample(Sensor::Hotend0), frozen);
}

#[test]
fn a_loose_contact_opens_for_its_part_of_each_period() {
    let mut plant = hot(200.0);
    plant.faults().hotend_sensor = SensorFault::Intermittent { period_seconds: 2.0, open_seconds: 0.3 };
    let mut open = 0;
    for _ in 0..1000 {
        plant.step(&Drive { hotend: 0.35, ..Drive::IDLE }, 0.02);
        open += u32::from(plant.sample(Sensor::Hotend0).unwrap() > 60_000);
    }
    // 20 s: ten periods, 15 readings each.
    assert!(open.abs_diff(150) <= 10, "{open}");
}

#[test]
fn a_sensor_that_slipped_out_cools_to_the_room() {
    let mut plant = hot(200.0);
    plant.faults().hotend_sensor = SensorFault::Slipped { lag_seconds: 10.0 };
    run(&mut plant, &HEAT, 10);
    assert_near(sample(&mut plant), reads(25.0 + 175.0 / core::f64::consts::E), 32.0);
    run(&mut plant, &HEAT, 190);
    assert_near(sample(&mut plant), reads(25.0), 32.0);
    assert!(plant.hotend_celsius() > 320.0);
}

#[test]
fn a_sensor_that_leaves_its_hole_shows_a_share_of_the_rise() {
    let mut plant = hot(200.0);
    plant.faults().hotend_sensor = SensorFault::Leaves { share: 0.5, seconds: 600.0 };
    run(&mut plant, &Drive { hotend: 0.35, ..Drive::IDLE }, 300);
    let shown = |plant: &Plant, share: f64| 25.0 + share * (plant.hotend_celsius() - 25.0);
    assert_near(sample(&mut plant), reads(shown(&plant, 0.75)), 64.0);
    run(&mut plant, &Drive { hotend: 0.35, ..Drive::IDLE }, 600);
    assert_near(sample(&mut plant), reads(shown(&plant, 0.5)), 64.0);
}

#[test]
fn a_plug_that_corrodes_reads_colder() {
    let mut plant = hot(200.0);
    plant.faults().hotend_sensor = SensorFault::Series { ohm: 300.0, seconds: 60.0 };
    run(&mut plant, &Drive { hotend: 0.35, ..Drive::IDLE }, 90);
    let ohm = Thermistor::semitec_104gt2().ohm(plant.hotend_celsius()) + 300.0;
    assert_near(sample(&mut plant), 65_536.0 * ohm / (ohm + 4700.0), 64.0);
}

#[test]
fn a_cartridge_that_slides_out_gets_hot_and_its_block_does_not() {
    let mut plant = hot(200.0);
    plant.faults().hotend_heater.contact = 0.05 / 1.5;
    // The power that holds a sound one at 200 C.
    run(&mut plant, &Drive { hotend: 0.35, ..Drive::IDLE }, 60);
    let [block, cartridge] = [plant.hotend_celsius(), plant.hottest_celsius()];
    assert!(block < 180.0 && cartridge > 400.0, "{block} {cartridge}");
}

#[test]
fn a_leaky_switch_heats_a_little_until_the_supply_goes() {
    let mut plant = prototype();
    plant.faults().hotend_heater = HeaterFault::LEAKY;
    let watts =
        |plant: &Plant, hotend: f64, supply_on: bool| plant.watts(&Drive { hotend, supply_on, ..Drive::IDLE })[0];
    assert_near(watts(&plant, 0.0, true), 12.0, 1e-9);
    assert_eq!([watts(&plant, 1.0, true), watts(&plant, 0.0, false)], [40.0, 0.0]);
}

#[test]
fn a_badly_seated_sensor_lags() {
    let (mut good, mut bad) = (hot(200.0), hot(200.0));
    bad.faults().hotend_sensor = SensorFault::ExtraLag { lag_seconds: 18.8 };
    run(&mut good, &HEAT, 60);
    run(&mut bad, &HEAT, 60);
    assert_eq!(good.hotend_celsius(), bad.hotend_celsius());
    assert!(sample(&mut bad) > sample(&mut good) + 50.0);
}

#[test]
fn a_thermistor_of_10_kilo_ohm_reads_hot() {
    let mut plant = prototype();
    plant.faults().bed_sensor = SensorFault::TenKiloOhm;
    assert_near(f64::from(plant.sample(Sensor::Bed).unwrap()), 65_536.0 * 10.0 / 14.7, 16.0);
}

#[test]
fn swapped_sensors_read_each_other_with_their_faults() {
    let mut plant = hot(200.0);
    plant.faults().swapped_sensors = true;
    assert_near(f64::from(plant.sample(Sensor::Bed).unwrap()), reads(200.0), 16.0);
    assert_near(sample(&mut plant), 62_594.0, 16.0);
    plant.faults().hotend_sensor = SensorFault::ShortToGround;
    assert!(plant.sample(Sensor::Bed).unwrap() < 16);
}

#[test]
fn swapped_heaters_heat_each_other() {
    let mut plant = prototype();
    plant.faults().swapped_heaters = true;
    run(&mut plant, &Drive { hotend: 1.0, ..Drive::IDLE }, 30);
    assert_eq!(plant.hotend_celsius(), 25.0);
    assert!(plant.bed_celsius() > 30.0);
    // The switch stays with its output.
    plant.faults().hotend_heater = HeaterFault::STUCK_ON;
    let before = plant.bed_celsius();
    run(&mut plant, &Drive::IDLE, 30);
    assert_eq!(plant.hotend_celsius(), 25.0);
    assert!(plant.bed_celsius() > before + 5.0);
}

#[test]
fn open_weak_and_undersupplied_heaters() {
    let power = |change: &dyn Fn(&mut PlantFaults)| {
        let mut plant = prototype();
        change(plant.faults());
        plant.watts(&HEAT)
    };
    assert_eq!(power(&|_| ()), [40.0, 500.0, 0.0]);
    assert_eq!(power(&|f| f.hotend_heater = HeaterFault::OPEN), [0.0, 500.0, 0.0]);
    assert_eq!(power(&|f| f.bed_heater.power = 0.5), [40.0, 250.0, 0.0]);
    // 18 V of 24: nine sixteenths.
    assert_eq!(power(&|f| f.supply_volts = 18.0), [22.5, 281.25, 0.0]);
}

#[test]
fn a_stuck_switch_heats_until_the_supply_goes() {
    for is_bed in [false, true] {
        let mut plant = prototype();
        let f = plant.faults();
        *(if is_bed { &mut f.bed_heater } else { &mut f.hotend_heater }) = HeaterFault::STUCK_ON;
        assert_eq!(plant.watts(&Drive::IDLE), if is_bed { [0.0, 500.0, 0.0] } else { [40.0, 0.0, 0.0] });
        assert_eq!(plant.watts(&Drive { supply_on: false, ..HEAT }), [0.0; 3]);
        run(&mut plant, &Drive::IDLE, 120);
        assert!(if is_bed { plant.bed_celsius() > 50.0 } else { plant.hotend_celsius() > 200.0 });
    }
}

#[test]
fn fans_stop_when_broken_or_without_supply() {
    let cooled = |change: &dyn Fn(&mut PlantFaults), drive: Drive| {
        let mut plant = hot(200.0);
        change(plant.faults());
        run(&mut plant, &drive, 60);
        (plant.hotend_celsius(), plant.sink_celsius())
    };
    let blow = Drive { part_fan: 1.0, ..Drive::IDLE };
    let (blown, _) = cooled(&|_| (), blow);
    let (still, cool) = cooled(&|f| f.part_fan_broken = true, blow);
    assert!(still > blown + 10.0, "{still}, {blown}");
    assert_eq!((still, cool), cooled(&|_| (), Drive::IDLE));
    let (_, warm) = cooled(&|f| f.hotend_fan_broken = true, Drive::IDLE);
    assert!(warm > cool + 1.0, "{warm}, {cool}");
    assert_eq!(cooled(&|_| (), Drive { supply_on: false, ..blow }).1, warm);
}

#[test]
fn a_shifted_reference_moves_vrefint_and_nothing_else() {
    let (mut plant, mut other) = (prototype(), prototype());
    other.faults().vdda_volts = 2.97;
    assert_near(f64::from(plant.vref_sample().unwrap()), 65_536.0 * 1.21 / 3.3, 16.0);
    assert_near(f64::from(other.vref_sample().unwrap()), 65_536.0 * 1.21 / 2.97, 16.0);
    for (sensor, _) in Sensor::ALL {
        assert_eq!(plant.sample(sensor), other.sample(sensor));
    }
}

#[test]
fn a_stopped_converter_says_nothing() {
    let mut plant = prototype();
    plant.faults().converter_stopped = true;
    assert_eq!((plant.sample(Sensor::Bed), plant.sample(Sensor::Hotend0), plant.vref_sample()), (None, None, None));
    plant.faults().converter_stopped = false;
    assert!(plant.sample(Sensor::Bed).is_some());
}

#[test]
fn a_slipped_sequence_shows_the_following_channel() {
    let mut plant = hot(200.0);
    plant.faults().channels_slipped = true;
    assert_near(f64::from(plant.sample(Sensor::Bed).unwrap()), reads(200.0), 16.0);
    assert_near(sample(&mut plant), 65_536.0 * 1.21 / 3.3, 16.0);
    assert_near(f64::from(plant.vref_sample().unwrap()), 62_594.0, 16.0);
}

#[test]
fn a_cold_room_cools_everything() {
    let mut plant = prototype();
    plant.faults().ambient_celsius = -5.0;
    plant.step(&Drive::IDLE, 4.0 * 3600.0);
    assert_near(plant.hotend_celsius(), -5.0, 1e-6);
    assert_near(plant.bed_celsius(), -5.0, 1e-3);
}
