//! Print: one page that shows the tool path, speed and load of a print, without any network.
//!
//! The page is a template. It holds the streams of the [record](crate::record) in blobs of base64, which the page
//! unpacks when it shows them. So a print of any length has all of its lines and still opens at once. Everything else
//! is one JSON object. It comes before the blobs, with some of a large print's moves: they are the first picture, while
//! the browser still reads the rest.

mod belt;
mod heat_chart;
mod machine;

use crate::fault::Fault;
use crate::heat_log::HeatLog;
use crate::moves::StoredMoves;
use crate::path::{Bounds, Chunk, Stored};
use crate::record::{Record, TextChunk, blobs, text_blobs};
use crate::summary::Summary;
use crate::sums::{
    Filament, LayerSum, LimitSum, OutsideSum, TypeSum, by_layer, by_limit, by_type, chunk_row, layer_of,
};
use crate::viewer::{self, TEMPLATE};
use belt::BeltData;
use corehbot::kinematics::Row;
use corehbot::motors::MotorName;
use corehbot::settings::{HomedAxis, Settings};
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::belt::course::Course;
use corehbot_sim::host::HeatWait;
use corehbot_sim::moves::Limit;
use corehbot_sim::slicer::{LineType, Notes};
use corehbot_sim::tally::Figures;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use heat_chart::HeatData;
use machine::{MachineData, ShaperSince};
use serde::Serialize;
use std::io::{self, Read, Seek, Write};

/// The head of every page.
pub(crate) const HEAD: &str = include_str!("print/head.html");

/// Where the style goes, the viewer, the data, the moves of the first picture, and the streams.
const MARKS: [&str; 5] = ["/*STYLE*/\n", "/*VIEWER*/", "/*DATA*/", "<!--PREVIEW-->", "<!--STREAMS-->"];

/// Chunks of moves from which on a print has a first picture of some of them.
const LARGE: usize = 100;

/// That picture has one chunk of so many at least, and the last ones.
const PICKED: usize = 32;
const LAST: usize = 6;

/// The chunks of moves for a first picture, by their indices.
fn preview(chunks: usize) -> Vec<usize> {
    let apart = chunks.div_ceil(PICKED);
    let is_picked = |i: &usize| i.is_multiple_of(apart) || i + LAST >= chunks;
    if chunks < LARGE { Vec::new() } else { (0..chunks).filter(is_picked).collect() }
}

/// The content of a page.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// The figures in one line each.
    pub summary: &'a Summary,
    /// Those over time.
    pub figures: &'a Figures,
    /// Temperatures and duties over time.
    pub heat: &'a HeatLog,
    /// Where the print waited for temperatures.
    pub heat_waits: &'a [HeatWait],
    /// The belt plant's load over time, if there was a belt plant.
    pub belt: Option<&'a Course>,
    /// The machine.
    pub settings: &'a Settings,
    /// What the slicer says in the file.
    pub notes: &'a Notes,
}

/// The streams of a print: its path, its moves and the text of its file.
#[derive(Debug)]
pub struct Streams<P, M, T> {
    /// The way of the tool.
    pub path: Stored<P>,
    /// The moves.
    pub moves: StoredMoves<M>,
    /// The G-code file from its begin.
    pub gcode: T,
}

#[derive(Serialize)]
struct Data<'a> {
    summary: &'a Summary,
    /// Reachable space in mm.
    reach: [[f64; 2]; 2],
    motors: Vec<MotorData>,
    /// Heights of the layers in mm.
    heights: Vec<f64>,
    /// Layer, vertices, begin and end in 10 us of each chunk.
    chunks: Vec<[u64; 4]>,
    printed: Option<BoundsData>,
    travelled: Option<BoundsData>,
    /// Seconds a bin of the curves.
    bin_s: f64,
    /// Mean and peak speed of each bin in mm/s, and events a second.
    speed: Vec<f64>,
    peak: Vec<f64>,
    rate: Vec<u64>,
    /// `None` on a machine without heaters.
    heat: Option<HeatData>,
    /// `None` on a rigid machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    belt: Option<BeltData>,
    types: &'a [LineType],
    limits: [Limit; Limit::ALL.len()],
    by_type: Vec<TypeSum>,
    by_layer: Vec<LayerSum>,
    before_layers: OutsideSum,
    after_layers: OutsideSum,
    by_limit: Vec<LimitSum>,
    /// Why the print failed, if it did.
    fault: Option<&'a Fault>,
    /// The part of the documents about that, in Markdown.
    fault_page: Option<&'static str>,
    time: TimeData,
    filament: Filament,
    machine: MachineData,
    /// Every setting at the start, by its key in a machine file.
    settings: serde_json::Value,
    /// What x and y follow, by time.
    shapers: Vec<ShaperSince>,
    move_chunks: Vec<[i64; 7]>,
    /// Those for a first picture, by their indices.
    preview: Vec<usize>,
    gcode_chunks: Vec<TextChunk>,
}

/// Times in s.
#[derive(Serialize)]
struct TimeData {
    total: f64,
    motion: f64,
    heat: f64,
    waits: f64,
    /// The slicer's estimate, if the file has one.
    slicer: Option<f64>,
}

