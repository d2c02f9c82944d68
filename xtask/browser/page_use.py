"""The page as people use it, from its file and from a static server, on a desk and on a phone: it prints, cancels and prints
again, shows errors of a machine file in their lines, and has a printer at the end of a serial line.

Arguments: corehbot. `PAGE` is the page's first file.
"""

import functools
import gzip
import http.server
import io
import json
import os
import pathlib
import threading
import zipfile

from chromium import DESK, PHONE, Chromium, check
from every import use_all
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from trial import main

# So long that nobody waits for its end: a circle is printed again and again.
ENDLESS = "const lines = ['G28', 'G1 F3000']; for (let i = 0; i < 40000; i++) lines.push(`G1 X${100 + i % 7} Y${100 + i % 5}`); take('endless.gcode', lines.join('\\n'));"

# A file that is dropped, as a file manager does it.
DROP = """const data = new DataTransfer();
    const content = arguments[1] ? Uint8Array.from(arguments[1]) : 'G28\\nG1 X10 F6000\\n';
    data.items.add(new File([content], arguments[0]));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));"""

# What file inputs hold when they are about to be used again. The event opens no window of the system.
CLEARED = """return [...document.querySelectorAll('input[type=file]')].map(input => {
    const data = new DataTransfer();
    data.items.add(new File(['G28'], 'old.gcode'));
    input.files = data.files;
    input.dispatchEvent(new Event('click'));
    return input.value;
});"""

# How high the picture in the report is.
TALL = "return document.querySelector('.stage')?.clientHeight ?? 0"

# Whether the frame is as high as what is in it, but for its borders.
FITS = "return Math.abs(innerHeight - document.body.scrollHeight) < 1 && innerHeight > 400"


def in_report(browser, script, *args):
    """The result of a script in the report, which is in a sandbox: the page cannot look into it, the driver can."""
    browser.driver.switch_to.frame(browser.find("#report"))
    try:
        return browser.run(script, *args)
    finally:
        browser.driver.switch_to.default_content()


def text(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).textContent", selector)


# The page asks one worker about what was typed; after one more answer all earlier ones have come.
SETTLED = "const done = arguments[0]; answers.call('hands').then(() => done());"


def type_in(browser, selector, words):
    """Types in place of what a field has, key by key. A field has what was typed after each key, and when the page has thought
    about it."""
    field = browser.find(selector)
    field.send_keys(Keys.CONTROL, "a")
    field.send_keys(Keys.BACKSPACE)
    for i, letter in enumerate(words, 1):
        field.send_keys(letter)
        browser.driver.execute_async_script(SETTLED)
        has = value_of(browser, selector)
        check(has == words[:i], f"{selector} has {has!r} after {words[:i]!r} was typed")


def press(browser, selector):
    """A click on a control, wherever it is on the page."""
    browser.run("document.querySelector(arguments[0]).click()", selector)


def value_of(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).value", selector)


def printed(browser):
    browser.wait("end of the print", lambda: browser.find("#cancel").is_displayed() is False and browser.find("#start").is_enabled())
    return text(browser, "#badge") if browser.find("#result").is_displayed() else text(browser, "#failure")


# Whether the way to print is in the window.
SEEN = "const { top, bottom } = document.querySelector('#start').getBoundingClientRect(); return top >= 0 && bottom <= innerHeight"


# Room above what the page scrolls to, as page.css has it.
MARGIN_PX = 12

# Whether the browser follows what moves when a part above it goes or comes: some do, for some changes.
ANCHORS = ("auto", "none")


def check_place(browser, selector):
    """The page has scrolled to the result: it begins just below the upper edge."""
    scrolls, top = browser.run("return [scrolls, document.querySelector(arguments[0]).getBoundingClientRect().top]", selector)
    check(scrolls > 0 and abs(top - MARGIN_PX) <= 1, f"{selector} begins at {top} px after {scrolls} scrolls, not at {MARGIN_PX}")


def check_print(browser):
    browser.find("#tab-print").click()
    browser.run("scrollTo(0, 0)")
    check(browser.run(SEEN), "the way to print is out of the window")
    Select(browser.find("#example")).select_by_value("circle.gcode")
    browser.find("#start").click()
    check(printed(browser) == "printed", f"the circle: {text(browser, '#failure')}")
    check_place(browser, "#result")
    first = text(browser, "#sha256")
    check(len(first) == 64, f"its SHA-256 is {first}")
    browser.wait("report as high as its content", lambda: in_report(browser, "return document.querySelector('.charts') != null") and in_report(browser, FITS))
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


