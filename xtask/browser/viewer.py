"""The viewer of a print: layers, moves, text and charts follow each other, every control has a name, two runs compare.

Arguments: corehbot.
"""

import re

from chromium import DESK, PHONE, Chromium, check
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from trial import ROOT, main, print_report

FILE = "examples/first-print.gcode"

HEAT = ROOT / "xtask/clients"

# The number of pixels in `data` that have the colour of what went wrong.
RED = """const [r, g, b] = document.querySelector('.fault h2').computedStyleMap().get('color').toString().match(/\\d+/g).map(Number);
    let red = 0;
    for (let i = 0; i < data.length; i += 4) red += Math.hypot(data[i] - r, data[i + 1] - g, data[i + 2] - b) < 24 && data[i + 3] > 200;
    return red;"""

# What is shown; the page keeps its parts where a trial finds them.
STATE = """const { player, stage } = document.querySelector('.viewer').corehbotView;
    return { done: player.done, low: player.low, high: player.high, layers: player.layers, moves: player.moves.n,
        line: +(document.querySelector('.rows .chosen')?.dataset.line ?? 0), isAbove: stage.camera.isAbove,
        hover: stage.hover, playing: player.playing };"""

# The share of the picture that lines cover.
COVERED = """const { stage } = document.querySelector('.viewer').corehbotView, gl = stage.lines.gl;
    const { width, height } = gl.canvas, pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let lines = 0;
    for (let i = 3; i < pixels.length; i += 4) lines += pixels[i] > 0;
    return lines / (width * height);"""

# A sum of the picture's colours, in which places count.
PIXELS = """const { stage } = document.querySelector('.viewer').corehbotView, gl = stage.lines.gl;
    const { width, height } = gl.canvas, pixels = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels.reduce((sum, value, i) => (sum * 31 + value + i) % 1000003, 0);"""

# How fast real time is played, after two pauses within one frame.
PLAYED = """const done = arguments[0], { player } = document.querySelector('.viewer').corehbotView, { speed } = player;
    player.setMove(100); player.speed = 1;
    for (let i = 0; i < 5; i++) player.play();
    const begin = performance.now(), from = player.now;
    setTimeout(() => {
        const times = (player.now - from) / (performance.now() - begin) * 1000;
        player.stop(); player.speed = speed; done(times);
    }, 1000);"""

# Whether all is drawn, exactly.
WHOLE = """const view = document.querySelector('.viewer')?.corehbotView;
    return view && !view.stage.dirty && !view.stage.lines.queue.length && view.stage.drawn === view.player.done;"""


def run(corehbot, folder):
    report = print_report(corehbot, ROOT / FILE, folder).rename(folder / "first.html")
    with Chromium() as browser:
        seconds = browser.open(report)
        whole(browser)
        desk(browser, report)
        frames = browser.frames_per_second()
        told_marks(browser, corehbot, folder)
        other_file(browser, report)
        other_settings(browser, corehbot, folder)
        fault(browser, corehbot, folder)
        browser.resize(PHONE, True)
        browser.open(report)
        whole(browser)
        phone(browser)
    return f"opened in {seconds:.2f} s, {frames:.0f} frames/s"


def marks(file):
    """Retractions, primes and closed outer walls of the example, which primes before each of them."""
    found, kind = {"retractions": 0, "primes": 0, "seams": 0}, ""
    for line in file.read_text().splitlines():
        if line.startswith(";TYPE:"):
            kind = line
        elif line.startswith("G1 E"):
            found["retractions" if line[4] == "-" else "primes"] += 1
            found["seams"] += line[4] != "-" and kind == ";TYPE:External perimeter"
    return found


# Lines after which the file has comments of slicers and commands; a comment and its command are one mark. The file has
# no line that moves between a pause and its comment.
TOLD = {
    60: (";COLOR_CHANGE,T0,#ff0000", "M600"),
    80: ("; PAUSE_PRINTING", "M601"),
    100: ("; WIPE_START", ";WIPE_END", "T1", "T1", "T0"),
    120: ("M0 S1", ";WIPE_START", "; CUSTOM_GCODE", "M117 M600 ; no pause: M0"),
}
MARKS = {"wipes": 2, "pauses": 2, "colour changes": 1, "tool changes": 1, "custom G-code": 1}


