"""The viewer's tools: lines by number and by words, objects and tools as colours and as a list, views that are saved, the
whole screen, and a finger that scrolls past the picture.

Arguments: corehbot.
"""

import re

from chromium import PHONE, Chromium, check
from PIL import Image
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from trial import main, print_report

# Names of objects, two of them with letters that markup, files and patterns have.
NAMES = ("cube_id_0", "Shape-Box <b>&", "plate (2)*.stl")

# Each way to say which object comes: before it, and behind it.
WAYS = {
    "m486": (lambda k: ("M486 T3",) * (k == 0) + (f"M486 S{k}", f"M486 A{NAMES[k]}"), lambda k: ("M486 S-1",)),
    "m486-quoted": (lambda k: (f'M486 S{k} A"{NAMES[k]}"',), lambda k: ("M486 S-1 ; none",)),
    "exclude": (
        lambda k: (f"EXCLUDE_OBJECT_START NAME='{NAMES[k]}'",),
        lambda k: (f"EXCLUDE_OBJECT_END NAME='{NAMES[k]}'",),
    ),
}

# What each move is of: its line, its object's name and its tool's, if any; of printed moves.
SORTED = """const { record } = document.querySelector('.viewer').corehbotView, { moves, sorted: { objects, tools } } = record, rows = [];
    for (let i = 0; i < moves.n; i++) if (moves.isPrinted(i)) rows.push([moves.line[i], objects?.names[objects.of[i]] ?? null, tools?.names[tools.of[i]] ?? null]);
    return rows;"""

STATE = """const { player, stage } = document.querySelector('.viewer').corehbotView, { camera } = stage;
    return { done: player.done, low: player.low, high: player.high, hidden: player.hidden, view: [...camera.centre, camera.scale,
        camera.azimuth, camera.elevation].map(v => +v.toPrecision(5)), colour: document.querySelector('label select').value };"""

CHOSEN = "return +(document.querySelector('.rows .chosen')?.dataset.line ?? 0)"


def squares(way):
    """Squares of two layers, one an object; the second layer is of another tool."""
    begin, end = WAYS[way]
    lines = ["G28", "M83", "G1 F3000"]
    for layer in range(2):
        lines += [f"T{layer}", f"G1 Z{0.2 * (layer + 1):.1f}", ";TYPE:External perimeter"]
        for k in range(3):
            x = 40 + 30 * k
            lines += [*begin(k), f"G1 X{x} Y40"]
            lines += [f"G1 X{x + dx} Y{40 + dy} E0.4" for dx, dy in ((10, 0), (10, 10), (0, 10), (0, 0))]
            lines += end(k)
    return lines


def expected(lines):
    """Line, object and tool of each line that prints."""
    rows, tool, k = [], "T0", None
    for number, line in enumerate(lines, 1):
        if re.fullmatch(r"T\d", line):
            tool = line
        elif line.startswith(("M486 S", "EXCLUDE_OBJECT_START")):
            digit = re.match(r"M486 S(-?\d)", line)
            k = int(digit[1]) if digit else next(i for i, name in enumerate(NAMES) if name in line)
        elif line.startswith("EXCLUDE_OBJECT_END"):
            k = -1
        elif " E" in line:
            rows.append([number, NAMES[k], tool])
    return rows


def ready(browser):
    """Everything of a report is there, and drawn."""
    browser.wait("whole report", lambda: browser.run("return document.querySelector('.viewer')?.dataset.sorted === 'true'"))
    whole(browser)


def whole(browser):
    browser.driver.execute_async_script("const done = arguments[0]; document.querySelector('.viewer').corehbotView.stage.whole().then(() => done());")


def button(browser, words):
    return next(one for one in browser.find_all("button") if one.text.strip() == words)


