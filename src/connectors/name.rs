//! Names of connectors, as they are printed on a board.

use crate::text::{NameKind, ShortName};

/// The kind of [`ConnectorName`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum OfConnector {}

impl NameKind for OfConnector {
    const IS_ALPHANUMERIC: bool = false;
    const EXPECTED: &str = "the name of a connector, of at most 8 characters";
}

/// The name of a connector: `M0`, `X-STOP`. Up to 8 printable characters of ASCII, without blanks and without `!`,
/// which inverts a connector in machine files. The empty name is no connector: nothing is plugged in.
pub type ConnectorName = ShortName<8, OfConnector>;

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::format;

    #[test]
    fn a_name_is_short_and_printable() {
        for text in ["M0", "X-STOP", "E0DET", "Z2-STOP", "12345678", ""] {
            let name = ConnectorName::new(text).unwrap();
            assert_eq!(name.as_str(), text);
            assert_eq!((format!("{name}"), format!("{name:?}")), (text.into(), format!("{text:?}")));
            assert_eq!(name.is_none(), text.is_empty());
        }
        for text in ["123456789", "M 0", "!M0", "M0!", "M\0", "M\u{7f}", "\u{fc}"] {
            assert_eq!(ConnectorName::new(text), None, "{text}");
        }
    }

    #[test]
    fn a_stored_name_is_one_of_these() {
        let name = ConnectorName::lit("X-STOP");
        let mut bytes = [0; 9];
        let bytes = postcard::to_slice(&name, &mut bytes).unwrap();
        assert_eq!(bytes, b"\x06X-STOP");
        assert_eq!(postcard::from_bytes(bytes), Ok(name));
        bytes[1] = b'!';
        assert!(postcard::from_bytes::<ConnectorName>(bytes).is_err());
        assert!(postcard::from_bytes::<ConnectorName>(b"\x09123456789").is_err());
        assert!(postcard::from_bytes::<ConnectorName>(b"\x01\xff").is_err());
    }
}
