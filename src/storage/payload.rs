//! Payload: the settings of a record as elements, one for each row of `settings::rows`.
//!
//! | bytes | content |
//! |---|---|
//! | 1 or 2 | the id of the row, seven bits a byte, low ones first; the top bit says that more follow |
//! | 1 | bytes of the values |
//! | .. | the values of all parts of the machine that have such a setting, in their order |
//!
//! A number takes as many bytes as it has sevens of bits, its sign in the lowest bit. A text has its length before it.
//! So firmware that knows more settings reads records of firmware that knows fewer, and the reverse: a missing setting
//! has its default, and an unknown one is kept for firmware that knows it.

use crate::settings::Settings;
use crate::settings::rows::{Field, Key, Text24, Value, Visitor};
use crate::settings::table;

/// Bytes of unknown elements that are kept, as settings of later firmware may be.
pub(super) const MOST_UNKNOWN: usize = 64;

/// Bytes of the longest payload.
pub(super) const LONGEST_PAYLOAD: usize = table::LONGEST + MOST_UNKNOWN;

/// Bytes that are no payload.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Damaged;

/// Elements that this firmware does not know, unchanged.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Unknown {
    bytes: [u8; MOST_UNKNOWN],
    length: u8,
}

impl Unknown {
    /// None.
    pub const NONE: Self = Self { bytes: [0; MOST_UNKNOWN], length: 0 };

    /// Their ids.
    pub fn ids(&self) -> impl Iterator<Item = u16> {
        Elements(self.as_bytes()).map_while(Result::ok).map(|element| element.id)
    }

    /// The first of their ids, 0 where there are no more.
    #[must_use]
    pub fn first_ids(&self) -> [u16; 4] {
        let mut ids = self.ids();
        [(); 4].map(|()| ids.next().unwrap_or_default())
    }

    fn as_bytes(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or_default()
    }

    /// Keeps one more; those that there is no room for are lost.
    fn keep(&mut self, whole: &[u8]) {
        let at = usize::from(self.length);
        if let Some(place) = self.bytes.get_mut(at..at + whole.len()) {
            place.copy_from_slice(whole);
            self.length += whole.len() as u8;
        }
    }
}

/// An element.
struct Element<'a> {
    id: u16,
    values: &'a [u8],
    /// All of it.
    whole: &'a [u8],
}

/// The elements of a payload.
struct Elements<'a>(&'a [u8]);

impl<'a> Iterator for Elements<'a> {
    type Item = Result<Element<'a>, Damaged>;

    fn next(&mut self) -> Option<Self::Item> {
        let begin = self.0;
        (!begin.is_empty()).then(|| {
            let mut rest = begin;
            let id = take_number(&mut rest).and_then(|id| u16::try_from(id).ok()).ok_or(Damaged)?;
            let (length, rest) = rest.split_first().ok_or(Damaged)?;
            let (values, rest) = rest.split_at_checked(usize::from(*length)).ok_or(Damaged)?;
            let whole = begin.get(..begin.len() - rest.len()).unwrap_or(begin);
            self.0 = rest;
            Ok(Element { id, values, whole })
        })
    }
}

/// A number of up to 64 bits, seven a byte.
fn take_number(bytes: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for shift in (0..u64::BITS).step_by(7) {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        number |= u64::from(byte & 0x7F).checked_shl(shift)?;
        if byte & 0x80 == 0 {
            return Some(number);
        }
    }
    None
}

/// Bytes that are written one behind the other.
struct Writer<'a> {
    bytes: &'a mut [u8],
    at: usize,
    /// The place of the length of the element being written, and the id of its row.
    open: Option<(usize, u16)>,
    /// Something did not fit.
    is_full: bool,
}

impl Writer<'_> {
    fn put(&mut self, byte: u8) {
        match self.bytes.get_mut(self.at) {
            Some(place) => *place = byte,
            None => self.is_full = true,
        }
        self.at += 1;
    }

    fn put_number(&mut self, mut number: u64) {
        while number >= 0x80 {
            self.put(number as u8 | 0x80);
            number >>= 7;
        }
        self.put(number as u8);
    }

    /// Writes the length of the finished element.
    fn close(&mut self) {
        if let Some((at, _)) = self.open.take() {
            let length = self.at - at - 1;
            match (self.bytes.get_mut(at), u8::try_from(length)) {
                (Some(place), Ok(length)) => *place = length,
                _ => self.is_full = true,
            }
        }
    }
}

