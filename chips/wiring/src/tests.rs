//! Tests of wiring.

use super::*;
use corehbot::connectors::{BoardConnectors, ConnectorName};
use corehbot::motors::{MOTORS, prototype};
use corehbot::port::MotorSet;
use corehbot::settings::{Settings, Supply};

const NAMES: BoardConnectors = BoardConnectors {
    sockets: &ConnectorName::all(["X"]),
    inputs: &ConnectorName::all(["X", "Y", "Z"]),
    has_servo: false,
    accelerometer: None,
    ..BoardConnectors::ANY
};

fn board(uart: Option<Pin>) -> Board {
    let pin = |number| Pin::new(Port::B, number);
    let slot = Slot { step: pin(0), dir: pin(1), enable: pin(2), uart };
    Board {
        name: "",
        connectors: &NAMES,
        crystal: Crystal::Clock8MHz,
        sockets: vec![slot].leak(),
        inputs: const { &[Input::plain(Port::B, 3), Input::plain(Port::B, 4), Input::plain(Port::B, 5)] },
        thermistors: &[],
        loads: &[],
        heaters: &[],
        fans: &[],
        supply_pins: &[],
        servo: None,
        accelerometer: None,
        serial: &[],
        has_usb: false,
        eeprom: None,
        has_144_pins: false,
        marks: &[],
    }
}

#[test]
fn a_uart_pin_has_no_other_job() {
    let uarts = |uart| {
        let board: &'static Board = Box::leak(Box::new(board(uart)));
        (board.problem(), board.usual().uarts())
    };
    assert_eq!(uarts(None), (None, MotorSet::NONE));
    assert_eq!(uarts(Some(Pin::new(Port::B, 8))), (None, MotorSet::of(prototype::M1)));
    for taken in [1, 2, 5] {
        assert_eq!(board(Some(Pin::new(Port::B, taken))).problem(), Some("a pin has two jobs"));
    }
    assert!(board(Some(Pin::new(Port::A, 14))).problem().is_some());
}

#[test]
fn there_is_a_name_for_every_socket_and_input() {
    let good = board(None);
    assert!(Board { connectors: &BoardConnectors::ANY, ..good }.problem().is_some());
    assert!(Board { inputs: good.inputs.split_at(2).0, ..good }.problem().is_some());
}

#[test]
fn a_servo_has_a_pin_and_its_timer_for_itself() {
    let with = |servo, heaters| {
        let connectors = &BoardConnectors { has_servo: true, ..NAMES };
        let loads = const { &[Pin::new(Port::B, 9)] };
        Board { connectors: Box::leak(Box::new(*connectors)), servo, heaters, loads, ..board(None) }.problem()
    };
    let [line, taken] = [10, 5].map(|number| Some(Pin::new(Port::B, number)));
    assert_eq!(with(line, &[]), None);
    assert_eq!(with(taken, &[]), Some("a pin has two jobs"));
    assert_eq!(with(None, &[]), Some("the connectors do not say whether there is a servo"));
    let heater = |timer| vec![HeaterPin { output: Output::Bed, pin: Pin::new(Port::B, 9), timer, channel: 1 }].leak();
    assert_eq!(with(line, heater(HeaterTimer::Five)), None);
    assert_eq!(with(line, heater(HeaterTimer::Three)), Some("a servo and a heater share TIM3"));
}

#[test]
fn an_accelerometer_has_pins_of_its_own() {
    let with = |connectors, accelerometer| Board { connectors, accelerometer, ..board(None) }.problem();
    let has = &BoardConnectors { accelerometer: Some("SPI"), ..NAMES };
    let has = Box::leak(Box::new(*has));
    let pins = |first| {
        let [clock, miso, mosi, select] = [0, 1, 2, 3].map(|n: u8| Pin::new(Port::B, first + n));
        Some(SensorPins { clock, miso, mosi, select })
    };
    assert_eq!(with(has, pins(10)), None);
    assert_eq!(with(has, pins(5)), Some("a pin has two jobs"));
    let untold = Some("the connectors do not say whether there is one for an accelerometer");
    assert_eq!((with(has, None), with(&NAMES, pins(10))), (untold, untold));
}

/// Two connectors on one pin, by different circuits, are said to be one line.
#[test]
fn inputs_share_a_pin_if_their_connectors_say_so() {
    const INPUTS: &[Input] = &[Input::plain(Port::B, 3), Input::plain(Port::B, 4), Input::optocoupler(Port::B, 4)];
    const SHARED: BoardConnectors = BoardConnectors { shared_inputs: &[ConnectorName::all(["Z", "Y"])], ..NAMES };
    let with = |connectors, inputs| Board { connectors, inputs, ..board(None) }.problem();
    assert_eq!(with(&SHARED, INPUTS), None);
    let told = Some("inputs share a pin and their connectors do not say so, or the reverse");
    assert_eq!((with(&NAMES, INPUTS), with(&SHARED, board(None).inputs)), (told, told));
}

#[test]
fn the_debug_port_is_taken_by_sockets_that_say_so_alone() {
    fn with(dir: Pin) -> Board {
        let good = board(None);
        Board { sockets: vec![Slot { dir, ..good.sockets[0] }].leak(), ..good }
    }
    assert!(with(DEBUG[1]).problem().is_some_and(|text| text.contains("without being asked")), "not the prototype's");
    assert!(Board { loads: const { &[Pin::new(Port::A, 13)] }, ..board(None) }.problem().is_some());
    assert_eq!(with(Pin::new(Port::A, 12)).problem(), None);
}