def check_drop(browser):
    """A file that is dropped on any tab is shown where it is used, by its content and not by its name."""
    machine = list(b"[axes.x]\nlength = 200\n")
    for name, tab, content in (("machine.toml", "print", None), ("print.gcode", "machine", machine), ("again.gcode", "print", None)):
        browser.find("#tab-terminal").click()
        browser.run(DROP, name, content)
        browser.wait(f"place of {name}", lambda: browser.find(f"#{tab}").is_displayed())
    check(text(browser, "#file-name") == "again.gcode", f"the file is {text(browser, '#file-name')}")
    check(browser.run(CLEARED) == ["", ""], "a file that is chosen again is not read again")
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.find("#start").click()
    check(printed(browser) == "printed", f"the dropped file: {text(browser, '#failure')}")
    # On the report too, but for the place that takes a second report.
    browser.wait("report", lambda: in_report(browser, TALL) > 0)
    in_report(browser, DROP, "on-report.gcode")
    browser.wait("file", lambda: text(browser, "#file-name") == "on-report.gcode")


def check_kinds(browser):
    """Another kind of file is told with its way, packed G-code prints, and a plate is chosen."""
    browser.find("#tab-print").click()
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.run(DROP, "printer.gcode", list(b"[printer]\nkinematics: corexy\n"))
    browser.wait("way", lambda: "printer.gcode: this is Klipper's printer.cfg, not G-code: `corehbot config from" in text(browser, "#failure"))
    browser.run(DROP, "a.gcode.gz", list(gzip.compress(b"G28\nG1 X20 F6000\n")))
    browser.wait("packed file", lambda: text(browser, "#file-name") == "a.gcode.gz" and not browser.find("#failure").is_displayed())
    browser.find("#start").click()
    check(printed(browser) == "printed", f"packed: {text(browser, '#failure')}")
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for number in (1, 2):
            archive.writestr(f"Metadata/plate_{number}.gcode", f"G28\nG1 X{number}0 F6000\n")
    browser.run(DROP, "two.3mf", list(packed.getvalue()))
    browser.wait("plates", lambda: browser.find("#plate").is_displayed())
    Select(browser.find("#plate")).select_by_value("2")
    browser.find("#start").click()
    check(printed(browser) == "printed", f"plate 2: {text(browser, '#failure')}")
    browser.run(DROP, "cut.3mf", list(packed.getvalue()[:90]))
    browser.wait("damage", lambda: "cut.3mf: the file is damaged" in text(browser, "#failure"))


def check_scrolls(browser):
    """The page scrolls to the result and to a failure, in browsers that follow what moves and in others."""
    browser.find("#tab-print").click()
    for anchor in ANCHORS:
        browser.run("document.documentElement.style.overflowAnchor = arguments[0]", anchor)
        # The first print of a page has no report of an earlier one below it.
        for example, machine, place in (("circle.gcode", "prototype.toml", "#result"), ("heat.gcode", "heat.toml", "#failure")):
            Select(browser.find("#machine-of-print")).select_by_value(machine)
            Select(browser.find("#example")).select_by_value(example)
            if place == "#failure":
                # The bar with Print may cover it.
                press(browser, "#presets button")
            browser.run("scrollTo(0, 0)")
            browser.find("#start").click()
            printed(browser)
            check_place(browser, place)
        press(browser, "#chosen button")
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")


def check_accident(browser):
    Select(browser.find("#machine-of-print")).select_by_value("heat.toml")
    Select(browser.find("#example")).select_by_value("heat.gcode")
    browser.find("#presets button").click()
    browser.find("#start").click()
    check(printed(browser) == "failed", "a thermistor that is off ends no print")
    check("sensor" in text(browser, "#failure").lower(), f"why: {text(browser, '#failure')}")
    browser.find("#chosen button").click()
    type_in(browser, "#assume-homed", "1,2")
    browser.wait("refusal", lambda: "three numbers" in text(browser, "#assume-homed-trouble"))
    browser.find("#start").click()
    check("three numbers" in printed(browser), f"two numbers are no place: {printed(browser)}")
    type_in(browser, "#assume-homed", "")


