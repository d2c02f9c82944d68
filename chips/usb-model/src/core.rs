//! The core as its program sees it: registers, FIFO windows and the interrupt line.

mod endpoints;

use crate::bits as b;
use crate::breach::Breach;
use crate::endpoint::{Endpoint, InEndpoint, OutEndpoint};
use crate::fifo::{ReceiveFifo, Status};

/// Endpoints of each direction (RM0390 rev 6, section 31.3).
pub const ENDPOINTS: usize = 6;

/// GUSBCFG, GRXFSIZ, DIEPTXF0 and DIEPTXFx after a reset.
const USB_CONFIGURATION: u32 = 0x0000_1440;
const FIFO_SIZE: u32 = 0x0000_0200;
const FIRST_AREA: u32 = 0x0200_0200;
const OTHER_AREA: u32 = 0x0200_0400;

/// Core identification of the F446.
const IDENTITY: u32 = 0x0000_2000;

/// Full speed, as ENUMSPD of DSTS.
const FULL_SPEED: u32 = 3 << 1;

/// Words that a packet for an OUT endpoint leaves free: ten for SETUP packets and one for the global NAK (RM0390 rev 6,
/// section 31.11.3).
const RESERVED: usize = 11;

/// The USB core.
#[derive(Clone, Debug)]
pub struct UsbCore {
    pub(crate) gotgctl: u32,
    pub(crate) gotgint: u32,
    gahbcfg: u32,
    pub(crate) gusbcfg: u32,
    grstctl: u32,
    /// The flags of GINTSTS that stay until they are cleared.
    pub(crate) flags: u32,
    gintmsk: u32,
    grxfsiz: u32,
    areas: [u32; ENDPOINTS],
    gccfg: u32,
    pub(crate) dcfg: u32,
    /// The address that it answers to; a new one counts after the next status stage.
    pub(crate) address: u8,
    pub(crate) dctl: u32,
    diepmsk: u32,
    doepmsk: u32,
    daintmsk: u32,
    diepempmsk: u32,
    pcgcctl: u32,
    pub(crate) is_suspended: bool,
    pub(crate) frame: u16,
    pub(crate) has_global_in_nak: bool,
    pub(crate) has_global_out_nak: bool,
    /// A SETUP packet came, and no token after it.
    pub(crate) is_in_setup: bool,
    pub(crate) received: ReceiveFifo,
    pub(crate) ins: [InEndpoint; ENDPOINTS],
    pub(crate) outs: [OutEndpoint; ENDPOINTS],
    /// The endpoint that gets the words of a packet just now, and how many are left of it.
    writing: Option<(usize, u32)>,
    /// A flush of a transmit FIFO never ends.
    is_flush_stuck: bool,
    breaches: Vec<Breach>,
}

impl Default for UsbCore {
    fn default() -> Self {
        Self::new()
    }
}

impl UsbCore {
    /// A core after a reset.
    #[must_use]
    pub fn new() -> Self {
        let mut areas = [OTHER_AREA; ENDPOINTS];
        areas[0] = FIRST_AREA;
        Self {
            gotgctl: 0,
            gotgint: 0,
            gahbcfg: 0,
            gusbcfg: USB_CONFIGURATION,
            grstctl: b::AHBIDL,
            flags: 0,
            gintmsk: 0,
            grxfsiz: FIFO_SIZE,
            areas,
            gccfg: 0,
            dcfg: 0,
            address: 0,
            dctl: b::SDIS,
            diepmsk: 0,
            doepmsk: 0,
            daintmsk: 0,
            diepempmsk: 0,
            pcgcctl: 0,
            is_suspended: false,
            frame: 0,
            has_global_in_nak: false,
            has_global_out_nak: false,
            is_in_setup: false,
            received: ReceiveFifo::default(),
            ins: std::array::from_fn(|n| InEndpoint { common: Endpoint::new(n), ..InEndpoint::default() }),
            outs: std::array::from_fn(|n| OutEndpoint { common: Endpoint::new(n), ..OutEndpoint::default() }),
            writing: None,
            is_flush_stuck: false,
            breaches: Vec::new(),
        }
    }

    /// The reset line of the clock controller (OTGFSRST): all registers as after a reset. What was noted stays.
    pub fn reset(&mut self) {
        let breaches = std::mem::take(&mut self.breaches);
        *self = Self { breaches, ..Self::new() };
    }

