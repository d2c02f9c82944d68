//! Properties for any bytes at all: one body each for the fuzzer and for the property tests.

use super::machine::Machine;
use super::print::Printed;
use corehbot::gcode::Command;
use corehbot::machine::parse;
use corehbot::port::Received;

/// Answers all that has arrived; every answer has one `ok`, and is printable.
fn drain(machine: &mut Machine) -> String {
    let mut all = String::new();
    while machine.answer_one() {
        let answer = machine.take_replies();
        assert_eq!(answer.lines().filter(|line| line.starts_with("ok")).count(), 1, "{answer}");
        assert!(answer.bytes().all(|byte| matches!(byte, b' '..=b'~' | b'\n')), "{answer:?}");
        all += &answer;
    }
    all
}

/// Bytes arrive, with losses (FF), openings (FE) and pauses (FD and 8 times the next byte, in ms). The result is the
/// same for a poll after each byte and for polls only at FC.
pub fn protocol(data: &[u8]) {
    let (mut prompt, mut lazy) = (Machine::new(), Machine::new());
    let (mut said, mut said_late) = (String::new(), String::new());
    let mut bytes = data.iter().copied();
    while let Some(byte) = bytes.next() {
        if matches!(byte, 0xFC..=0xFE) || !lazy.receiver.has_room() {
            said_late += &drain(&mut lazy);
        }
        match byte {
            0xFC => continue,
            0xFD => {
                let pause = u32::from(bytes.next().unwrap_or(0)) * 8;
                prompt.ms += pause;
                lazy.ms += pause;
                said_late += &drain(&mut lazy);
            }
            _ => {
                let received = match byte {
                    0xFF => Received::Lost,
                    0xFE => Received::Opened,
                    _ => Received::Byte(byte),
                };
                prompt.feed(received);
                lazy.feed(received);
            }
        }
        said += &drain(&mut prompt);
    }
    said_late += &drain(&mut lazy);
    assert_eq!(said, said_late);
    assert_eq!(prompt.commands, lazy.commands);
    assert_eq!(prompt.emergencies, lazy.emergencies);
    assert_eq!(prompt.receiver.last_line(), lazy.receiver.last_line());
}

/// Any line is some command; its printed form is that command, and final.
pub fn gcode(data: &[u8]) {
    // Lines from the protocol have no line ends.
    let line = data.split(|byte| matches!(byte, b'\n' | b'\r' | 0)).next().unwrap_or_default();
    let command = parse(line);
    let printed = Printed(command, line).to_string();
    let again = parse(printed.as_bytes());
    match command {
        // Unprintable bytes are replaced, so only the text is the same.
        // A question mark in place of a byte can mean something: T? asks a multi-material unit.
        Command::Unknown(_) if printed == "T?" => return assert_eq!(again, Command::Silent),
        Command::Unknown(_) => assert_eq!(again, Command::Unknown(printed.as_bytes()), "{line:?}"),
        // Of an error only the beginning is printed.
        Command::Malformed(_) => return assert!(matches!(again, Command::Malformed(_)), "{line:?} {printed}"),
        Command::Table(command) if command.takes_text() => {
            let is_same = matches!(again, Command::Table(again) if again.place() == command.place());
            assert!(is_same, "{line:?} {printed}");
        }
        _ => assert_eq!(again, command, "{printed}"),
    }
    assert_eq!(Printed(again, printed.as_bytes()).to_string(), printed);
}
