"""Printrun's pronsole uploads a file and then prints it: nothing of the upload is carried out, the print is.

Arguments: corehbot, G-code file (its machine stands beside it) and `clean`.

Pronsole does not wait for the answer to M28: its printcore sends that, and the file behind it as if it were a print.
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
from printer import check

# A printer that says nothing for so long is done for.
SILENCE_S = 60

# Between two looks at what pronsole has done.
PAUSE_S = 0.1

# The name on a card.
TARGET = "test.gco"

LETTERS = "TB"


def run(program, file, _kind):
    machine = str(pathlib.Path(file).with_suffix(".toml"))
    summary = printer.simulate(program, file, machine)
    device = printer.Printer(program, settings=machine)
    try:
        with tempfile.TemporaryDirectory() as folder, open(os.devnull, "w", encoding="utf-8") as nowhere:
            path = os.path.join(folder, "print.gcode")
            commands = printer.commands(file)
            pathlib.Path(path).write_text("\n".join(commands) + "\n", encoding="utf-8")
            # What it tells its user: of each line that it hears, and of its progress.
            shown, sys.stdout = sys.stdout, nowhere
            try:
                uploaded, printed, cold, off = talk(consoles.pronsole_class(folder), device.path, path)
            finally:
                sys.stdout = shown
        failed = [line for line in uploaded if "open failed" in line]
        check(failed and TARGET in failed[0], f"the upload is answered with {uploaded[:5]}")
        count = [line for line in uploaded if "ignored lines" in line and "upload ended" in line]
        check(count and count[0].endswith(f": {len(commands)}"), f"of {len(commands)} lines it says {count}")
        check(all(float(cold[letter][1]) == 0 for letter in LETTERS), f"heated by the upload: {cold}")
        check(all(float(off[letter][1]) == 0 for letter in LETTERS), f"not off after the print: {off}")
        complaints = [line for line in uploaded + printed if line.startswith("Error") or "Unknown" in line]
        check(not complaints, f"the printer said {complaints[:3]}")
        waits = [line for line in printed if " W:" in line]
        check(waits, "the print does not heat")
        # The steps of an upload that moved anything would be among them.
        return f"{len(commands)} commands uploaded, then printed: {printer.same_steps(device, summary)}"
    finally:
        device.kill()


def talk(pronsole, port, path):
    """Uploads, and prints; returns what was heard in either, and the temperatures after either."""
    from printrun.utils import parse_temperature_report

    host = pronsole()
    heard = []
    host.recvlisteners.append(heard.append)
    check(host.connect_to_printer(port, 115200, None), "pronsole does not connect")
    ended = threading.Event()
    said, host.p.endcb = host.p.endcb, lambda: (said(), ended.set())

    def wait(holds, what):
        begin, count = time.monotonic(), len(heard)
        while not holds():
            if len(heard) > count:
                begin, count = time.monotonic(), len(heard)
            check(time.monotonic() < begin + SILENCE_S, what)
            time.sleep(PAUSE_S)

    def temperatures():
        count = len(heard)
        reports = lambda: [line for line in heard[count:] if line.startswith("ok T:")]
        host.onecmd("M105")
        wait(reports, "M105 is not answered")
        return parse_temperature_report(reports()[-1])

    try:
        wait(lambda: host.p.online, "pronsole does not get online")
        wait(lambda: temperatures()["T"][0] != "0.00", "nothing is measured")
        heard.clear()
        host.onecmd(f"upload {path} {TARGET}")
        check(ended.is_set(), "the upload has not ended")
        cold = temperatures()
        uploaded = list(heard)
        heard.clear()
        ended.clear()
        host.onecmd("print")
        wait(ended.is_set, f"pronsole stalls at line {host.p.lineno}")
        # The last line is M400, and it was answered.
        off = temperatures()
        return uploaded, list(heard), cold, off
    finally:
        consoles.leave(host)


logging.disable()
printer.main(run)
