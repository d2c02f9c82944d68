//! A drawing of each board: its connectors, with pins and with the prototype's motors and switches. It is drawn from
//! the board's table, and `BLESS=1` writes it. It does not show where a connector lies on the board, which no table
//! has.

use corehbot_boards::{Entry, entries};
use corehbot_wiring::{Board, FanTimer, Pin, USB};
use std::fmt::Write as _;
use std::path::Path;

/// Pairs that are coupled have a colour each: motors 1 and 8, motors 4 and 11.
const PAIRS: [&str; 2] = ["#1f6fb4", "#c2571a"];

/// Everything else.
const PLAIN: &str = "#777";

/// The prototype's motors, in the order of a board's sockets: where, and the colour.
const MOTORS: [(&str, &str); 7] = [
    ("motor 1, front left", PAIRS[0]),
    ("motor 4, front right", PAIRS[1]),
    ("motor 8, rear right", PAIRS[0]),
    ("motor 11, rear left", PAIRS[1]),
    ("left Z screw", PLAIN),
    ("right Z screw", PLAIN),
    ("extruder", PLAIN),
];

/// The prototype's switches, in the order of a board's inputs.
const SWITCHES: [&str; 3] = ["X switch", "Y switch", "Z switch"];

/// Columns of cards: width, and the gap between them, in px.
const COLUMN: usize = 300;
const GAP: usize = 24;

/// Heights of a heading, of a card, and of what is above the columns, in px.
const HEADING: usize = 30;
const CARD: usize = 40;
const TOP: usize = 70;

/// Height of the sketch of the stage, in px.
const SKETCH: usize = 150;

/// A connector.
struct Card {
    name: String,
    purpose: String,
    pins: String,
    colour: &'static str,
}

/// Connectors of a kind.
struct Group {
    heading: &'static str,
    cards: Vec<Card>,
}

#[test]
fn every_board_is_drawn_from_its_table() {
    for entry in entries() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(entry.board.connectors.key);
        let path = folder.join("wiring.svg");
        let today = drawing(entry);
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, &today).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(kept == today, "{}: BLESS=1 draws it", path.display());
        let readme = std::fs::read_to_string(folder.join("README.md")).unwrap();
        assert!(readme.contains("(wiring.svg)"), "{} does not show its drawing", entry.board.name);
    }
}

/// Every pin that the firmware drives or reads for a connector stands in the drawing.
#[test]
fn no_connector_is_left_out() {
    for entry in entries() {
        let board = entry.board;
        let text = drawing(entry);
        let sockets =
            board.sockets.iter().flat_map(|slot| [Some(slot.step), Some(slot.dir), Some(slot.enable), slot.uart]);
        let inputs = board.inputs.iter().map(|input| input.pin);
        let sensors = board.thermistors.iter().map(|sensor| sensor.pin);
        let hosts = board.serial.iter().flat_map(|port| [port.tx, port.rx]);
        let loads = board.heaters.iter().map(|heater| heater.pin).chain(board.fans.iter().map(|fan| fan.pin));
        for pin in sockets.flatten().chain(inputs).chain(sensors).chain(hosts).chain(loads) {
            assert!(text.contains(&name(pin)), "{}: {pin:?}", board.name);
        }
    }
}

/// A pin's name in the manual, such as PF13.
fn name(pin: Pin) -> String {
    format!("P{:?}{}", pin.port, pin.number())
}

fn card(name: impl ToString, purpose: impl ToString, pins: String) -> Card {
    Card { name: name.to_string(), purpose: purpose.to_string(), pins, colour: PLAIN }
}

/// The drivers' sockets.
fn sockets(board: &Board) -> Group {
    let cards = board.sockets.iter().zip(board.connectors.sockets).enumerate().map(|(place, (slot, printed))| {
        let (purpose, colour) = MOTORS.get(place).copied().unwrap_or(("free", PLAIN));
        let uart = slot.uart.map(|pin| format!(" UART {}", name(pin))).unwrap_or_default();
        let pins = format!("STEP {} DIR {} EN {}{uart}", name(slot.step), name(slot.dir), name(slot.enable));
        Card { colour, ..card(printed, purpose, pins) }
    });
    Group { heading: "Motors", cards: cards.collect() }
}

fn inputs(board: &Board) -> Group {
    let cards = board.inputs.iter().zip(board.connectors.inputs).enumerate().map(|(place, (input, printed))| {
        let purpose = SWITCHES.get(place).copied().unwrap_or("any switch or probe");
        let servo = board.servo.filter(|_| printed.to_string() == "BLTOUCH");
        let servo = servo.map(|pin| format!(", servo {}", name(pin))).unwrap_or_default();
        card(printed, purpose, format!("{}, {}{servo}", name(input.pin), input.circuit.name()))
    });
    Group { heading: "Switches and probes", cards: cards.collect() }
}

fn thermistors(board: &Board) -> Group {
    let cards =
        board.thermistors.iter().map(|sensor| card(sensor.sensor.name(), "thermistor to ground", name(sensor.pin)));
    Group { heading: "Temperature", cards: cards.collect() }
}

fn loads(board: &Board) -> Group {
    let heaters = board.heaters.iter().map(|heater| card(heater.output.name(), "heater", name(heater.pin)));
    let fans = board.fans.iter().enumerate().map(|(place, fan)| {
        let speed = if fan.timer == FanTimer::None { "fan, on or off" } else { "fan" };
        card(format!("FAN{place}"), speed, name(fan.pin))
    });
    Group { heading: "Heaters and fans", cards: heaters.chain(fans).collect() }
}

