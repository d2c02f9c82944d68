"""The page keeps what a person types and edits, and keeps out what files and printers say: fields stay as they are typed, edited
files outlive a reload, the report is in a sandbox, and names that would be scripts are text.

Arguments: corehbot. `PAGE` is the page's first file.
"""

import os

from chromium import Chromium, check
from page_use import DROP, check_print, in_report, press, printed, text, type_in, value_of
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select
from trial import main


def reload(browser):
    browser.driver.refresh()
    browser.wait("firmware", lambda: "ready" in text(browser, "#status"))


# Fields for words and numbers, each with its tab and what is typed there: two places of accidents, the first in no list.
TYPED = (
    ("print", "#seed", "1234"),
    ("print", "#assume-homed", "100,90,1.5"),
    ("print", "#bed", "tilt.x=0.0004,bowl=0.25"),
    ("print", "#accident-place", "m99"),
    ("print", "#accident-place", "m8"),
    ("print", "#accident-how", "0.5"),
    ("print", "#accident-time", "2.5s"),
    ("print", "#chosen input", "seized:7@1s"),
    ("machine", "#find-key", "Fan speed"),
    ("machine", "#text", "[axes.x]\nmax_speed = 20 # mm/s, as Mum's\n"),
    ("terminal", "#command", "m117 Hello, world"),
)

# Fields for words and numbers that are on the page.
FIELDS = """return [...document.querySelectorAll('input, textarea')]
    .filter(({ type }) => !['checkbox', 'radio', 'range', 'file'].includes(type))
    .map(field => field.id ? '#' + field.id : field.closest('#chosen') ? '#chosen input' : field.outerHTML);"""


def check_typing(browser):
    """No field changes what is typed there, by the page or by a phone's keyboard."""
    browser.find("#tab-print").click()
    browser.wait("kinds of accidents", lambda: browser.find_all("#accident option"))
    Select(browser.find("#accident")).select_by_value("Belts loose")
    browser.find("#presets button").click()
    fields = browser.run(FIELDS)
    check(set(fields) == {field for _, field, _ in TYPED}, f"fields of the page: {fields}")
    for tab, field, words in TYPED:
        browser.find(f"#tab-{tab}").click()
        type_in(browser, field, words)
        wrong = browser.run("const field = document.querySelector(arguments[0]); return ['autocapitalize', 'autocorrect', 'autocomplete'].filter(name => field.getAttribute(name) !== 'off')", field)
        check(not wrong, f"{field}: a keyboard may change words: {wrong}")
    # The begun line comes back when the arrows leave the history.
    command = browser.find("#command")
    command.send_keys(Keys.ENTER, "M105", Keys.ARROW_UP)
    check(value_of(browser, "#command") == TYPED[-1][2], "there is no history")
    command.send_keys(Keys.ARROW_DOWN)
    check(value_of(browser, "#command") == "M105", f"the begun line is {value_of(browser, '#command')!r}")
    # A place stays with another kind of its group, and gives way to one of another group.
    browser.find("#tab-print").click()
    for kind, place in (("Belts seized", "m8"), ("Heat open", "hotend"), ("Belts seized", "m1")):
        Select(browser.find("#accident")).select_by_value(kind)
        check(value_of(browser, "#accident-place") == place, f"the place of {kind} is {value_of(browser, '#accident-place')}")
    browser.run("localStorage.clear()")
    reload(browser)


# The texts of the files that the browser keeps.
KEPT = "return Object.keys(localStorage).filter(key => key.startsWith('corehbot machine ')).map(key => JSON.parse(localStorage[key]).text)"


def check_kept(browser):
    """Edited files outlive a reload, in this window and in another one; they go only when a person says so, and come back."""
    browser.run("localStorage.clear()")
    reload(browser)
    browser.find("#tab-machine").click()
    shown = lambda selector: browser.find(selector).is_displayed()
    check(not shown("#kept") and not shown("#forget-machine"), "the page speaks of files that are not there")
    type_in(browser, "#text", "[axes.x]\nmax_speed = 199\n")
    check("keeps your file" in text(browser, "#kept") and "Save file" in text(browser, "#kept"), f"the person is told {text(browser, '#kept')}")
    browser.run("add('mine.toml', '[axes.y]\\nmax_speed = 99\\n')")
    check("keeps your 2 files" in text(browser, "#kept"), f"the person is told {text(browser, '#kept')}")
    reload(browser)
    browser.find("#tab-machine").click()
    check(value_of(browser, "#text") == "[axes.y]\nmax_speed = 99\n", f"the chosen file is {value_of(browser, '#text')[:60]!r}")
    Select(browser.find("#machine-to-edit")).select_by_visible_text("prototype")
    check(value_of(browser, "#text") == "[axes.x]\nmax_speed = 199\n", f"the edited file is {value_of(browser, '#text')[:60]!r}")
    # Another window keeps its own file, and overwrites none.
    first = browser.driver.current_window_handle
    browser.driver.switch_to.new_window("window")
    browser.open(os.environ["PAGE"])
    browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
    browser.run("add('other.toml', '# other')")
    browser.driver.close()
    browser.driver.switch_to.window(first)
    type_in(browser, "#text", "# edited")
    check(sorted(browser.run(KEPT)) == ["# edited", "# other", "[axes.y]\nmax_speed = 99\n"], f"kept: {browser.run(KEPT)}")
    browser.find("#forget-machine").click()
    check("# edited" not in browser.run(KEPT) and value_of(browser, "#machine-to-edit") == "prototype.toml", "the file is not forgotten")
    browser.find("#restore-machine").click()
    check("# edited" in browser.run(KEPT) and value_of(browser, "#text") == "# edited", "the file is not brought back")
    # A browser that keeps nothing is told of, and what it has kept of other pages is no file.
    browser.run("localStorage['corehbot machine 0'] = '{'; localStorage['corehbot machine 1'] = '{\"name\": 1}'; Storage.prototype.setItem = () => { throw Error('full'); }; edit('# more')")
    check("does not keep your 2 files (full)" in text(browser, "#kept"), f"the person is told {text(browser, '#kept')}")
    reload(browser)
    check(browser.run("return own.length") == 3, f"files: {browser.run('return own.length')}")
    browser.run("localStorage.clear()")
    reload(browser)


