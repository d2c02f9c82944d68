//! Moves of a print, packed in a file, and their sums by type and by layer.
//!
//! They are packed in chunks that can be read alone. A chunk has at most [`CHUNK`] moves of one layer. It ends where
//! the firmware gives the place another name (G92), because the next move does not begin where this one ended. A move
//! is the numbers of this table, all as varints. A difference is to the move before; in a chunk's first move it is to
//! 0.
//!
//! | numbers | unit |
//! |---|---|
//! | line of the file (difference; 0 if no line caused it) | |
//! | time since the end of the move before; in the first move since the start | 10 us |
//! | times of acceleration, cruise, deceleration | 10 us |
//! | entry, top and exit speed (differences) | 0.01 mm/s |
//! | commanded speed (difference) | 0.01 mm/s |
//! | way in x, y and z, filament (signed) | um |
//! | type * 16 + limit | |

use crate::layers::Layers;
use crate::varint::{put, put_signed};
use corehbot::units::TICKS_PER_SECOND;
use corehbot_sim::moves::{Limit, MadeMove, ShaperChange};
use corehbot_sim::slicer::PURGE;
use corehbot_twin::math::hypot;
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};

/// Most moves of a chunk.
pub const CHUNK: usize = 4096;

/// Changes of shapers that are kept. A tower of shapers has one a layer.
const MOST_SHAPER_CHANGES: usize = 2000;

/// Ticks in 10 us.
const TICKS: u64 = TICKS_PER_SECOND as u64 / 100_000;

/// The content of a chunk.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MoveChunk {
    /// The height of its layer in um; `None` before the first printed move.
    pub height: Option<i64>,
    /// Its moves.
    pub moves: usize,
    /// When it begins and ends, in 10 us.
    pub time: [u64; 2],
    /// Where the tool is at its begin: x, y, z in um.
    pub from: [i64; 3],
    /// Its bytes in the file.
    pub bytes: usize,
}

/// What some moves take.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct Sum {
    /// Their time in s.
    pub seconds: f64,
    /// Filament that they move, in mm; pulled back it counts negative.
    pub filament_mm: f64,
    /// The way of the tool on which filament was laid, in mm.
    pub printed_mm: f64,
    /// Their number.
    pub moves: u64,
}

impl Sum {
    fn add(&mut self, made: &MadeMove) {
        self.seconds += (made.end() - made.begin) as f64 / f64::from(TICKS_PER_SECOND);
        self.filament_mm += made.way[3];
        self.moves += 1;
        if made.is_printing() {
            let [x, y, z, _] = made.way;
            self.printed_mm += hypot(hypot(x, y), z);
        }
    }

    /// Adds another sum.
    pub fn join(&mut self, other: &Self) {
        self.seconds += other.seconds;
        self.filament_mm += other.filament_mm;
        self.printed_mm += other.printed_mm;
        self.moves += other.moves;
    }
}

/// Moves that are stored.
#[derive(Debug)]
pub struct StoredMoves<F> {
    /// The packed chunks, one after another.
    pub file: F,
    /// The content of each chunk.
    pub chunks: Vec<MoveChunk>,
    /// Filament that was used, in mm: the most that was ahead at any time. What is pulled back and primed again counts
    /// once, and what is pulled back at the end was used.
    pub filament_mm: f64,
    /// Sums by the index of the type.
    pub by_type: Vec<Sum>,
    /// Sums by the height of the layer in um. What comes before a layer's first printed move counts to the layer
    /// before.
    pub by_layer: BTreeMap<i64, Sum>,
    /// What comes before the first layer, purge lines among it, and after the last printed move.
    pub outside: [Sum; 2],
    /// Seconds by the number of the limit.
    pub by_limit: [f64; Limit::ALL.len()],
    /// The shapers of x and y, by time.
    pub shapers: Vec<ShaperChange>,
}

impl<F> StoredMoves<F> {
    /// The same moves in another file.
    pub fn in_file<G>(self, file: G) -> StoredMoves<G> {
        let Self { chunks, filament_mm, by_type, by_layer, outside, by_limit, shapers, .. } = self;
        StoredMoves { file, chunks, filament_mm, by_type, by_layer, outside, by_limit, shapers }
    }
}

/// What differences are taken to.
#[derive(Clone, Copy, Default)]
struct Before {
    line: i64,
    end: u64,
    speeds: [i64; 3],
    feed: i64,
}

/// Packs moves and writes them.
pub struct Moves<F: Write> {
    out: BufWriter<F>,
    error: Option<io::Error>,
    layers: Layers,
    packed: Vec<u8>,
    chunk: MoveChunk,
    chunks: Vec<MoveChunk>,
    before: Before,
    /// Filament that is ahead in mm, pulled back one taken off, and the most of it so far.
    ahead: f64,
    used: f64,
    by_type: Vec<Sum>,
    by_layer: BTreeMap<i64, Sum>,
    by_limit: [f64; Limit::ALL.len()],
    /// What comes before the first layer, and after the last printed move so far.
    first: Sum,
    rest: Sum,
    shapers: Vec<ShaperChange>,
}

fn um(mm: f64) -> i64 {
    (mm * 1000.0).round() as i64
}

/// A speed in 0.01 mm/s.
fn cents(speed: f64) -> i64 {
    (speed * 100.0).round() as i64
}

const EMPTY: MoveChunk = MoveChunk { height: None, moves: 0, time: [0; 2], from: [0; 3], bytes: 0 };

