"""A headless Chromium that a trial drives through WebDriver: pages from files, as wide as a desk's screen or a phone's.

It draws in software and with one scale, so that pictures are the same on computers with other screens. A page that asks
anything of a network, or complains in the console, fails.
"""

import json
import os
import pathlib
import tempfile
import time

from PIL import Image, ImageChops
from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

# Width and height in CSS pixels. The phone is as wide as most phones of 2020 and later.
DESK = (1280, 800)
PHONE = (390, 844)

# Nothing that a page does here takes longer, on two cores of a small virtual machine with other work beside it.
PATIENCE_S = 120

GOLDEN = pathlib.Path(__file__).parent / "golden"

# Addresses that are no network.
LOCAL = ("file:", "data:", "blob:", "about:")

# Pictures are kept at half their size, and compared in squares of so many pixels of the whole size: the edges of letters
# differ from one version to the next.
SQUARE = 4

# Goldens have so many colours, which makes them a third as large.
COLOURS = 128

# A square differs if one of its colours does by more, of 255.
UNLIKE = 48

# At most this share of a picture's squares may differ. Measured on the largest picture: 0.0003 % with the same browser,
# its hints for letters or its compositor changed; 0.09 % without a heading or with the tiles 2 px to the side, 0.5 % with
# the lines 1 % smaller, 2.7 % with 60 moves less.
MOST_UNLIKE = 0.0005

# The font of pictures, which Debian's fontconfig depends on; and the stage is no part of the window's height.
STYLE = """* { font-family: DejaVu Sans !important; caret-color: transparent !important; }
    .viewer { --tall: 400px !important; }"""

# Width and height of the window, height of the page, and whether all lines and charts are drawn.
SETTLED = """const view = document.querySelector('.viewer')?.corehbotView;
    const isDrawn = view && !view.stage.dirty && !view.stage.lines.queue.length && view.stage.drawn === view.player.done
        && [...document.querySelectorAll('.plot')].every(place => place.hidden || place.querySelector('.u-over'));
    return [innerWidth, innerHeight, Math.ceil(document.body.getBoundingClientRect().height), isDrawn];"""


# Before a page's own scripts, in its frames too. A page that scrolls to an element does so after the last change of its
# layout. So the element of a task's last scroll is where it was scrolled to when the task is over; browsers differ in
# whether they follow an element that moves. A smooth scroll takes longer and is left out.
WATCH_SCROLLS = """const native = Element.prototype.scrollIntoView;
    Object.assign(window, { scrolls: 0, wrongScrolls: [] });
    Element.prototype.scrollIntoView = function (how) {
        native.call(this, how);
        const own = ++window.scrolls;
        if (how?.behavior === 'smooth') return;
        const { top } = this.getBoundingClientRect(), at = scrollY, channel = new MessageChannel();
        channel.port1.onmessage = () => {
            const moved = this.getBoundingClientRect().top - top;
            if (own === window.scrolls && (moved || scrollY !== at)) window.wrongScrolls.push(`${this.id || this.className}: ${moved} px`);
        };
        channel.port2.postMessage(0);
    };"""

SCROLLS = "return window.wrongScrolls?.splice(0) ?? []"


class Failure(Exception):
    """What does not hold."""


def check(holds, what):
    if not holds:
        raise Failure(what)