def check_old_failure(browser):
    """What is said of an earlier file goes when another one is chosen."""
    for choose in (lambda: Select(browser.find("#example")).select_by_value("tiny.gcode"), lambda: browser.run(DROP, "new.gcode")):
        browser.find("#tab-print").click()
        Select(browser.find("#machine-of-print")).select_by_value("heat.toml")
        Select(browser.find("#example")).select_by_value("heat.gcode")
        press(browser, "#presets button")
        browser.find("#start").click()
        check(printed(browser) == "failed" and browser.find("#failure").is_displayed(), "a thermistor that is off ends no print")
        choose()
        browser.wait("page without the failure", lambda: not browser.find("#failure").is_displayed())
        press(browser, "#chosen button")
    Select(browser.find("#machine-of-print")).select_by_value("prototype.toml")


# What a report in a sandbox must not reach, each as a promise that fails.
BARRED = {
    "the page": "async () => parent.document.body",
    "the page's storage": "async () => localStorage.length",
    "the network": "async () => fetch('https://corehbot.invalid/')",
    "a file": "async () => fetch('file:///etc/hostname')",
    "another server's picture": "() => new Promise((good, bad) => Object.assign(new Image(), { onload: good, onerror: bad, src: 'https://corehbot.invalid/a.png' }))",
    "the page's address": "async () => { top.location = 'https://corehbot.invalid/'; throw Error('no word of a browser'); }",
}
REACH = "const done = arguments[0]; (%s)().then(() => done(true), () => done(false));"

# Names that would be a script's if they ever were markup.
EVIL = "<img src=x onerror=window.hacked=1><script>window.hacked=1</script>"

# What has become of them, in a page or in a report.
HACKED = "return window.hacked !== undefined || document.querySelector('img, [onerror]') !== null"


def check_sandbox(browser):
    """The report cannot reach the page, its storage or a network, and the page cannot reach a network."""
    check_print(browser)
    browser.check_quiet()
    browser.driver.switch_to.frame(browser.find("#report"))
    for what, script in BARRED.items():
        check(not browser.driver.execute_async_script(REACH % script), f"a report reaches {what}")
    browser.driver.switch_to.default_content()
    for what in ("the network", "another server's picture"):
        check(not browser.driver.execute_async_script(REACH % BARRED[what]), f"the page reaches {what}")
    check(browser.run("return location.protocol") == "file:", "the report has led the page elsewhere")
    # The browser complains of each, and lists what was not asked.
    for log in ("browser", "performance"):
        browser.driver.get_log(log)


def check_names(browser):
    """Names and answers are text, whatever is in them: of files, machines, motors, parts and accidents, and from the printer."""
    browser.run("add(arguments[0] + '.toml', EXAMPLES.machines['prototype.toml'])", EVIL)
    lines = f"G28\n;TYPE:{EVIL}\nG1 X10 E1 F6000\nM118 {EVIL}\nM117 {EVIL}\n{EVIL}\nM862.3 P\"{EVIL}\"\n"
    browser.find("#tab-print").click()
    browser.run("take(arguments[0] + '.gcode', arguments[1])", EVIL, lines)
    check(EVIL in text(browser, "#file-name"), "the file's name is not shown as it is")
    browser.find("#start").click()
    printed(browser)
    check(EVIL in text(browser, "#result-name"), f"the result is called {text(browser, '#result-name')}")
    browser.wait("report", lambda: in_report(browser, "return document.querySelector('.charts') != null"))
    check(in_report(browser, "return document.body.innerText.includes(arguments[0])", EVIL), "the report does not show names as they are")
    check(not in_report(browser, HACKED), "a name is markup in the report")
    browser.run("addAccident({ breaks: arguments[0] })", EVIL)
    browser.wait("refusal", lambda: text(browser, "#chosen .trouble"))
    browser.find("#chosen button").click()
    browser.find("#tab-machine").click()
    type_in(browser, "#text", f'name = "{EVIL}"\n[{EVIL}]\n')
    browser.wait("refusal", lambda: browser.find_all("#problems .bad"))
    Select(browser.find("#machine-to-edit")).select_by_value("prototype.toml")
    browser.find("#tab-terminal").click()
    browser.wait("greeting", lambda: "start" in text(browser, "#log"))
    for line in (EVIL, f"M118 {EVIL}", f"M117 {EVIL}"):
        begin = len(text(browser, "#log")) + len(line)
        browser.find("#command").send_keys(line, Keys.ENTER)
        browser.wait("answer", lambda: text(browser, "#log")[begin:].endswith("ok\n"))
    check(not browser.run(HACKED), "a name is markup in the page")


def run(_corehbot, _folder):
    parts = (check_typing, check_old_failure, check_kept, check_sandbox, check_names)
    with Chromium() as browser:
        browser.open(os.environ["PAGE"])
        browser.wait("firmware", lambda: "ready" in text(browser, "#status"))
        for part in parts:
            part(browser)
            browser.check_quiet()
    return f"{len({field for _, field, _ in TYPED})} fields, {len(BARRED)} ways out of the report"


if __name__ == "__main__":
    main(run)
