"""The page as people use it, on a desk and on a phone: it prints, cancels and prints again, shows errors of a machine file in
their lines, and has a printer at the end of a serial line.

Arguments: corehbot. `PAGE` is the page's first file.
"""

import os

from chromium import DESK, PHONE, Chromium, check
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from trial import main

# So long that nobody waits for its end: a circle is printed again and again.
ENDLESS = "const lines = ['G28', 'G1 F3000']; for (let i = 0; i < 40000; i++) lines.push(`G1 X${100 + i % 7} Y${100 + i % 5}`); take('endless.gcode', lines.join('\\n'));"

# How high the picture in the report is.
TALL = "return document.querySelector('#report').contentDocument?.querySelector('.stage')?.clientHeight ?? 0"


def text(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).textContent", selector)


def value(browser, selector, value):
    browser.run(
        """const [selector, value] = arguments, control = document.querySelector(selector);
        control.value = value;
        for (const name of ['input', 'change']) control.dispatchEvent(new Event(name, {bubbles: true}));""",
        selector,
        value,
    )


def value_of(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).value", selector)


def printed(browser):
    browser.wait("end of the print", lambda: browser.find("#cancel").is_displayed() is False and browser.find("#start").is_enabled())
    return text(browser, "#badge") if browser.find("#result").is_displayed() else text(browser, "#failure")


def check_print(browser):
    Select(browser.find("#example")).select_by_value("circle.gcode")
    browser.find("#start").click()
    check(printed(browser) == "printed", f"the circle: {text(browser, '#failure')}")
    first = text(browser, "#sha256")
    check(len(first) == 64, f"its SHA-256 is {first}")
    browser.wait("report", lambda: browser.run("return document.querySelector('#report').contentDocument?.querySelector('canvas') != null"))
    # Cancelled by a click, and once more by the keyboard.
    for cancel in (lambda: browser.find("#cancel").click(), lambda: browser.find("body").send_keys(Keys.ESCAPE)):
        browser.run(ENDLESS)
        browser.find("#start").click()
        browser.wait("progress", lambda: "commands" in text(browser, "#how-far"))
        cancel()
        browser.wait("cancelled print", lambda: text(browser, "#how-far") == "cancelled")
    Select(browser.find("#example")).select_by_value("circle.gcode")
    browser.find("#start").click()
    check(printed(browser) == "printed" and text(browser, "#sha256") == first, "the second print is another one")


def check_accident(browser):
    Select(browser.find("#machine-of-print")).select_by_value("heat.toml")
    Select(browser.find("#example")).select_by_value("heat.gcode")
    browser.find("#presets button").click()
    browser.find("#start").click()
    check(printed(browser) == "failed", "a thermistor that is off ends no print")
    check("sensor" in text(browser, "#failure").lower(), f"why: {text(browser, '#failure')}")
    browser.find("#chosen button").click()
    value(browser, "#assume-homed", "1,2")
    browser.wait("refusal", lambda: "three numbers" in text(browser, "#assume-homed-trouble"))
    browser.find("#start").click()
    check("three numbers" in printed(browser), f"two numbers are no place: {printed(browser)}")
    value(browser, "#assume-homed", "")


def check_parts(browser):
    """A part is broken by a click on it; what cannot be is told next to its field, until it can."""
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.wait("picture", lambda: browser.find("#parts").is_displayed())
    browser.find("#parts [data-part=m8]").click()
    check(value_of(browser, "#accident-place") == "m8" and value_of(browser, "#accident") == "seized", "a click chooses no motor")
    browser.find("#parts [data-part='7']").send_keys(Keys.ENTER)
    check(value_of(browser, "#accident-place") == "7", "a pulley cannot be chosen by the keyboard")
    value(browser, "#accident-time", "1s")
    browser.find("#add-accident").click()
    check(value_of(browser, "#chosen input") == "seized:7@1s" and browser.find("#belt").is_selected(), "no pulley is seized")
    wrong, trouble = "seized:99@1s", lambda: text(browser, "#chosen .trouble")
    value(browser, "#chosen input", wrong)
    browser.wait("refusal", lambda: "neither a belt motor" in trouble())
    value(browser, "#chosen input", "seized:7@1s")
    browser.wait("accident that can be", lambda: trouble() == "")
    for field, wrong, why in (("seed", "many", "whole number"), ("bed", "bowl=1", "no probe")):
        value(browser, f"#{field}", wrong)
        browser.wait("refusal", lambda: why in text(browser, f"#{field}-trouble"))
        value(browser, f"#{field}", "")
        browser.wait("field without a fault", lambda: text(browser, f"#{field}-trouble") == "")
    browser.find("#start").click()
    check(printed(browser) == "printed" and "seized:7@1s" in text(browser, "#words"), f"a seized pulley: {text(browser, '#words')}")
    browser.find("#chosen button").click()
    browser.find("#belt").click()