/// A motor that is fitted.
#[derive(Serialize)]
struct MotorData {
    name: MotorName,
    /// The axes that it turns for.
    drives: String,
    steps: i64,
    net: i64,
}

#[derive(Serialize)]
struct BoundsData {
    /// Left, front, right and back in mm.
    area: [f64; 4],
    /// Greatest speed in mm/s.
    speed: f64,
}

impl BoundsData {
    fn new(bounds: &Bounds) -> Option<Self> {
        (!bounds.is_empty()).then_some(Self { area: bounds.area, speed: bounds.speed })
    }
}

impl Page<'_> {
    /// Writes the page with these streams.
    ///
    /// # Errors
    /// The error from `out` or from a stream.
    pub fn write<P: Read + Seek, M: Read + Seek>(
        &self,
        streams: Streams<P, M, impl Read>,
        out: &mut impl Write,
    ) -> io::Result<()> {
        let mut parts = Vec::new();
        let mut rest = TEMPLATE;
        for mark in MARKS {
            let (part, after) = rest.split_once(mark).ok_or(io::ErrorKind::InvalidData)?;
            parts.push(part);
            rest = after;
        }
        let picked = preview(streams.moves.chunks.len());
        let (mut first, mut all, mut chunk) = (Vec::new(), Vec::new(), 0);
        let data = self.read(streams, |stream, blob| {
            let text = packed(blob)?;
            if stream == Stream::Moves {
                if picked.contains(&chunk) {
                    script("preview", &text, &mut first)?;
                }
                chunk += 1;
            }
            script(stream.name(), &text, &mut all)
        })?;
        // A file name with "</script>" in it must not end the script.
        let json = serde_json::to_string(&data)?.replace('<', "\\u003c");
        let (style, viewer) = (viewer::style(), viewer::script());
        let contents = [style.as_bytes(), viewer.as_bytes(), json.as_bytes(), &first, &all];
        out.write_all(HEAD.as_bytes())?;
        for (part, content) in parts.into_iter().zip(contents) {
            out.write_all(part.as_bytes())?;
            out.write_all(content)?;
        }
        out.write_all(rest.as_bytes())?;
        out.flush()
    }

    /// The same for a page that has the simulator in it.
    ///
    /// # Errors
    /// The error from a stream.
    pub fn record<P: Read + Seek, M: Read + Seek>(&self, streams: Streams<P, M, impl Read>) -> io::Result<Record> {
        let mut record = Record { data: String::new(), path: Vec::new(), moves: Vec::new(), gcode: Vec::new() };
        let data = self.read(streams, |stream, blob| {
            let blobs = match stream {
                Stream::Path => &mut record.path,
                Stream::Moves => &mut record.moves,
                Stream::Gcode => &mut record.gcode,
            };
            blobs.push(blob.to_vec());
            Ok(())
        })?;
        record.data = serde_json::to_string(&data)?;
        Ok(record)
    }

    /// Shows every blob of the streams, and returns the data.
    fn read<P: Read + Seek, M: Read + Seek>(
        &self,
        streams: Streams<P, M, impl Read>,
        mut each: impl FnMut(Stream, &[u8]) -> io::Result<()>,
    ) -> io::Result<Data<'_>> {
        let Streams { path, moves, gcode } = streams;
        let mut data = self.data(&path, &moves);
        blobs(path.file, path.chunks.iter().map(|chunk| chunk.bytes), |blob| each(Stream::Path, blob))?;
        blobs(moves.file, moves.chunks.iter().map(|chunk| chunk.bytes), |blob| each(Stream::Moves, blob))?;
        text_blobs(gcode, |chunk, blob| {
            data.gcode_chunks.push(chunk);
            each(Stream::Gcode, blob)
        })?;
        Ok(data)
    }

    fn data<F, M>(&self, stored: &Stored<F>, moves: &StoredMoves<M>) -> Data<'_> {
        let Self { summary, figures, heat, heat_waits, belt, settings, notes } = *self;
        let bin_s = figures.series.bin_ticks() as f64 / f64::from(TICKS_PER_SECOND);
        let bins = figures.series.bins();
        // Those of the moves: a purge line may be higher than the first layer.
        let has_layers = moves.chunks.iter().any(|chunk| chunk.height.is_some());
        let heights = if has_layers { moves.by_layer.keys().copied().collect() } else { stored.heights.clone() };
        Data {
            summary,
            reach: [HomedAxis::X, HomedAxis::Y]
                .map(|axis| settings.reach(axis))
                .map(|r| [r.least, r.most].map(Mm::to_num)),
            motors: motors(summary, settings),
            heights: heights.iter().map(|um| *um as f64 / 1000.0).collect(),
            chunks: stored.chunks.iter().map(|chunk| row(chunk, &heights)).collect(),
            printed: BoundsData::new(&stored.printed),
            travelled: BoundsData::new(&stored.travelled),
            bin_s,
            speed: bins.iter().map(|b| tenth(f64::from(b.path) / bin_s)).collect(),
            peak: bins.iter().map(|b| tenth(b.peak_speed.into())).collect(),
            rate: bins.iter().map(|b| (f64::from(b.events) / bin_s).round() as u64).collect(),
            heat: HeatData::new(heat, heat_waits, &settings.thermal),
            belt: belt.zip(summary.belt.as_ref()).map(|(course, figures)| BeltData::new(course, figures)),
            types: notes.types(),
            limits: Limit::ALL,
            by_type: by_type(&moves.by_type, notes),
            by_layer: by_layer(&moves.by_layer, &heights),
            before_layers: OutsideSum::new(&moves.outside[0]),
            after_layers: OutsideSum::new(&moves.outside[1]),
            by_limit: by_limit(&moves.by_limit),
            fault: summary.fault.as_ref(),
            fault_page: summary.fault.as_ref().map(Fault::text_of_page),
            time: TimeData {
                total: summary.print_time_s,
                motion: summary.motion_time_s,
                heat: summary.heating_time_s,
                waits: summary.waiting_time_s,
                slicer: summary.slicer_time_s,
            },
            filament: Filament::new(moves.filament_mm, notes),
            machine: MachineData::new(settings),
            settings: corehbot_machine_file::keyed(settings),
            shapers: moves.shapers.iter().map(ShaperSince::new).collect(),
            move_chunks: moves.chunks.iter().map(|chunk| chunk_row(chunk, &heights)).collect(),
            preview: preview(moves.chunks.len()),
            gcode_chunks: Vec::new(),
        }
    }
}

