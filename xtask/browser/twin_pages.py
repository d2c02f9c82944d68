"""The pages that show no print, on a desk and, in the dark, on a phone: a played path, machines side by side, frequencies over
the reach, a study, and what an accelerometer measured. They are in the viewer's style, and every control of them is used.

Arguments: corehbot.
"""

import math
import subprocess
from pathlib import Path

from chromium import DESK, PHONE, Chromium, check
from paper import check_paper
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from trial import ROOT, main

STUDY = """compute = ["stiffness", "modes"]
machines = ["corehbot", "corexy"]
method = "latin-hypercube"
samples = 12

[vary]
belt_EA_N = { from = 20000, to = 56000 }
head_mass_kg = { from = 0.4, to = 0.8 }
"""

# A sweep from 20 to 60 Hz in 10 s, of a tool that rings at 40 Hz with a damping ratio of 0.06.
FROM_HZ, TO_HZ, HZ_PER_S, RATE_HZ = 20, 60, 4, 1600
MODE_HZ, DAMPING = 40, 0.06

# Charts are drawn when they are in sight, or when the page has nothing else to do.
DRAWN = """const places = [...document.querySelectorAll('.plot')].filter(place => place.checkVisibility());
    const missing = places.find(place => !place.querySelector('.u-over'));
    missing?.scrollIntoView({ block: 'center' });
    return !missing && places.length;"""

# What the page says over its chart when a finger or the mouse is there.
READ = """const place = document.querySelectorAll('.plot')[arguments[0]], over = place.querySelector('.u-over'), box = over.getBoundingClientRect();
    const at = { clientX: box.left + box.width * arguments[1], clientY: box.top + box.height / 2, bubbles: true, pointerType: arguments[2], buttons: 1 };
    over.dispatchEvent(arguments[2] == 'touch' ? new PointerEvent('pointermove', at) : new MouseEvent('mousemove', at));
    return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(place.closest('.chart').querySelector('output').textContent.trim()))));"""

# What is said of the first part of a picture when a finger or the mouse is there.
SAYS = """const part = document.querySelector(arguments[0]), box = part.getBoundingClientRect();
    const at = { clientX: box.left + box.width / 2, clientY: box.top + box.height / 2, bubbles: true, pointerType: arguments[1] };
    part.dispatchEvent(new PointerEvent(arguments[1] == 'touch' ? 'pointerdown' : 'pointermove', at));
    return part.closest('section').querySelector('.says').textContent;"""


