//! The mesh in a memory with power that can be cut, beside the settings.

use super::memories::{Cut, Eeprom, Stuck, TORN, now};
use corehbot::port::{NoStorage, StorageError};
use corehbot::settings::Settings;
use corehbot::storage::{self, MOST_STORED, MeshFate, MeshNotSaved, MeshRejected, StoredMesh};
use corehbot::surface::{Heights, Mesh};
use corehbot::units::Mm;

fn mesh(columns: usize, rows: usize, seed: i16) -> StoredMesh {
    let mut heights = Heights::flat(columns, rows).unwrap();
    for row in 0..rows {
        for column in 0..columns {
            heights.set(column, row, (column as i16 * 37 - row as i16 * 53) * 5 + seed);
        }
    }
    let place = |x: f64, y: f64| [Mm::from_num(x), Mm::from_num(y)];
    let mesh = Mesh::new(heights, place(10.0, 12.5), place(380.0, 400.25), Mm::from_num(20)).unwrap();
    StoredMesh { mesh, reference: place(195.0, 208.75), temperatures: [Some(-3), None] }
}

fn load(eeprom: &mut Eeprom, s: &Settings) -> Result<StoredMesh, MeshRejected> {
    now(storage::load_mesh(eeprom, s)).unwrap()
}

#[test]
fn the_mesh_that_was_saved_last_is_read_and_the_settings_stay() {
    let s = Settings::prototype();
    let mut eeprom = Eeprom::with(&[s]);
    assert_eq!(load(&mut eeprom, &s), Err(MeshRejected::Blank));
    for seed in 0..5 {
        let mesh = mesh(7, 7, seed);
        assert_eq!(now(storage::save_mesh(&mut eeprom, &mesh, &s)), Ok(()));
        assert_eq!(load(&mut eeprom, &s), Ok(mesh));
        let writes = eeprom.writes.len();
        assert_eq!(now(storage::save_mesh(&mut eeprom, &mesh, &s)), Ok(()));
        assert_eq!(eeprom.writes.len(), writes, "an unchanged mesh is not written again");
    }
    assert_eq!(now(storage::survey(&mut eeprom)).unwrap().newest.map(|stored| stored.settings), Some(s));
    now(storage::forget_mesh(&mut eeprom)).unwrap();
    assert_eq!(load(&mut eeprom, &s), Err(MeshRejected::Blank));
}

#[test]
fn a_mesh_of_another_machine_is_none() {
    let s = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    now(storage::save_mesh(&mut eeprom, &mesh(5, 5, 1), &s)).unwrap();
    let changes: [fn(&mut Settings); 4] = [
        |s| s.mechanism.rows.swap(0, 1),
        |s| s.axes.x.length = Mm::from_num(200),
        |s| s.probe.offset.x = Mm::from_num(-20),
        |s| s.axes.z.steps_per_mm = s.axes.x.steps_per_mm,
    ];
    for change in changes {
        let mut other = s;
        change(&mut other);
        assert_eq!(load(&mut eeprom, &other), Err(MeshRejected::Machine));
    }
    let mut renamed = s;
    renamed.keepalive_s += 1;
    assert_eq!(load(&mut eeprom, &renamed), Ok(mesh(5, 5, 1)));
}

#[test]
fn a_mesh_follows_a_probe_that_is_elsewhere_and_no_other_change() {
    let s = Settings::prototype();
    let (mut moved, mut longer, mut fed) = (s, s, s);
    (moved.probe.offset.x, moved.probe.offset.y) = (Mm::from_num(-1.5), Mm::from_num(2));
    longer.axes.y.length = Mm::from_num(300);
    fed.axes.e.steps_per_mm = s.axes.x.steps_per_mm;
    let fate = |eeprom: &mut Eeprom, before: &Settings, after: &Settings| {
        assert_eq!(now(storage::is_of_others(eeprom, before)), Ok(false));
        now(storage::follow_settings(eeprom, before, after)).unwrap()
    };
    let mut eeprom = Eeprom::blank();
    assert_eq!(fate(&mut eeprom, &s, &moved), MeshFate::Stays);
    now(storage::save_mesh(&mut eeprom, &mesh(5, 5, 1), &s)).unwrap();
    assert_eq!(fate(&mut eeprom, &s, &longer), MeshFate::Ends);
    assert_eq!(load(&mut eeprom, &s), Ok(mesh(5, 5, 1)));
    let by = [Mm::from_num(-1.5), Mm::from_num(2)];
    assert_eq!(fate(&mut eeprom, &s, &moved), MeshFate::Moves(by));
    assert_eq!(now(storage::is_of_others(&mut eeprom, &moved)), Ok(false));
    let place = |x: f64, y: f64| [Mm::from_num(x), Mm::from_num(y)];
    let found = load(&mut eeprom, &moved).unwrap();
    assert_eq!([found.mesh.first(), found.mesh.last()], [place(8.5, 14.5), place(378.5, 402.25)]);
    assert_eq!((found.reference, found.mesh.heights()), (place(193.5, 210.75), mesh(5, 5, 1).mesh.heights()));
    // Power was cut before the settings were in storage, too: the mesh is still that of the old ones.
    assert_eq!(load(&mut eeprom, &s), Ok(mesh(5, 5, 1)));
    now(storage::save_mesh(&mut eeprom, &mesh(5, 5, 2), &moved)).unwrap();
    now(storage::save_mesh(&mut eeprom, &mesh(5, 5, 3), &moved)).unwrap();
    assert_eq!(load(&mut eeprom, &s), Err(MeshRejected::Machine));
    fed.probe = moved.probe;
    assert_eq!(fate(&mut eeprom, &moved, &fed), MeshFate::Moves([Mm::ZERO; 2]));
    assert_eq!(load(&mut eeprom, &fed), Ok(mesh(5, 5, 3)));
}

