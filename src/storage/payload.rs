//! Payload: the settings of a record as elements, one for each row of `settings::rows`.
//!
//! | bytes | content |
//! |---|---|
//! | 1 | the head: 1 bit, whether an id follows; 3 bits, bytes of each value; 4 bits, the number of values |
//! | 0 to 2 | the id of the row: below 128 in a byte; from there on seven low bits and the top bit, then the others |
//! | 0 or 1 | bytes of each value, if the head has 0 for them |
//! | .. | the values of all parts of the machine that have such a setting, in their order |
//!
//! Without an id, an element has the id after the one of the element before it; the first has 1. All values of an
//! element are as wide as its widest. Numbers have their low bytes first, in two's complement if their type has a sign.
//! Texts have zeros behind them.
//!
//! So firmware that knows more settings reads records of firmware that knows fewer, and the reverse. A missing setting
//! has its default, and an unknown one is kept for firmware that knows it.

use super::out::Out;
use crate::settings::Settings;
use crate::settings::rows::{Field, Key, LONGEST_TEXT, Legal, Row, Text24, Value, Visitor};
use crate::settings::table::{self, ALL};

/// Bytes of unknown elements that are kept, as settings of later firmware may be.
pub(super) const MOST_UNKNOWN: usize = 64;

/// The bit of a head that says that an id follows.
const HAS_ID: u8 = 0x80;

/// The widest value that a head has room for.
const MOST_IN_HEAD: usize = 7;

/// Values of the longest element.
const MOST_VALUES: usize = 15;

/// Ids from here on do not fit in two bytes.
const NO_ID: u16 = 1 << 15;

/// Bytes of the longest payload, reckoned from the ranges of all rows.
pub(super) const LONGEST_PAYLOAD: usize = {
    let (mut bytes, mut id_before, mut files) = (0, 0, ALL);
    while let [file, other_files @ ..] = files {
        let mut rows = file.rows;
        while let [row, others @ ..] = rows {
            // If one of two keys of a field is absent, the next element may need an id of two bytes; a head and a value
            // less make up for it.
            bytes += longest_head(row, id_before) + widest(row) * row.tables.len();
            (id_before, rows) = (row.id, others);
        }
        files = other_files;
    }
    bytes + MOST_UNKNOWN
};

/// Bytes before the values of a row's longest element.
const fn longest_head(row: &Row, id_before: u16) -> usize {
    assert!(row.tables.len() <= MOST_VALUES && row.id < NO_ID);
    let id = match row.id {
        id if id == id_before + 1 => 0,
        ..128 => 1,
        _ => 2,
    };
    1 + id + (widest(row) > MOST_IN_HEAD) as usize
}

/// Bytes of the widest value of a row.
const fn widest(row: &Row) -> usize {
    let (mut widest, mut legal) = (1, Some(row.first_legal()));
    while let Some(first) = legal {
        let Legal { least, most, is_text, is_signed, next, .. } = *first;
        assert!(is_signed || least >= 0);
        let (least, most) = match is_text {
            true => (0, most as usize),
            false => (width_of(least, is_signed), width_of(most, is_signed)),
        };
        let bytes = if least > most { least } else { most };
        widest = if bytes > widest { bytes } else { widest };
        legal = next;
    }
    widest
}

/// Bytes of a number, with a bit for its sign if its type has one.
const fn width_of(number: i64, is_signed: bool) -> usize {
    let bits = is_signed as u32 + i64::BITS - (number ^ (number >> 63)).leading_zeros();
    bits.div_ceil(8) as usize
}

/// Bytes that are no payload.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Damaged;

