//! Terminal: a printer at the end of a serial line, as `corehbot serve` is one.
//!
//! The session is a future, because a world borrows from its desk: it goes on until the printer's time has come as far
//! as the page wants it, and then it yields. After a restart (M999, or the reset button) the same machine is switched
//! on again where it stands.

use crate::job::{Job, Prepared};
use crate::picture::{Moved, Picture};
use anyhow::{Context as _, Result, bail, ensure};
use corehbot::connectors::Heater;
use corehbot::kinematics::ForwardKinematics;
use corehbot::motors::{MOTORS, MotorSet};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS, TICKS_PER_SECOND};
use corehbot_machine_file::Machine;
use corehbot_sim::accident::Accident;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::user_actions::{self, Act};
use corehbot_sim::world::{Desk, SimBoard, Sink, World};
use serde::Serialize;
use std::cell::{Cell, RefCell};
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};

/// A page that lets no more than this of the printer's time pass at once stays quick, in ms.
const LONGEST_TURN_MS: f64 = 10_000.0;

/// Something that happens to the machine.
#[derive(Clone)]
enum Event {
    /// A hand does something.
    Hand(Act),
    /// Something breaks.
    Break(Accident),
}

/// The words of all that hands do, as JSON.
#[must_use]
pub fn hands() -> String {
    serde_json::to_string(&user_actions::ACTS.map(|(words, _)| words)).unwrap_or_default()
}

/// A heater that is fitted.
#[derive(Clone, Serialize)]
struct Warmth {
    name: &'static str,
    measured_c: Option<f64>,
    target_c: f64,
    /// Of 1.
    duty: f64,
}

/// The printer's state.
#[derive(Clone, Default, Serialize)]
struct State {
    now_s: f64,
    tool_mm: [f64; 3],
    #[serde(skip)]
    counts: [i32; MOTORS],
    is_off: bool,
    is_halted: bool,
    is_for_user: bool,
    is_ready: bool,
    is_moving: bool,
    /// When motors were last seen to have stepped, in s.
    #[serde(skip)]
    stepped_s: Option<f64>,
    moves_ahead: u32,
    heaters: Vec<Warmth>,
}

/// What the page sees.
#[derive(Serialize)]
struct Seen<'s> {
    #[serde(flatten)]
    state: &'s State,
    /// Name and turns of each motor that is fitted.
    turns: Vec<(String, f64)>,
    picture: Option<Moved>,
}

/// Both ends of the line, and the printer's time.
#[derive(Default)]
struct Line {
    to_printer: RefCell<Vec<u8>>,
    to_page: RefCell<Vec<u8>>,
    events: RefCell<Vec<Event>>,
    /// How far time may go, in ticks.
    until: Cell<u64>,
    state: RefCell<State>,
}

/// A printer that is switched on.
pub struct Terminal {
    session: Pin<Box<dyn Future<Output = ()>>>,
    line: Rc<Line>,
    machine: Machine,
    picture: Result<Picture, String>,
}

impl Terminal {
    /// Switches it on.
    ///
    /// # Errors
    /// What is wrong with the machine or an accident.
    pub fn new(job: &Job) -> Result<Self> {
        let prepared = job.prepare()?;
        let machine = prepared.machine.clone();
        let picture = Picture::new(&machine);
        let line = Rc::new(Line::default());
        let mut terminal = Self { session: Box::pin(session(prepared, line.clone())), line, machine, picture };
        // The greeting.
        let greeting = terminal.turn(1.0);
        terminal.line.to_page.borrow_mut().extend(greeting.into_bytes());
        Ok(terminal)
    }

    /// Bytes go to the printer.
    pub fn send(&self, text: &str) {
        self.line.to_printer.borrow_mut().extend(text.bytes());
    }

    /// Something happens to the machine, now.
    ///
    /// # Errors
    /// There is nothing of the kind, or the machine has no such part.
    pub fn act(&self, what: &str) -> Result<()> {
        let event = match Act::called(what) {
            Some(act) => Event::Hand(act),
            None => {
                let accident: Accident = format!("{what}@0s").parse().with_context(|| what.to_owned())?;
                ensure!(!accident.row.family.needs_belts(), "{what}: a part of belts breaks in a print alone");
                if let Some(missing) = accident.missing(&self.machine.settings) {
                    bail!("{what}: {missing}");
                }
                Event::Break(accident)
            }
        };
        self.line.events.borrow_mut().push(event);
        Ok(())
    }

    /// Goes on for some milliseconds of the printer's time; returns what it has said.
    pub fn turn(&mut self, ms: f64) -> String {
        let ticks = ms.clamp(0.0, LONGEST_TURN_MS) * f64::from(TICKS_PER_MS);
        self.line.until.set(self.line.until.get() + ticks as u64);
        // It never ends.
        let _ = self.session.as_mut().poll(&mut Context::from_waker(Waker::noop()));
        String::from_utf8_lossy(&self.line.to_page.take()).into_owned()
    }