def sorts(browser, corehbot, folder):
    for way in WAYS:
        lines = squares(way)
        file = folder / f"{way}.gcode"
        file.write_text("\n".join(lines) + "\n")
        report = print_report(corehbot, file, folder).rename(folder / f"{way}.html")
        browser.open(report)
        ready(browser)
        rows, wanted = browser.run(SORTED), expected(lines)
        check(sorted({tuple(row) for row in rows}) == sorted(map(tuple, wanted)), f"{way}: {rows} instead of {wanted}")
        check([cell.text for cell in browser.find_all(".objects tbody td:first-child")] == list(NAMES), f"{way}: the list of objects")
        browser.check_quiet()
    return report


def colours(browser):
    """Objects and tools are colours with a legend; the list shows an object alone in its colour, in the middle."""
    box = Select(browser.find("label select"))
    for value, names in (("tool", ("T0", "T1")), ("object", NAMES)):
        box.select_by_value(value)
        whole(browser)
        check(all(name in browser.find(".kinds").text for name in names), f"{value}: {browser.find('.kinds').text}")
    begin = browser.run(STATE)
    for k in (1, 2):
        show = browser.find_all(".objects tbody button")[k]
        show.click()
        whole(browser)
        x, y, _ = browser.run(STATE)["view"][:3]
        check(abs(x - (45 + 30 * k)) < 0.5 and abs(y - 45) < 0.5, f"object {k} is shown at {x}, {y}")
        check(show.get_attribute("aria-pressed") == "true", "the button is not pressed")
    show.click()
    whole(browser)
    check(browser.run(STATE)["view"] == begin["view"], "the whole print is not back")


def lines(browser, file):
    """A line by its number, and lines by words, letter by letter and by keys; what cannot be is told, and stays as typed."""
    text = file.read_text().splitlines()
    line, word, out = (browser.find(f".find {selector}") for selector in ("[inputmode=numeric]", "[type=search]", "output"))

    def typed(field, words):
        field.send_keys(Keys.CONTROL, "a")
        field.send_keys(Keys.BACKSPACE)
        for i, letter in enumerate(words, 1):
            field.send_keys(letter)
            check(field.get_attribute("value") == words[:i], f"{words[:i]} became {field.get_attribute('value')}")

    for number in (17, 3, len(text)):
        typed(line, str(number))
        line.send_keys(Keys.ENTER)
        browser.wait(f"line {number}", lambda: browser.run(CHOSEN) == number)
        check(line.get_attribute("value") == str(number), "a choice changes the field")
    for wrong in ("0", str(len(text) + 1), "x", "1.5"):
        typed(line, wrong)
        line.send_keys(Keys.ENTER)
        check(f"lines 1 to {len(text)}" in out.text and line.get_attribute("aria-invalid") == "true", f"{wrong}: {out.text}")
        check(browser.run(CHOSEN) == len(text), "a wrong number chooses a line")
    typed(line, "1")
    line.send_keys(Keys.ENTER)
    for sought in ("exclude_object_start", "Box <b>&", "G1 X"):
        found = [number for number, own in enumerate(text, 1) if sought.lower() in own.lower()]
        typed(line, "1")
        line.send_keys(Keys.ENTER)
        typed(word, sought)
        browser.wait(f"{len(found)} lines", lambda: out.text.startswith(f"{len(found)} lines"))
        for k in (0, 1, 0, -1):
            word.send_keys((Keys.SHIFT, Keys.ENTER) if k in (0, -1) and browser.run(CHOSEN) != 1 else Keys.ENTER)
            browser.wait(f"line {found[k]}", lambda: browser.run(CHOSEN) == found[k])
            check(f"{k % len(found) + 1} of {len(found)}" in out.text, out.text)
        check(word.get_attribute("value") == sought, "a search changes the field")
    typed(word, "no such word")
    browser.wait("no line", lambda: out.text == "not found")
    browser.check_quiet()