impl Visitor for Writer<'_> {
    fn visit(&mut self, Key { row, .. }: Key, field: &mut dyn Field) {
        let value = field.get();
        if value == Value::Absent {
            return;
        }
        if self.open.is_none_or(|(_, id)| id != row.id) {
            self.close();
            self.put_number(row.id.into());
            self.open = Some((self.at, row.id));
            self.put(0);
        }
        match value {
            Value::Absent => {}
            // The sign in the lowest bit.
            Value::Number(number) => self.put_number(((number << 1) ^ (number >> 63)).cast_unsigned()),
            Value::Text(text) => {
                self.put(text.len() as u8);
                text.bytes().for_each(|byte| self.put(byte));
            }
        }
    }
}

/// Reads elements into settings.
struct Reader<'a> {
    payload: &'a [u8],
    /// The next elements: usually the element of the next row.
    next: Elements<'a>,
    /// The unread part of a row's element.
    open: Option<(u16, &'a [u8])>,
    /// A value does not fit its type.
    is_damaged: bool,
}

impl<'a> Reader<'a> {
    /// The values of the element of that row that have not been read. Of two elements with the same id either may
    /// count: no firmware writes two.
    fn values(&mut self, id: u16) -> &'a [u8] {
        if let Some((open, values)) = self.open
            && open == id
        {
            return values;
        }
        let is_of_row = |element: &Element<'_>| element.id == id;
        let mut next = Elements(self.next.0);
        if let Some(Ok(element)) = next.next()
            && is_of_row(&element)
        {
            self.next = next;
            return element.values;
        }
        let found = Elements(self.payload).map_while(Result::ok).find(is_of_row);
        found.map_or(&[], |element| element.values)
    }
}

impl Visitor for Reader<'_> {
    fn visit(&mut self, Key { row, .. }: Key, field: &mut dyn Field) {
        let mut values = self.values(row.id);
        if !values.is_empty() {
            // Only the field knows its kind: it is read as a text if it is no number.
            let value = match field.get() {
                Value::Text(_) => take_text(&mut values),
                Value::Number(_) | Value::Absent => take_number(&mut values)
                    .map(|number| Value::Number((number >> 1).cast_signed() ^ -((number & 1).cast_signed()))),
            };
            self.is_damaged |= !value.is_some_and(|value| field.set(&value));
        }
        self.open = Some((row.id, values));
    }
}

/// A text with its length before it.
fn take_text(bytes: &mut &[u8]) -> Option<Value> {
    let (length, rest) = bytes.split_first()?;
    let (text, rest) = rest.split_at_checked(usize::from(*length))?;
    *bytes = rest;
    Some(Value::Text(Text24::try_from(core::str::from_utf8(text).ok()?).ok()?))
}

/// Writes settings and unknown elements; returns their bytes, or `None` if they do not fit.
pub(super) fn write(settings: &Settings, unknown: &Unknown, into: &mut [u8]) -> Option<usize> {
    let mut writer = Writer { bytes: into, at: 0, open: None, is_full: false };
    // Visitors may change values; this one does not.
    settings.clone().visit(&mut writer);
    writer.close();
    unknown.as_bytes().iter().for_each(|byte| writer.put(*byte));
    (!writer.is_full).then_some(writer.at)
}

/// The settings in a payload, and the elements that are unknown.
///
/// # Errors
/// [`Damaged`] if it is no payload, or if a value does not fit its type.
pub(super) fn read(payload: &[u8]) -> Result<(Settings, Unknown), Damaged> {
    let mut unknown = Unknown::NONE;
    for element in Elements(payload) {
        let element = element?;
        if !table::is_known(element.id) {
            unknown.keep(element.whole);
        }
    }
    let mut settings = Settings::prototype();
    let mut reader = Reader { payload, next: Elements(payload), open: None, is_damaged: false };
    settings.visit(&mut reader);
    if reader.is_damaged { Err(Damaged) } else { Ok((settings, unknown)) }
}