fn lines(board: &Board) -> Group {
    let serial = board.serial.iter().map(|port| {
        let pins = format!("TX {} RX {}, {} baud", name(port.tx), name(port.rx), port.baud);
        card(port.usart.name(), "a host", pins)
    });
    let usb = board.has_usb.then(|| card("USB", "a host", USB.map(name).join(", ")));
    let supply = board.connectors.supply_switches.iter().zip(board.supply_pins);
    let supply = supply.filter(|(printed, _)| printed.as_str() == "PS-ON");
    let supply = supply.map(|(printed, pin)| card(printed, "power supply", format!("{}, low is on", name(*pin))));
    let sensor = board.accelerometer.zip(board.connectors.accelerometer).map(|(pins, printed)| {
        let [clock, miso, mosi, select] = [pins.clock, pins.miso, pins.mosi, pins.select].map(name);
        card(printed, "accelerometer", format!("SCK {clock} SDO {miso} SDA {mosi} CS {select}"))
    });
    let cards = usb.into_iter().chain(serial).chain(supply).chain(sensor);
    Group { heading: "Hosts and the rest", cards: cards.collect() }
}

/// The drawing of a board.
fn drawing(entry: &Entry) -> String {
    let board = entry.board;
    let columns = [vec![sockets(board)], vec![inputs(board), thermistors(board)], vec![loads(board), lines(board)]];
    let height = |groups: &[Group]| -> usize {
        let filled = groups.iter().filter(|group| !group.cards.is_empty());
        filled.map(|group| HEADING + CARD * group.cards.len()).sum()
    };
    let [first, others @ ..] = columns.each_ref().map(|groups| height(groups));
    let bottom = TOP + others.into_iter().fold(first + SKETCH, usize::max) + GAP;
    let width = 3 * COLUMN + 4 * GAP;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {bottom}\" font-family=\"sans-serif\" \
         font-size=\"13\" role=\"img\">\n<title>Connectors of the {0}</title>\n\
         <rect width=\"{width}\" height=\"{bottom}\" fill=\"#fff\"/>\n\
         <text x=\"{GAP}\" y=\"30\" font-size=\"18\" font-weight=\"bold\">{0}: connectors and pins</text>\n\
         <text x=\"{GAP}\" y=\"50\" fill=\"#444\">With the prototype's motors and switches; a machine file may say \
         otherwise. Not where connectors lie on the board.</text>\n",
        board.name
    );
    text += &sketch(board);
    for (place, groups) in columns.iter().enumerate() {
        let x = GAP + place * (COLUMN + GAP);
        let mut y = if place == 0 { TOP + SKETCH } else { TOP };
        for group in groups.iter().filter(|group| !group.cards.is_empty()) {
            writeln!(text, "<text x=\"{x}\" y=\"{}\" font-weight=\"bold\">{}</text>", y + 18, group.heading).unwrap();
            y += HEADING;
            for card in &group.cards {
                text += &drawn(card, x, y);
                y += CARD;
            }
        }
    }
    text + "</svg>\n"
}

/// The stage from above, with the sockets of the four belt motors.
fn sketch(board: &Board) -> String {
    let (left, right, rear, front) = (GAP + 40, GAP + COLUMN - 40, TOP + 26, TOP + SKETCH - 26);
    let (width, height, middle) = (right - left, front - rear, (left + right) / 2);
    let mut text = format!(
        "<rect x=\"{left}\" y=\"{rear}\" width=\"{width}\" height=\"{height}\" fill=\"none\" stroke=\"{PLAIN}\"/>\n"
    );
    for (word, y) in [("rear", rear + 16), ("front", front - 6)] {
        writeln!(text, "<text x=\"{middle}\" y=\"{y}\" text-anchor=\"middle\" fill=\"#444\">{word}</text>").unwrap();
    }
    let corners = [(left, front, "1"), (right, front, "4"), (right, rear, "8"), (left, rear, "11")];
    for (((x, y, number), printed), (_, colour)) in corners.into_iter().zip(board.connectors.sockets).zip(MOTORS) {
        let (anchor, aside) = if x == left { ("start", x + 20) } else { ("end", x - 20) };
        let inside = if y == rear { y + 18 } else { y - 8 };
        writeln!(
            text,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"14\" fill=\"{colour}\"/>\
             <text x=\"{x}\" y=\"{}\" text-anchor=\"middle\" fill=\"#fff\">{number}</text>\
             <text x=\"{aside}\" y=\"{inside}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{printed}</text>",
            y + 5
        )
        .unwrap();
    }
    text
}

fn drawn(card: &Card, x: usize, y: usize) -> String {
    let Card { name, purpose, pins, colour } = card;
    let (height, left, right, upper, lower) = (CARD - 4, x + 12, x + COLUMN - 8, y + 15, y + 30);
    format!(
        "<rect x=\"{x}\" y=\"{y}\" width=\"{COLUMN}\" height=\"{height}\" fill=\"#f6f6f6\"/>\
         <rect x=\"{x}\" y=\"{y}\" width=\"5\" height=\"{height}\" fill=\"{colour}\"/>\n\
         <text x=\"{left}\" y=\"{upper}\" font-weight=\"bold\">{name}</text>\
         <text x=\"{right}\" y=\"{upper}\" text-anchor=\"end\" fill=\"#444\">{purpose}</text>\n\
         <text x=\"{left}\" y=\"{lower}\" font-family=\"monospace\" font-size=\"11\">{pins}</text>\n"
    )
}
