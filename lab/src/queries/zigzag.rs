//! Zig-zag: the tool's path at step resolution, when motors make their steps one after the other and in one instant.
//!
//! Carlyle (CoreXYZ, 2014): a firmware that steps one motor at a time moves a CoreXY on a tiny zig-zag, and a CoreXYZ
//! on a helix; motors that step together move straight. The tool stands where the motors' belts agree best (least
//! squares), as on belts of one stiffness.

use corehbot_twin::geometry::workspace;
use corehbot_twin::math::square;
use corehbot_twin::model::coordinate::Coordinate;
use corehbot_twin::model::elastic::Freedom;
use corehbot_twin::model::ways::{Ways, residual_mm};
use corehbot_twin::params::Params;
use corehbot_twin::queries::{Setup, shown};
use corehbot_twin::routing::Machine;
use corehbot_twin::solve::NotHeld;
use corehbot_twin::solve::modes::{mode_of, modes};
use serde::Serialize;

/// The machines of the study.
pub const MACHINES: [Machine; 4] = [Machine::CoreXy, Machine::CoreXyzThree, Machine::CoreXyz, Machine::CoreHBot];

/// Names of the axes.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// Most motors of which all orders are tried.
const MOST_MOTORS: usize = 5;

/// Smaller parts of a step count as none.
const NONE: f64 = 1e-9;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Ask {
    /// The axis that moves: 0 to 2.
    pub axis: usize,
    /// Steps of the axis.
    pub steps: u32,
    /// Length of a step, mm.
    pub step_mm: f64,
    /// Speed of the move, for what is left of the zig-zag.
    pub speed_mm_s: f64,
    /// The motors' order by their names; Carlyle's (A, B, C, D) without it.
    pub order: Option<Vec<String>>,
    /// Every second step has the opposite order.
    pub alternates: bool,
}

/// The paths of one machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Zigzag {
    /// The machine.
    pub machine: &'static str,
    /// The axis that moves.
    pub axis: &'static str,
    /// Length of a step of the axis.
    pub step_mm: f64,
    /// The motors' steps of one step of the axis, in their order.
    pub order: Vec<String>,
    /// The tool's places after each motor's step, from 0.
    pub one_after_the_other_mm: Vec<[f64; 3]>,
    /// The tool's places after each step of all motors, from 0.
    pub in_one_instant_mm: Vec<[f64; 3]>,
    /// Greatest way aside.
    pub aside_mm: f64,
    /// The same in steps of the axis.
    pub aside_steps: f64,
    /// Width of the path across the axis, in steps: the greatest distance of two of its places.
    pub width_steps: f64,
    /// Greatest residual, in steps; none on a machine without one.
    pub residual_steps: Option<f64>,
    /// Ways aside of all orders, in steps: how many orders have it, and their residual.
    pub orders: Vec<Orders>,
    /// Speed of the move.
    pub speed_mm_s: f64,
    /// Frequency of the zig-zag at this speed.
    #[serde(rename = "zigzag_Hz")]
    pub zigzag_hz: f64,
    /// Frequency of the tool across the move on its belts, motors fixed: the highest of the modes of the other axes.
    #[serde(rename = "tool_Hz")]
    pub tool_hz: f64,
    /// Part of the zig-zag that the tool follows at this speed: f0^2 / |f^2 - f0^2|, the largest of the axes across.
    pub followed: f64,
}

/// Orders of the motors that move the tool aside alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Orders {
    /// Greatest way aside, in steps.
    pub aside_steps: f64,
    /// Greatest residual, in steps.
    pub residual_steps: Option<f64>,
    /// How many there are.
    pub count: usize,
    /// One of them.
    pub example: Vec<String>,
}

/// Why there is no path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ZigzagError {
    /// No motor of this machine moves the axis.
    NoAxis(&'static str, &'static str),
    /// The order does not name each motor once; these move the axis.
    Order(Vec<String>),
    /// The machine has more motors than orders can be tried for.
    TooMany(usize),
    /// Nothing holds the machine.
    NotHeld(NotHeld),
}