# The names of the pulleys, the widths of their targets in CSS pixels, and what a click on the middle of each chooses.
TARGETS = """return [...document.querySelectorAll('#parts .target')].map(target => {
    target.scrollIntoView({ block: 'center' });
    const { x, y, width, height } = target.getBoundingClientRect(), at = { clientX: x + width / 2, clientY: y + height / 2 };
    document.elementFromPoint(at.clientX, at.clientY).dispatchEvent(new MouseEvent('click', { bubbles: true, detail: 1, ...at }));
    return [target.parentNode.dataset.part, width, document.querySelector('#accident-place').value];
});"""


def check_targets(browser):
    """Each pulley is wide enough for a pointer, also in a small picture (WCAG 2.5.8), and is chosen by its middle."""
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.wait("picture", lambda: browser.find("#parts").is_displayed())
    targets = browser.run(TARGETS)
    wrong = [target for target in targets if target[1] < 23.9 or target[0] != target[2]]
    check(len(targets) > 4 and not wrong, f"targets of pulleys: {wrong}")


def check_editor(browser):
    browser.find("#tab-machine").click()
    value(browser, "#text", "[axes.x]\nmax_sped = 200\n")
    browser.wait("error in its line", lambda: "did you mean" in browser.run("return document.querySelector('#under .bad em')?.textContent ?? ''"))
    check(browser.run("return [...document.querySelectorAll('#under div')].findIndex(line => line.className == 'bad')") == 1, "the wrong line is marked")
    area = browser.find("#text")
    area.click()
    area.send_keys(Keys.CONTROL, "a")
    area.send_keys("[axes.x]\nmax_speed = 200")
    browser.wait("file without a fault", lambda: "without a fault" in text(browser, "#problem-count"))
    check("Speed limit" in text(browser, "#key-meaning"), f"the key's meaning: {text(browser, '#key-meaning')}")
    value(browser, "#find-key", "probe")
    check(browser.run("return document.querySelectorAll('#keys dt').length") > 5, "no keys of the probe")
    value(browser, "#find-key", "")
    names = browser.run("return [...document.querySelectorAll('#machine-to-edit option')].map(option => option.value)")
    board = next(name for name in names if name.startswith("board octopus"))
    Select(browser.find("#machine-to-edit")).select_by_value(board)
    browser.wait("new file", lambda: "octopus" in browser.run("return document.querySelector('#text').value"))
    Select(browser.find("#machine-to-edit")).select_by_value("prototype.toml")


def check_terminal(browser):
    browser.find("#tab-terminal").click()
    said = lambda: text(browser, "#log")
    browser.wait("greeting", lambda: "start" in said())
    command = browser.find("#command")
    command.send_keys("M115", Keys.ENTER)
    browser.wait("answer", lambda: "FIRMWARE_NAME" in said())
    command.send_keys(Keys.ARROW_UP)
    check(command.get_attribute("value") == "M115", "there is no history")
    command.clear()
    Select(browser.find("#speed")).select_by_value("20")
    path = lambda: browser.run("return document.querySelector('#picture .belt')?.getAttribute('d')")
    before = browser.wait("picture", path)
    command.send_keys("G28", Keys.ENTER)
    browser.wait("moving belt", lambda: path() != before)
    command.send_keys("G1 X50 Y50 F6000", Keys.ENTER, "M400", Keys.ENTER)
    browser.wait("place", lambda: "X50.00 Y50.00" in text(browser, "#place"))
    command.send_keys("M112", Keys.ENTER)
    browser.wait("stop", lambda: text(browser, "#state") == "halted")
    command.send_keys("M999", Keys.ENTER)
    browser.wait("restart", lambda: text(browser, "#state") == "ready")
    act = lambda what: next(button for button in browser.find_all("#acts button") if button.text == what).click()
    act("open:hotend")
    browser.wait("refusal", lambda: "hotend" in said().rsplit("(open:hotend)", 1)[-1])
    act("off")
    browser.wait("printer without power", lambda: text(browser, "#state") == "off")
    browser.find("#power").click()
    browser.wait("printer with power", lambda: text(browser, "#state") == "ready" and "start" in said())


def check_tabs(browser):
    for tab in ("print", "machine", "terminal"):
        browser.find(f"#tab-{tab}").click()
        browser.drawn()
        browser.check_width()
        browser.check_labels()
    browser.find("#tab-terminal").send_keys(Keys.ARROW_RIGHT)
    check(browser.find("#tab-print").get_attribute("aria-selected") == "true", "arrow keys do not choose a tab")


def run(_corehbot, _folder):
    with Chromium() as browser:
        seconds = browser.open(os.environ["PAGE"])
        browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
        for part in (check_tabs, check_print, check_accident, check_parts, check_editor, check_terminal):
            part(browser)
            browser.check_quiet()
        for size, is_dark in ((PHONE, False), (DESK, True)):
            browser.resize(size, is_dark)
            browser.open(os.environ["PAGE"])
            check_tabs(browser)
            check_print(browser)
            browser.check_width()
            check_targets(browser)
            # The frame is as high as the report, which must not be as high as a share of its frame.
            browser.wait("report", lambda: browser.run(TALL) > 0)
            check(browser.run(TALL) < size[1], f"the picture of the report is {browser.run(TALL)} px high")
            browser.check_quiet()
    return f"loaded in {seconds:.2f} s; prints, is cancelled, prints again, explains keys, answers M-codes"


main(run)
