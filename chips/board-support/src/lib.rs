//! Shared by boards with any chip: the parts of drivers that name no register. A chip's crate has the registers, and
//! calls these.
//!
//! | file | job |
//! |---|---|
//! | `ring`, `receiver_flags` | bytes that DMA takes from a serial line, and the line's errors |
//! | `accelerometer` | set-up and samples of an accelerometer on SPI |
//! | `exchange` | a request to a motor driver and its reply, bit by bit |
//! | `usb_pump`, `usb_traffic` | the buffers of a USB serial port, and the tasks that fill them |
//! | `mcu_temperature` | the processor's own temperature from the readings of its sensor |
//! | `memory` | memory for settings, whichever a board has |
//! | `flash_sectors`, `flash_slot`, `flash_pages` | settings in two sectors of flash |
//!
//! Nothing here needs a processor, so all of it is tested on the host.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod accelerometer;
pub mod exchange;
pub mod flash_pages;
pub mod flash_sectors;
mod flash_slot;
pub mod mcu_temperature;
pub mod memory;
pub mod receiver_flags;
pub mod ring;
pub mod usb_pump;
pub mod usb_traffic;
