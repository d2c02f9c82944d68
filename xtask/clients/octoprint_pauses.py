"""OctoPrint pauses a heated print until its heat is off, goes on, cancels, and prints the same file again on the same printer;
and a print with M600 and M0 in it goes on from OctoPrint.

Arguments: corehbot, G-code file (its machine stands beside it) and `clean`.
"""

import os
import pathlib
import re
import subprocess
import tempfile
import time

import heat
import octo
import printer
from printer import check

# So many times as fast as real time: a minute in 2 s.
SPEED = 30

# Lines that print, as they are sent.
PRINTS = re.compile(r"^N\d+ G1 X.* E")

# A hotend that cannot print, in C.
COLD = 150


def run(program, file, _kind):
    machine = str(pathlib.Path(file).with_suffix(".toml"))
    with tempfile.TemporaryDirectory(prefix="corehbot-octoprint-") as folder:
        port = os.path.join(folder, "printer")
        host = octo.OctoPrint(folder, port)
        try:
            host.wait_until_up()
            said = [
                timed(lives_of_a_print, host, program, port, file, machine, folder),
                timed(printer_pauses, host, program, port, file, machine, folder),
            ]
            return "; ".join(said)
        finally:
            host.end()


def hotend(host):
    return host.ask("printer")["temperature"]["tool0"]


def timed(trial, *words):
    begin = time.monotonic()
    said = trial(*words)
    return f"{said}, in all {time.monotonic() - begin:.1f} s"


def printed(host):
    """How many lines that print were sent."""
    return sum(bool(PRINTS.match(line)) for line in host.sent())


def until_it_prints(host, lines):
    """Waits until so many more lines that print were sent; returns how long that took."""
    before = printed(host)
    return host.wait("motion", lambda: printed(host) >= before + lines)


def lives_of_a_print(host, program, port, file, machine, folder):
    trace = os.path.join(folder, "served.csv")
    device = printer.Printer(program, port, SPEED, machine, trace)
    try:
        host.connect()
        host.begin("paused.gcode", printer.commands(file))
        until_it_prints(host, 3)
        host.command("job", command="pause", action="pause")
        paused = host.wait_for_state("Paused")
        host.wait("heat that goes off", lambda: "Heaters off after 1 minutes without use" in host.log("serial.log"))
        host.wait("a hotend that is cold", lambda: hotend(host)["actual"] < COLD)
        host.command("job", command="pause", action="resume")
        resumed = until_it_prints(host, 3)
        said = check_heated_again(host.log("serial.log"))
        host.command("job", command="pause", action="pause")
        host.wait_for_state("Paused")
        host.command("job", command="cancel")
        cancelled = host.wait_for_state("Operational")
        host.wait("a hotend that is off", lambda: hotend(host)["target"] == 0 and hotend(host)["actual"] < COLD)
        print_again(host, printer.commands(file))
        check_peace(host)
        device.end()
        steps = same_tail(program, file, machine, trace, folder)
        return (
            f"Pause in {paused:.1f} s, Resume in {resumed:.1f} s ({said}), Cancel in {cancelled:.1f} s, "
            f"printed again with the same {steps} events"
        )
    finally:
        device.kill()


def print_again(host, commands):
    """Prints on a printer that has been through a pause and a cancel; heat is waited for."""
    before = len(host.log("serial.log"))
    host.begin("again.gcode", commands)
    host.wait_for_state("Operational")
    during = re.search(r"Send: N\d+ M109 S200\*\d+\n(.*?)Recv: ok", host.log("serial.log")[before:], re.DOTALL)
    check(during, "M109 of the second print is not answered")
    heat.check_wait(during[1].splitlines(), "M109")


def printer_pauses(host, program, port, file, machine, folder):
    """M600 is answered in the dialogue; OctoPrint shows `Pausing` until the line has its `ok`. M0 it does not send: it pauses by
    itself (its `blockedCommands`)."""
    host.wait_until_gone()
    lines = printer.commands(file)
    first = next(i for i, line in enumerate(lines) if line.startswith("G1 X"))
    lines = [*lines[:first + 4], "M600", *lines[first + 4:first + 8], "M0", *lines[first + 8:]]
    device = printer.Printer(program, port, SPEED, machine)
    try:
        host.reconnect()
        host.begin("pauses.gcode", lines)
        host.wait_for_state("Pausing")
        check(host.ask("plugin/action_command_prompt").get("choices") == ["Continue"], "it shows no question")
        before = printed(host)
        host.command("plugin/action_command_prompt", command="select", choice=0)
        answered = host.wait("motion after M600", lambda: printed(host) > before)
        host.wait_for_state("Paused")
        before = printed(host)
        host.command("job", command="pause", action="resume")
        resumed = host.wait("motion after M0", lambda: printed(host) > before)
        host.wait_for_state("Operational")
        check(printed(host) == sum(line.startswith("G1 X") for line in lines), "lines are missing")
        check_peace(host)
        device.end()
        return (
            f"M600 and M0: shown as paused, on after {answered:.1f} s by the question and {resumed:.1f} s by the button"
        )
    finally:
        device.kill()


def check_heated_again(log):
    """Heat came back and was waited for before the line that goes on got its `ok`."""
    during = re.search(r"Recv: echo:Heating again\n(.*?)Recv: ok\n", log, re.DOTALL)
    check(during, "it does not heat again")
    last = [line for line in during[1].splitlines() if " W:" in line][-1]
    celsius = float(re.search(r"T:([\d.]+)", last)[1])
    check(celsius > heat.TARGETS["hotend"] - heat.NEAR, f"it goes on at {celsius} C")
    return f"at {celsius:.0f} C"


def check_peace(host):
    """Nothing was said that OctoPrint takes for an error."""
    for line in host.log("serial.log").splitlines():
        check("Error" not in line and "Recv: !!" not in line, f"its log says: {line}")


def same_tail(program, file, machine, trace, folder):
    """Holds the last events of a trace, all that follow homing in a print of the file, to those of corehbot run."""
    homing = os.path.join(folder, "homing.gcode")
    with open(homing, "w", encoding="utf-8") as lines:
        lines.write("G28\n")
    [whole, home] = [events(program, each, machine, folder) for each in (file, homing)]
    with open(trace, encoding="utf-8") as lines:
        served = rows(lines)
    count = len(whole) - len(home)
    check(0 < count <= len(served), f"there are {count} events behind homing")
    pairs = zip(tail(whole, count), tail(served, count))
    # A tick of rounding: the second print begins at another time.
    same = all(one == other and abs(a - b) <= 1 for (a, one), (b, other) in pairs)
    check(same, "the steps of the second print are not those of corehbot run")
    return count


def events(program, file, machine, folder):
    trace = os.path.join(folder, "run.csv")
    command = [program, "run", file, "--machine", machine, "--trace", trace]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=printer.PATIENCE_S)
    with open(trace, encoding="utf-8") as lines:
        return rows(lines)


def rows(lines):
    """Events as (tick, the rest of the row)."""
    split = (line.rstrip("\n").split(",", 1) for line in lines if line[0].isdigit())
    return [(int(tick), rest) for tick, rest in split]


def tail(rows, count):
    """The last rows, with the ticks before the end."""
    end = rows[-1][0]
    return ((end - tick, rest) for tick, rest in rows[-count:])


printer.main(run)
