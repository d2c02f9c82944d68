"""The firmware in the page makes the very steps of `corehbot run`: the whole summary is the same for every example, on every
machine file, with belts that stretch, and with accidents. It says how much faster than real time the page prints.

Arguments: corehbot. `PAGE` is the page's first file.
"""

import json
import math
import os
import subprocess

from chromium import Chromium, check
from trial import ROOT, main

# What each machine prints: short, with corners, arcs and filament.
ON_ALL_MACHINES = "examples/tiny.gcode"

# The print whose ratio to real time is told, without a plant and with one, by the time of the processor. It is a figure
# of this computer, so nothing is asked of it.
TIMED = "examples/first-print.gcode"

PRINT = """
    const [job, text, done] = arguments;
    self.firmwareOfTrial ??= new Firmware();
    self.firmwareOfTrial.call('print', job, new TextEncoder().encode(text).buffer)
        .then(({summary}) => done({summary}), error => done({error: error.message}));
"""

# Fields of a job in the page, and the command's options for them.
OPTIONS = {"seed": "seed", "homed": "assume-homed", "bed": "bed", "hits": "hit", "breaks": "break"}

# A print over a mesh of a bed that is not flat, and its machine.
PROBED = "[endstops]\nprobe = \"PROBE\"\n[probe]\nkind = \"switch\"\n"
PROBING = "G28\nG29\nG1 X60 Y60 Z0.3 F9000\nG1 X120 Y150\n"

# Belts with accidents, and a bed that is not flat, as a user asks for them.
TROUBLED = {"has_belt_plant": True, "seed": "7", "hits": ["100,100,40,300"], "breaks": ["rub:m1:15N@0.5s", "seized:7:20N@1s+2s", "jump:m8@1.5s"]}
UNEVEN = {"bed": "bowl=0.2,tilt.x=0.0004,noise=0.005", "breaks": ["early:probe@1h"]}


def cases(folder):
    """A file, a machine file and a job's options."""
    belts = {"has_belt_plant": True}
    for file in sorted((ROOT / "examples").glob("*.gcode")):
        for options in ({}, belts):
            yield file, None, options
    yield ROOT / "examples/belt/skip-and-repair.gcode", None, belts
    for machine in sorted((ROOT / "examples/machines").glob("*.toml")):
        for options in ({}, belts):
            yield ROOT / ON_ALL_MACHINES, machine, options
    for options in ({}, belts):
        yield ROOT / "xtask/clients/heat.gcode", ROOT / "xtask/clients/heat.toml", options
    yield ROOT / "examples/circle.gcode", None, TROUBLED
    file, machine = folder / "probing.gcode", folder / "probed.toml"
    file.write_text(PROBING)
    machine.write_text(PROBED)
    yield file, machine, UNEVEN


def native(corehbot, file, machine, options):
    command = [corehbot, "run", file.name, "--json", "-"]
    command += ["--machine", str(machine)] if machine else []
    command += ["--plant", "belt"] if options.get("has_belt_plant") else []
    for field, option in OPTIONS.items():
        texts = options.get(field, [])
        for text in [texts] if isinstance(texts, str) else texts:
            command += [f"--{option}", text]
    ran = subprocess.run(command, capture_output=True, text=True, cwd=file.parent)
    check(ran.stdout.startswith("{"), f"{command}: {ran.stderr}")
    return json.loads(ran.stdout)


def in_page(browser, file, machine, options):
    job = {"file": file.name, **options}
    if machine:
        job |= {"machine_file": machine.name, "machine": machine.read_text()}
    before = browser.processor_seconds()
    printed = browser.driver.execute_async_script(PRINT, json.dumps(job), file.read_text())
    seconds = browser.processor_seconds() - before
    check("error" not in printed, f"{file.name} on {machine}, {options}: {printed.get('error')}")
    return json.loads(printed["summary"]), seconds


def alike(one, other):
    """Equal, but for the last digits of figures: sine and root of a system's library and of the page's differ there."""
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(alike(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(alike, one, other))
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-9)
    return one == other


def run(corehbot, folder):
    same, ratios = 0, {}
    with Chromium() as browser:
        browser.open(os.environ["PAGE"])
        for case in cases(folder):
            file, machine, options = case
            name = f"{file.name} on {machine.name if machine else 'the prototype'}, {options}"
            wanted, (found, seconds) = native(corehbot, *case), in_page(browser, *case)
            check(wanted["trace_sha256"] == found["trace_sha256"], f"{name}: the steps in the page are others")
            # The page has its own clock for this.
            wanted["wall_time_s"] = found["wall_time_s"]
            unlike = {key: (value, found.get(key)) for key, value in wanted.items() if not alike(value, found.get(key))}
            check(not unlike and wanted.keys() == found.keys(), f"{name}: the page's summary is another one: {unlike}")
            same += 1
            if file == ROOT / TIMED:
                ratios[bool(options)] = found["print_time_s"] / seconds
        browser.check_quiet()
    rigid, belt = ratios[False], ratios[True]
    return f"{same} prints with the steps and the summary of corehbot run; {rigid:.0f} times real time, {belt:.0f} with belts that stretch"


main(run)