def check_parts(browser):
    """A part is broken by a click on it; what cannot be is told next to its field, until it can."""
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.wait("picture", lambda: browser.find("#parts").is_displayed())
    browser.find("#parts [data-part=m8]").click()
    check(value_of(browser, "#accident-place") == "m8" and value_of(browser, "#accident") == "Belts seized", "a click chooses no motor")
    kinds = browser.run("return [...document.querySelectorAll('#accident option')].map(option => option.value)")
    check(len(kinds) == len(set(kinds)) and {"Belts loose", "Heat loose"} < set(kinds), f"kinds of accidents: {kinds}")
    Select(browser.find("#accident")).select_by_value("Belts loose")
    check("Belts loose" == value_of(browser, "#accident") and browser.find("#accident-how").is_displayed(), "no pulley can be loose")
    Select(browser.find("#accident")).select_by_value("Belts seized")
    browser.find("#parts [data-part='7']").send_keys(Keys.ENTER)
    check(value_of(browser, "#accident-place") == "7", "a pulley cannot be chosen by the keyboard")
    type_in(browser, "#accident-time", "1s")
    browser.find("#add-accident").click()
    check(value_of(browser, "#chosen input") == "seized:7@1s" and browser.find("#belt").is_selected(), "no pulley is seized")
    wrong, trouble = "seized:99@1s", lambda: text(browser, "#chosen .trouble")
    type_in(browser, "#chosen input", wrong)
    browser.wait("refusal", lambda: "neither a belt motor" in trouble())
    type_in(browser, "#chosen input", "seized:7@1s")
    browser.wait("accident that can be", lambda: trouble() == "")
    for field, wrong, why in (("seed", "many", "whole number"), ("bed", "bowl=1", "no probe")):
        type_in(browser, f"#{field}", wrong)
        browser.wait("refusal", lambda: why in text(browser, f"#{field}-trouble"))
        type_in(browser, f"#{field}", "")
        browser.wait("field without a fault", lambda: text(browser, f"#{field}-trouble") == "")
    browser.find("#start").click()
    check(printed(browser) == "printed" and "seized:7@1s" in text(browser, "#words"), f"a seized pulley: {text(browser, '#words')}")
    browser.find("#chosen button").click()
    browser.find("#belt").click()


# The names of pulleys, the widths of their targets in CSS pixels, and what a click on the middle of each chooses.
TARGETS = """return arguments[0].flatMap(part => [...document.querySelectorAll(`#parts ${part} .target`)]).map(target => {
    target.scrollIntoView({ block: 'center' });
    const { x, y, width, height } = target.getBoundingClientRect(), at = { clientX: x + width / 2, clientY: y + height / 2 };
    document.elementFromPoint(at.clientX, at.clientY).dispatchEvent(new MouseEvent('click', { bubbles: true, detail: 1, ...at }));
    return [target.parentNode.dataset.part, width, document.querySelector('#accident-place').value];
});"""


def check_targets(browser):
    """Each pulley is wide enough for a pointer, also in a small picture (WCAG 2.5.8), and is chosen by its middle."""
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")
    browser.wait("picture", lambda: browser.find("#parts").is_displayed())
    targets = browser.run(TARGETS, [""])
    wrong = [target for target in targets if target[1] < 23.9 or target[0] != target[2]]
    check(len(targets) > 4 and not wrong, f"targets of pulleys: {wrong}")
    # Two motors, one over the other: each click chooses the next part.
    Select(browser.find("#machine-of-print")).select_by_value("corexz.toml")
    browser.wait("picture", lambda: browser.find_all("#parts [data-part='41']"))
    chosen = [target[2] for target in browser.run(TARGETS, 3 * ["[data-part=m8]"])]
    check(set(chosen[:2]) == {"m8", "m11"} and len(set(chosen)) == 3, f"clicks on two motors choose {chosen}")
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")


