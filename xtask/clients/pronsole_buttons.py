"""Printrun's pronsole pauses at every M25 of a file. A command of its user, and `resume`: the rest is printed as if nothing had
been. Its pauses, buttons and lines are those of Pronterface.

Arguments: corehbot, G-code file and `clean`. The file has M83; it is printed with M82 too.
"""

import logging
import os
import pathlib
import sys
import tempfile
import threading
import time

import consoles
import printer
import undisturbed
from printer import check

# What is typed in each pause in turn, and the filament that it leaves moved, in mm.
TYPED = [
    ([], 0),
    (["extrude 5 300"], 5),
    (["extrude -3 300"], -3),
    (["move z 5 200"], 0),
    (["move x -20 6000", "extrude 2 300"], 2),
    (["home xy"], 0),
    (["extrude -30 300", "home xy", "extrude 33 300"], 3),
    (["M83", "G1 E2 F300", "M82"], 2),
]

# Between two looks at what pronsole has done.
PAUSE_S = 0.02


def run(program, file, _kind):
    said = []
    relative = printer.commands(file)
    with tempfile.TemporaryDirectory() as folder, open(os.devnull, "w", encoding="utf-8") as nowhere:
        pronsole = consoles.pronsole_class(folder)
        for name, commands in [("M83", relative), ("M82", undisturbed.absolute(relative))]:
            path = os.path.join(folder, name)
            device = printer.Printer(program, trace=path)
            # What it tells its user.
            shown, sys.stdout = sys.stdout, nowhere
            try:
                talk(pronsole, device.path, path, commands)
            finally:
                sys.stdout = shown
                if device.process.poll() is None and sys.exc_info()[0]:
                    device.kill()
            device.end()
            said.append(f"{name}: {undisturbed.same_lines(program, path, commands, [mm for _, mm in TYPED])}")
    return ", ".join(said)


def talk(pronsole, port, path, commands):
    pathlib.Path(path + ".print.gcode").write_text("\n".join(commands) + "\n", encoding="utf-8")
    host = pronsole()
    heard = []
    host.recvlisteners.append(heard.append)
    check(host.connect_to_printer(port, 115200, None), "pronsole does not connect")
    ended = threading.Event()
    said, host.p.endcb = host.p.endcb, lambda: (said(), ended.set())

    def wait(holds, what):
        until = time.monotonic() + printer.PATIENCE_S
        while not holds():
            check(time.monotonic() < until, f"{what}: {heard[-5:]}")
            time.sleep(PAUSE_S)

    try:
        wait(lambda: host.p.online, "pronsole does not get online")
        host.onecmd(f"load {path}.print.gcode")
        host.onecmd("print")
        for place, (lines, _) in enumerate(TYPED):
            wait(lambda: host.p.paused and host.p.print_thread is None, f"it does not pause at M25 number {place}")
            ended.clear()
            for line in lines:
                host.onecmd(line)
            host.onecmd(f"M118 TYPED {place}")
            wait(lambda place=place: any(line.startswith(f"TYPED {place}") for line in heard), "a line is not answered")
            host.onecmd("resume")
            resumed = lambda: sum(line.startswith("//action:resumed") for line in heard)
            wait(lambda place=place: resumed() > place, "it does not go on")
        wait(ended.is_set, f"pronsole stalls at line {host.p.lineno}")
        complaints = [line for line in heard if line.startswith("Error") or "Unknown" in line or line.startswith("Resend")]
        check(not complaints, f"the printer said {complaints[:3]}")
    finally:
        consoles.leave(host)


logging.disable()
printer.main(run)
