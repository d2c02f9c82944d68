"""OctoPrint prints a file that heats: its temperature graph shows the rise to the targets, and that all is off afterwards.

Arguments: corehbot, G-code file (its machine stands beside it) and `clean`.
"""

import os
import pathlib
import re
import tempfile
import time

import heat
import octo
import printer
from printer import check

# Its names of the heaters.
NAMES = {"hotend": "tool0", "bed": "bed"}


def run(program, file, _kind):
    machine = str(pathlib.Path(file).with_suffix(".toml"))
    summary = printer.simulate(program, file, machine)
    with tempfile.TemporaryDirectory(prefix="corehbot-octoprint-") as folder:
        port = os.path.join(folder, "printer")
        host = octo.OctoPrint(folder, port)
        device = None
        try:
            host.wait_until_up()
            device = printer.Printer(program, port, settings=machine)
            host.connect()
            begin = time.monotonic()
            host.begin("heat.gcode", printer.commands(file))
            host.wait_for_state("Operational")
            seconds = time.monotonic() - begin
            host.wait("a report of heaters that are off", lambda: is_off(history(host)[-1]))
            points = history(host)
            for name, key in NAMES.items():
                heat.check_rise(name, [(point[key]["actual"], point[key]["target"]) for point in points])
            said = check_waits(host.log("serial.log"))
            printer.same_steps(device, summary)
            return f"heats and prints in {seconds:.1f} s, a graph of {len(points)} points, {said}, same steps"
        finally:
            if device:
                device.kill()
            host.end()


def history(host):
    """The points of its graph, the oldest first, without those before anything was measured."""
    points = host.ask("printer?history=true&limit=10000")["temperature"]["history"]
    return sorted(filter(is_measured, points), key=lambda point: point["time"])


def is_measured(point):
    return all(point.get(key, {}).get("actual") for key in NAMES.values())


def is_off(point):
    return all(point[key]["target"] == 0 for key in NAMES.values())


def check_waits(log):
    """M190 and M109 wait, and what comes after them is sent when the wait is over."""
    said = []
    for command in ["M190 S35", "M109 S200"]:
        during = re.search(rf"Send: N\d+ {command}\*\d+\n(.*?)Recv: ok", log, re.DOTALL)
        check(during, f"{command} is not answered")
        said.append(heat.check_wait(during[1].splitlines(), command))
    return ", ".join(said)


printer.main(run)