impl std::fmt::Display for ZigzagError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoAxis(machine, axis) => write!(f, "the belts of a {machine} do not move {axis}"),
            Self::Order(known) => write!(f, "the order must name each motor once: {}", known.join(",")),
            Self::TooMany(count) => write!(f, "{count} motors move this axis; up to {MOST_MOTORS} can be ordered"),
            Self::NotHeld(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for ZigzagError {}

/// One motor's step.
#[derive(Clone, Debug)]
struct Turn {
    index: usize,
    name: String,
    /// Belt per step of the axis.
    way: f64,
}

impl Zigzag {
    /// The paths of a machine with these numbers.
    ///
    /// # Errors
    /// See [`ZigzagError`].
    pub fn new(machine: Machine, params: &Params, ask: &Ask) -> Result<Self, ZigzagError> {
        let axis = AXES.get(ask.axis).copied().unwrap_or_default();
        let ways = Ways::new(machine, params);
        let turns = turns(&ways, ask.axis);
        if turns.is_empty() {
            return Err(ZigzagError::NoAxis(machine.name(), axis));
        }
        if turns.len() > MOST_MOTORS {
            return Err(ZigzagError::TooMany(turns.len()));
        }
        let order = ordered(turns, ask.order.as_deref())?;
        let path = Path { machine, ways: &ways, axis: ask.axis };
        let played = path.play(&order, ask.steps, ask.alternates);
        let mut orders: Vec<Orders> = Vec::new();
        for one in permutations(&order) {
            let Played { aside, residual, .. } = path.play(&one, 1, false);
            let alike = |other: &&mut Orders| {
                let strain = other.residual_steps.unwrap_or(0.0) - residual.unwrap_or(0.0);
                (other.aside_steps - aside).abs() < NONE && strain.abs() < NONE
            };
            match orders.iter_mut().find(alike) {
                Some(orders) => orders.count += 1,
                None => {
                    orders.push(Orders { aside_steps: aside, residual_steps: residual, count: 1, example: names(&one) })
                }
            }
        }
        orders.sort_by(|a, b| a.aside_steps.total_cmp(&b.aside_steps));
        let setup = Setup {
            machine,
            params: params.clone(),
            tool: workspace(machine, params).centre(),
            freedom: Freedom::default(),
        };
        let found = modes(&setup.elastic()).map_err(ZigzagError::NotHeld)?;
        let across =
            Coordinate::TOOL.into_iter().take(machine.axes()).enumerate().filter(|(axis, _)| *axis != ask.axis);
        let tool_hz: Vec<f64> =
            across.filter_map(|(_, coordinate)| mode_of(&found, coordinate)).map(|mode| mode.frequency_hz).collect();
        // With every second order reversed the path repeats after two steps.
        let period_mm = if ask.alternates { 2.0 * ask.step_mm } else { ask.step_mm };
        let zigzag_hz = ask.speed_mm_s / period_mm;
        let mm = |places: &[[f64; 3]]| places.iter().map(|place| place.map(|v| v * ask.step_mm)).collect();
        Ok(Self {
            machine: machine.key(),
            axis,
            step_mm: ask.step_mm,
            order: names(&order),
            one_after_the_other_mm: mm(&played.places),
            in_one_instant_mm: mm(&path.together(&order, ask.steps)),
            aside_mm: played.aside * ask.step_mm,
            aside_steps: played.aside,
            width_steps: played.width,
            residual_steps: played.residual,
            orders,
            speed_mm_s: ask.speed_mm_s,
            zigzag_hz,
            followed: tool_hz
                .iter()
                .map(|own| own * own / (zigzag_hz * zigzag_hz - own * own).abs())
                .fold(0.0, f64::max),
            tool_hz: tool_hz.into_iter().fold(0.0, f64::max),
        })
    }
}

/// The steps of the motors for a step of an axis, by their letters where Carlyle names them all.
fn turns(ways: &Ways, axis: usize) -> Vec<Turn> {
    let letters: Option<Vec<&str>> =
        ways.rows.iter().map(|row| carlyle(row.map(|entry| entry.round() as i8))).collect();
    // Two motors of an AWD CoreXY would have one letter.
    let letters = letters.filter(|letters| letters.iter().all(|one| letters.iter().filter(|l| *l == one).count() == 1));
    let name = |(index, number): (usize, &u8)| {
        let letter = letters.as_ref().and_then(|letters| letters.get(index));
        letter.map_or_else(|| number.to_string(), |letter| (*letter).to_owned())
    };
    let ways = ways.motors.iter().enumerate().map(name).zip(&ways.rows).enumerate();
    let turn = |(index, (name, row)): (usize, (String, &[f64; 3]))| {
        let way = row.get(axis).copied().unwrap_or(0.0);
        (way.abs() > NONE).then_some(Turn { index, name, way })
    };
    let mut turns: Vec<Turn> = ways.filter_map(turn).collect();
    if letters.is_some() {
        turns.sort_by(|a, b| a.name.cmp(&b.name));
    }
    turns
}

/// The letter of a motor in Carlyle's tables for CoreXY and CoreXYZ.
const fn carlyle(row: [i8; 3]) -> Option<&'static str> {
    match row {
        [1, -1, 0] | [1, 1, 1] => Some("A"),
        [1, 1, 0] | [1, -1, 1] => Some("B"),
        [-1, -1, 1] => Some("C"),
        [-1, 1, 1] => Some("D"),
        _ => None,
    }
}

fn ordered(turns: Vec<Turn>, order: Option<&[String]>) -> Result<Vec<Turn>, ZigzagError> {
    let Some(order) = order else { return Ok(turns) };
    let found: Vec<Turn> = order
        .iter()
        .filter_map(|name| turns.iter().find(|turn| turn.name.eq_ignore_ascii_case(name)).cloned())
        .collect();
    let is_whole = turns.iter().all(|turn| found.iter().filter(|other| other.index == turn.index).count() == 1);
    if is_whole && found.len() == order.len() {
        Ok(found)
    } else {
        Err(ZigzagError::Order(turns.into_iter().map(|turn| turn.name).collect()))
    }
}