def told_marks(browser, corehbot, folder):
    """What the file's own text says of wipes, pauses and changes is marked, by keys, and gone again."""
    file = folder / "told.gcode"
    lines = (ROOT / FILE).read_text().splitlines()
    file.write_text("\n".join(line for i, own in enumerate(lines) for line in (own, *TOLD.get(i, ()))))
    browser.open(print_report(corehbot, file, folder))
    whole(browser)
    begin = browser.run(PIXELS)
    for name, number in MARKS.items():
        box = next(box for box in browser.find_all("[aria-label=Marks] label") if name in box.text)
        control = box.find_element("css selector", "input")
        control.send_keys(" ")
        browser.wait(f"{number} {name}, not {box.text}", lambda: box.text.strip() == f"{name}: {number}")
        whole(browser)
        check(box.get_attribute("title") and browser.run(PIXELS) != begin, f"{name} are not in the picture")
        control.send_keys(" ")
        whole(browser)
        browser.wait(f"picture without {name}", lambda: browser.run(PIXELS) == begin)
    browser.check_quiet()


def other_file(browser, report):
    """A report of another file is compared, with a warning that says where the files differ first."""
    browser.find("input[type=file]").send_keys(str(report))
    told = lambda: browser.find("section[aria-label^=Compare]").text
    browser.wait("comparison", lambda: "Both take the same time" in told() or "The second run takes" in told())
    first = min(TOLD) + 2
    expected = ("told.gcode", "first-print.gcode", f"They differ from line {first} on")
    check(all(word in told() for word in expected), f"no warning of another file: {told()[:400]}")
    browser.check_quiet()


def other_settings(browser, corehbot, folder):
    """Another page is refused in words, and the keys of settings that differ are listed, each of them."""
    chosen, told = browser.find("input[type=file]"), lambda: browser.find("section[aria-label^=Compare]").text
    pages = {
        "other.html": ("<!doctype html><title>corehbot</title>\nconst D = {};\n", "another page of corehbot"),
        "web.html": ("<!doctype html><title>news</title>", "a page of something else"),
        "text.html": ("G28", "is no page"),
    }
    for name, (text, words) in pages.items():
        (folder / name).write_text(text)
        chosen.send_keys(str(folder / name))
        browser.wait(f"{name}: {words}", lambda: f"{name} is" in told() and words in told())
    machine = folder / "quick.toml"
    machine.write_text('name = "quick"\nz_jerk = 1\nprint_acceleration = 2000\n[corner]\nsquare_corner = 4\n[axes.x]\nmax_acceleration = 2500\n')
    second = print_report(corehbot, ROOT / "examples/tiny.gcode", folder, "--machine", machine)
    chosen.send_keys(str(second))
    keys = "name", "z_jerk", "print_acceleration", "corner.square_corner", "corner.junction_deviation", "axes.x.max_acceleration"
    browser.wait("keys that differ", lambda: all(f"\n{key} " in told() for key in keys))
    browser.check_quiet()


