//! The mesh of the bed in memory: two places, and a save writes the older one.
//!
//! | bytes | content |
//! |---|---|
//! | 0..4 | `CHBM` |
//! | 4..8 | CRC-32 of all other bytes |
//! | 8..12 | sequence number |
//! | 12..16 | the machine: CRC-32 of what the mesh depends on ([`machine_of`]) |
//! | 16..32 | x and y of the first point, x and y of the last one, in um |
//! | 32..40 | x and y of the place where the height is 0, in um |
//! | 40..44 | the fade height in um |
//! | 44..48 | temperatures of bed and hotend at the measurement, in C; -32,768 for none |
//! | 48..50 | columns, rows |
//! | 50.. | heights of 2 bytes, row by row |
//!
//! Numbers are little-endian. The page with the beginning is written last, so a mesh that is not whole is none, and the
//! one before it counts.

use super::map::{MESH, NEEDED, PAGE};
use super::out::Out;
use crate::checksum::crc32;
use crate::port::{Storage, StorageError};
use crate::settings::Settings;
use crate::surface::{Heights, Mesh};
use crate::units::Mm;

const MAGIC: [u8; 4] = *b"CHBM";

/// Bytes before the heights.
const HEAD: usize = 50;

/// The number in place of a temperature without a reading.
const UNREAD: i16 = i16::MIN;

/// Points that a place has room for: 7 by 7 of them, or 9 by 6.
pub const MOST_STORED: usize = (ROOM - HEAD) / 2;

/// Bytes of a place.
const ROOM: usize = MESH[0].bytes as usize;
const _: () = assert!(MOST_STORED >= 49 && ROOM.is_multiple_of(PAGE));

/// A mesh, and where it comes from.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StoredMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Where the height is 0.
    pub reference: [Mm; 2],
    /// Temperatures of bed and hotend when it was measured, in C, where there was a reading.
    pub temperatures: [Option<i16>; 2],
}

impl StoredMesh {
    /// The same with its places elsewhere by so much.
    #[must_use]
    pub fn moved(&self, by: [Mm; 2]) -> Self {
        let [x, y] = self.reference;
        let [by_x, by_y] = by;
        Self { mesh: self.mesh.moved(by), reference: [x.saturating_add(by_x), y.saturating_add(by_y)], ..*self }
    }
}

/// What becomes of the kept mesh with other settings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshFate {
    /// There is none, or it is one of these settings, or of none that were there before.
    Stays,
    /// The probe's place is another one by so much, and the places of its points moved with it.
    Moves([Mm; 2]),
    /// The next start refuses it: steps, axes or motors are others.
    Ends,
}

/// Why there is no mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshRejected {
    /// None was saved, or the last one was forgotten.
    Blank,
    /// It is not whole: a save was cut, or the memory fails.
    Damaged,
    /// It was measured on a machine with other axes, motors or another probe.
    Machine,
}

/// Why a mesh was not saved.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MeshNotSaved {
    /// The storage's reason.
    Storage(StorageError),
    /// It has more points than [`MOST_STORED`].
    TooLarge,
    /// The storage took the bytes but does not give them back.
    NotKept,
}

impl From<StorageError> for MeshNotSaved {
    fn from(error: StorageError) -> Self {
        Self::Storage(error)
    }
}

/// What a mesh depends on, as a number: what each motor does, the axes and the probe.
#[must_use]
pub fn machine_of(s: &Settings) -> u32 {
    machine_with(s, s)
}

/// The same with the filament and the place of the probe of other settings, which change no height.
fn machine_with(s: &Settings, other: &Settings) -> u32 {
    // It takes less room than a mesh.
    let mut bytes = [0; ROOM];
    let mut out = Out::new(&mut bytes);
    for times in s.mechanism.rows.as_flattened() {
        out.put(&times.to_le_bytes());
    }
    for axis in [&s.axes.x, &s.axes.y, &s.axes.z, &other.axes.e] {
        out.put(&axis.steps_per_mm.to_bits().to_le_bytes());
        out.put(&axis.length.to_bits().to_le_bytes());
    }
    for offset in [other.probe.offset.x, other.probe.offset.y] {
        out.put(&offset.to_bits().to_le_bytes());
    }
    crc32(&[out.written().unwrap_or_default()])
}