impl<F: Write> Moves<F> {
    /// None yet; they go to `file`.
    pub fn new(file: F) -> Self {
        Self {
            out: BufWriter::new(file),
            error: None,
            layers: Layers::NONE,
            packed: Vec::new(),
            chunk: EMPTY,
            chunks: Vec::new(),
            before: Before::default(),
            ahead: 0.0,
            used: 0.0,
            by_type: Vec::new(),
            by_layer: BTreeMap::new(),
            by_limit: [0.0; Limit::ALL.len()],
            first: Sum::default(),
            rest: Sum::default(),
            shapers: Vec::new(),
        }
    }

    /// The next move.
    pub fn add(&mut self, made: &MadeMove) {
        // A purge line may be higher than the first layer.
        let is_of_layer = made.is_printing() && made.source.kind != PURGE;
        let laid = is_of_layer.then(|| {
            let [x, y, z, _] = made.way;
            self.layers.enter([x, y, z], made.from[2] + z)
        });
        let laid = laid.flatten();
        let height = laid.or(self.chunk.height);
        let is_other = self.chunk.height.is_some() && height != self.chunk.height;
        if made.is_apart || is_other || self.chunk.moves >= CHUNK {
            self.flush();
        }
        self.count(made, laid);
        self.chunk.height = height;
        self.pack(made);
    }

    /// An axis has another shaper from now on. Of several at one instant the last counts.
    pub fn reshape(&mut self, change: &ShaperChange) {
        let is_same = |known: &&mut ShaperChange| (known.axis, known.tick) == (change.axis, change.tick);
        if let Some(known) = self.shapers.iter_mut().rev().take(2).find(is_same) {
            known.clone_from(change);
        } else if self.shapers.len() < MOST_SHAPER_CHANGES {
            self.shapers.push(change.clone());
        }
    }

    /// Adds a move to the sums; `laid` is the layer that it is printed in.
    fn count(&mut self, made: &MadeMove, laid: Option<i64>) {
        let kind = usize::from(made.source.kind);
        if self.by_type.len() <= kind {
            self.by_type.resize(kind + 1, Sum::default());
        }
        self.by_type[kind].add(made);
        self.ahead += made.way[3];
        self.used = self.used.max(self.ahead);
        self.by_limit[made.limit as usize] += (made.end() - made.begin) as f64 / f64::from(TICKS_PER_SECOND);
        if laid.is_some()
            && let Some(before) = self.chunk.height
        {
            self.by_layer.entry(before).or_default().join(&std::mem::take(&mut self.rest));
        }
        let sum = match (laid, self.chunk.height) {
            (Some(height), _) => self.by_layer.entry(height).or_default(),
            (None, Some(_)) => &mut self.rest,
            (None, None) => &mut self.first,
        };
        sum.add(made);
    }

    fn pack(&mut self, made: &MadeMove) {
        let Self { packed, chunk, before, .. } = self;
        if chunk.moves == 0 {
            (chunk.from, chunk.time[0]) = (made.from.map(um), made.begin / TICKS);
            *before = Before::default();
        }
        // Ends are rounded, not times, so that nothing adds up.
        let [rise, level, fall] = made.phases;
        let begin = (made.begin / TICKS).max(before.end);
        let ends = [made.begin + rise, made.begin + rise + level, made.begin + rise + level + fall];
        let ends = ends.map(|end| (end / TICKS).max(begin));
        let line = i64::from(made.source.line);
        let speeds = made.speeds.map(cents);
        let feed = cents(made.source.feed.unwrap_or(made.speeds[1]));
        put_signed(packed, line - before.line);
        put(packed, begin - before.end);
        for (end, from) in ends.into_iter().zip([begin, ends[0], ends[1]]) {
            put(packed, end - from);
        }
        for (speed, last) in speeds.into_iter().zip(before.speeds) {
            put_signed(packed, speed - last);
        }
        put_signed(packed, feed - before.feed);
        // Positions are rounded, not ways.
        for (from, way) in made.from.into_iter().zip(made.way) {
            put_signed(packed, um(from + way) - um(from));
        }
        put_signed(packed, um(made.way[3]));
        put(packed, u64::from(made.source.kind) << 4 | made.limit as u64);
        *before = Before { line, end: ends[2], speeds, feed };
        chunk.time[1] = ends[2];
        chunk.moves += 1;
    }

    /// Ends the chunk; the next one is of the same layer unless a move says otherwise.
    fn flush(&mut self) {
        if self.chunk.moves == 0 {
            return;
        }
        self.chunk.bytes = self.packed.len();
        self.chunks.push(self.chunk);
        if self.error.is_none() {
            self.error = self.out.write_all(&self.packed).err();
        }
        self.packed.clear();
        self.chunk = MoveChunk { height: self.chunk.height, ..EMPTY };
    }

    /// All of them.
    ///
    /// # Errors
    /// If a move could not be stored.
    pub fn finish(mut self) -> io::Result<StoredMoves<F>> {
        self.flush();
        if let Some(error) = self.error {
            return Err(error);
        }
        if self.by_layer.is_empty() && self.first.moves > 0 {
            self.by_layer.insert(0, std::mem::take(&mut self.first));
        }
        Ok(StoredMoves {
            file: self.out.into_inner().map_err(io::IntoInnerError::into_error)?,
            chunks: self.chunks,
            filament_mm: self.used,
            by_type: self.by_type,
            by_layer: self.by_layer,
            outside: [self.first, self.rest],
            by_limit: self.by_limit,
            shapers: self.shapers,
        })
    }
}