def fault(browser, corehbot, folder):
    """The card of a fault opens the part of the documents about it; its place is marked in the path and in the charts."""
    options = ("--machine", HEAT / "heat.toml", "--break", "open:hotend@60s")
    browser.open(print_report(corehbot, HEAT / "heat.gcode", folder, *options, ends_well=False))
    whole(browser)
    document = (ROOT / "docs/reference/errors.md").read_text()
    row = re.search(r"^\| E01 \| .* \|$", document, re.MULTILINE)[0]
    check("E01" in browser.find(".fault h2").text, browser.find(".fault").text)
    check(not browser.find(".document").is_displayed(), "the document is open before it is asked for")
    browser.find(".fault summary").send_keys(Keys.ENTER)
    cells = [cell.text for cell in browser.find_all(".document .taken td")]
    check(cells == row.replace("`", "").strip("| ").split(" | "), f"the row of the document is {row}, not {cells}")
    section = document.split("\n## Faults\n")[1].split("\n## ")[0]
    rows = browser.find_all(".document tbody tr")
    check(len(rows) == section.count("\n| E"), f"{len(rows)} rows of {section.count('| E')}")
    check("llvm-addr2line" in browser.find(".document").text, "the rest of the part is not there")

    # The cross at the place of the fault, and the line in a chart of each clock.
    cross = """const { stage, record } = document.querySelector('.viewer').corehbotView, { moves, marks: [mark] } = record;
        const i = moves.indexAt(mark.time_s), [x, y] = stage.camera.toScreen(moves.place(i, moves.share(i, mark.time_s)));
        const { data } = stage.over.getContext('2d').getImageData(x - 12, y - 12, 24, 24);"""
    check(browser.run(cross + RED) > 20, "no cross in the picture")
    for name in ("Motion", "Heat"):
        place = f"section[aria-label={name}] .chart"
        browser.run("document.querySelector(arguments[0]).scrollIntoView()", place)
        chart = """const canvas = document.querySelector(arguments[0] + ' canvas'); if (!canvas) return 0;
            const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);"""
        browser.wait(f"a red line in the chart of {name}", lambda: browser.run(chart + RED, place) > 60)
    browser.check_quiet()


def whole(browser):
    browser.wait("whole picture", lambda: browser.run(WHOLE))


def state(browser):
    whole(browser)
    return browser.run(STATE)


