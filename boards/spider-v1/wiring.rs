//! The wiring of the Fysetc Spider V1.0 to V2.1: the Spider V2.2 with FAN0 and FAN1 on timers (Fysetc's README, pin
//! definition of V1.x; Klipper's generic-fysetc-spider.cfg). Where those versions have PB0 and PB1, V2.2 has inputs of
//! thermistors.

use crate::{Entry, Printed, spider};
use corehbot::connectors::BoardConnectors;
use corehbot_wiring::{Board, FanPin, FanTimer, Mark, Pin, Port};

/// The names printed on it.
pub const CONNECTORS: BoardConnectors = BoardConnectors {
    key: "spider-v1",
    name: "Fysetc Spider V1",
    fans: &[Some(1), Some(1), None],
    ..spider::CONNECTORS
};

/// The board.
pub static BOARD: Board = Board {
    name: "Fysetc Spider V1.0 to V2.1",
    connectors: &CONNECTORS,
    loads: &spider::loads(FANS),
    fans: &[
        FanPin { pin: FANS[0], timer: FanTimer::OneComplementary, channel: 2 },
        FanPin { pin: FANS[1], timer: FanTimer::OneComplementary, channel: 3 },
        spider::FAN2,
    ],
    // Gates, which no resistor pulls up. On V2.2 and V2.3 they are TB and TE4 with 4.7 kOhm to 3.3 V, so an input
    // without a sensor, or with a cold one, is high.
    marks: &[Mark::not_up(&FANS)],
    ..spider::BOARD
};

/// FAN0 and FAN1.
const FANS: [Pin; 2] = [Pin::new(Port::B, 0), Pin::new(Port::B, 1)];

/// The way of an image onto it.
pub const ENTRY: Entry = Entry {
    board: &BOARD,
    printed: Printed { heaters: &[spider::E2], sensors: &[], headers: spider::HEADERS, namesakes: spider::NAMESAKES },
    ..spider::ENTRY
};