    /// The printer's state, as JSON.
    #[must_use]
    pub fn state(&self) -> String {
        let state = self.line.state.borrow();
        let settings = &self.machine.settings;
        let names = settings.mechanism.motors().filter(|(motor, _)| settings.mechanism.fitted().has(*motor));
        let turns = names.map(|(motor, _)| {
            let micro = f64::from(settings.drivers.belt.microsteps);
            (settings.name_of(motor).to_string(), f64::from(state.counts[motor.index()]) / (FULL_STEPS * micro))
        });
        let picture = self.picture.as_ref().ok().map(|picture| picture.moved(state.tool_mm, state.counts));
        serde_json::to_string(&Seen { state: &state, turns: turns.collect(), picture }).unwrap_or_default()
    }

    /// What does not move in the picture, as JSON; or `why` there is none.
    #[must_use]
    pub fn frame(&self) -> String {
        let frame = match &self.picture {
            Ok(picture) => serde_json::to_string(&picture.frame()),
            Err(why) => serde_json::to_string(&serde_json::json!({ "why": why })),
        };
        frame.unwrap_or_default()
    }
}

/// Full steps of a turn of a motor of 1.8 degrees.
const FULL_STEPS: f64 = 200.0;

/// Nobody looks at the steps.
struct Unseen;

impl Sink for Unseen {
    fn event(&mut self, _tick: u64, _steps: MotorSet, _forward: MotorSet) {}
}

/// Waits for the page once.
async fn until_asked() {
    let mut is_asked = false;
    std::future::poll_fn(|_| if std::mem::replace(&mut is_asked, true) { Poll::Ready(()) } else { Poll::Pending })
        .await;
}

/// Is a printer until it is switched off, and then a silent one.
async fn session(prepared: Prepared, line: Rc<Line>) {
    let Prepared { machine, homed, mut belt, heat, mut bed, mut probe_accidents } = prepared;
    let (settings, board) = (machine.settings, SimBoard::of(&machine.texts));
    let drivers = Drivers::new();
    let mut place = homed.unwrap_or(corehbot_rig::AT_POWER_UP);
    let (mut start, mut now, mut plant) = (homed, 0, None);
    loop {
        let mut desk = Desk::at(1, now);
        (desk.belt, desk.heat, desk.plant) = (belt.take(), heat.clone(), plant.take());
        (desk.bed, desk.probe_accidents) = (bed.take(), std::mem::take(&mut probe_accidents));
        (desk.board, desk.is_strict) = (board, false);
        let mut sink = Unseen;
        let mut world = World::standing(&mut desk, &settings, Some(place), start, NoStorage, &drivers, &mut sink);
        let (mut is_reset, mut is_off) = (false, false);
        while !world.has_ended() {
            for event in line.events.take() {
                is_reset |= matches!(event, Event::Hand(Act::Reset));
                is_off |= matches!(event, Event::Hand(Act::Off));
                befall(&mut world, &settings, event);
            }
            if is_reset || is_off {
                break;
            }
            for wire in world.wires() {
                wire.put(line.to_printer.take());
            }
            while world.now() < line.until.get() && !world.has_ended() {
                world.poll();
                world.advance();
            }
            world.poll();
            for wire in world.wires() {
                line.to_page.borrow_mut().extend(wire.heard());
            }
            let seen = state(&mut world, &settings, &line.state.borrow());
            line.state.replace(seen);
            until_asked().await;
        }
        if is_off {
            line.state.borrow_mut().is_off = true;
            loop {
                line.to_printer.take();
                until_asked().await;
            }
        }
        let counts = world.outcome().counts;
        now = world.now();
        plant = world.take_plant();
        drop(world);
        (belt, bed) = (desk.belt.take(), desk.bed.take());
        probe_accidents = std::mem::take(&mut desk.probe_accidents);
        probe_accidents.retain(|accident| accident.at_s * f64::from(TICKS_PER_SECOND) > now as f64);
        // The next one begins where the tool stands, and does not know where that is.
        (place, start) = (moved(&settings, place, counts), None);
    }
}

fn befall(world: &mut World<'_>, settings: &Settings, event: Event) {
    match event {
        Event::Hand(act) => act.touch(world),
        Event::Break(accident) => {
            if let Some(fault) = accident.probe_fault(settings) {
                world.fail_probe(fault);
            }
            if let Some(plant) = world.heat().plant() {
                accident.happen(plant.faults());
            }
        }
    }
}

/// Where motors bring a tool, from their steps.
fn moved(settings: &Settings, place: [Mm; 3], counts: [i32; MOTORS]) -> [Mm; 3] {
    let back = settings.mechanism.forward_kinematics().unwrap_or(ForwardKinematics::<{ MOTORS }>::NONE);
    let way = back.fractions(&counts.map(i64::from)).map(|(sum, over)| sum as f64 / over as f64);
    let axes = [&settings.axes.x, &settings.axes.y, &settings.axes.z];
    let pitch = axes.map(|axis| axis.steps_per_mm.to_num::<f64>());
    std::array::from_fn(|axis| Mm::from_num(place[axis].to_num::<f64>() + way[axis] / pitch[axis]))
}