def desk(browser, report):
    browser.check_labels()
    stage = browser.find(".stage")
    begin = state(browser)
    check(begin["done"] == begin["moves"] and begin["high"] == begin["layers"] - 1, f"it does not begin whole: {begin}")
    check(browser.run(COVERED) > 0.1, "the print is not in the middle of the picture")

    # An arrow is one move, another one a layer; a layer alone is never blank, whatever the time was.
    stage.send_keys(Keys.ARROW_LEFT)
    check(state(browser)["done"] == begin["moves"] - 1, "an arrow is not one move")
    browser.run("document.querySelector('.viewer').corehbotView.player.setMove(5)")
    next(box for box in browser.find_all(".line label") if "only" in box.text).click()
    single = state(browser)
    check(single["low"] == single["high"] and browser.run(COVERED) > 0.02, f"a layer alone is blank: {single}")
    stage.send_keys(Keys.ARROW_DOWN)
    lower = state(browser)
    check(lower["high"] == single["high"] - 1 and browser.run(COVERED) > 0.02, f"the layer below is blank: {lower}")
    next(box for box in browser.find_all(".line label") if "only" in box.text).click()

    # A line of the text shows its move; a move chooses its line.
    browser.run("document.querySelector('.viewer').corehbotView.player.setMove(1e9)")
    row = browser.find('.rows [data-line]:nth-child(3)')
    line = int(row.get_attribute("data-line"))
    row.click()
    chosen = state(browser)
    check(chosen["line"] == line and chosen["done"] < begin["moves"], f"line {line} chose {chosen}")
    check(row.get_attribute("data-line") == str(line), "the row that was clicked is no longer the row of its line")
    ActionChains(browser.driver).send_keys(Keys.ARROW_DOWN).perform()
    check(state(browser)["line"] == line + 1, "the text has lost the keyboard's focus to a click")

    # After a move that one is the last, not the one that begins then: a click on a move chooses its line.
    others = browser.run(
        """const { player } = document.querySelector('.viewer').corehbotView, { moves, done, now } = player, others = [];
        for (let i = 0; i < moves.n; i++) {
            Object.assign(player, { done: i + 1, now: moves.end(i) });
            if (player.current !== i) others.push(i);
        }
        Object.assign(player, { done, now });
        return others;"""
    )
    check(not others, f"{len(others)} moves are not the current ones at their end, such as {others[:5]}")

    # Every colour has a legend.
    for value in browser.run("return [...document.querySelector('label select').options].map(option => option.value)"):
        script = "const list = document.querySelector('label select'); list.value = arguments[0]; list.onchange();"
        browser.run(script, value)
        check(browser.find(".kinds").text.strip(), f"{value} has no legend")
    whole(browser)

    # What is shown has an entry in the legend, travel too.
    legend = lambda: browser.find(".kinds").text
    browser.run("const list = document.querySelector('label select'); list.value = 'speed'; list.onchange();")
    travel = next(box for box in browser.find_all(".view label") if box.text.strip() == "travel")
    check("travel" not in legend(), "travel is hidden, and the legend has it")
    travel.click()
    check("travel" in legend(), "travel is shown, and the legend does not have it")
    browser.run("const list = document.querySelector('label select'); list.value = 'limit'; list.onchange();")
    check("firmware" in legend(), f"homing is limited by {legend()}")
    travel.click()
    check("firmware" not in legend(), f"what is hidden is in the legend: {legend()}")

    # The file's own lines say how many marks there are.
    for name, number in marks(ROOT / FILE).items():
        box = next(box for box in browser.find_all("[aria-label=Marks] label") if name in box.text)
        box.click()
        said = lambda: box.text.strip() == f"{name}: {number}"
        check(box.get_attribute("title"), f"{name} has no words")
        browser.wait(f"{number} {name} as in the file, not {box.text}", said)
        whole(browser)
        box.click()
    browser.run("const list = document.querySelector('label select'); list.value = 'type'; list.onchange();")

    used(browser)
    log_scale(browser, stage)
    only(browser)

    # The upright slider: a key moves its thumb by one layer.
    high = browser.find(".layers input:nth-of-type(2)")
    wide, high_px = browser.run("const { width, height } = arguments[0].getBoundingClientRect(); return [width, height]", high)
    check(high_px > 4 * wide, f"the slider of layers is not upright: {wide} by {high_px} px")
    high.send_keys(Keys.ARROW_LEFT)
    check(state(browser)["high"] == begin["layers"] - 2, "the slider of layers does not choose one")
    high.send_keys(Keys.ARROW_RIGHT)
    check(state(browser)["high"] == begin["layers"] - 1, "the slider of layers does not go back")

    # Hover in the middle of the outer wall of the last layer.
    place = browser.run(
        """const { stage, record } = document.querySelector('.viewer').corehbotView, { moves } = record;
        let i = moves.n - 1;
        while (record.data.types[moves.type[i]].role !== 'outer wall') i--;
        const box = stage.element.getBoundingClientRect(), [x, y] = stage.camera.toScreen(moves.place(i, 0.5));
        stage.player.setMove(moves.n); stage.look(x, y);
        return i"""
    )
    browser.wait("words under the pointer", lambda: "Commanded" in browser.find(".tip").text)
    check(state(browser)["hover"] == place, f"the pointer is at move {place}: {state(browser)}")

    stage.send_keys("3")
    check(not state(browser)["isAbove"] and browser.run(COVERED) > 0.02, "nothing in three dimensions")
    stage.send_keys(" ")
    browser.wait("motion", lambda: browser.run(STATE)["playing"])
    stage.send_keys(" ")
    check(not state(browser)["playing"], "play does not pause")
    speed = browser.driver.execute_async_script(PLAYED)
    check(speed < 1.5, f"paused and played again at once, real time is {speed:.2f} times as fast")

    # The same report once more: nothing differs.
    browser.find("input[type=file]").send_keys(str(report))
    browser.wait("comparison", lambda: "same time" in browser.find("section[aria-label^=Compare]").text)
    told = browser.find("section[aria-label^=Compare]").text
    check("path: none" in told and "speeds: none" in told, f"a report differs from itself: {told[:300]}")
    browser.check_quiet()