class Chromium:
    """The browser, at the paths that `cargo xtask` has found."""

    def __init__(self, size=DESK):
        options = Options()
        options.binary_location = os.environ["CHROMIUM"]
        # A container has no sandbox; the pages are ours.
        for argument in (
            "--headless=new",
            "--no-sandbox",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--disable-component-update",
            "--no-first-run",
            "--hide-scrollbars",
            "--force-device-scale-factor=1",
            "--force-color-profile=srgb",
            "--font-render-hinting=none",
            "--disable-lcd-text",
            "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader",
        ):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(os.environ["CHROMEDRIVER"]))
        self.driver.set_script_timeout(PATIENCE_S)
        self.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WATCH_SCROLLS})
        self.resize(size, is_dark=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def resize(self, size, is_dark=None):
        """The size of the page, whatever the window's is, and its colours; a phone has fingers and no mouse."""
        is_phone = size[0] < 600
        metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": is_phone}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        self.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": is_phone})
        if is_dark is None:
            return
        scheme = {"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def open(self, path):
        """Opens a file; returns the seconds until it is loaded and drawn."""
        begin = time.monotonic()
        self.driver.get(pathlib.Path(path).resolve().as_uri())
        self.drawn()
        return time.monotonic() - begin

    def drawn(self):
        """Waits until what was done is drawn."""
        wait = "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => done()));"
        self.driver.execute_async_script(wait)

    def run(self, script, *args):
        """The result of a script in the page."""
        return self.driver.execute_script(script, *args)

    def find(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def find_all(self, selector):
        return self.driver.find_elements(By.CSS_SELECTOR, selector)

    def wait(self, what, holds):
        """Waits until something holds, and returns it. Each wait has the same patience: a short one fails on a slow computer."""
        end = time.monotonic() + PATIENCE_S
        while True:
            value = holds()
            if value:
                return value
            check(time.monotonic() < end, f"no {what} within {PATIENCE_S} s")
            time.sleep(0.02)

    def frames_per_second(self, seconds=1.0):
        """How often the page draws while it plays."""
        count = """const [seconds, done] = arguments, begin = performance.now();
            let frames = 0;
            const next = now => {
                if (now - begin >= 1000 * seconds) return done(frames * 1000 / (now - begin));
                frames++;
                requestAnimationFrame(next);
            };
            requestAnimationFrame(next);"""
        return self.driver.execute_async_script(count, seconds)

    def processor_seconds(self):
        """Time of processors that the browser has taken so far, whatever else goes on on this computer."""
        parents, times = {}, {}
        for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                # The name, in parentheses, may have blanks.
                fields = path.read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            pid = int(path.parent.name)
            parents[pid] = int(fields[1])
            times[pid] = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

        def is_ours(pid):
            while pid in parents and pid != self.driver.service.process.pid:
                pid = parents[pid]
            return pid == self.driver.service.process.pid

        return sum(seconds for pid, seconds in times.items() if is_ours(pid))

    def check_quiet(self, *own):
        """Nothing since the last call was a complaint in the console, nothing asked a network, but for `own`, and nothing
        that was scrolled to moved away."""
        wrong = self.run(SCROLLS)
        # A frame in a sandbox is open to the driver alone.
        for frame in self.find_all("iframe"):
            self.driver.switch_to.frame(frame)
            wrong += self.run(SCROLLS)
            self.driver.switch_to.default_content()
        check(not wrong, f"the page scrolled before its layout was done: {wrong}")
        said = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
        # A computer without graphics is one of the cases.
        said = [line for line in said if "GPU stall" not in line and "swiftshader" not in line.lower()]
        check(not said, f"the console says: {said[:3]}")
        for entry in self.driver.get_log("performance"):
            event = json.loads(entry["message"])["message"]
            if event["method"] in ("Network.requestWillBeSent", "Network.webSocketCreated"):
                params = event["params"]
                url = params.get("request", params)["url"]
                check(url.startswith(LOCAL + own), f"the page asks {url}")

    def check_width(self):
        """Nothing of the page is beyond the right edge."""
        page, window = self.run("return [document.documentElement.scrollWidth, innerWidth]")
        check(page <= window, f"the page is {page} px wide in a window of {window} px")

    def check_labels(self):
        """Every control that is seen has a name that a screen reader can say."""
        nameless = self.run(
            """return [...document.querySelectorAll('button, input, select, textarea, [role=button], [role=tab]')]
                .filter(control => control.checkVisibility() && control.type != 'hidden')
                .filter(control => !(control.labels?.length || control.getAttribute('aria-label')
                    || control.getAttribute('aria-labelledby') || control.textContent.trim() || control.title))
                .map(control => control.outerHTML.slice(0, 80))"""
        )
        check(not nameless, f"controls without a name: {nameless}")

    def is_settled(self):
        """Whether the window is as high as the page, and everything in it is drawn: charts are when they are in sight."""
        width, height, page, is_drawn = self.run(SETTLED)
        if page != height:
            self.resize((width, page))
        self.drawn()
        return page == height and is_drawn

    def picture(self, name):
        """Compares the whole page with the picture `golden/NAME.png`. `BLESS=1` writes the picture. One that differs is
        kept in the folder of the trials."""
        add = "const style = document.createElement('style'); style.textContent = arguments[0]; document.head.append(style)"
        self.run(add, STYLE)
        self.wait("whole picture", self.is_settled)
        seen = pathlib.Path(os.environ.get("PICTURES", tempfile.gettempdir())) / f"{name}.png"
        self.driver.save_screenshot(str(seen))
        half = Image.open(seen).convert("RGB").reduce(2)
        half.save(seen, optimize=True)
        golden = GOLDEN / f"{name}.png"
        if os.environ.get("BLESS") == "1":
            GOLDEN.mkdir(exist_ok=True)
            few = half.quantize(COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            few.save(golden, optimize=True)
        check(golden.is_file(), f"there is no {golden}: BLESS=1 writes it; look at it")
        unlike = difference(golden, seen)
        check(unlike <= MOST_UNLIKE, f"{seen} differs from {golden} in {unlike:.2%} of its area, {MOST_UNLIKE:.2%} at most")
        seen.unlink()
        return unlike


def difference(one, other):
    """The share of the squares of a picture that differ from those of another one."""
    one, other = (Image.open(path).convert("RGB") for path in (one, other))
    check(one.size == other.size, f"the pictures have {one.size} and {other.size} pixels")
    one, other = (picture.reduce(SQUARE // 2) for picture in (one, other))
    red, green, blue = ImageChops.difference(one, other).split()
    worst = ImageChops.lighter(ImageChops.lighter(red, green), blue)
    return sum(worst.histogram()[UNLIKE + 1 :]) / (worst.width * worst.height)
