//! Store: the lines of a path, packed, in a file.
//!
//! They are packed in chunks of one layer each, so that a page can unpack the layer that it shows. A vertex is four
//! numbers. Three are the differences of x, y and z to the previous one in um. The fourth is the time difference in 10
//! us, doubled, plus one if the line to it is printed; all as [varints](crate::varint). The first vertex of a chunk is
//! where the previous one ended, with differences to 0.

use super::Vertex;
use crate::layers::Layers;
use crate::varint;
use corehbot::units::TICKS_PER_SECOND;
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};

/// Most vertices of a chunk.
pub const CHUNK: usize = 4096;

/// Ticks in 10 us.
const TICKS: u64 = TICKS_PER_SECOND as u64 / 100_000;

/// A line shorter than this says little of its speed, in mm.
const SHORTEST: f64 = 0.3;

/// The content of a chunk.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Chunk {
    /// The height of its layer, in um; `None` before the first printed line.
    pub height: Option<i64>,
    /// Vertices, among them the one where it begins.
    pub vertices: usize,
    /// When it begins and ends, in 10 us.
    pub time: [u64; 2],
    /// Its bytes in the file.
    pub bytes: usize,
}

/// The bounds of lines.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bounds {
    /// Least x and y, greatest x and y, in mm.
    pub area: [f64; 4],
    /// Greatest speed in mm/s.
    pub speed: f64,
}

impl Bounds {
    const NONE: Self = Self { area: [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], speed: 0.0 };

    fn add(&mut self, [a, b]: [Vertex; 2], length: f64) {
        for [x, y, _] in [a.at, b.at] {
            let [left, low, right, high] = self.area;
            self.area = [left.min(x), low.min(y), right.max(x), high.max(y)];
        }
        let seconds = (b.tick - a.tick) as f64 / f64::from(TICKS_PER_SECOND);
        if length >= SHORTEST && seconds > 0.0 {
            self.speed = self.speed.max(length / seconds);
        }
    }

    /// Whether there are any.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.area[0] > self.area[2]
    }
}

/// A path that is stored.
#[derive(Debug)]
pub struct Stored<F> {
    /// The packed chunks, one after another.
    pub file: F,
    /// The content of each chunk.
    pub chunks: Vec<Chunk>,
    /// Heights of the layers in um, each once, the lowest first.
    pub heights: Vec<i64>,
    /// Bounds of the printed lines.
    pub printed: Bounds,
    /// Bounds of travel.
    pub travelled: Bounds,
}

/// Packs vertices and writes them.
pub(super) struct Store<F: Write> {
    out: BufWriter<F>,
    error: Option<io::Error>,
    layers: Layers,
    packed: Vec<u8>,
    chunk: Chunk,
    chunks: Vec<Chunk>,
    /// How many lines each height has.
    heights: BTreeMap<i64, u64>,
    last: Option<Vertex>,
    printed: Bounds,
    travelled: Bounds,
}

impl<F: Write> Store<F> {
    /// An empty one, which writes to `file`.
    pub fn new(file: F) -> Self {
        Self {
            out: BufWriter::new(file),
            error: None,
            layers: Layers::NONE,
            packed: Vec::new(),
            chunk: Chunk { height: None, vertices: 0, time: [0; 2], bytes: 0 },
            chunks: Vec::new(),
            heights: BTreeMap::new(),
            last: None,
            printed: Bounds::NONE,
            travelled: Bounds::NONE,
        }
    }

    /// The next vertex.
    pub fn add(&mut self, vertex: Vertex) {
        let Some(last) = self.last.replace(vertex) else {
            self.pack(vertex, None);
            return;
        };
        let length = super::distance(last.at, vertex.at);
        if vertex.is_printing {
            self.printed.add([last, vertex], length);
            self.enter(last, vertex);
        } else if length > 0.0 {
            self.travelled.add([last, vertex], length);
        }
        if self.chunk.vertices >= CHUNK {
            self.end_chunk(self.chunk.height, last);
        }
        self.pack(vertex, Some(last));
    }

    /// The layer of a printed line begins a chunk if the last one was another.
    fn enter(&mut self, last: Vertex, vertex: Vertex) {
        let way = std::array::from_fn(|i| vertex.at[i] - last.at[i]);
        let Some(height) = self.layers.enter(way, vertex.at[2]) else { return };
        *self.heights.entry(height).or_default() += 1;
        match self.chunk.height {
            Some(own) if own == height => {}
            None => self.chunk.height = Some(height),
            Some(_) => self.end_chunk(Some(height), last),
        }
    }

    /// Ends a chunk, and begins another one at its last vertex.
    fn end_chunk(&mut self, height: Option<i64>, last: Vertex) {
        self.flush();
        self.chunk = Chunk { height, vertices: 0, time: [0; 2], bytes: 0 };
        self.pack(last, None);
    }

    fn flush(&mut self) {
        self.chunk.bytes = self.packed.len();
        self.chunks.push(self.chunk);
        if self.error.is_none() {
            self.error = self.out.write_all(&self.packed).err();
        }
        self.packed.clear();
    }

    fn pack(&mut self, vertex: Vertex, before: Option<Vertex>) {
        let um = |vertex: Vertex| vertex.at.map(|v| (v * 1000.0).round() as i64);
        let origin = before.map_or([0; 3], um);
        for (now, then) in um(vertex).into_iter().zip(origin) {
            varint::put_signed(&mut self.packed, now - then);
        }
        let [now, then] = [vertex.tick / TICKS, before.map_or(0, |before| before.tick / TICKS)];
        varint::put(&mut self.packed, (now - then) << 1 | u64::from(vertex.is_printing));
        if before.is_none() {
            self.chunk.time[0] = now;
        }
        self.chunk.time[1] = now;
        self.chunk.vertices += 1;
    }

    /// The whole path.
    pub fn finish(mut self) -> io::Result<Stored<F>> {
        self.flush();
        if let Some(error) = self.error {
            return Err(error);
        }
        Ok(Stored {
            file: self.out.into_inner().map_err(io::IntoInnerError::into_error)?,
            chunks: self.chunks,
            heights: self.heights.into_keys().collect(),
            printed: self.printed,
            travelled: self.travelled,
        })
    }
}