def used(browser):
    """Time left and filament up to a place are those of the file's own lines; the example has relative E words."""
    lines = (ROOT / FILE).read_text().splitlines()
    words = [re.match(r"G[1-3] .*?E(-?[\d.]+)", line) for line in lines]
    whole_mm = sum(float(word[1]) for word in words if word)
    script = """const { player, record } = document.querySelector('.viewer').corehbotView, { moves } = record;
        player.setMove(Math.round(moves.n * arguments[0]));
        let i = player.done - 1;
        while (!moves.line[i]) i--;
        return [moves.line[i], moves.whole, player.now, document.querySelector('.now').textContent];"""
    for share in (0.3, 0.7, 1):
        line, whole_s, now_s, told = browser.run(script, share)
        metres, grams = map(float, re.search(r"(-?[\d.]+) m, (-?[\d.]+) g", told).groups())
        mm = sum(float(word[1]) for word in words[:line] if word)
        # Arcs and lines may be several moves; the text has three digits of m.
        check(abs(1000 * metres - mm) < 1, f"line {line}: {mm} mm in the file, {told}")
        check(abs(grams * whole_mm - mm * browser.run("return D.filament.g")) < 0.02 * whole_mm, f"line {line}: {told}")
        left = round(whole_s - now_s)
        check(left < 60 or f"{left // 60}:{left % 60:02} left" in told, f"{left} s left: {told}")


def log_scale(browser, stage):
    """The middle of the scale of layer times is the mean of its ends; on the scale of factors, their geometric mean."""
    choose = "const list = document.querySelector('label select'); list.value = arguments[0]; list.onchange();"
    box = next(box for box in browser.find_all(".view label") if "log scale" in box.get_attribute("textContent"))
    check(not box.is_displayed(), "line types have a log scale")
    browser.run(choose, "layer")
    check(box.is_displayed() and box.get_attribute("title"), "layer times have no log scale, or it has no words")
    texts = "return [...document.querySelectorAll('.ramped div span')].map(span => parseFloat(span.textContent.replace(/[^\\d.]/g, '')))"
    low, _, middle, _, high = browser.run(texts)
    check(abs(middle - (low + high) / 2) < 0.02 * high, f"linear: {low}, {middle}, {high}")
    box.find_element("css selector", "input").send_keys(" ")
    whole(browser)
    low, _, middle, _, high = browser.run(texts)
    check(abs(middle - (low * high) ** 0.5) < 0.02 * high, f"log: {low}, {middle}, {high}")
    stage.send_keys(Keys.ARROW_LEFT)
    box.find_element("css selector", "input").send_keys(" ")
    check(abs(browser.run(texts)[2] - (low + high) / 2) < 0.02 * high, "it does not get linear again")
    browser.run(choose, "type")
    whole(browser)


def only(browser):
    """One type alone, another one alone, and back to what was shown at first: by keys, and by a double click."""
    kinds = browser.find_all(".kinds .kind")
    boxes = lambda: [kind.find_element("css selector", "input").is_selected() for kind in kinds]
    begin, covered = boxes(), browser.run(COVERED)
    check(sum(begin) > 2, f"few types are shown: {begin}")
    for chosen in (0, 1):
        button = kinds[chosen].find_element("css selector", "button")
        check("only" in button.get_attribute("title"), "the button has no words")
        button.send_keys(Keys.ENTER)
        whole(browser)
        check(boxes() == [k == chosen for k in range(len(kinds))], f"type {chosen} is not alone: {boxes()}")
        check(0 < browser.run(COVERED) < covered, f"type {chosen} alone covers {browser.run(COVERED)} of {covered}")
        check(button.get_attribute("aria-pressed") == "true", "the button is not pressed")
    button.send_keys(" ")
    whole(browser)
    check(boxes() == begin and abs(browser.run(COVERED) - covered) < 1e-3, f"what was shown is not back: {boxes()}")
    for expected in ([True] + [False] * (len(kinds) - 1), begin):
        ActionChains(browser.driver).double_click(kinds[0].find_element("css selector", "label")).perform()
        whole(browser)
        check(boxes() == expected, f"a double click shows {boxes()}")