def views(browser, report, folder):
    """A link opens the view that it was made of; what a link cannot mean changes nothing. A picture is what is seen."""
    Select(browser.find("label select")).select_by_value("object")
    button(browser, "3D").click()
    browser.run("""const { player, stage } = document.querySelector('.viewer').corehbotView;
        player.setLayers(1, 1); player.setMove(player.done - 3); stage.camera.orbit(33, -7); stage.camera.zoom(1.7, 100, 80); stage.redraw();""")
    whole(browser)
    begin = browser.run(STATE)
    button(browser, "Link").click()
    link = browser.run("return location.href")
    check("#view:" in link, f"the link is {link}")
    for address in (link, report.resolve().as_uri() + "#view:camera=1_2&layers=9-1&move=-4&colour=none&hidden=x&&=", report.resolve().as_uri() + "#%E0%A4%A"):
        browser.driver.get("about:blank")
        browser.driver.get(address)
        ready(browser)
        state = browser.run(STATE)
        check((state == begin) == (address == link), f"{address} shows {state}, not {begin}")
    # The same page follows a link, too.
    browser.run("location.hash = arguments[0]", link.split("#")[1])
    browser.wait("view of the link", lambda: browser.run(STATE) == begin)
    browser.driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)})
    button(browser, "Picture").click()
    saved = browser.wait("picture", lambda: next(folder.glob("*.png"), None))
    width, height = browser.run("const { over } = document.querySelector('.viewer').corehbotView.stage; return [over.width, over.height]")
    with Image.open(saved) as picture:
        check(picture.width == width and picture.height > height, f"the picture has {picture.size} pixels, the stage {width}, {height}")
        check(len(picture.convert("RGB").getcolors(1 << 20)) > 30, "the picture is blank")
    browser.check_quiet()


def screen(browser):
    """The picture takes the whole screen, and gives it back."""
    tall = "return document.querySelector('.stage').clientHeight / innerHeight"
    for is_on in (True, False):
        button(browser, "Full screen").click()
        browser.wait("full screen" if is_on else "end of it", lambda: browser.run("return document.fullscreenElement !== null") == is_on)
        whole(browser)
        check(browser.run("return getComputedStyle(document.querySelector('.stage')).touchAction") == ("none" if is_on else "pan-y"), "a finger does not drag any way")
        if is_on:
            check(browser.run(tall) > 0.5, f"the picture has {browser.run(tall):.0%} of the screen")
    browser.check_quiet()


# Whether the page scrolls no more: a finger that is lifted leaves it in motion.
AT_REST = """const done = arguments[0], from = scrollY, frames = n => n ? requestAnimationFrame(() => frames(n - 1)) : done(scrollY === from);
    frames(10);"""


def swipe(browser):
    """A finger that goes up on the picture scrolls the page; sideways it moves the picture."""
    view = "return document.querySelector('.viewer').corehbotView.stage.camera.view"
    at_rest = lambda: browser.wait("page at rest", lambda: browser.driver.execute_async_script(AT_REST))
    for dx, dy in ((0, -250), (-150, 0)):
        at_rest()
        x, y, scrolled = browser.run("""const stage = document.querySelector('.stage'); stage.scrollIntoView({ block: 'center' });
            const { x, y, width, height } = stage.getBoundingClientRect(); return [x + width / 2, y + height / 2, scrollY];""")
        at_rest()
        whole(browser)
        before = browser.run(view)
        for i in range(12):
            point = {"x": x + dx * i / 11, "y": y + dy * i / 11}
            browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchMove" if i else "touchStart", "touchPoints": [point]})
        browser.driver.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        if dy:
            browser.wait("scroll", lambda: browser.run("return scrollY") > scrolled + 100)
            check(browser.run(view) == before, "the picture moves while the page scrolls")
        else:
            browser.wait("motion of the picture", lambda: browser.run(view) != before)
            check(browser.run("return scrollY") == scrolled, "the page scrolls while the picture moves")
    browser.check_quiet()


def run(corehbot, folder):
    with Chromium() as browser:
        report = sorts(browser, corehbot, folder)
        colours(browser)
        lines(browser, report.with_suffix(".gcode"))
        screen(browser)
        views(browser, report, folder)
        browser.resize(PHONE, False)
        browser.open(report)
        ready(browser)
        browser.check_width()
        swipe(browser)
    return f"{len(WAYS)} ways to name objects, lines, words, links, pictures, the whole screen and fingers"


main(run)