    /// What the program did against the manual so far.
    #[must_use]
    pub fn breaches(&self) -> &[Breach] {
        &self.breaches
    }

    /// Breaks the flush of transmit FIFOs: it never ends.
    pub fn break_flush(&mut self) {
        self.is_flush_stuck = true;
    }

    /// Puts an entry into the receive FIFO that no bus makes: PKTSTS, endpoint and data.
    pub fn inject(&mut self, status: u32, endpoint: usize, data: &[u8]) {
        self.received.push_any(status & 0xF, endpoint & 0xF, false, data);
    }

    pub(crate) fn note(&mut self, breach: Breach) {
        if !self.breaches.contains(&breach) {
            self.breaches.push(breach);
        }
    }

    /// Whether the interrupt line is high.
    #[must_use]
    pub fn is_pending(&self) -> bool {
        self.gahbcfg & b::GINT != 0 && self.status() & self.gintmsk != 0
    }

    /// Reads the register, or a word of the receive FIFO, at `offset` from the core's base.
    pub fn read(&mut self, offset: u32) -> u32 {
        if offset >= b::FIFO {
            return self.received.read().unwrap_or_else(|| {
                self.note(Breach::EmptyRead);
                0
            });
        }
        self.interrupt_words();
        if offset == b::GRXSTSP {
            return self.pop();
        }
        self.peek(offset).unwrap_or_else(|| {
            self.note(Breach::NoRegister(offset));
            0
        })
    }

    /// What [`UsbCore::read`] would answer, with nothing changed.
    #[must_use]
    pub fn peek(&self, offset: u32) -> Option<u32> {
        if let Some((n, register)) = endpoint_at(offset, b::IN) {
            return Some(match register {
                b::EPCTL => self.ins[n].common.control(),
                b::EPINT => self.in_flags(n),
                b::EPTSIZ => self.ins[n].common.packets << 19 | self.ins[n].common.size,
                b::DTXFSTS => self.space(n),
                _ => return None,
            });
        }
        if let Some((n, register)) = endpoint_at(offset, b::OUT) {
            let OutEndpoint { common, setups } = &self.outs[n];
            return Some(match register {
                b::EPCTL => common.control(),
                b::EPINT => common.flags,
                b::EPTSIZ => setups << 29 | common.packets << 19 | common.size,
                _ => return None,
            });
        }
        Some(match offset {
            b::GOTGCTL => self.gotgctl,
            b::GOTGINT => self.gotgint,
            b::GAHBCFG => self.gahbcfg,
            b::GUSBCFG => self.gusbcfg,
            b::GRSTCTL => self.grstctl,
            b::GINTSTS => self.status(),
            b::GINTMSK => self.gintmsk,
            b::GRXSTSR | b::GRXSTSP => self.received.front(),
            b::GRXFSIZ => self.grxfsiz,
            b::DIEPTXF0 => self.areas[0],
            b::DIEPTXF1..0x118 => *self.areas.get((offset - b::DIEPTXF1) as usize / 4 + 1)?,
            b::GCCFG => self.gccfg,
            b::CID => IDENTITY,
            b::DCFG => self.dcfg,
            b::DCTL => self.dctl | self.global_naks(),
            b::DSTS => u32::from(self.is_suspended) | FULL_SPEED | u32::from(self.frame) << 8,
            b::DIEPMSK => self.diepmsk,
            b::DOEPMSK => self.doepmsk,
            b::DAINT => self.endpoint_interrupts(),
            b::DAINTMSK => self.daintmsk,
            b::DIEPEMPMSK => self.diepempmsk,
            b::PCGCCTL => self.pcgcctl,
            _ => return None,
        })
    }