#[test]
fn a_cut_save_leaves_the_mesh_before_or_the_new_one() {
    let s = Settings::prototype();
    let mut start = Eeprom::with(&[s]);
    let (old, new) = (mesh(7, 7, 100), mesh(6, 5, -700));
    now(storage::save_mesh(&mut start, &old, &s)).unwrap();
    let mut whole = start.clone();
    whole.writes.clear();
    now(storage::save_mesh(&mut whole, &new, &s)).unwrap();
    for left in 0..whole.bytes_written() {
        for torn in TORN {
            for whole_page in [false, true] {
                let mut eeprom = start.clone();
                let mut cut = Cut { eeprom: &mut eeprom, left, torn, whole_page, is_dead: false };
                let result = now(storage::save_mesh(&mut cut, &new, &s));
                assert_eq!(result, Err(MeshNotSaved::Storage(StorageError::Failed)));
                let found = load(&mut eeprom, &s);
                assert!(found == Ok(old) || found == Ok(new), "cut after {left}: {found:?}");
                assert!(now(storage::survey(&mut eeprom)).unwrap().newest.is_some());
            }
        }
    }
}

/// *Reproducer*: a cut while the meshes were forgotten left the older one, which a start then took for the last.
#[test]
fn forgetting_that_is_cut_leaves_the_last_mesh_or_none() {
    let s = Settings::prototype();
    for saves in 2..4 {
        let mut start = Eeprom::blank();
        for seed in 0..saves {
            now(storage::save_mesh(&mut start, &mesh(5, 5, seed), &s)).unwrap();
        }
        let mut whole = start.clone();
        whole.writes.clear();
        now(storage::forget_mesh(&mut whole)).unwrap();
        for left in 0..whole.bytes_written() {
            for torn in TORN {
                let mut eeprom = start.clone();
                let mut cut = Cut { eeprom: &mut eeprom, left, torn, whole_page: false, is_dead: false };
                let _ = now(storage::forget_mesh(&mut cut));
                let found = load(&mut eeprom, &s);
                let is_older = found.is_ok_and(|found| found != mesh(5, 5, saves - 1));
                assert!(!is_older, "{saves} saves, cut after {left}: {found:?}");
            }
        }
    }
}

#[test]
fn p12_a_flipped_bit_is_found() {
    let s = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    now(storage::save_mesh(&mut eeprom, &mesh(5, 4, 9), &s)).unwrap();
    let (begin, bytes) =
        eeprom.writes.iter().fold((u32::MAX, 0), |(begin, bytes), (at, size)| (begin.min(*at), bytes + size));
    for bit in 0..8 * bytes {
        let mut damaged = eeprom.clone();
        damaged.cells[begin as usize + bit / 8] ^= 1 << (bit % 8);
        let found = load(&mut damaged, &s);
        assert!(matches!(found, Err(MeshRejected::Damaged | MeshRejected::Blank)), "bit {bit}: {found:?}");
    }
}

#[test]
fn what_does_not_fit_or_is_not_kept_is_told() {
    let s = Settings::prototype();
    let mut eeprom = Eeprom::blank();
    const { assert!(MOST_STORED >= 49) };
    assert_eq!(now(storage::save_mesh(&mut eeprom, &mesh(9, 9, 0), &s)), Err(MeshNotSaved::TooLarge));
    assert!(eeprom.writes.is_empty());
    let absent = Err(MeshNotSaved::Storage(StorageError::Absent));
    assert_eq!(now(storage::save_mesh(&mut NoStorage, &mesh(3, 3, 0), &s)), absent);
    let mut stuck = Stuck(Eeprom::blank(), 1280 + 40);
    assert_eq!(now(storage::save_mesh(&mut stuck, &mesh(3, 3, 0), &s)), Err(MeshNotSaved::NotKept));
}
