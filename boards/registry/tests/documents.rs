//! Lists of boards in documents. They stand between `<!-- boards:KIND -->` and `<!-- /boards -->`; `BLESS=1` writes
//! them.

use corehbot::connectors::{BoardConnectors, ConnectorName, Output, OutputSet};
use corehbot_boards::{Entry, all, entries};
use corehbot_wiring::Crystal;
use std::path::Path;

/// Each document, and the way from it to the root.
const DOCUMENTS: [(&str, &str); 3] =
    [("README.md", ""), ("docs/reference/boards.md", "../../"), ("docs/reference/machines.md", "../../")];

#[test]
fn documents_list_every_board() {
    for (document, root) in DOCUMENTS {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(document);
        let text = std::fs::read_to_string(&path).unwrap();
        let today = listed(&text, root);
        assert!(today.contains("<!-- boards:"), "{document} has no list of boards");
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, &today).unwrap();
        } else {
            assert!(text == today, "{document}: BLESS=1 writes its lists");
        }
    }
}

/// The text with the lists of today.
fn listed(text: &str, root: &str) -> String {
    let (begin, end) = ("<!-- boards:", "<!-- /boards -->");
    let mut parts = text.split(begin);
    let mut listed = parts.next().unwrap().to_owned();
    for part in parts {
        let (kind, rest) = part.split_once(" -->").unwrap();
        let (_, after) = rest.split_once(end).unwrap_or_else(|| panic!("boards:{kind} has no end"));
        listed.extend([begin, kind, " -->", &list(kind, root), end, after]);
    }
    listed
}

fn list(kind: &str, root: &str) -> String {
    let join = |of: fn(&Entry, &str) -> String| entries().map(|entry| of(entry, root)).collect::<Vec<_>>().join(", ");
    match kind {
        "keys" => join(|entry, _| format!("`{}`", entry.board.connectors.key)),
        "links" => join(|entry, root| {
            let purpose = Some(purpose(entry)).filter(|purpose| *purpose != "printing");
            let purpose = purpose.map(|purpose| format!(", {purpose}")).unwrap_or_default();
            format!("{} (`{}`{purpose})", link(entry, root), entry.board.connectors.key)
        }),
        "connectors" => table(["`board`", "sockets", "inputs", "heater outputs", "sensors"], all().map(connectors)),
        "table" => table(
            [
                "board",
                "for",
                "processor, clock",
                "image at",
                "drivers",
                "inputs",
                "heaters",
                "fans",
                "hosts",
                "settings",
            ],
            entries().map(|entry| row(entry, root)),
        ),
        other => panic!("there is no list boards:{other}"),
    }
}

fn table<const N: usize>(head: [&str; N], rows: impl Iterator<Item = [String; N]>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rows: String = rows.map(|row| line(&row)).collect();
    format!("\n{}|{}\n{rows}", line(&head.map(str::to_owned)), "---|".repeat(N))
}

fn link(entry: &Entry, root: &str) -> String {
    format!("[{}]({root}boards/{}/README.md)", entry.board.name, entry.board.connectors.key)
}

fn purpose(entry: &Entry) -> &'static str {
    let connectors = entry.board.connectors;
    match connectors.is_bench {
        true => "a bench rig",
        false if connectors.outputs == OutputSet::NONE => "motion only",
        false => "printing",
    }
}

/// A row of the table of boards.
fn row(entry: &Entry, root: &str) -> [String; 10] {
    let (board, connectors) = (entry.board, entry.board.connectors);
    let clock = match board.crystal {
        Crystal::Oscillator12MHz => "12 MHz",
        Crystal::Clock8MHz => "8 MHz from the ST-LINK",
    };
    let has_uarts = board.sockets.iter().all(|slot| slot.uart.is_some());
    let thermistors = match board.thermistors.len() {
        0 => String::new(),
        count => format!(", {count} thermistors"),
    };
    let usb = board.has_usb.then_some("USB");
    let hosts = usb.into_iter().chain(board.serial.iter().map(|port| port.usart.name()));
    [
        link(entry, root),
        purpose(entry).to_owned(),
        format!("{}, {clock}", entry.chip.trim_end_matches("Tx")),
        format!("{:#010x}", entry.start),
        format!("{}{}", board.sockets.len(), if has_uarts { ", with UART" } else { "" }),
        format!("{} contacts{thermistors}", board.inputs.len()),
        outputs(connectors),
        if board.fans.is_empty() { "none".to_owned() } else { board.fans.len().to_string() },
        hosts.collect::<Vec<_>>().join(", "),
        if board.eeprom.is_some() { "EEPROM" } else { "flash" }.to_owned(),
    ]
}

/// A row of the table of connectors.
fn connectors(board: &'static BoardConnectors) -> [String; 5] {
    let key = format!("`{}`", board.key);
    if board.is_simulated {
        let any = || "any".to_owned();
        return [key, any(), any(), any(), any()];
    }
    let without = if board.is_bench { "; a motor may be without" } else { "" };
    let sensors = board.sensors.iter().map(|sensor| sensor.name().to_owned());
    [key, names(board.sockets) + without, names(board.inputs), outputs(board), or_none(sensors.collect())]
}

fn names(names: &[ConnectorName]) -> String {
    let mut names: Vec<_> = names.iter().map(ToString::to_string).collect();
    names.sort();
    or_none(names)
}

fn outputs(board: &BoardConnectors) -> String {
    let outputs = Output::ALL.into_iter().filter(|(output, _)| board.outputs.has(*output));
    or_none(outputs.map(|(_, name)| name.to_owned()).collect())
}

fn or_none(names: Vec<String>) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