def recording():
    """The lines of an accelerometer: a square wave of 40 mm/s^2 per Hz, through a mode of the tool."""
    rows, turns, place, speed = ["#time,accel_x,accel_y,accel_z"], 0.0, 0.0, 0.0
    w, fine = 2 * math.pi * MODE_HZ, 4
    for i in range((TO_HZ - FROM_HZ) * RATE_HZ // HZ_PER_S):
        hz = FROM_HZ + HZ_PER_S * i / RATE_HZ
        turns += hz / RATE_HZ
        pushed = 40 * hz * (1 if turns % 1 < 0.5 else -1)
        for _ in range(fine):
            speed += (w * w * (pushed - place) - 2 * DAMPING * w * speed) / RATE_HZ / fine
            place += speed / RATE_HZ / fine
        rows.append(f"{100 + i / RATE_HZ:.6f},{place:.3f},0,9806.65")
    return "\n".join(rows) + "\n"


def runs(folder):
    """Files of runs along both diagonals: motors of one side shake the tool more, once an electrical turn of 0.8 mm of belt."""
    for angle, mm in ((45, 0.004), (135, 0.003)):
        for speed in range(16, 60, 4):
            w = 2 * math.pi * math.sqrt(2) * speed / 0.8
            r = w / (2 * math.pi * MODE_HZ)
            most = mm * w * w / math.hypot(1 - r * r, 2 * DAMPING * r)
            rows = (f"{i / RATE_HZ:.6f},{most * math.sin(w * i / RATE_HZ):.3f},0,9806.65" for i in range(2000))
            text = "\n".join(["#time,accel_x,accel_y,accel_z", *rows, ""])
            (folder / f"vib_an{angle}_00sp{speed}_00n1.csv").write_text(text)
    return sorted(folder.glob("vib_an*.csv"))


def pages(corehbot, folder):
    """Writes them; returns their paths by name."""
    (folder / "study.toml").write_text(STUDY)
    (folder / "raw_data_x.csv").write_text(recording())
    circle, packed = ROOT / "examples/shaping.gcode", ROOT / "resonance/tests/files/two_runs.stdata"
    sweep = ["--sweep", f"{FROM_HZ}-{TO_HZ}", "--growth", str(HZ_PER_S)]
    orders = {
        "run": ["twin", "run", circle],
        "compare": ["compare", "--grid", "3x3"],
        "resonance": ["twin", "resonance", "--grid", "5x5"],
        "study": ["sweep", "study.toml", "-o", "study.csv"],
        "measured": ["resonance", "raw_data_x.csv", packed, *runs(folder), *sweep],
    }
    for name, words in orders.items():
        program = Path(corehbot).with_name("corehbot-lab") if name in ("compare", "study") else corehbot
        ran = subprocess.run([program, *map(str, words), "--report", f"{name}.html"], capture_output=True, text=True, cwd=folder)
        check(ran.returncode == 0, f"{words}: {ran.stdout}{ran.stderr}")
    return {name: folder / f"{name}.html" for name in orders}


def check_family(browser, name, charts):
    """Head, cards, charts, widths and names are those of the viewer."""
    check(browser.run("return document.querySelectorAll('main.viewer > header > h1').length") >= 1, f"{name} has no head")
    check("corehbot" in browser.driver.title, f"the title of {name} is {browser.driver.title}")
    if charts:
        browser.wait(f"charts of {name}", lambda: browser.run(DRAWN))
    found = browser.run("return [...document.querySelectorAll('.u-over')].map(over => getComputedStyle(over).touchAction)")
    check(len(found) >= charts and set(found) <= {"pan-y"}, f"{name} has {len(found)} charts, which a finger passes by {set(found)}")
    browser.check_width()
    browser.check_labels()
    said = browser.run("return document.body.innerText")
    check("NaN" not in said and "undefined" not in said and "e-1" not in said, f"{name} says {said[:400]}")


def read(browser, chart, share, kind):
    said = browser.run(READ, chart, share, kind)
    check(any(digit in said for digit in "0123456789"), f"chart {chart} says nothing under a {kind}: {said}")
    return said


def use_run(browser, kind):
    # All charts have one time; a curve is hidden and comes back.
    at = read(browser, 1, 0.5, kind)
    check(at.split(" s:")[0] == read(browser, 0, 0.5, kind).split(" s:")[0], f"charts are not at one time: {at}")
    curve = browser.find(".charts .legend button")
    curve.send_keys(Keys.ENTER)
    check(curve.get_attribute("aria-pressed") == "false", "a curve cannot be hidden")
    check(curve.text not in read(browser, 1, 0.6, kind).split(": ")[1], "a hidden curve is read")
    curve.send_keys(Keys.ENTER)
    # Keys read the chart, value by value.
    place = browser.find_all(".plot")[0]
    place.send_keys(Keys.ARROW_RIGHT)
    first = browser.run("return document.querySelector('.chart output').textContent")
    place.send_keys(Keys.ARROW_RIGHT)
    check(first != browser.run("return document.querySelector('.chart output').textContent"), f"keys do not read a chart: {first}")
    # A corner is shown larger, and Fit shows all again.
    scale = lambda: browser.run("return camera.scale")
    whole = scale()
    browser.find("tbody button").send_keys(Keys.ENTER)
    check(scale() > 2 * whole, "a corner is not shown")
    browser.find("button[title='Show the whole path']").send_keys(Keys.ENTER)
    check(abs(scale() / whole - 1) < 1e-6, "Fit does not show the whole path")
    stage = browser.find(".stage")
    stage.send_keys("+")
    check(scale() > whole, "a key does not zoom")
    stage.send_keys("0")
    painted = "const c = document.querySelector('.stage canvas'), d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (c.width * c.height)"
    check(browser.run(painted) > 0.01, "the path is not drawn")


def use_study(browser, kind):
    over = Select(browser.find("label select"))
    counts = {}
    for value in ("all", "1", "0"):
        over.select_by_value(value)
        counts[value] = browser.run("return document.querySelectorAll('.plot').length")
    check(counts["all"] == 2 * counts["0"] == 2 * counts["1"], f"plots: {counts}")
    browser.wait("plots", lambda: browser.run(DRAWN))
    said = read(browser, 0, 0.5, kind)
    check("sample" in said and " N, " in said and said.endswith("N/mm"), f"a sample has a number and units: {said}")
    check("The same in all samples: Kxy_N_per_mm 0" in browser.find("main").text, "noise is drawn as a result")


def use_measured(browser, kind):
    spectrum = read(browser, 0, 0.2, kind)
    check(" Hz: x " in spectrum and "(mm/s²)²/Hz, suggested" in spectrum, f"values have no units: {spectrum}")
    check(" y 0, z 0, " in spectrum, f"nothing moves along y and z, and noise is read: {spectrum}")
    for part in (".polar path", ".heatmap [data-says]"):
        said = browser.run(SAYS, part, kind)
        check("°, " in said and " mm/s²" in said and said.count(" Hz") == 1, f"{part} says {said} under a {kind}")
    check(f"{MODE_HZ}.0" in browser.find("main").text, "the mode of the plant is not told")
    check(browser.find_all("button[title='Copy this line']"), "no line to copy")
    said = browser.find("main").text
    # 1 - (4 - 3) / (4 + 3) of the vibration.
    check("86\n%\nsymmetry" in said or "86 %\nsymmetry" in said, f"the symmetry is not told: {said[-1500:]}")
    check(said.count("main resonance of") == 2 and "electrical turns" in said, "motors are not told")
    painted = "const c = document.querySelector('.spectrogram canvas'); return c.getContext('2d').getImageData(c.width / 2, c.height / 2, 1, 1).data[3]"
    check(browser.run(painted) == 255, "the spectrogram is not drawn")


USE = {"run": (4, use_run), "compare": (0, None), "resonance": (0, None), "study": (3, use_study), "measured": (7, use_measured)}


def run(corehbot, folder):
    files = pages(corehbot, folder)
    with Chromium() as browser:
        for size, kind in ((DESK, "mouse"), (PHONE, "touch")):
            browser.resize(size, is_dark=size == PHONE)
            for name, (charts, use) in USE.items():
                browser.open(files[name])
                check_family(browser, name, charts)
                check_paper(browser, name, size, is_dark=size == PHONE)
                if use:
                    use(browser, kind)
                browser.check_quiet()
    return f"{len(files)} pages, {max(file.stat().st_size for file in files.values()) / 1e3:.0f} kB at most"


if __name__ == "__main__":
    main(run)
