"""Reports of three prints open from their files and look like the pictures in `golden`, on a desk and, in the dark, on a
phone. Every control of them is used.

Arguments: corehbot. `BLESS=1` writes the pictures.
"""

from chromium import DESK, PHONE, Chromium, check
from every import use_all
from paper import check_paper
from trial import ROOT, main, print_report

HEAT = ROOT / "xtask/clients"

# A print with each type of line; one that fails at a broken thermistor; one with belts that stretch, with shapers that its M593
# set.
PRINTS = {
    "lines": (ROOT / "examples/first-print.gcode",),
    "fault": (HEAT / "heat.gcode", "--machine", HEAT / "heat.toml", "--break", "open:hotend@60s"),
    "belt": (ROOT / "examples/shaping.gcode", "--plant", "belt"),
}

# A report has at least as many controls as this: those of the picture, of the charts and of the comparison.
LEAST_CONTROLS = 40

# Goes to the end, as a chart's keys have gone to the begin, and counts the moves in the picture.
MOVES = "const { stage, player } = document.querySelector('.viewer').corehbotView; player.setMove(1e9); return stage.drawn"


def run(corehbot, folder):
    worst, times, megabytes, used = 0, [], 0, 0
    with Chromium() as browser:
        for name, (file, *options) in PRINTS.items():
            report = print_report(corehbot, file, folder, *options, ends_well=name != "fault")
            megabytes = max(megabytes, report.stat().st_size / 1e6)
            for place, size in (("desk", DESK), ("phone", PHONE)):
                browser.resize(size, is_dark=size == PHONE)
                times.append(browser.open(report))
                check(file.stem in browser.driver.title, f"the title is {browser.driver.title}")
                worst = max(worst, browser.picture(f"{name}-{place}"))
                browser.check_width()
                browser.check_quiet()
                check_paper(browser, name, size, is_dark=size == PHONE)
                browser.check_quiet()
                if place == "desk":
                    used += use_all(browser, "body", LEAST_CONTROLS)
                    browser.wait(f"picture of {name} after all controls were used", lambda: browser.run(MOVES) > 0)
    return f"loaded in {max(times):.2f} s, {megabytes:.1f} MB; {used} controls were used; {len(times)} pictures differ in {worst:.3%} of their area at most"


main(run)
