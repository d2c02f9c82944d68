"""Pages on paper: light, whole, without controls, and nothing lies over something else."""

import base64
import re

from chromium import check

# Width and height of the sheets in inches.
SHEETS = {"A4": (8.27, 11.69), "letter": (8.5, 11)}

# The margin at each side, as paper.css has it, and a CSS pixel.
MARGIN_MM = 12
PX_PER_INCH = 96

# More pages than this mean that something is far higher than it should be.
MOST_PAGES = 30

# What is wrong on the sheet: controls, charts and pictures without ink, dark ground, and what lies over something else or
# beyond the edge.
WRONG = """const wrong = [], seen = [...document.querySelectorAll('body *')].filter(one => one.checkVisibility({ visibilityProperty: true }));
    const name = one => `${one.localName}.${one.getAttribute('class') ?? ''} ${one.textContent.slice(0, 30)}`;
    for (const one of seen) {
        const isWord = one.localName === 'button' && one.closest('.legend, td');
        if (one.matches('input, select, summary, button') && !isWord) wrong.push('a control: ' + name(one));
        if (one.getBoundingClientRect().right > innerWidth + 1) wrong.push('beyond the edge: ' + name(one));
    }
    const ink = canvas => {
        const copy = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height }), g = copy.getContext('2d');
        g.drawImage(canvas, 0, 0);
        const { data } = g.getImageData(0, 0, copy.width, copy.height);
        let n = 0;
        for (let i = 3; i < data.length; i += 4) n += data[i] > 0;
        return n;
    };
    for (const place of seen.filter(one => one.matches('.plot, .stage, .map, .spectrogram'))) {
        const canvases = [...place.querySelectorAll('canvas')].filter(canvas => canvas.checkVisibility());
        if (!canvases.some(canvas => ink(canvas) > 300)) wrong.push('no ink: ' + (place.ariaLabel ?? name(place)));
    }
    const [r, g, b] = getComputedStyle(document.querySelector('h1')).color.match(/\\d+/g).map(Number);
    if (r + g + b > 200) wrong.push('light ink');
    const boxes = seen.filter(one => one.matches('h1, h2, h3, p, li, td, th, dt, dd, pre, output, .tile, .plot, .stage, .map, .spectrogram, .polar, .legend, .badge'))
        .slice(0, 900).map(one => [one, one.getBoundingClientRect()]).filter(([, { width, height }]) => width > 0 && height > 0);
    for (const [i, [one, a]] of boxes.entries()) for (const [other, b] of boxes.slice(i + 1)) {
        const isOver = Math.min(a.right, b.right) - Math.max(a.left, b.left) > 2 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 2;
        if (isOver && !one.contains(other) && !other.contains(one)) wrong.push(`${name(one)} lies over ${name(other)}`);
    }
    return wrong;"""

# Whether all charts are drawn, also those that were never in sight.
DRAWN = "return [...document.querySelectorAll('.plot')].every(place => place.hidden || place.querySelector('.u-over'))"


def check_paper(browser, name, size, is_dark):
    """A page that is open, on sheets of both sizes; afterwards it is on the screen as before, `size` wide and high."""
    browser.wait(f"all charts of {name}", lambda: browser.run(DRAWN))
    scheme = {"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}
    media = lambda kind: browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": kind, "features": [scheme]})
    for sheet, (width, height) in SHEETS.items():
        media("print")
        browser.resize((round((width - 2 * MARGIN_MM / 25.4) * PX_PER_INCH), round(height * PX_PER_INCH)))
        browser.drawn()
        browser.run("dispatchEvent(new Event('beforeprint'))")
        wrong = browser.run(WRONG)
        browser.run("dispatchEvent(new Event('afterprint'))")
        check(not wrong, f"{name} on {sheet}: {len(wrong)} faults, such as {wrong[:6]}")
        media("")
        browser.resize(size)
        browser.drawn()
        order = {"printBackground": True, "paperWidth": width, "paperHeight": height}
        pdf = base64.b64decode(browser.driver.execute_cdp_cmd("Page.printToPDF", order)["data"])
        pages = len(re.findall(rb"/Type /Page\b", pdf))
        check(0 < pages <= MOST_PAGES, f"{name} has {pages} pages of {sheet}")
        check(not browser.run("return document.documentElement.classList.contains('paper')"), f"{name} stays on paper")
