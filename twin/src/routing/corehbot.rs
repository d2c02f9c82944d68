//! CoreH-bot: one closed belt through four motors, eight pulleys on the bar and two on the head.
//!
//! The numbers are from the paper's figures 5 and 6c. The side of each pulley and the order of travel reproduce every
//! length of its table 1 and its equations 8, 16, 26 and 33 to 36.

use super::Belt;
use super::stop::Mark::{High, Low, Tool};
use super::stop::Stop;

pub(super) const BELT: Belt = Belt::flat(&STOPS, &["lo", "R", "up", "L"]);

const STOPS: [Stop; 14] = [
    Stop::motor_at(1, Low, Low),
    Stop::outside(2, (Low, 2.0, 0.0), (Tool, 0.0, -1.0)),
    Stop::outside(3, (High, -2.0, 0.0), (Tool, 0.0, -1.0)),
    Stop::motor_at(4, High, Low),
    Stop::inside(5, (High, 0.0, 0.0), (Tool, -2.0, 0.0)),
    Stop::outside(6, (Tool, 0.0, 1.0), (Tool, 0.0, 0.0)),
    Stop::inside(7, (High, 0.0, 0.0), (Tool, 2.0, 0.0)),
    Stop::motor_at(8, High, High),
    Stop::outside(9, (High, -2.0, 0.0), (Tool, 0.0, 1.0)),
    Stop::outside(10, (Low, 2.0, 0.0), (Tool, 0.0, 1.0)),
    Stop::motor_at(11, Low, High),
    Stop::inside(12, (Low, 0.0, 0.0), (Tool, 2.0, 0.0)),
    Stop::outside(13, (Tool, 0.0, -1.0), (Tool, 0.0, 0.0)),
    Stop::inside(14, (Low, 0.0, 0.0), (Tool, -2.0, 0.0)),
];