/// A stream of a record.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Stream {
    Path,
    Moves,
    Gcode,
}

impl Stream {
    const fn name(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Moves => "moves",
            Self::Gcode => "gcode",
        }
    }
}

/// A blob as text. RFC 1951: browsers unpack it by themselves.
fn packed(blob: &[u8]) -> io::Result<String> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(blob)?;
    Ok(base64(&encoder.finish()?))
}

/// A text as a script that does nothing.
fn script(class: &str, text: &str, out: &mut Vec<u8>) -> io::Result<()> {
    writeln!(out, "<script type=\"text/plain\" class=\"{class}\">{text}</script>")
}

fn row(chunk: &Chunk, heights: &[i64]) -> [u64; 4] {
    let layer = chunk.height.and_then(|height| layer_of(height, heights)).unwrap_or(0);
    [layer as u64, chunk.vertices as u64, chunk.time[0], chunk.time[1]]
}

/// The motors that the machine has.
fn motors(summary: &Summary, settings: &Settings) -> Vec<MotorData> {
    let fitted = settings.mechanism.fitted();
    let counts = summary.steps.iter().zip(summary.net_steps.iter());
    let motors = settings.mechanism.motors().filter(|(motor, _)| fitted.has(*motor)).zip(counts);
    let data = |((_, row), ((name, steps), (_, net)))| MotorData { name, drives: drives(row), steps, net };
    motors.map(data).collect()
}

/// `x \u{2212} y`: for which axes a motor turns, and which way.
fn drives(row: Row) -> String {
    let mut text = String::new();
    for (times, axis) in row.into_iter().zip(["x", "y", "z", "e"]) {
        let sign = match (times, text.is_empty()) {
            (0, _) | (1.., true) => "",
            (1.., false) => " + ",
            (..0, true) => "\u{2212}",
            (..0, false) => " \u{2212} ",
        };
        if times != 0 {
            text.push_str(sign);
            if times.unsigned_abs() > 1 {
                text += &times.unsigned_abs().to_string();
            }
            text.push_str(axis);
        }
    }
    text
}

fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let bits = (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(chunk.get(i).copied().unwrap_or(0)));
        for i in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * i) & 63) as usize] as char;
            text.push(if i <= chunk.len() { digit } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_as_the_rfc_says() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn a_large_print_has_a_first_picture_of_its_whole_height_and_its_end() {
        assert_eq!(preview(0), [0; 0]);
        assert_eq!(preview(LARGE - 1), [0; 0]);
        for chunks in [LARGE, 488, 100_000] {
            let picked = preview(chunks);
            assert!(
                picked.is_sorted() && picked.len() <= PICKED + LAST && picked.len() > PICKED / 2 + LAST,
                "{picked:?}"
            );
            assert!(picked.ends_with(&Vec::from_iter(chunks - LAST..chunks)), "{picked:?}");
            assert!(picked.windows(2).all(|pair| pair[1] - pair[0] <= chunks.div_ceil(PICKED)), "{picked:?}");
        }
    }

    #[test]
    fn the_template_has_a_place_for_each_content() {
        assert!(MARKS.iter().all(|mark| TEMPLATE.matches(mark).count() == 1));
        assert!(MARKS.map(|mark| TEMPLATE.find(mark)).is_sorted());
    }

    #[test]
    fn a_motor_is_named_by_the_axes_that_it_turns_for() {
        assert_eq!(drives([-1, 1, 0, 0]), "\u{2212}x + y");
        assert_eq!(drives([1, -1, 0, 0]), "x \u{2212} y");
        assert_eq!(drives([5, -5, 0, 0]), "5x \u{2212} 5y");
        assert_eq!(drives([0, 0, 0, 1]), "e");
    }
}
