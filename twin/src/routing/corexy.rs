//! CoreXY: two belts in two planes that mirror each other, with a motor on each at the front.
//!
//! The layout of the paper's figure 6b, with all segments along x or y. Belt A has motor 1, belt B motor 4. With four
//! motors ("all-wheel drive") each belt has a second one where it leaves the back corner opposite of its first.

use super::Belt;
use super::stop::Mark::{High, Low, Tool};
use super::stop::Stop;

pub(super) const BELTS: [Belt; 2] =
    [Belt::flat(&BELT_A, &["A back", "A front"]), Belt::flat(&BELT_B, &["B front", "B back"])];

pub(super) const AWD_BELTS: [Belt; 2] = [
    Belt::flat(&AWD_BELT_A, &["A right", "A back", "A front"]),
    Belt::flat(&AWD_BELT_B, &["B front", "B back", "B left"]),
];

const A_RIGHT: Stop = Stop::clamp((Tool, 0.0, 1.0), (Tool, -1.0, 1.0));
const A_BAR_BACK: Stop = Stop::inside(5, (High, 0.0, 0.0), (Tool, 0.0, 1.0));
const A_BAR_FRONT: Stop = Stop::outside(2, (Low, 2.0, 0.0), (Tool, 0.0, -1.0));
const A_LEFT: Stop = Stop::clamp((Tool, 0.0, -1.0), (Tool, 1.0, -1.0));

const B_RIGHT: Stop = Stop::clamp((Tool, 0.0, 1.0), (Tool, 1.0, -1.0));
const B_BAR_FRONT: Stop = Stop::outside(3, (High, -2.0, 0.0), (Tool, 0.0, -1.0));
const B_BAR_BACK: Stop = Stop::inside(9, (Low, 0.0, 0.0), (Tool, 0.0, 1.0));
const B_LEFT: Stop = Stop::clamp((Tool, 0.0, -1.0), (Tool, -1.0, 1.0));

const BACK_RIGHT: Stop = Stop::inside(6, (High, 0.0, 0.0), (High, 0.0, 0.0));
const BACK_LEFT: Stop = Stop::inside(10, (Low, 0.0, 0.0), (High, 0.0, 0.0));
const MOTOR_1: Stop = Stop::motor_at(1, Low, Low);
const MOTOR_4: Stop = Stop::motor_at(4, High, Low);
const MOTOR_8: Stop = Stop::motor_at(8, High, High);
const MOTOR_11: Stop = Stop::motor_at(11, Low, High);

const BELT_A: [Stop; 7] = [A_RIGHT, A_BAR_BACK, BACK_RIGHT, BACK_LEFT, MOTOR_1, A_BAR_FRONT, A_LEFT];
const BELT_B: [Stop; 7] = [B_RIGHT, B_BAR_FRONT, MOTOR_4, BACK_RIGHT, BACK_LEFT, B_BAR_BACK, B_LEFT];

const AWD_BELT_A: [Stop; 7] = [A_RIGHT, A_BAR_BACK, MOTOR_8, BACK_LEFT, MOTOR_1, A_BAR_FRONT, A_LEFT];
const AWD_BELT_B: [Stop; 7] = [B_RIGHT, B_BAR_FRONT, MOTOR_4, BACK_RIGHT, MOTOR_11, B_BAR_BACK, B_LEFT];
