//! The switch of the power supply: by which output, and at which level of it the supply is on. It is the last resort
//! against a heater that does not go off.

use super::rows::{Spec, ValueKind, rows};
use crate::connectors::{BoardConnectors, ConnectorName};
use serde::{Deserialize, Serialize};

/// The name that stands for the board's own connector, if it has one.
const AUTO: ConnectorName = ConnectorName::lit("auto");

/// The name that stands for no switch.
const NONE: ConnectorName = ConnectorName::lit("none");

/// The connector that boards have for it.
const OWN: ConnectorName = ConnectorName::lit("PS-ON");

/// How the power supply is switched.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, Serialize, Deserialize)]
pub struct Supply {
    /// The output, "auto" or "none"; without a name none too.
    pub switch: ConnectorName,
    /// The supply is on while the output is high, else while it is low.
    pub is_on_high: bool,
}

impl Supply {
    /// The board's own connector. Low is on, as for an ATX supply (PS_ON#; ATX12V design guide, section on PS_ON#), and
    /// so for Marlin unless told otherwise (`PSU_ACTIVE_STATE LOW`).
    pub(super) const fn prototype() -> Self {
        Self { switch: AUTO, is_on_high: false }
    }

    /// Whether the machine may have one at all.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.switch == NONE || self.switch.is_none()
    }

    /// The output on that board, which need not have it if the machine names it.
    #[must_use]
    pub fn output(&self, board: &BoardConnectors) -> Option<ConnectorName> {
        match self.switch {
            AUTO => Some(OWN).filter(|own| board.supply_switches.contains(own)),
            named => Some(named).filter(|_| !self.is_none()),
        }
    }
}

rows! {
    for supply in |s, _| Some(&mut s.supply), named &["supply"];

    /// Output that switches the power supply: "auto" is the board's PS-ON, if it has one; else a free pin of the board,
    /// such as "PE7"; "none" drives no output.
    157 "switch" = &mut supply.switch, "", [Spec::text(ConnectorName::LONGEST, ValueKind::Connector)];
    /// Whether the supply is on while that output is high. An ATX supply is on while it is low.
    158 "on_high" = &mut supply.is_on_high, "", [Spec::SWITCH];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::connectors::samples::{BENCH, OTHER, PRINTER};

    #[test]
    fn auto_is_the_boards_own_output_and_none_is_none() {
        let output = |name, board| Supply { switch: ConnectorName::lit(name), is_on_high: false }.output(board);
        let named = |name| Some(ConnectorName::lit(name));
        assert_eq!(Supply::prototype().output(&PRINTER), named("PS-ON"));
        assert_eq!([output("auto", &OTHER), output("auto", &BENCH), output("auto", &BoardConnectors::ANY)], [None; 3]);
        assert_eq!([output("none", &PRINTER), output("", &PRINTER)], [None; 2]);
        assert_eq!([output("PE7", &PRINTER), output("PC9", &PRINTER)], [named("PE7"), named("PC9")]);
    }
}