def check_editor(browser):
    browser.find("#tab-machine").click()
    type_in(browser, "#text", "[axes.x]\nmax_sped = 200\n")
    browser.wait("error in its line", lambda: "did you mean" in browser.run("return document.querySelector('#under .bad em')?.textContent ?? ''"))
    check(browser.run("return [...document.querySelectorAll('#under div')].findIndex(line => line.className == 'bad')") == 1, "the wrong line is marked")
    area = browser.find("#text")
    area.click()
    area.send_keys(Keys.CONTROL, "a")
    area.send_keys("[axes.x]\nmax_speed = 200")
    browser.wait("file without a fault", lambda: "without a fault" in text(browser, "#problem-count"))
    check("Speed limit" in text(browser, "#key-meaning"), f"the key's meaning: {text(browser, '#key-meaning')}")
    type_in(browser, "#find-key", "probe")
    check(browser.run("return document.querySelectorAll('#keys dt').length") > 5, "no keys of the probe")
    type_in(browser, "#find-key", "")
    # A table opens, and a key without a default is written with a value of its type.
    browser.run("showKeys()")
    for name in ("corner", "corner.square_corner"):
        browser.run("[...document.querySelectorAll('#keys button')].find(key => key.textContent === arguments[0]).click()", name)
    check(value_of(browser, "#text").endswith("[corner]\nsquare_corner = 0.01"), f"the key is written as {value_of(browser, '#text')}")
    check(browser.run("return getSelection().toString()") == "0.01", "its value is not there to be typed over")
    names = browser.run("return [...document.querySelectorAll('#machine-to-edit option')].map(option => option.value)")
    board = next(name for name in names if name.startswith("board octopus"))
    Select(browser.find("#machine-to-edit")).select_by_value(board)
    browser.wait("new file", lambda: "octopus" in browser.run("return document.querySelector('#text').value"))
    # What was edited can be chosen again.
    Select(browser.find("#machine-to-edit")).select_by_visible_text("prototype")
    check(value_of(browser, "#text").startswith("[axes.x]\nmax_speed = 200"), f"the edited file is lost: {value_of(browser, '#text')[:40]}")
    Select(browser.find("#machine-to-edit")).select_by_value("prototype.toml")


# Where each part of the picture is.
MOVED = """const picture = document.querySelector('#picture'), place = (name, key) => picture.querySelector(name)?.getAttribute(key);
    if (!place('.belt', 'd')) return null;
    const motors = [...picture.querySelectorAll('.motor')].map(motor => [motor.textContent, motor.innerHTML]);
    return { belt: place('.belt', 'd'), teeth: place('.teeth', 'stroke-dashoffset'), bar: place('.rail', 'y'), head: place('.head', 'x'),
        ...Object.fromEntries(motors) };"""


# The states that the terminal has told: a slow trial may look after the motion.
NOTE_STATES = """const state = document.querySelector('#state');
    window.states = [];
    new MutationObserver(() => window.states.push(state.textContent)).observe(state, { childList: true, characterData: true, subtree: true });"""


def numbered(line):
    """The line with its checksum: the XOR of its bytes."""
    return f"{line}*{functools.reduce(lambda sum, byte: sum ^ byte, line.encode())}"


# Lines, and what the printer answers: the words of docs/reference/host-protocol/ and docs/reference/errors.md.
CONVERSATION = (
    ("M105", ("ok T:",)),
    ("M114", ("X:0.00 Y:0.00 Z:0.00",)),
    ("M119", ("x_min: open",)),
    ("M20", ("ok",)),
    ("M503", ("M92 X80", "M569", "ok")),
    ("hello", ('Unknown command: "hello"', "ok")),
    ("G1 XS", ("X needs a number", "ok")),
    ("M110 N0", ("ok",)),
    (numbered("N1 M114"), ("X:0.00", "ok")),
    ("N2 M114*1", ("checksum mismatch, Last Line: 1", "Resend: 2")),
    (numbered("N4 M114"), ("Last Line: 1", "Resend: 2")),
    (numbered("N2 M105"), ("ok T:",)),
)


def check_conversation(browser):
    """Each line gets its own answer: reports, wrong words, line numbers that are asked for again."""
    command = browser.find("#command")
    for line, answers in CONVERSATION:
        begin = len(text(browser, "#log")) + len(line)
        command.send_keys(line, Keys.ENTER)
        said = lambda: text(browser, "#log")[begin:]
        browser.wait(f"answer to {line}: {said()}", lambda: all(answer in said() for answer in answers) and said().endswith("\n"))


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
    check_conversation(browser)
    before = browser.wait("picture", lambda: browser.run(MOVED))
    browser.run(NOTE_STATES)
    command.send_keys("G28", Keys.ENTER)
    # Belt, bar, head and at least one motor. All four turn, once the tool goes along X and then along Y.
    still = lambda: [part for part, now in browser.run(MOVED).items() if now == before[part]]
    browser.wait("motion of the picture", lambda: not still())
    browser.wait("motion", lambda: "moving" in browser.run("return window.states"))
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
    command.send_keys("M105", Keys.ENTER)
    browser.wait("word of a printer that is off", lambda: "the printer is off" in said())
    browser.find("#power").click()
    browser.wait("printer with power", lambda: text(browser, "#state") == "ready" and "start" in said())
    # A machine that cannot be has no picture.
    browser.run("add('wrong.toml', '[axes.x]\\nlength = 0\\n')")
    browser.wait("printer that cannot be", lambda: text(browser, "#state") == "off" and "wrong.toml:2:" in said())
    check(browser.run("return ['picture', 'dials'].every(id => !document.getElementById(id).children.length)"), "it has a picture")
    command.send_keys("M105", Keys.ENTER)
    browser.wait("word of no printer", lambda: "no printer" in said())
    Select(browser.find("#machine-of-terminal")).select_by_value("prototype.toml")
    browser.wait("printer", lambda: text(browser, "#state") == "ready")


