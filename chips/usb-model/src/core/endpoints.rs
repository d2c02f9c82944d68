//! Writes to the registers of endpoints: transfers begin, and are ended.

use super::{ENDPOINTS, UsbCore};
use crate::bits as b;
use crate::breach::Breach;
use crate::endpoint::OutEndpoint;

impl UsbCore {
    pub(super) fn write_in(&mut self, n: usize, register: u32, value: u32) {
        let is_enabled = register == b::EPCTL && value & (b::EPENA | b::EPDIS) == b::EPENA;
        let has_areas = !is_enabled || self.check_areas();
        let endpoint = &mut self.ins[n];
        let common = &mut endpoint.common;
        match register {
            b::EPINT => common.flags &= !value,
            b::EPTSIZ if common.is_enabled => self.note(Breach::ChangedTransfer(n)),
            b::EPTSIZ => (common.size, common.packets) = transfer(n, value),
            b::EPCTL => {
                if common.set_control(n, value) {
                    common.flags |= b::INEPNE;
                }
                if value & b::CNAK != 0 {
                    common.flags &= !b::INEPNE;
                }
                if value & b::EPDIS != 0 {
                    self.disable_in(n);
                } else if value & b::EPENA != 0 && !common.is_enabled {
                    endpoint.to_send = common.size;
                    common.is_enabled = true;
                    let checks = [
                        (Breach::InactiveEndpoint(n), !common.is_active),
                        (Breach::StaleWords(n), !endpoint.fifo.is_empty()),
                        (Breach::OtherFifo(n), (value >> 22 & 0xF) as usize != n),
                        (Breach::FifoAreas, !has_areas),
                        (Breach::WrongSize(n), common.packets == 0 || common.size > common.packets * common.longest(n)),
                    ];
                    checks.into_iter().filter(|(_, is_wrong)| *is_wrong).for_each(|(breach, _)| self.note(breach));
                }
            }
            _ => self.note(Breach::NoRegister(b::IN + 0x20 * n as u32 + register)),
        }
    }

    fn disable_in(&mut self, n: usize) {
        let has_global_nak = self.has_global_in_nak;
        let common = &mut self.ins[n].common;
        if !common.is_enabled {
            return self.note(Breach::DisabledIdle(n));
        }
        let is_nak = common.is_nak || has_global_nak;
        (common.is_enabled, common.flags) = (false, common.flags | b::EPDISD);
        if !is_nak {
            self.note(Breach::DisabledWithoutNak(n));
        }
    }

    pub(super) fn write_out(&mut self, n: usize, register: u32, value: u32) {
        let OutEndpoint { common, setups } = &mut self.outs[n];
        match register {
            b::EPINT => common.flags &= !value,
            b::EPTSIZ if common.is_enabled && n != 0 => self.note(Breach::ChangedTransfer(n)),
            b::EPTSIZ => {
                (common.size, common.packets) = transfer(n, value);
                if n == 0 {
                    *setups = value >> 29 & 3;
                }
            }
            b::EPCTL => {
                common.set_control(n, value);
                if value & b::EPDIS != 0 {
                    self.disable_out(n);
                } else if value & b::EPENA != 0 && !common.is_enabled {
                    common.is_enabled = true;
                    let is_active = common.is_active;
                    let is_wrong = common.packets == 0 || common.size < common.packets * common.longest(n);
                    if !is_active {
                        self.note(Breach::InactiveEndpoint(n));
                    }
                    // Endpoint 0 may be enabled for SETUP packets alone.
                    if is_wrong && n != 0 {
                        self.note(Breach::WrongSize(n));
                    }
                }
            }
            _ => self.note(Breach::NoRegister(b::OUT + 0x20 * n as u32 + register)),
        }
    }

    fn disable_out(&mut self, n: usize) {
        let common = &mut self.outs[n].common;
        let breach = match common.is_enabled {
            _ if n == 0 => Some(Breach::DisabledControl),
            false => Some(Breach::DisabledIdle(n)),
            true => {
                (common.is_enabled, common.flags) = (false, common.flags | b::EPDISD);
                (!self.has_global_out_nak).then_some(Breach::DisabledWithoutGlobalNak(n))
            }
        };
        if let Some(breach) = breach {
            self.note(breach);
        }
    }

    /// Whether the areas of all FIFOs with an active endpoint lie apart and in the memory.
    fn check_areas(&self) -> bool {
        let sizes = (0..ENDPOINTS).filter(|&n| self.ins[n].common.is_active).map(|n| self.areas[n]);
        let mut areas: Vec<_> = sizes.map(|area| (area & 0xFFFF, area >> 16)).collect();
        areas.push((0, self.grxfsiz));
        areas.sort_unstable();
        let are_apart = areas.windows(2).all(|pair| pair[0].0 + pair[0].1 <= pair[1].0);
        // At least 16 words (RM0390 rev 6, GRXFSIZ and DIEPTXFx).
        are_apart && areas.iter().all(|(begin, size)| *size >= 16 && begin + size <= b::FIFO_WORDS)
    }
}

/// Bytes and packets of a transfer size register.
fn transfer(n: usize, value: u32) -> (u32, u32) {
    if n == 0 { (value & 0x7F, value >> 19 & 3) } else { (value & 0x7_FFFF, value >> 19 & 0x3FF) }
}
