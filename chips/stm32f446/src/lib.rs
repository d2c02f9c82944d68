//! Shared by boards with an STM32F446: everything except pins.
//!
//! A board is a [`Board`](wiring::Board), a table of pins (`chips/wiring`). An [`Image`](wiring::Image) lists one or
//! several boards. It calls `run` with these boards and with the settings memory that they have.
//!
//! | priority | context | runs |
//! |---|---|---|
//! | 0x00 | SysTick | Stepper; nothing masks it |
//! | 0x00 | PVD | the end, when the supply falls |
//! | 0x20 | TIM3, during an order to a BLTouch | the edges of its pulses |
//! | 0x40 | USART1 and 2, DMA2 and DMA1 stream 5, OTG_FS, TIM2 | bytes, USB packets, time |
//! | 0x40 | TIM7, every 0.5 ms if a fan has a tachometer | its pulses |
//! | 0x40 | TIM6 and DMA1 stream 0, while an accelerometer is read | its transfers |
//! | 0x40 | TIM8, during an exchange with a motor driver | its bits |
//! | 0x80 | CAN2_SCE, pended by software | StepGenerator |
//! | 0xC0 | TIM5, at the end of the heaters' pulses, every 20 ms | ThermalControl, which feeds the watchdog |
//! | thread | embassy executor | Console; USB |
//!
//! **Safe levels** are the levels of all outputs at which no motor has power and nothing heats (`safe_levels`). An
//! **exchange** is a request to a motor driver and its reply (`exchange` of `chips/board-support`, which has all that
//! names no register). A value that start-up makes and one
//! interrupt handler uses is in a `Handover` of `chips/cortex-m4`.
//!
//! `unsafe` stays in `fault`, `flash`, `otg`, `panic_path`, `priorities`, `ram_walk`, `reference_voltage`,
//! `reset_reason`, `stack_guard`, `step_timer`, `stepper` and `time`.
#![cfg_attr(target_os = "none", no_std)]

pub use corehbot_wiring as wiring;

pub mod fan_cycle;
pub mod heater_pulses;
pub mod resources;

#[cfg(any(test, target_os = "none"))]
mod interrupt_storm;

#[cfg(target_os = "none")]
mod accelerometer;
#[cfg(target_os = "none")]
mod after_bootloader;
#[cfg(target_os = "none")]
mod assembly;
#[cfg(target_os = "none")]
mod board_facts;
#[cfg(target_os = "none")]
mod board_heat;
#[cfg(target_os = "none")]
mod board_storage;
#[cfg(target_os = "none")]
mod bus;
#[cfg(target_os = "none")]
mod clock_check;
#[cfg(target_os = "none")]
mod clocks;
#[cfg(target_os = "none")]
mod console_waker;
#[cfg(target_os = "none")]
mod contexts;
#[cfg(target_os = "none")]
mod driver_uart;
#[cfg(target_os = "none")]
mod drivers;
#[cfg(target_os = "none")]
mod eeprom;
#[cfg(target_os = "none")]
mod fans;
#[cfg(target_os = "none")]
mod fault;
#[cfg(target_os = "none")]
mod flash;
#[cfg(target_os = "none")]
mod handles;
#[cfg(target_os = "none")]
mod heater_registers;
#[cfg(target_os = "none")]
mod heater_timer;
#[cfg(target_os = "none")]
mod host_serial;
#[cfg(target_os = "none")]
mod image;
#[cfg(target_os = "none")]
mod machine_at_start;
#[cfg(target_os = "none")]
mod motor_power;
#[cfg(target_os = "none")]
mod narrow_heaters;
#[cfg(target_os = "none")]
mod otg;
#[cfg(target_os = "none")]
mod panic_path;
#[cfg(target_os = "none")]
mod pin_scrub;
#[cfg(target_os = "none")]
mod plain_serial;
#[cfg(target_os = "none")]
mod ports;
#[cfg(target_os = "none")]
mod priorities;
#[cfg(target_os = "none")]
mod ram_walk;
#[cfg(target_os = "none")]
mod receiver;
#[cfg(target_os = "none")]
mod reference_voltage;
#[cfg(target_os = "none")]
mod reset_reason;
#[cfg(target_os = "none")]
mod safe_levels;
#[cfg(target_os = "none")]
mod servo;
#[cfg(target_os = "none")]
mod stack_guard;
#[cfg(target_os = "none")]
mod start;
#[cfg(target_os = "none")]
mod step_pins;
#[cfg(target_os = "none")]
mod step_timer;
#[cfg(target_os = "none")]
mod stepper;
#[cfg(target_os = "none")]
mod supply;
#[cfg(target_os = "none")]
mod tachometers;
#[cfg(target_os = "none")]
mod thermistors;
#[cfg(target_os = "none")]
mod time;
#[cfg(target_os = "none")]
mod usart;
#[cfg(target_os = "none")]
mod usb;
#[cfg(target_os = "none")]
mod wake;
#[cfg(target_os = "none")]
mod watchdog;

#[cfg(target_os = "none")]
pub use eeprom::eeprom;
#[cfg(target_os = "none")]
pub use flash::flash;
#[cfg(target_os = "none")]
pub use start::run;