    /// Writes the register, or a word of a transmit FIFO, at `offset` from the core's base.
    pub fn write(&mut self, offset: u32, value: u32) {
        if offset >= b::FIFO {
            return self.write_word(((offset - b::FIFO) / 0x1000) as usize, value);
        }
        self.interrupt_words();
        if let Some((n, register)) = endpoint_at(offset, b::IN) {
            return self.write_in(n, register, value);
        }
        if let Some((n, register)) = endpoint_at(offset, b::OUT) {
            return self.write_out(n, register, value);
        }
        match offset {
            b::GOTGCTL => self.gotgctl = value,
            b::GOTGINT => self.gotgint &= !value,
            b::GAHBCFG => self.gahbcfg = value,
            b::GUSBCFG => self.gusbcfg = value,
            b::GRSTCTL => self.write_reset(value),
            b::GINTSTS => self.flags &= !(value & b::CLEARABLE),
            b::GINTMSK => self.gintmsk = value,
            b::GRXFSIZ => self.grxfsiz = self.resized(value),
            b::DIEPTXF0 => self.areas[0] = self.resized(value),
            b::DIEPTXF1..0x118 if offset.is_multiple_of(4) => {
                self.areas[(offset - b::DIEPTXF1) as usize / 4 + 1] = self.resized(value);
            }
            b::GCCFG => self.gccfg = value,
            b::DCFG => {
                self.dcfg = value;
                if self.own_address() == 0 {
                    self.address = 0;
                }
            }
            b::DCTL => self.write_control(value),
            b::DIEPMSK => self.diepmsk = value,
            b::DOEPMSK => self.doepmsk = value,
            b::DAINTMSK => self.daintmsk = value,
            b::DIEPEMPMSK => self.diepempmsk = value,
            b::PCGCCTL => self.pcgcctl = value,
            _ => self.note(Breach::NoRegister(offset)),
        }
    }

    /// DAD of DCFG.
    pub(crate) fn own_address(&self) -> u8 {
        (self.dcfg >> 4 & 0x7F) as u8
    }

    /// GINTSTS.
    fn status(&self) -> u32 {
        let interrupts = self.endpoint_interrupts() & self.daintmsk;
        let levels = [
            (b::OTGINT, self.gotgint != 0),
            (b::RXFLVL, self.received.has_entry()),
            (b::GINAKEFF, self.has_global_in_nak),
            (b::GONAKEFF, self.has_global_out_nak),
            (b::IEPINT, interrupts & 0xFFFF != 0),
            (b::OEPINT, interrupts >> 16 != 0),
        ];
        levels.into_iter().filter(|(_, is_set)| *is_set).fold(b::QUIET | self.flags, |word, (bit, _)| word | bit)
    }

    /// GINSTS and GONSTS of DCTL.
    fn global_naks(&self) -> u32 {
        u32::from(self.has_global_in_nak) << 2 | u32::from(self.has_global_out_nak) << 3
    }

    /// DAINT.
    fn endpoint_interrupts(&self) -> u32 {
        let in_mask =
            |n: usize| if self.diepempmsk >> n & 1 != 0 { self.diepmsk | b::TXFE } else { self.diepmsk & !b::TXFE };
        let ins = (0..ENDPOINTS).filter(|&n| self.in_flags(n) & in_mask(n) != 0).fold(0, |word, n| word | 1 << n);
        let has_out = |n: usize| self.outs[n].common.flags & self.doepmsk != 0;
        (0..ENDPOINTS).filter(|&n| has_out(n)).fold(ins, |word, n| word | 1 << (n + 16))
    }

    /// DIEPINTn.
    fn in_flags(&self, n: usize) -> u32 {
        let (space, all) = (self.space(n), self.areas[n] >> 16);
        let is_empty = if self.gahbcfg & b::TXFELVL != 0 { space == all } else { 2 * space >= all };
        self.ins[n].common.flags | if is_empty { b::TXFE } else { 0 }
    }

    /// Free words of a transmit FIFO.
    fn space(&self, n: usize) -> u32 {
        (self.areas[n] >> 16).saturating_sub(self.ins[n].fifo.len() as u32)
    }

    /// Whether a packet of `bytes` fits the receive FIFO. A SETUP packet may use the reserved words.
    pub(crate) fn has_room(&self, bytes: usize, is_setup: bool) -> bool {
        let reserved = if is_setup { 0 } else { RESERVED };
        // Its words, its status, and the entry of the end of the transfer.
        self.received.words() + bytes.div_ceil(4) + 2 + reserved <= self.grxfsiz as usize
    }