/// Motors that have not stepped for so long stand still, in s of the printer's time.
const STILL_S: f64 = 0.2;

fn state(world: &mut World<'_>, settings: &Settings, before: &State) -> State {
    let status = world.status();
    let known = status.heat();
    let heaters = Heater::ALL.into_iter().filter(|heater| settings.thermal.heater(*heater).is_fitted);
    let heaters = heaters.map(|heater| Warmth {
        name: heater.name(),
        measured_c: known.measured(heater).map(|c| c.to_num()),
        target_c: known.target(heater).to_num(),
        duty: f64::from(known.duty(heater)) / f64::from(u16::MAX),
    });
    let (now_s, counts) = (world.now() as f64 / f64::from(TICKS_PER_SECOND), world.outcome().counts);
    let stepped_s = if counts == before.counts { before.stepped_s } else { Some(now_s) };
    State {
        now_s,
        counts,
        stepped_s,
        is_moving: stepped_s.is_some_and(|stepped_s| now_s - stepped_s < STILL_S),
        is_off: false,
        is_halted: status.is_halted(),
        is_for_user: status.is_awaiting_user(),
        is_ready: world.is_awaiting_hosts(),
        moves_ahead: status.level(),
        heaters: heaters.collect(),
        tool_mm: world.nozzle(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_home() -> Terminal {
        Terminal::new(&Job { homed: Some("100,100,10".to_owned()), ..Job::default() }).unwrap()
    }

    fn asked(terminal: &mut Terminal, line: &str, ms: f64) -> String {
        terminal.send(line);
        terminal.turn(ms)
    }

    #[test]
    fn it_greets_answers_and_moves() {
        let mut terminal = at_home();
        assert!(terminal.turn(1.0).contains("start"));
        assert!(asked(&mut terminal, "M115\n", 10.0).contains("FIRMWARE_NAME"));
        assert!(asked(&mut terminal, "G1 X110 F6000\nM400\n", 9_000.0).ends_with("ok\n"));
        let seen: serde_json::Value = serde_json::from_str(&terminal.state()).unwrap();
        assert_eq!(seen["tool_mm"][0].as_f64().unwrap().round(), 110.0);
        assert!(seen["picture"]["belts"][0]["path"].as_str().unwrap().starts_with('M'));
    }

    #[test]
    fn it_moves_until_the_last_move_has_ended() {
        let mut terminal = at_home();
        let moves = |terminal: &Terminal| terminal.state().contains("\"is_moving\":true");
        // Motors get their power.
        asked(&mut terminal, "G1 X110 F6000\nM400\n", 9_000.0);
        terminal.turn(1000.0);
        assert!(!moves(&terminal));
        // A move of 1 s, which the host does not wait for.
        assert!(asked(&mut terminal, "G1 X120 F600\n", 500.0).contains("ok"));
        assert!(moves(&terminal) && terminal.state().contains("\"moves_ahead\":0"));
        for _ in 0..20 {
            terminal.turn(100.0);
        }
        assert!(!moves(&terminal));
    }

    #[test]
    fn after_a_stop_it_restarts_where_it_stands() {
        let mut terminal = at_home();
        asked(&mut terminal, "G1 X120 F6000\nM400\n", 9_000.0);
        assert!(asked(&mut terminal, "M112\n", 10.0).contains("Error"));
        assert!(terminal.state().contains("\"is_halted\":true"));
        asked(&mut terminal, "M999\n", 10.0);
        assert!(terminal.turn(100.0).contains("start"));
        assert!(terminal.state().contains("\"is_halted\":false"));
        assert!(asked(&mut terminal, "M114 R\n", 10.0).contains("ok"));
        let seen: serde_json::Value = serde_json::from_str(&terminal.state()).unwrap();
        assert_eq!(seen["tool_mm"][0].as_f64().unwrap().round(), 120.0);
    }

    #[test]
    fn switched_off_it_says_nothing() {
        let mut terminal = at_home();
        terminal.act("off").unwrap();
        asked(&mut terminal, "M115\n", 10.0);
        assert!(terminal.state().contains("\"is_off\":true"));
        assert_eq!(asked(&mut terminal, "M115\n", 1000.0), "");
    }

    #[test]
    fn nothing_unknown_happens() {
        let terminal = at_home();
        assert!(terminal.act("press x").is_ok());
        assert!(terminal.act("kick it").is_err());
        assert!(terminal.act("open:hotend").unwrap_err().to_string().contains("hotend"));
        assert!(terminal.act("stuck:probe").unwrap_err().to_string().contains("no probe"));
        assert!(terminal.act("seized:m1").unwrap_err().to_string().contains("in a print"));
    }
}