/// Micrometres.
fn um(mm: Mm) -> i32 {
    let (whole, part) = (mm.to_bits() >> 32, mm.to_bits() & 0xFFFF_FFFF);
    (whole * 1000 + ((part * 1000 + (1 << 31)) >> 32)) as i32
}

/// A length of so many micrometres: the nearest one, so that it is the same after each save.
fn of_um(um: i32) -> Mm {
    let bits = (i64::from(um) << 32).saturating_add(500).div_euclid(1000);
    Mm::from_bits(bits)
}

/// Writes the record of a mesh, and returns its length; `None` if it has too many points.
fn encode(stored: &StoredMesh, machine: u32, sequence: u32, record: &mut [u8; ROOM]) -> Option<usize> {
    let StoredMesh { mesh, reference: [zero_x, zero_y], temperatures } = stored;
    let (heights, [x, y], [to_x, to_y]) = (mesh.heights(), mesh.first(), mesh.last());
    let (head, payload) = record.split_at_mut(MAGIC.len() + 4);
    let mut out = Out::new(payload);
    out.put(&sequence.to_le_bytes());
    out.put(&machine.to_le_bytes());
    for length in [x, y, to_x, to_y, *zero_x, *zero_y, mesh.fade()] {
        out.put(&um(length).to_le_bytes());
    }
    for celsius in temperatures {
        out.put(&celsius.unwrap_or(UNREAD).to_le_bytes());
    }
    out.put(&[heights.columns() as u8, heights.rows() as u8]);
    for height in heights.points() {
        out.put(&height.to_le_bytes());
    }
    let payload = out.written()?;
    let mut out = Out::new(head);
    out.put(&MAGIC);
    out.put(&check(payload).to_le_bytes());
    Some(out.written()?.len() + payload.len())
}

fn check(payload: &[u8]) -> u32 {
    crc32(&[&MAGIC, payload])
}

/// A record as it was read.
struct Decoded {
    stored: StoredMesh,
    machine: u32,
    sequence: u32,
}

fn decode(bytes: &[u8; ROOM]) -> Result<Decoded, MeshRejected> {
    let (head, payload) = bytes.split_at(8);
    let (magic, crc) = head.split_at(4);
    if magic != MAGIC {
        return Err(MeshRejected::Blank);
    }
    let word = |number: usize| payload.get(4 * number..4 * number + 4).and_then(|word| word.first_chunk::<4>());
    let number = |place: usize| word(place).map_or(0, |word| u32::from_le_bytes(*word));
    // They say how long the record is, so they are read before its sum proves them. A wrong length makes a wrong sum.
    let [.., columns, rows] = *payload.first_chunk::<{ HEAD - 8 }>().ok_or(MeshRejected::Damaged)?;
    let length = 2 * usize::from(columns) * usize::from(rows);
    let payload_used = payload.get(..HEAD - 8 + length).ok_or(MeshRejected::Damaged)?;
    if crc != check(payload_used).to_le_bytes() {
        return Err(MeshRejected::Damaged);
    }
    let mut heights = Heights::flat(columns.into(), rows.into()).ok_or(MeshRejected::Damaged)?;
    let points = payload_used.get(HEAD - 8..).unwrap_or_default();
    for (place, height) in points.as_chunks::<2>().0.iter().enumerate() {
        let (column, row) = (place % usize::from(columns), place / usize::from(columns));
        heights.set(column, row, i16::from_le_bytes(*height));
    }
    // Words in the order of `encode`.
    let mm = |place: usize| of_um(number(place) as i32);
    let mesh = Mesh::new(heights, [mm(2), mm(3)], [mm(4), mm(5)], mm(8)).map_err(|_| MeshRejected::Damaged)?;
    let warm = number(9);
    let temperatures = [warm as i16, (warm >> 16) as i16].map(|celsius| Some(celsius).filter(|is| *is != UNREAD));
    let stored = StoredMesh { mesh, reference: [mm(6), mm(7)], temperatures };
    Ok(Decoded { stored, machine: number(1), sequence: number(0) })
}