/// Elements that this firmware does not know, each with its id in front of its values.
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
        Elements::of(self.as_bytes()).map_while(Result::ok).map(|element| element.id)
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

    /// Keeps one more; those that there is no room for are lost. It may stand behind any other element then.
    fn keep(&mut self, element: &Element<'_>) {
        let [low, high] = [element.id as u8 | 0x80, (element.id >> 7) as u8];
        let head = [HAS_ID | element.count, low, high, element.width];
        let (at, length) = (usize::from(self.length), head.len() + element.values.len());
        if let Some((head_place, values)) = self.bytes.get_mut(at..at + length).and_then(<[u8]>::split_first_chunk_mut)
        {
            *head_place = head;
            values.copy_from_slice(element.values);
            self.length += length as u8;
        }
    }
}

/// An element.
#[derive(Clone, Copy)]
struct Element<'a> {
    id: u16,
    /// Bytes of each value.
    width: u8,
    /// The number of values.
    count: u8,
    values: &'a [u8],
}

impl Element<'_> {
    /// None: ids begin with 1.
    const NONE: Self = Self { id: 0, width: 0, count: 0, values: &[] };
}

/// The elements of a payload.
#[derive(Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    /// The id of the element before.
    id: u16,
}

impl<'a> Elements<'a> {
    const fn of(bytes: &'a [u8]) -> Self {
        Self { bytes, id: 0 }
    }

    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(*byte)
    }

    fn take(&mut self) -> Option<Element<'a>> {
        let head = self.byte()?;
        self.id = if head & HAS_ID == 0 {
            self.id.wrapping_add(1)
        } else {
            match self.byte()? {
                low @ ..0x80 => low.into(),
                low => u16::from(low & 0x7F) | u16::from(self.byte()?) << 7,
            }
        };
        let width = match head >> 4 & 7 {
            0 => self.byte()?,
            width => width,
        };
        let count = head & 0xF;
        let (values, rest) = self.bytes.split_at_checked(usize::from(width) * usize::from(count))?;
        self.bytes = rest;
        Some(Element { id: self.id, width, count, values })
    }
}

impl<'a> Iterator for Elements<'a> {
    type Item = Result<Element<'a>, Damaged>;

    fn next(&mut self) -> Option<Self::Item> {
        (!self.bytes.is_empty()).then(|| self.take().ok_or(Damaged))
    }
}

/// Writes settings as elements.
struct Writer<'a> {
    out: Out<'a>,
    /// The id of the element before.
    id_before: u16,
    /// The row of the values that are not written yet, and how wide their widest is.
    id: u16,
    width: usize,
    count: usize,
    values: [[u8; LONGEST_TEXT]; MOST_VALUES],
    /// An element has more values than [`MOST_VALUES`], which an assertion above excludes.
    is_too_long: bool,
}

impl Writer<'_> {
    /// Writes the element of the values so far.
    fn close(&mut self) {
        if self.count > 0 {
            let has_id = self.id != self.id_before + 1;
            let is_in_head = self.width <= MOST_IN_HEAD;
            let width = if is_in_head { self.width } else { 0 };
            let head = if has_id { HAS_ID } else { 0 } | (width << 4 | self.count) as u8;
            let (low, high) = (self.id as u8, (self.id >> 7) as u8);
            self.out.put(&[head]);
            match has_id {
                false => {}
                true if self.id < 128 => self.out.put(&[low]),
                true => self.out.put(&[low | 0x80, high]),
            }
            if !is_in_head {
                self.out.put(&[self.width as u8]);
            }
            for value in self.values.iter().take(self.count) {
                self.out.put(value.get(..self.width).unwrap_or_default());
            }
            (self.id_before, self.count, self.width) = (self.id, 0, 1);
        }
    }
}

impl Visitor for Writer<'_> {
    fn visit(&mut self, Key { row, .. }: Key, field: &mut dyn Field) {
        let value = field.get();
        if value == Value::Absent {
            return;
        }
        if self.id != row.id {
            self.close();
            self.id = row.id;
        }
        let number;
        let (bytes, width) = match &value {
            Value::Absent => (&[][..], 0),
            Value::Number(bits) => {
                number = bits.to_le_bytes();
                (&number[..], width_of(*bits, row.is_signed()))
            }
            Value::Text(text) => (text.as_bytes(), text.len()),
        };
        match self.values.get_mut(self.count) {
            Some(place) => {
                place.fill(0);
                place.iter_mut().zip(bytes).for_each(|(place, byte)| *place = *byte);
            }
            None => self.is_too_long = true,
        }
        self.count += 1;
        self.width = self.width.max(width);
    }
}