/// "+A", "-C".
fn names(turns: &[Turn]) -> Vec<String> {
    turns.iter().map(|turn| format!("{}{}", if turn.way < 0.0 { '-' } else { '+' }, turn.name)).collect()
}

/// All orders (Heap's algorithm is not needed for five at most): each element inserted at each place.
fn permutations(turns: &[Turn]) -> Vec<Vec<Turn>> {
    let mut all = vec![Vec::new()];
    for turn in turns {
        let longer = |order: Vec<Turn>| {
            (0..=order.len()).map(move |place| {
                let mut with = order.clone();
                with.insert(place, turn.clone());
                with
            })
        };
        all = all.into_iter().flat_map(longer).collect();
    }
    all
}

struct Path<'w> {
    machine: Machine,
    ways: &'w Ways,
    axis: usize,
}

/// A path in steps of the axis.
struct Played {
    places: Vec<[f64; 3]>,
    aside: f64,
    width: f64,
    residual: Option<f64>,
}

impl Path<'_> {
    /// One motor after the other.
    fn play(&self, order: &[Turn], steps: u32, alternates: bool) -> Played {
        let mut turned = vec![0.0; self.ways.motors.len()];
        let mut places = vec![[0.0; 3]];
        let mut residual: Option<f64> = residual_mm(self.machine, &turned);
        for step in 0..steps {
            let mut turns: Vec<&Turn> = order.iter().collect();
            if alternates && step % 2 == 1 {
                turns.reverse();
            }
            for Turn { index, way, .. } in turns {
                turned.iter_mut().skip(*index).take(1).for_each(|motor| *motor += way);
                places.push(self.ways.tool(&turned));
                residual = residual_mm(self.machine, &turned).map(|now| residual.unwrap_or(0.0).max(now.abs()));
            }
        }
        let across = |[a, b]: [&[f64; 3]; 2]| {
            let apart = (0..3).filter(|axis| *axis != self.axis).map(|axis| square(a[axis] - b[axis]));
            apart.sum::<f64>().sqrt()
        };
        let aside = places.iter().map(|place| across([place, &[0.0; 3]])).fold(0.0, f64::max);
        let pairs = places.iter().flat_map(|a| places.iter().map(move |b| [a, b]));
        Played { aside, width: pairs.map(across).fold(0.0, f64::max), residual, places }
    }

    /// All motors in one instant.
    fn together(&self, order: &[Turn], steps: u32) -> Vec<[f64; 3]> {
        let place = |step: u32| {
            let mut turned = vec![0.0; self.ways.motors.len()];
            for Turn { index, way, .. } in order {
                turned.iter_mut().skip(*index).take(1).for_each(|motor| *motor = f64::from(step) * way);
            }
            self.ways.tool(&turned)
        };
        (0..=steps).map(place).collect()
    }
}

impl std::fmt::Display for Zigzag {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { axis, step_mm, order, aside_mm, aside_steps, width_steps, .. } = self;
        writeln!(f, "{}, a step of {step_mm} mm in {axis}: {}", Machine::name_of(self.machine), order.join(" "))?;
        let um = |mm: f64| shown(1e3 * mm, 3);
        let strain =
            |residual: Option<f64>| residual.map_or_else(String::new, |r| format!(", residual {}", shown(r, 2)));
        writeln!(
            f,
            "  one after the other: {} um aside ({} steps), path {} steps wide{}",
            um(*aside_mm),
            shown(*aside_steps, 4),
            shown(*width_steps, 4),
            strain(self.residual_steps)
        )?;
        let aside = |[x, y, z]: &[f64; 3]| {
            [*x, *y, *z]
                .into_iter()
                .zip(AXES)
                .filter(|(_, name)| name != axis)
                .map(|(v, _)| v.abs())
                .fold(0.0, f64::max)
        };
        let together = self.in_one_instant_mm.iter().map(aside).fold(0.0, f64::max);
        writeln!(f, "  in one instant: {} um aside", um(together))?;
        for Orders { aside_steps, residual_steps, count, example } in &self.orders {
            let (aside, example) = (shown(*aside_steps, 4), example.join(" "));
            writeln!(
                f,
                "  {count:2} of all orders: {aside} steps aside{}, such as {example}",
                strain(*residual_steps)
            )?;
        }
        let Self { speed_mm_s, zigzag_hz, tool_hz, followed, .. } = self;
        let left = shown(1e6 * aside_mm * followed, 2);
        writeln!(
            f,
            "  at {speed_mm_s} mm/s: {zigzag_hz:.0} Hz, the tool's own frequency across is at most {tool_hz:.1} Hz, so {left} nm are left"
        )
    }
}