/// The bytes of the two places.
type Places = [[u8; ROOM]; 2];

const UNREAD_PLACES: Places = [[0; ROOM]; 2];

/// Reads the two places.
async fn look(storage: &mut impl Storage, places: &mut Places) -> Result<(), StorageError> {
    for (place, bytes) in places.iter_mut().enumerate() {
        read(storage, place, bytes).await?;
    }
    Ok(())
}

async fn read(storage: &mut impl Storage, place: usize, bytes: &mut [u8; ROOM]) -> Result<(), StorageError> {
    for (number, page) in bytes.chunks_mut(PAGE).enumerate() {
        storage.read(address(place, number), page).await?;
    }
    Ok(())
}

/// The records in the two places.
fn found([a, b]: &Places) -> [Result<Decoded, MeshRejected>; 2] {
    [decode(a), decode(b)]
}

fn address(place: usize, page: usize) -> u32 {
    MESH.get(place).map_or(0, |region| region.begin) + (page * PAGE) as u32
}

/// The place of the newest mesh.
fn newest(found: &[Result<Decoded, MeshRejected>; 2]) -> Option<usize> {
    match found {
        [Ok(a), Ok(b)] => Some(usize::from((a.sequence.wrapping_sub(b.sequence) as i32) < 0)),
        [Ok(_), Err(_)] => Some(0),
        [Err(_), Ok(_)] => Some(1),
        [Err(_), Err(_)] => None,
    }
}

/// The place of the newest mesh, and its record.
fn newest_in(places: &Places) -> Option<(usize, Decoded)> {
    let found = found(places);
    let place = newest(&found)?;
    Some((place, found.into_iter().nth(place)?.ok()?))
}

/// Whether there is memory for a mesh beside the settings.
fn can_keep(storage: &impl Storage) -> bool {
    storage.keeps_pages() && storage.capacity() >= NEEDED
}

/// The newest mesh of the machine with these settings.
///
/// # Errors
/// The storage's.
pub async fn load_mesh(
    storage: &mut impl Storage,
    s: &Settings,
) -> Result<Result<StoredMesh, MeshRejected>, StorageError> {
    if !can_keep(storage) {
        return Ok(Err(MeshRejected::Blank));
    }
    let mut places = UNREAD_PLACES;
    look(storage, &mut places).await?;
    Ok(mesh_in(&places, machine_of(s)))
}

/// The newest mesh of a machine. A separate function, because records are large: otherwise their copies would be in
/// memory while the storage is read.
#[inline(never)]
fn mesh_in(places: &Places, machine: u32) -> Result<StoredMesh, MeshRejected> {
    let found = found(places);
    let damaged = found.iter().any(|found| matches!(found, Err(MeshRejected::Damaged)));
    let [newest, other] = match (newest(&found), &found) {
        (Some(1), [a, b]) => [b.as_ref().ok(), a.as_ref().ok()],
        (_, [a, b]) => [a.as_ref().ok(), b.as_ref().ok()],
    };
    match (newest, other) {
        (Some(found), _) if found.machine == machine => Ok(found.stored),
        // It was moved for settings that a cut has kept from storage.
        (Some(newest), Some(found))
            if found.machine == machine && found.stored.mesh.heights() == newest.stored.mesh.heights() =>
        {
            Ok(found.stored)
        }
        (Some(_), _) => Err(MeshRejected::Machine),
        (None, _) if damaged => Err(MeshRejected::Damaged),
        (None, _) => Err(MeshRejected::Blank),
    }
}