/// Reads elements into settings.
struct Reader<'a> {
    payload: Elements<'a>,
    /// The next elements: usually the element of the next row.
    next: Elements<'a>,
    /// A row's element, with the values that are not read yet.
    open: Element<'a>,
    /// A value does not fit its type.
    is_damaged: bool,
}

impl<'a> Reader<'a> {
    /// The element of that row, with the values that are not read yet. Of two elements with the same id either may
    /// count: no firmware writes two.
    fn element(&mut self, id: u16) -> Element<'a> {
        if self.open.id == id {
            return self.open;
        }
        let is_of_row = |element: &Element<'_>| element.id == id;
        let mut next = self.next;
        if let Some(Ok(element)) = next.next()
            && is_of_row(&element)
        {
            self.next = next;
            return element;
        }
        let found = self.payload.map_while(Result::ok).find(is_of_row);
        found.unwrap_or(Element { id, ..Element::NONE })
    }
}

impl Visitor for Reader<'_> {
    fn visit(&mut self, Key { row, .. }: Key, field: &mut dyn Field) {
        self.open = self.element(row.id);
        let Some((bytes, others)) = self.open.values.split_at_checked(self.open.width.into()) else { return };
        self.open.values = others;
        if !bytes.is_empty() {
            // Only the field knows its kind: it is read as a text if it is no number.
            let value = match field.get() {
                Value::Text(_) => text_in(bytes),
                Value::Number(_) | Value::Absent => number_in(bytes, row.is_signed()),
            };
            self.is_damaged |= !value.is_some_and(|value| field.set(&value));
        }
    }
}

/// A number, low bytes first, in two's complement if its type has a sign.
fn number_in(bytes: &[u8], is_signed: bool) -> Option<Value> {
    let is_negative = is_signed && bytes.last()? & 0x80 != 0;
    let mut number = [if is_negative { 0xFF } else { 0 }; 8];
    number.get_mut(..bytes.len())?.copy_from_slice(bytes);
    Some(Value::Number(i64::from_le_bytes(number)))
}

/// A text with zeros behind it.
fn text_in(bytes: &[u8]) -> Option<Value> {
    let text = bytes.split(|byte| *byte == 0).next()?;
    Some(Value::Text(Text24::try_from(core::str::from_utf8(text).ok()?).ok()?))
}

/// Writes settings and unknown elements; returns their bytes, or `None` if they do not fit.
pub(super) fn write(settings: &Settings, unknown: &Unknown, into: &mut [u8]) -> Option<usize> {
    let out = Out::new(into);
    let values = [[0; LONGEST_TEXT]; MOST_VALUES];
    let mut writer = Writer { out, id_before: 0, id: 0, width: 1, count: 0, values, is_too_long: false };
    // Visitors may change values; this one does not.
    settings.clone().visit(&mut writer);
    writer.close();
    writer.out.put(unknown.as_bytes());
    let written = writer.out.written()?;
    (!writer.is_too_long).then_some(written.len())
}

/// Reads the settings in a payload; returns the elements that are unknown.
///
/// # Errors
/// [`Damaged`] if it is no payload, or if a value does not fit its type.
pub(super) fn read(payload: &[u8], settings: &mut Settings) -> Result<Unknown, Damaged> {
    let payload = Elements::of(payload);
    let mut unknown = Unknown::NONE;
    for element in payload {
        let element = element?;
        if !table::is_known(element.id) {
            unknown.keep(&element);
        }
    }
    *settings = Settings::prototype();
    let mut reader = Reader { payload, next: payload, open: Element::NONE, is_damaged: false };
    settings.visit(&mut reader);
    if reader.is_damaged { Err(Damaged) } else { Ok(unknown) }
}
