//! Tests of wiring.

use super::*;

fn board(uart: Option<Pin>) -> Board {
    let pin = |number| Pin::new(Port::B, number);
    let slot = Slot { step: pin(0), dir: pin(1), enable: pin(2), uart };
    let mut slots = [None; Motor::ALL.len()];
    slots[Motor::M8 as usize] = Some(slot);
    Board {
        name: "",
        crystal: Crystal::Clock8MHz,
        slots,
        reversed: MotorSet::NONE,
        slow: MotorSet::NONE,
        endstops: [pin(3), pin(4), pin(5)],
        probe: None,
        thermistors: &[],
        loads: &[],
        serial: &[],
        has_usb: false,
        eeprom: None,
        marks: &[],
    }
}

#[test]
fn a_uart_pin_has_no_other_job() {
    assert_eq!((board(None).problem(), board(None).uarts()), (None, MotorSet::NONE));
    let free = board(Some(Pin::new(Port::B, 8)));
    assert_eq!((free.problem(), free.uarts()), (None, MotorSet::of(Motor::M8)));
    for taken in [1, 2, 5] {
        assert_eq!(board(Some(Pin::new(Port::B, taken))).problem(), Some("a pin has two jobs"));
    }
    assert!(board(Some(Pin::new(Port::A, 14))).problem().is_some());
}
