"""No page keeps people from using it: axe-core finds nothing in reports, in pages without a print and in the page with the
firmware, light and dark, on a desk and on a phone.

Arguments: corehbot. `PAGE` is the page's first file, `AXE` the folder of axe-core's package.
"""

import os
import pathlib

from chromium import DESK, PHONE, Chromium, check
from selenium.webdriver.support.ui import Select
from trial import ROOT, main, print_report
from twin_pages import pages

# Rules that axe-core leaves out by itself: the size of targets (WCAG 2.2, 2.5.8), and names that do not begin with the word on a
# control (2.5.3).
MORE = ("target-size", "label-content-name-mismatch")

# Styles are not fetched, as the page forbids it; no rule needs them but the one about turning a phone.
RUN = """const [more, done] = arguments;
    axe.run(document, { preload: false, rules: Object.fromEntries(more.map(rule => [rule, { enabled: true }])) }).then(({ violations, passes }) => done({
        passed: passes.map(({ id }) => id),
        found: violations.flatMap(({ id, nodes }) => nodes.map(({ target, any, all, none }) => `${id}: ${target.join(' ')}: ${[...any, ...all, ...none][0]?.message}`)),
    }), error => done({ passed: [], found: [String(error)] }));"""

# Rules that a look at a page uses, or it has looked at nothing.
USED = {"color-contrast", "document-title"}

SCREENS = ((DESK, False), (DESK, True), (PHONE, False), (PHONE, True))


def script():
    return next(pathlib.Path(os.environ["AXE"]).glob("lib/python*/site-packages/axe_playwright_python/axe.min.js")).read_text()


def look(browser, axe, name):
    browser.drawn()
    # A frame has no axe-core yet.
    if not browser.run("return 'axe' in window"):
        browser.run(axe)
    result = browser.driver.execute_async_script(RUN, MORE)
    check(USED <= set(result["passed"]), f"{name}: axe-core has looked at {result['passed']} alone")
    return [f"{name}: {finding}" for finding in result["found"]]


def reports(corehbot, folder):
    """Reports of a print that is well, of one that failed, and of one with belts; and the pages without a print."""
    heat = ROOT / "xtask/clients"
    made = {
        "lines": (ROOT / "examples/first-print.gcode",),
        "fault": (heat / "heat.gcode", "--settings", heat / "heat.toml", "--break", "open:hotend@60s"),
        "belt": (ROOT / "examples/shaping.gcode", "--plant", "belt"),
    }
    files = {}
    for name, (file, *options) in made.items():
        files[name] = print_report(corehbot, file, folder, *options, ends_well=name != "fault").rename(folder / f"report-{name}.html")
    return files | pages(corehbot, folder)


def looks(browser, axe, files, size, is_dark):
    found, count = [], 0
    where = f"{size[0]} px{', dark' if is_dark else ''}"
    for name, file in files.items():
        browser.open(file)
        if name in ("lines", "fault", "belt"):
            browser.wait("whole report", lambda: browser.run("return document.querySelector('.viewer')?.dataset.sorted === 'true'"))
        found += look(browser, axe, f"{name}, {where}")
        browser.check_quiet()
        count += 1
    browser.open(os.environ["PAGE"])
    ready = lambda: "ready" in browser.run("return document.querySelector('#status').textContent")
    browser.wait("firmware", ready)
    browser.run("take('circle.gcode', EXAMPLES.gcode['circle.gcode']); start()")
    browser.wait("print", lambda: browser.find("#result").is_displayed())
    browser.run("document.querySelector('#presets button').click(); document.querySelector('#seed').value = 'many'; checkOptions(); edit('[axes.x]\\nmax_sped = 1\\nlength = 300\\n')")
    for tab in ("print", "machine", "terminal"):
        browser.run("document.querySelector(arguments[0]).click()", f"#tab-{tab}")
        if tab == "machine":
            browser.wait("error", lambda: browser.find_all("#problems .bad"))
        if tab == "terminal":
            Select(browser.find("#machine-of-terminal")).select_by_value("prototype.toml")
            browser.wait("printer", lambda: "start" in browser.find("#log").text)
        found += look(browser, axe, f"the page's {tab}, {where}")
        count += 1
    browser.run("localStorage.clear()")
    browser.check_quiet()
    return found, count


def run(corehbot, folder):
    axe, found, count = script(), [], 0
    files = reports(corehbot, folder)
    with Chromium() as browser:
        for size, is_dark in SCREENS:
            browser.resize(size, is_dark)
            more, looked = looks(browser, axe, files, size, is_dark)
            found, count = found + more, count + looked
    check(not found, f"{len(found)} findings: " + "\n".join(found[:20]))
    return f"axe-core has found nothing in {count} looks"


if __name__ == "__main__":
    main(run)
