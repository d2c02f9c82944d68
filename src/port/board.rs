//! Facts of the board, and its servo.

use crate::connectors::BoardConnectors;

/// Facts of the board. The default methods describe a board with any connectors and no trouble.
pub trait BoardFacts {
    /// The board's connectors.
    fn connectors(&self) -> &'static BoardConnectors {
        &BoardConnectors::ANY
    }

    /// The owner's texts, as [`storage`](crate::storage) has them in an image.
    fn texts(&self) -> &'static [u8] {
        &[]
    }

    /// Why no motor may have power, independent of its driver: the board has no machine, or one for another board.
    fn refusal(&self) -> Option<&'static str> {
        None
    }

    /// Warnings for M122 about protections of this board that do not work.
    fn warnings(&self) -> [Option<&'static str>; 2] {
        [None; 2]
    }

    /// How often since the start a register of the heaters had changed by itself and was set right.
    fn registers_set_right(&self) -> u32 {
        0
    }
}

/// A board with any connectors and no trouble.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnyBoard;

impl BoardFacts for AnyBoard {}

/// The line to a servo, which moves the pin of a BLTouch.
pub trait Servo {
    /// Gives an order: pulses of so many us, every 20 ms, five of them at least. Then the line stays low. `None` ends
    /// an order at once. A later order replaces an earlier one.
    fn order(&mut self, micros: Option<u16>);
}

/// For machines without a servo.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoServo;

impl Servo for NoServo {
    fn order(&mut self, _micros: Option<u16>) {}
}
