//! Mesh log: the mesh that z follows, and its effect on the nozzle over the true bed.
//!
//! The firmware counts places from another zero than the rig, because homing finds zero by its own means. So the log
//! knows the difference, and asks the firmware's own frame of the mesh for the correction at a place.
//!
//! A place counts for the first layer if filament was laid there at the least z at which any was laid. The nozzle's
//! true distance from the bed there should be that z. It is off by an error `after` the correction. The correction
//! taken off, it would be off by the error `before`.

use corehbot::kinematics::ForwardKinematics;
use corehbot::motion::SurfaceFrame;
use corehbot::motors::MOTORS;
use corehbot::settings::Settings;
use corehbot::surface::{Heights, UNITS_PER_MM};
use corehbot::units::Steps;
use corehbot_rig::bed::BedPlant;
use corehbot_twin::math::hypot;

/// A place is looked at after so many mm of way.
const EVERY_MM: f64 = 0.25;

/// Filament is of the same layer within so many mm of z: less than any layer is thick, more than a step of z.
const SAME_LAYER_MM: f64 = 0.02;

/// The program's z is known to a step of z or two, which must not make layers. So it is shown in so many mm, and stays
/// until it is off by so many.
const SHOWN_MM: f64 = 0.005;
const STAYS_MM: f64 = 0.004;

/// The true error over the mesh is taken at so many places along x, and along y.
const PLACES: usize = 41;

/// A mesh with its place, in mm of the firmware.
#[derive(Clone, PartialEq, Debug)]
pub struct MeshFigures {
    /// Place of the first column and row, and of the last ones.
    pub corners_mm: [[f64; 2]; 2],
    /// Heights, row by row from the front.
    pub heights_mm: Vec<Vec<f64>>,
    /// Their mean.
    pub mean_mm: f64,
    /// The height up to which it fades; `None` if it does not.
    pub fade_height_mm: Option<f64>,
}

/// Root mean square and largest size of errors.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Errors {
    /// Root mean square.
    pub rms_mm: f64,
    /// Largest size.
    pub max_mm: f64,
}

/// Errors with the correction taken off, and as they were.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Improvement {
    /// Without the mesh.
    pub before: Errors,
    /// With it.
    pub after: Errors,
}

/// What a mesh was, and what it did. The mesh is the last one that z followed, all else is of all meshes.
#[derive(Clone, PartialEq, Debug)]
pub struct MeshEffect {
    /// The mesh.
    pub mesh: MeshFigures,
    /// Least and greatest correction of z.
    pub correction_mm: [f64; 2],
    /// Steps of z that a flat bed would not have taken.
    pub z_steps_added: u64,
    /// z of the first layer, and its errors against the true bed.
    pub first_layer: Option<(f64, Improvement)>,
    /// The mesh against the true bed, over the area of the mesh.
    pub area: Option<Improvement>,
}

/// Sums of errors.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    squares: [f64; 2],
    most: [f64; 2],
}

impl Sums {
    /// Adds an error before and after.
    fn add(&mut self, errors: [f64; 2]) {
        self.count += 1.0;
        for ((square, most), error) in self.squares.iter_mut().zip(&mut self.most).zip(errors) {
            *square += error * error;
            *most = most.max(error.abs());
        }
    }

    fn improvement(&self) -> Option<Improvement> {
        let errors = |i: usize| Errors { rms_mm: (self.squares[i] / self.count).sqrt(), max_mm: self.most[i] };
        (self.count > 0.0).then(|| Improvement { before: errors(0), after: errors(1) })
    }
}

/// A way to and fro, in steps, without what whole steps add to it: it follows a place by a step.
#[derive(Clone, Copy, Default)]
struct Way {
    at: f64,
    sum: f64,
}

impl Way {
    fn begin(&mut self, place: f64) {
        self.at = place;
    }

    fn go(&mut self, place: f64) {
        let at = self.at.clamp(place - 1.0, place + 1.0);
        self.sum += (at - self.at).abs();
        self.at = at;
    }
}

/// The surface that the firmware follows.
struct Surface {
    frame: SurfaceFrame,
    heights: Heights,
}

