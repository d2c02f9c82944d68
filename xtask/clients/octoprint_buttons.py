"""OctoPrint pauses at every M25 of a file. A button is pressed, and Resume: the rest is printed as if nothing had been.

Arguments: corehbot, G-code file and `clean`. The file has M83; it is printed with M82 too.
"""

import os
import tempfile

import octo
import printer
import undisturbed
from printer import check

# What is pressed in each pause in turn: requests to OctoPrint's interface, and the filament that they leave moved, in mm.
EXTRUDE = ("printer/tool", {"command": "extrude", "amount": 5})
RETRACT = ("printer/tool", {"command": "extrude", "amount": -3})
JOG_UP = ("printer/printhead", {"command": "jog", "z": 5})
JOG_ASIDE = ("printer/printhead", {"command": "jog", "x": -20, "y": 15})
HOME = ("printer/printhead", {"command": "home", "axes": ["x", "y"]})
OUT = ("printer/tool", {"command": "extrude", "amount": -30})
IN = ("printer/tool", {"command": "extrude", "amount": 33})
CHANGE = ("printer/command", {"command": "M600"})
PRESSED = [
    ([], 0),
    ([EXTRUDE], 5),
    ([RETRACT], -3),
    ([JOG_UP], 0),
    ([JOG_ASIDE, EXTRUDE, JOG_UP], 5),
    ([HOME], 0),
    ([OUT, HOME, IN], 3),
    ([JOG_UP, CHANGE], 0),
]

def run(program, file, _kind):
    said = []
    with tempfile.TemporaryDirectory(prefix="corehbot-octoprint-") as folder:
        port = os.path.join(folder, "printer")
        host = octo.OctoPrint(folder, port)
        try:
            host.wait_until_up()
            relative = printer.commands(file)
            for name, commands in [("M83", relative), ("M82", undisturbed.absolute(relative))]:
                said.append(f"{name}: {lives(host, program, port, commands, os.path.join(folder, name))}")
                host.wait_until_gone()
        finally:
            host.end()
    return ", ".join(said)


def lives(host, program, port, commands, path):
    """Prints, pauses and presses; returns what to say of it."""
    device = printer.Printer(program, port, trace=path)
    try:
        host.connect() if host.connections == 0 else host.reconnect()
        host.begin(os.path.basename(path) + ".gcode", commands)
        for place, (buttons, _) in enumerate(PRESSED):
            host.wait_for_state("Paused")
            for where, words in buttons:
                host.command(where, **words)
            if CHANGE in buttons:
                # The answer makes OctoPrint go on, too.
                answer(host)
            else:
                mark = f"pressed {place}"
                host.command("printer/command", command=f"M118 {mark}")
                host.wait(mark, lambda mark=mark: f"Recv: {mark}" in host.log("serial.log"))
                host.command("job", command="pause", action="resume")
            host.wait("the next line", lambda place=place: resumed(host) > place)
        host.wait_for_state("Operational")
        check(resumed(host) == len(PRESSED), f"it went on {resumed(host)} times")
        check("G91" in host.sent(), "it numbers the lines of its buttons")
        for line in host.log("serial.log").splitlines():
            check("Error" not in line and "Recv: !!" not in line, f"its log says: {line}")
        device.end()
    finally:
        device.kill()
    return undisturbed.same_lines(program, path, commands, [filament for _, filament in PRESSED])


def answer(host):
    """Answers the question that M600 asks."""
    prompt = "plugin/action_command_prompt"
    host.wait("a question", lambda: (host.ask(prompt) or {}).get("choices") == ["Continue"])
    host.command(prompt, command="select", choice=0)


def resumed(host):
    return host.log("serial.log").count("Recv: //action:resumed")


printer.main(run)