/// Whether a mesh is kept that is not of these settings.
///
/// # Errors
/// The storage's.
pub async fn is_of_others(storage: &mut impl Storage, s: &Settings) -> Result<bool, StorageError> {
    if !can_keep(storage) {
        return Ok(false);
    }
    let mut places = UNREAD_PLACES;
    look(storage, &mut places).await?;
    Ok(newest_in(&places).is_some_and(|(_, newest)| newest.machine != machine_of(s)))
}

/// Makes the kept mesh one of the settings `now`, if it is of those `before` and the change leaves it right.
///
/// # Errors
/// If it is not safely stored.
pub async fn follow_settings(
    storage: &mut impl Storage,
    before: &Settings,
    now: &Settings,
) -> Result<MeshFate, MeshNotSaved> {
    let Ok(stored) = load_mesh(storage, before).await? else { return Ok(MeshFate::Stays) };
    if machine_of(before) != machine_with(now, before) {
        return Ok(MeshFate::Ends);
    }
    let by = before.probe.way_to(&now.probe);
    save_mesh(storage, &stored.moved(by), now).await?;
    Ok(MeshFate::Moves(by))
}

/// Saves a mesh, and reads it back. Writes nothing if it is the newest one already.
///
/// # Errors
/// If it is not safely stored; then the one before still is.
pub async fn save_mesh(storage: &mut impl Storage, mesh: &StoredMesh, s: &Settings) -> Result<(), MeshNotSaved> {
    if !can_keep(storage) {
        return Err(StorageError::Absent.into());
    }
    let (mut places, mut record) = (UNREAD_PLACES, [0; ROOM]);
    look(storage, &mut places).await?;
    let Some((place, length)) = next_record(&places, mesh, machine_of(s), &mut record)? else { return Ok(()) };
    let used = record.get(..length).unwrap_or_default();
    // The header with the sum is the last to come, so a cut leaves no whole record.
    for (number, page) in used.chunks(PAGE).enumerate().rev() {
        storage.write(address(place, number), page).await?;
    }
    let [kept, _] = &mut places;
    read(storage, place, kept).await?;
    if kept.get(..length) == Some(used) { Ok(()) } else { Err(MeshNotSaved::NotKept) }
}

/// Makes the record that a save is to write, and says to which place and how long it is. `None` if the newest record is
/// of the same mesh: places count in um.
#[inline(never)]
fn next_record(
    places: &Places,
    mesh: &StoredMesh,
    machine: u32,
    record: &mut [u8; ROOM],
) -> Result<Option<(usize, usize)>, MeshNotSaved> {
    let mut make = |sequence: u32| encode(mesh, machine, sequence, record).ok_or(MeshNotSaved::TooLarge);
    let Some((place, Decoded { sequence, .. })) = newest_in(places) else {
        return Ok(Some((0, make(1)?)));
    };
    let length = make(sequence)?;
    if places.get(place).and_then(|newest| newest.get(..length)) == record.get(..length) {
        return Ok(None);
    }
    let length = encode(mesh, machine, sequence.wrapping_add(1), record);
    Ok(Some((1 - place, length.ok_or(MeshNotSaved::TooLarge)?)))
}

/// Forgets all meshes: their beginnings are written over, the newest one's last. Otherwise a cut would leave the older
/// one, which a start would take for the newest.
///
/// # Errors
/// The storage's.
pub async fn forget_mesh(storage: &mut impl Storage) -> Result<(), StorageError> {
    if !can_keep(storage) {
        return Ok(());
    }
    let mut places = UNREAD_PLACES;
    look(storage, &mut places).await?;
    let newest = newest_in(&places).map_or(0, |(place, _)| place);
    for place in [1 - newest, newest] {
        if places.get(place).is_some_and(|bytes| decode(bytes).is_ok()) {
            storage.write(address(place, 0), &[0xFF; MAGIC.len()]).await?;
        }
    }
    Ok(())
}