/// Watches the nozzle while z follows a mesh.
pub struct MeshLog {
    /// Where motors bring the tool, and steps of x, y and z a mm.
    back: ForwardKinematics<{ MOTORS }>,
    pitch: [f64; 3],
    extruder: Option<usize>,
    /// The last surface, and whether z follows it.
    surface: Option<Surface>,
    is_on: bool,
    mesh: Option<MeshFigures>,
    /// The firmware's place less the nozzle's, in mm.
    offset: [f64; 3],
    /// Ways of z of the motors and of the program.
    ways: [Way; 2],
    correction: [f64; 2],
    /// The place and the filament of the last look, in mm and steps.
    seen: Option<([f64; 3], i32)>,
    /// The program's z there, as it is shown, in mm.
    shown: f64,
    layer: Option<f64>,
    errors: Sums,
}

impl MeshLog {
    /// A log for a machine.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let axes = &settings.axes;
        Self {
            back: settings.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::NONE),
            pitch: [axes.x, axes.y, axes.z].map(|axis| axis.steps_per_mm.to_num()),
            extruder: settings.mechanism.extruder().map(|motor| motor.index()),
            surface: None,
            is_on: false,
            mesh: None,
            offset: [0.0; 3],
            ways: [Way::default(); 2],
            correction: [0.0; 2],
            seen: None,
            shown: 0.0,
            layer: None,
            errors: Sums::default(),
        }
    }

    /// Whether z follows a surface.
    #[must_use]
    pub const fn is_on(&self) -> bool {
        self.is_on
    }

    /// The program's z where the nozzle is, in mm; `None` if z follows no mesh.
    #[must_use]
    pub fn z(&self) -> Option<f64> {
        (self.is_on && self.seen.is_some()).then_some(self.shown)
    }

    /// Whether z follows another surface than the log knows.
    #[must_use]
    pub fn is_news(&self, surface: Option<(&SurfaceFrame, &Heights)>) -> bool {
        match (self.surface.as_ref().filter(|_| self.is_on), surface) {
            (None, None) => false,
            (Some(known), Some((frame, heights))) => known.frame != *frame || known.heights != *heights,
            _ => true,
        }
    }

    /// Z follows this surface from now on, or none.
    pub fn follow(&mut self, surface: Option<(&SurfaceFrame, &Heights)>) {
        self.is_on = surface.is_some();
        if let Some((frame, heights)) = surface {
            self.surface = Some(Surface { frame: *frame, heights: *heights });
            self.mesh = Some(figures(frame, heights, self.pitch));
        }
        self.seen = None;
    }

    /// The nozzle is at this place in mm, where the firmware counts its motors so.
    pub fn stand(&mut self, nozzle: [f64; 3], counts: &[i32; MOTORS]) {
        let place = self.back.fractions(&counts.map(i64::from));
        for (i, (sum, over)) in place.into_iter().take(3).enumerate() {
            self.offset[i] = sum as f64 / (over as f64 * self.pitch[i]) - nozzle[i];
        }
        self.seen = None;
    }

    /// The nozzle has come to this place, and motors have made these steps.
    pub fn event(&mut self, nozzle: [f64; 3], counts: &[i32; MOTORS], bed: Option<&BedPlant>) {
        let Some(Surface { frame, heights }) = self.surface.as_ref().filter(|_| self.is_on) else { return };
        let filament = self.extruder.map_or(0, |motor| counts[motor]);
        let (before, fed) = match self.seen {
            Some((before, fed)) => (Some(before), filament.wrapping_sub(fed)),
            None => (None, 0),
        };
        let way = before.map_or(0.0, |[x, y, _]: [f64; 3]| hypot(nozzle[0] - x, nozzle[1] - y));
        if before.is_some_and(|[.., z]| z == nozzle[2]) && way < EVERY_MM {
            return;
        }
        let real: [f64; 3] = std::array::from_fn(|i| nozzle[i] + self.offset[i]);
        let steps = |i: usize| Steps::from_num(real[i] * self.pitch[i]);
        let planned = frame.to_planned(heights, [steps(0), steps(1), steps(2), Steps::ZERO]);
        let planned: f64 = planned[2].to_num();
        let height = planned / self.pitch[2];
        if (height - self.shown).abs() > STAYS_MM {
            self.shown = (height / SHOWN_MM).round() * SHOWN_MM;
        }
        let places = [real[2] * self.pitch[2], planned];
        let correction = (places[0] - planned) / self.pitch[2];
        for (way, place) in self.ways.iter_mut().zip(places) {
            if before.is_some() { way.go(place) } else { way.begin(place) }
        }
        if way < EVERY_MM && before.is_some() {
            // Only z has moved: the way and the filament go on.
            self.seen = before.map(|[x, y, _]| ([x, y, nozzle[2]], filament.wrapping_sub(fed)));
        } else {
            self.seen = Some((nozzle, filament));
        }
        if before.is_none() || way < EVERY_MM {
            return;
        }
        self.correction = [self.correction[0].min(correction), self.correction[1].max(correction)];
        if let Some(bed) = bed.filter(|_| fed > 0) {
            let [x, y, z] = nozzle;
            let off = z - bed.height([x, y]) - height;
            self.lay(height, [off - correction, off]);
        }
    }

    /// Filament is laid at a height, with these errors before and after.
    fn lay(&mut self, height: f64, errors: [f64; 2]) {
        let layer = *self.layer.get_or_insert(height);
        if height < layer - SAME_LAYER_MM {
            (self.layer, self.errors) = (Some(height), Sums::default());
        } else if height > layer + SAME_LAYER_MM {
            return;
        }
        self.errors.add(errors);
    }

    /// What the mesh did, if z ever followed one, over this bed as it is now.
    #[must_use]
    pub fn effect(&self, bed: Option<&BedPlant>) -> Option<MeshEffect> {
        let mesh = self.mesh.clone()?;
        let [real, planned] = self.ways;
        let area = bed.and_then(|bed| self.area(&mesh, bed));
        Some(MeshEffect {
            correction_mm: self.correction,
            z_steps_added: (real.sum - planned.sum).max(0.0).round() as u64,
            first_layer: self.layer.zip(self.errors.improvement()),
            area,
            mesh,
        })
    }

    /// The errors of the mesh over its own area.
    fn area(&self, mesh: &MeshFigures, bed: &BedPlant) -> Option<Improvement> {
        let Surface { frame, heights } = self.surface.as_ref()?;
        let mut sums = Sums::default();
        let at = |i: usize, part: usize| {
            let [first, last] = mesh.corners_mm.map(|corner| corner[i]);
            first + (last - first) * part as f64 / (PLACES - 1) as f64
        };
        for (i, j) in (0..PLACES).flat_map(|i| (0..PLACES).map(move |j| (i, j))) {
            let (x, y) = (at(0, i), at(1, j));
            let steps = [x * self.pitch[0], y * self.pitch[1]].map(Steps::from_num);
            let raised = frame.to_real(heights, [steps[0], steps[1], Steps::ZERO, Steps::ZERO]);
            let raised = raised[2].to_num::<f64>() / self.pitch[2];
            // Where the firmware's z is 0 the nozzle is so high over the bed.
            let flat = -self.offset[2] - bed.height([x - self.offset[0], y - self.offset[1]]);
            sums.add([flat, flat + raised]);
        }
        sums.improvement()
    }
}

/// A mesh in mm.
fn figures(frame: &SurfaceFrame, heights: &Heights, pitch: [f64; 3]) -> MeshFigures {
    let mm = |units: f64| units / f64::from(UNITS_PER_MM);
    let rows = (0..heights.rows())
        .map(|row| (0..heights.columns()).map(|column| mm(f64::from(heights.get(column, row)))).collect::<Vec<_>>());
    let corners = frame.corners().map(|[x, y]| [f64::from(x) / pitch[0], f64::from(y) / pitch[1]]);
    let fade = f64::from(frame.fade_height()) / pitch[2];
    MeshFigures {
        corners_mm: corners,
        heights_mm: rows.collect(),
        mean_mm: mm(f64::from(heights.mean())),
        fade_height_mm: (fade > 0.0).then_some(fade),
    }
}