    /// GRXSTSP.
    fn pop(&mut self) -> u32 {
        if self.received.unread() > 0 {
            self.note(Breach::UnreadWords(self.received.unread()));
        }
        let Some((word, status, n)) = self.received.pop() else { return 0 };
        if status == Status::GlobalNak as u32 {
            self.has_global_out_nak = true;
        }
        let flags = [(Status::OutDone, b::XFRC), (Status::SetupDone, b::STUP)];
        let flag = flags.into_iter().find(|(kind, _)| *kind as u32 == status);
        if let Some(((_, flag), out)) = flag.zip(self.outs.get_mut(n)) {
            (out.common.flags, out.common.is_enabled) = (out.common.flags | flag, false);
        }
        word
    }

    /// Another access comes between the words of a packet.
    fn interrupt_words(&mut self) {
        if let Some((n, _)) = self.writing.take() {
            self.note(Breach::InterruptedWords(n));
        }
    }

    fn write_word(&mut self, n: usize, value: u32) {
        if n >= ENDPOINTS {
            return self.note(Breach::NoRegister(b::FIFO + 0x1000 * n as u32));
        }
        let has_space = self.space(n) > 0;
        let endpoint = &mut self.ins[n];
        if !endpoint.common.is_enabled || endpoint.common.size == 0 {
            return self.note(Breach::UnneededWord(n));
        }
        if !has_space {
            return self.note(Breach::TransmitOverflow(n));
        }
        let longest = endpoint.common.longest(n).max(1);
        let left = match self.writing {
            Some((other, left)) if other == n => left,
            _ => endpoint.common.size.min(longest),
        };
        endpoint.fifo.push_back(value);
        endpoint.common.size = endpoint.common.size.saturating_sub(4);
        let is_other = self.writing.is_some_and(|(other, _)| other != n);
        self.writing = (left > 4).then(|| (n, left - 4));
        if is_other {
            self.note(Breach::InterruptedWords(n));
        }
    }

    fn write_reset(&mut self, value: u32) {
        if value & b::CSRST != 0 {
            return self.reset();
        }
        let stuck = if self.is_flush_stuck { value & b::TXFFLSH } else { 0 };
        self.grstctl = b::AHBIDL | value & 0x7C0 | stuck;
        if value & b::RXFFLSH != 0 {
            let is_in_use = self.outs.iter().any(|out| out.common.is_enabled && !out.common.is_nak);
            if is_in_use && !self.has_global_out_nak && self.is_reachable() {
                self.note(Breach::FlushedReceive);
            }
            self.received.flush();
        }
        if value & b::TXFFLSH != 0 {
            let number = (value >> 6 & 0x1F) as usize;
            for n in (0..ENDPOINTS).filter(|&n| number == 0x10 || number == n) {
                let InEndpoint { common, fifo, .. } = &mut self.ins[n];
                let is_in_use = common.is_enabled && !common.is_nak && !fifo.is_empty();
                fifo.clear();
                if is_in_use && !self.has_global_in_nak {
                    self.note(Breach::FlushedInUse(n));
                }
            }
        }
    }

    /// Whether a host may talk to it: it is connected, and the bus is not in reset.
    fn is_reachable(&self) -> bool {
        self.dctl & b::SDIS == 0 && self.flags & b::USBRST == 0
    }

    fn resized(&mut self, value: u32) -> u32 {
        let is_in_use = self.ins.iter().any(|n| n.common.is_enabled && !n.fifo.is_empty());
        if is_in_use && self.is_reachable() {
            self.note(Breach::ResizedInUse);
        }
        value
    }

    fn write_control(&mut self, value: u32) {
        self.dctl = value & (b::SDIS | 1);
        if value & b::SGINAK != 0 {
            self.has_global_in_nak = true;
        }
        if value & b::CGINAK != 0 {
            self.has_global_in_nak = false;
        }
        if value & b::SGONAK != 0 && !self.has_global_out_nak {
            self.received.push(Status::GlobalNak, 0, false, &[]);
        }
        if value & b::CGONAK != 0 {
            self.has_global_out_nak = false;
        }
    }
}

/// The endpoint whose registers begin at `base` and the register, if `offset` is one.
fn endpoint_at(offset: u32, base: u32) -> Option<(usize, u32)> {
    let from = offset.checked_sub(base)?;
    let n = (from / 0x20) as usize;
    (n < ENDPOINTS).then_some((n, from % 0x20))
}