def tap(browser):
    """A tap on a wall says what is known of it, until the next tap beside the print."""
    at = """const { stage, record } = document.querySelector('.viewer').corehbotView, { moves } = record;
        stage.element.scrollIntoView({ block: 'center' });
        let i = moves.n - 1;
        while (record.data.types[moves.type[i]].role !== 'outer wall') i--;
        const box = stage.element.getBoundingClientRect(), [x, y] = stage.camera.toScreen(moves.place(i, 0.5));
        return [[box.x + x, box.y + y], [box.x + 3, box.y + 3]];"""
    for (x, y), is_told in zip(browser.run(at), (True, False)):
        for kind, points in (("touchStart", [{"x": x, "y": y}]), ("touchEnd", [])):
            browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        browser.drawn()
        told = lambda: browser.find(".tip").is_displayed() and "Commanded" in browser.find(".tip").text
        browser.wait(f"words at {x}, {y}: {is_told}", lambda: told() == is_told)


def phone(browser):
    browser.check_width()
    tap(browser)
    remarks(browser)
    charts(browser)
    browser.run("document.querySelector('.charts').scrollIntoView()")
    browser.wait("a chart", lambda: browser.find_all(".charts .u-over"))
    touch = browser.run("return getComputedStyle(document.querySelector('.charts .u-over')).touchAction")
    check(touch == "pan-y", f"a chart cannot be scrolled past: {touch}")
    browser.check_quiet()


# The heights of the charts; and whether all of them have values.
CHARTS = "return [...document.querySelectorAll('.charts .chart')].map(chart => chart.getBoundingClientRect().height)"
READ = "return [...document.querySelectorAll('.charts .plot:not([hidden])')].every(plot => plot.parentNode.querySelector('b').textContent)"

# Each value as long as it may be.
LONGEST = "for (const value of document.querySelectorAll('.legend.values b')) value.textContent = '-10.5k to -12.5k'"


def charts(browser):
    """Values come later than the page and change all the time; none of them moves what stands below."""
    browser.driver.refresh()
    whole(browser)
    heights = browser.run(CHARTS)
    browser.wait("values", lambda: browser.run(READ))
    check(browser.run(CHARTS) == heights, f"charts were {heights} px high, and with values {browser.run(CHARTS)}")
    browser.run(LONGEST)
    check(browser.run(CHARTS) == heights, f"charts were {heights} px high, and with long values {browser.run(CHARTS)}")
    browser.check_width()


def remarks(browser):
    """A print with thousands of remarks is no higher than one with twenty, and a key scrolls the list."""
    fill = """const { record } = document.querySelector('.viewer').corehbotView, count = arguments[0];
        const { summary } = record.data, texts = Array.from({ length: count }, (_, i) => `motor 1 slipped at ${i} s`);
        const { pauses, warnings, violations } = summary;
        Object.assign(summary, { pauses: texts, warnings: [], violations: [] });
        const root = document.querySelector('.viewer'), streams = corehbotViewer.streamsOfPage;
        window.corehbotFilled = false;
        corehbotViewer.openRecord(root, record.data, (window.corehbotStreams ??= streams()))
            .then(() => { Object.assign(summary, { pauses, warnings, violations }); window.corehbotFilled = true; });"""
    heights = []
    for number in (40, 3000):
        browser.run(fill, number)
        browser.wait("remarks", lambda: browser.run("return window.corehbotFilled"))
        check(len(browser.find_all("[aria-label^=Remarks] li")) == number, f"{number} remarks are not all there")
        heights.append(browser.run("return document.body.getBoundingClientRect().height"))
    check(abs(heights[1] - heights[0]) < 1, f"40 and 3000 remarks make the page {heights} px high")
    items = browser.find("[aria-label^=Remarks]")
    items.send_keys(Keys.END)
    browser.wait("end of the remarks", lambda: browser.run("return arguments[0].scrollTop > 1000", items))
    check("3,000" in items.get_attribute("aria-label"), f"the list is called {items.get_attribute('aria-label')}")
    answers = [answer.get_attribute("textContent") for answer in browser.find_all("[aria-label^=Answers] li")]
    check(len(answers) == 1 and ": M115\nFIRMWARE_NAME:" in answers[0], f"the file asks for M115 alone: {answers}")


main(run)
