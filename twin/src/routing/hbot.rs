//! H-bot: one belt from the head around the whole frame and back to it, with two motors at the front.
//!
//! The paper's figure 6a has the head as a point. Here the belt's clamps are the head's pulley distance apart. Motors
//! have the numbers of their corners on a CoreH-bot; the other pulleys are numbered in the belt's order.

use super::Belt;
use super::stop::Mark::{High, Low, Tool};
use super::stop::Stop;

pub(super) const BELT: Belt = Belt::flat(&STOPS, &["right", "back", "left"]);

const STOPS: [Stop; 10] = [
    Stop::clamp((Tool, 0.0, 1.0), (Tool, 1.0, -1.0)),
    Stop::outside(2, (High, -2.0, 0.0), (Tool, 0.0, -1.0)),
    Stop::motor_at(4, High, Low),
    Stop::inside(5, (High, 0.0, 0.0), (High, 0.0, 0.0)),
    Stop::outside(6, (High, -2.0, 0.0), (Tool, 0.0, 1.0)),
    Stop::outside(7, (Low, 2.0, 0.0), (Tool, 0.0, 1.0)),
    Stop::inside(8, (Low, 0.0, 0.0), (High, 0.0, 0.0)),
    Stop::motor_at(1, Low, Low),
    Stop::outside(9, (Low, 2.0, 0.0), (Tool, 0.0, -1.0)),
    Stop::clamp((Tool, 0.0, -1.0), (Tool, 1.0, -1.0)),
];