def check_tabs(browser):
    for tab in ("print", "machine", "terminal"):
        browser.find(f"#tab-{tab}").click()
        browser.drawn()
        browser.check_width()
        browser.check_labels()
    browser.find("#tab-terminal").send_keys(Keys.ARROW_RIGHT)
    check(browser.find("#tab-print").get_attribute("aria-selected") == "true", "arrow keys do not choose a tab")


def check_saved(browser, folder):
    """Report, summary and machine file are saved whole."""
    browser.driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)})
    check_print(browser)
    browser.find("#tab-print").click()
    # Another file is chosen meanwhile.
    Select(browser.find("#example")).select_by_value("tiny.gcode")
    hash = text(browser, "#sha256")
    for control in ("save-report", "save-summary"):
        browser.find(f"#{control}").click()
    browser.find("#tab-machine").click()
    browser.find("#save-machine").click()
    saved = lambda end: next((path.read_text() for path in folder.glob(f"*{end}")), "")
    browser.wait("saved report", lambda: hash in saved("circle.html") and saved("circle.html").rstrip().endswith("</html>"))
    browser.wait("saved summary", lambda: saved("circle.json").rstrip().endswith("}"))
    check(json.loads(saved(".json"))["trace_sha256"] == hash, "the saved summary is of another print")
    browser.wait("saved machine file", lambda: saved(".toml") == value_of(browser, "#text"))


def check_every_control(browser):
    """Nothing complains when every control is used in haste. Then a printer can be switched on, and the page prints."""
    used = 0
    # A word keeps the list of keys as it is when a key is written.
    browser.find("#tab-machine").click()
    type_in(browser, "#find-key", "speed")
    for tab, least in (("print", 40), ("machine", 40), ("terminal", 25)):
        browser.find(f"#tab-{tab}").click()
        used += use_all(browser, f"#{tab}", least)
    browser.find("#power").click()
    browser.wait("printer", lambda: text(browser, "#state") == "ready" and "start" in text(browser, "#log"))
    browser.find("#tab-print").click()
    Select(browser.find("#example")).select_by_value("tiny.gcode")
    browser.find("#start").click()
    check(printed(browser) == "printed", f"after all controls were used: {text(browser, '#failure')}")
    browser.check_quiet()
    return used


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def check_served(browser):
    """From a static server as from the file: the page asks for nothing but its own files, and all of them are there."""
    folder = pathlib.Path(os.environ["PAGE"]).parent
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        own = f"http://127.0.0.1:{server.server_port}/"
        browser.driver.get(own)
        browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
        Select(browser.find("#example")).select_by_value("tiny.gcode")
        browser.find("#start").click()
        check(printed(browser) == "printed", f"from a server: {text(browser, '#failure')}")
        browser.check_quiet(own)
        server.shutdown()


def run(_corehbot, folder):
    with Chromium() as browser:
        seconds = browser.open(os.environ["PAGE"])
        browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
        for part in (check_tabs, check_print, check_drop, check_kinds, check_accident, check_parts, check_editor, check_terminal):
            part(browser)
            browser.check_quiet()
        browser.run("localStorage.clear()")
        for size, is_dark in ((PHONE, False), (DESK, True)):
            browser.resize(size, is_dark)
            browser.open(os.environ["PAGE"])
            browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
            check_scrolls(browser)
            check_tabs(browser)
            check_print(browser)
            browser.check_width()
            check_targets(browser)
            # The frame is as high as the report, which must not be as high as a share of its frame.
            browser.wait("report", lambda: in_report(browser, TALL) > 0)
            check(in_report(browser, TALL) < size[1], f"the picture of the report is {in_report(browser, TALL)} px high")
            browser.check_quiet()
        check_saved(browser, folder)
        check_served(browser)
        used = check_every_control(browser)
    return f"loaded in {seconds:.2f} s; {used} controls were used; prints, is cancelled, prints again, explains keys, answers M-codes"


if __name__ == "__main__":
    main(run)
