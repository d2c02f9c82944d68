"""The firmware in the page makes the very steps of `corehbot run`: the SHA-256 of the trace is the same for every example,
on every machine file, and with belts that stretch. It says how much faster than real time the page prints.

Arguments: corehbot. `PAGE` is the page's first file.
"""

import json
import os
import subprocess

from chromium import Chromium, check
from trial import ROOT, main

# What each machine prints: short, with corners, arcs and filament.
ON_ALL_MACHINES = "examples/tiny.gcode"

# The print whose ratio is told, without a plant and with one, by the time of the processor. The goal for the first is 100
# on an idle computer; a processor that other steps use too does half of it in the same time.
TIMED = "examples/first-print.gcode"
LEAST_RATIO = 50

PRINT = """
    const [job, text, done] = arguments;
    self.firmwareOfTrial ??= new Firmware();
    self.firmwareOfTrial.call('print', job, new TextEncoder().encode(text).buffer)
        .then(({summary}) => done({summary}), error => done({error: error.message}));
"""


def cases():
    for file in sorted((ROOT / "examples").glob("*.gcode")):
        yield file, None, False
    for machine in sorted((ROOT / "examples/machines").glob("*.toml")):
        for has_belt_plant in (False, True):
            yield ROOT / ON_ALL_MACHINES, machine, has_belt_plant
    yield ROOT / "xtask/clients/heat.gcode", ROOT / "xtask/clients/heat.toml", False
    yield ROOT / TIMED, None, True


def native(corehbot, file, machine, has_belt_plant):
    command = [corehbot, "run", str(file), "--json", "-"]
    command += ["--settings", str(machine)] if machine else []
    command += ["--plant", "belt"] if has_belt_plant else []
    ran = subprocess.run(command, capture_output=True, text=True)
    check(ran.stdout.startswith("{"), f"corehbot run {file}: {ran.stderr}")
    return json.loads(ran.stdout)


def in_page(browser, file, machine, has_belt_plant):
    job = {"file": file.name, "has_belt_plant": has_belt_plant}
    if machine:
        job |= {"machine_file": machine.name, "machine": machine.read_text()}
    before = browser.processor_seconds()
    printed = browser.driver.execute_async_script(PRINT, json.dumps(job), file.read_text())
    seconds = browser.processor_seconds() - before
    check("error" not in printed, f"{file.name} on {machine}: {printed.get('error')}")
    return json.loads(printed["summary"]), seconds


def run(corehbot, _folder):
    same, ratios = 0, {}
    with Chromium() as browser:
        browser.open(os.environ["PAGE"])
        for case in cases():
            file, machine, has_belt_plant = case
            name = f"{file.name} on {machine.name if machine else 'the prototype'}{', with belts that stretch' if has_belt_plant else ''}"
            wanted, (found, seconds) = native(corehbot, *case), in_page(browser, *case)
            check(wanted["trace_sha256"] == found["trace_sha256"], f"{name}: the steps in the page are others")
            check(wanted["ok"] == found["ok"], f"{name}: {found['failure']}")
            same += 1
            if file == ROOT / TIMED:
                ratios[has_belt_plant] = found["print_time_s"] / seconds
        browser.check_quiet()
    rigid, belt = ratios[False], ratios[True]
    check(rigid >= LEAST_RATIO, f"{TIMED} is printed at {rigid:.0f} times real time, {LEAST_RATIO} at least")
    return f"{same} prints with the steps of corehbot run; {rigid:.0f} times real time, {belt:.0f} with belts that stretch"


main(run)
