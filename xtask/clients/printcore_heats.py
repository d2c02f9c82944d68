"""Printrun's printcore prints a file that heats: it is told of the rise, the waits end, and M105 says that all is off.

Arguments: corehbot, G-code file (its machine stands beside it) and `clean`; a fourth one is the printer if it is not corehbot.
"""

import pathlib
import threading
import time

import heat
import printer
from printer import check
from printrun import gcoder
from printrun.printcore import printcore
from printrun.utils import parse_temperature_report

# A printer that says nothing for so long is done for.
SILENCE_S = 60

# Longer silence passes in real time (corehbot serve --speed max).
PAUSE_S = 0.5

# The letters of the heaters in reports.
LETTERS = {"hotend": "T", "bed": "B"}


def run(program, file, _kind, other=None):
    machine = str(pathlib.Path(file).with_suffix(".toml"))
    commands = printer.commands(file)
    summary = printer.simulate(program, file, machine)
    device = printer.Printer(other or program, settings=machine)
    try:
        heard, asked, seconds = stream(device.path, commands)
        reports = [parse_temperature_report(line) for line in heard if "T:" in line]
        check(all(report.keys() == {"T", "B"} for report in reports), f"reports are not of T and B: {reports[:3]}")
        for name, letter in LETTERS.items():
            heat.check_rise(name, [tuple(map(float, report[letter])) for report in reports])
        for answer in asked:
            check(answer.startswith("ok T:") and " B:" in answer, f"M105 is answered with {answer}")
            off = parse_temperature_report(answer)
            check(all(float(off[letter][1]) == 0 for letter in "TB"), f"not off: {answer}")
            check(" @:0 B@:0" in answer, f"there is power: {answer}")
        cooled = [float(parse_temperature_report(answer)["T"][0]) for answer in asked]
        check(cooled[0] < heat.ROOM + heat.NEAR and heat.ROOM + heat.NEAR < cooled[1], f"M105 says {cooled}")
        said = heat.check_wait(heard, "M109")
        check(not [line for line in heard if line.startswith("Error")], "the printer complains")
        # The extruder's steps are among them: filament that a cold hotend refuses would be missing.
        return f"{len(commands)} commands in {seconds:.1f} s, {len(reports)} reports, {said}, {printer.same_steps(device, summary)}"
    finally:
        device.kill()


def stream(path, commands):
    """Prints the commands; returns what was said, the answers to an M105 before and after, and how long it took."""
    host = printcore()
    heard, temperatures = [], []
    online, done, told = threading.Event(), threading.Event(), threading.Event()
    host.onlinecb, host.endcb = online.set, done.set
    host.recvcb = lambda reply: heard.append(reply.rstrip("\n"))
    host.tempcb = lambda line: (temperatures.append(line.strip()), told.set())
    host.connect(path, 115200)

    def ask():
        told.clear()
        host.send_now("M105")
        check(told.wait(SILENCE_S), "M105 is not answered")
        return temperatures[-1]

    def measured():
        return float(parse_temperature_report(ask())["T"][0]) > 0

    try:
        check(online.wait(SILENCE_S), "printcore does not get online")
        # In the first ms nothing is measured yet, and the time of a printer that waits for its host nearly stands still.
        switched_on = time.monotonic()
        while not measured():
            check(time.monotonic() < switched_on + SILENCE_S, "nothing is measured")
            time.sleep(PAUSE_S)
        heard.clear()
        answers = [ask()]
        begin = time.monotonic()
        host.startprint(gcoder.LightGCode(commands))
        replies = -1
        while not done.wait(SILENCE_S):
            check(len(heard) > replies, f"printcore stalls at line {host.lineno}")
            replies = len(heard)
        seconds = time.monotonic() - begin
        return heard, [*answers, ask()], seconds
    finally:
        if host.printing:
            host.cancelprint()
        while not (host.send_thread and host.send_thread.is_alive()):
            time.sleep(0.01)
        host.disconnect()


printer.main(run)