#[test]
fn a_heater_has_a_safe_level_a_channel_of_its_own_and_a_port_that_faults_look_at() {
    const BED: HeaterPin =
        HeaterPin { output: Output::Bed, pin: Pin::new(Port::A, 1), timer: HeaterTimer::Five, channel: 2 };
    const LOADS: &[Pin] = &[Pin::new(Port::A, 1), Pin::new(Port::A, 2), Pin::new(Port::B, 15), Pin::new(Port::D, 3)];
    let with = |heaters: &'static [HeaterPin]| Board { loads: LOADS, heaters, ..board(None) };
    const HE0: HeaterPin = HeaterPin { output: Output::He0, pin: Pin::new(Port::A, 2), channel: 3, ..BED };
    const HE1: HeaterPin =
        HeaterPin { output: Output::He1, pin: Pin::new(Port::B, 15), timer: HeaterTimer::Twelve, channel: 2 };
    let good = with(const { &[BED, HE0, HE1] });
    let outputs = OutputSet::NONE.with(Output::Bed).with(Output::He0).with(Output::He1);
    assert_eq!((good.problem(), good.outputs()), (None, outputs));
    assert_eq!(good.heater_outputs(Port::A), 0b0101_0000 >> 2);
    assert_eq!((good.heater_outputs(Port::B), good.heater_outputs(Port::C)), (1 << 30, 0));
    assert!(Board { loads: &[], ..good }.problem().is_some());
    const WRONG: [&[HeaterPin]; 5] = [
        &[BED, HeaterPin { output: Output::He0, ..BED }],
        &[BED, HeaterPin { channel: 3, ..BED }],
        &[HeaterPin { channel: 5, ..BED }],
        &[HeaterPin { channel: 3, ..HE1 }],
        &[HeaterPin { pin: Pin::new(Port::D, 3), ..BED }],
    ];
    assert!(WRONG.into_iter().all(|heaters| with(heaters).problem().is_some()));
}

#[test]
fn two_fans_do_not_share_a_channel() {
    const FAN: FanPin = FanPin { pin: Pin::new(Port::A, 8), timer: FanTimer::One, channel: 1 };
    const OTHER: FanPin = FanPin { timer: FanTimer::Four, ..FAN };
    const LOADS: &[Pin] = &[Pin::new(Port::A, 8)];
    let with = |fans: &'static [FanPin]| Board { loads: LOADS, fans, ..board(None) };
    assert_eq!(with(const { &[FAN, OTHER] }).problem(), None);
    assert!(with(const { &[FAN, FAN] }).problem().is_some());
    const SWITCHED: FanPin = FanPin { timer: FanTimer::None, channel: 0, ..FAN };
    assert_eq!(with(const { &[SWITCHED, SWITCHED] }).problem(), None);
    for wrong in [(FanTimer::Nine, 3), (FanTimer::Two, 1), (FanTimer::OneComplementary, 4)] {
        let fan = FanPin { timer: wrong.0, channel: wrong.1, ..FAN };
        assert!(with(vec![fan].leak()).problem().is_some(), "{wrong:?}");
    }
    assert!(Board { loads: &[], ..with(const { &[FAN] }) }.problem().is_some());
}

/// A pin for the supply's switch has no other job, and a machine chooses one of them.
#[test]
fn a_machine_switches_its_supply_by_one_of_the_pins_or_by_none() {
    const OWN: BoardConnectors =
        BoardConnectors { supply_switches: &ConnectorName::all(["PS-ON", "PE7"]), is_simulated: false, ..NAMES };
    const PINS: [Pin; 2] = [Pin::new(Port::E, 11), Pin::new(Port::E, 7)];
    let good = Board { connectors: &OWN, supply_pins: &PINS, ..board(None) };
    assert_eq!(good.problem(), None);
    assert!(Board { supply_pins: const { &[PINS[0], PINS[0]] }, ..good }.problem().is_some());
    assert!(Board { supply_pins: const { &[PINS[0]] }, ..good }.problem().is_some());
    let board: &'static Board = Box::leak(Box::new(good));
    let switch = |name: &str, is_on_high| {
        let mut machine = Settings::prototype();
        machine.mechanism = corehbot::kinematics::Mechanism { rows: [[0; 4]; MOTORS] };
        let axes = &mut machine.wiring.endstops;
        [axes.x.connector, axes.y.connector, axes.z.connector] = ["X", "Y", "Z"].map(ConnectorName::lit);
        machine.supply = Supply { switch: ConnectorName::lit(name), is_on_high };
        board.plugged(&machine).map(|plugged| plugged.supply_switch)
    };
    let is = |pin, is_on_high| Ok(Some(SupplySwitch { pin, is_on_high }));
    assert_eq!(switch("auto", false), is(PINS[0], false));
    assert_eq!(switch("PE7", true), is(PINS[1], true));
    assert_eq!((switch("none", true), switch("PE8", true).is_err()), (Ok(None), true));
    assert_eq!(board.usual().supply_switch, Some(SupplySwitch { pin: PINS[0], is_on_high: false }));
}
