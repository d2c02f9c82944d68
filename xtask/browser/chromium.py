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

# A picture is compared in squares of so many pixels: the edges of letters differ from one version to the next.
SQUARE = 4

# A square differs if one of its colours does by more, of 255.
UNLIKE = 24


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
        self.resize(size)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def resize(self, size, is_dark=False):
        """The size of the page, whatever the window's is; a phone has fingers and no mouse."""
        is_phone = size[0] < 600
        metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": is_phone}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        self.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": is_phone})
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

    def wait(self, what, holds, patience_s=PATIENCE_S):
        """Waits until something holds, and returns it."""
        end = time.monotonic() + patience_s
        while True:
            value = holds()
            if value:
                return value
            check(time.monotonic() < end, f"no {what} within {patience_s} s")
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

    def check_quiet(self):
        """Nothing since the last call was a complaint in the console, and nothing asked a network."""
        said = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]
        # A computer without graphics is one of the cases.
        said = [line for line in said if "GPU stall" not in line and "swiftshader" not in line.lower()]
        check(not said, f"the console says: {said[:3]}")
        for entry in self.driver.get_log("performance"):
            event = json.loads(entry["message"])["message"]
            if event["method"] in ("Network.requestWillBeSent", "Network.webSocketCreated"):
                params = event["params"]
                url = params.get("request", params)["url"]
                check(url.startswith(LOCAL), f"the page asks {url}")

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

    def picture(self, name, share=0.01, element=None):
        """Compares what is seen with the picture `golden/NAME.png`; at most this share of it may differ. `BLESS=1`
        writes the picture. One that differs is kept in the folder of the trials."""
        self.drawn()
        seen = pathlib.Path(os.environ.get("PICTURES", tempfile.gettempdir())) / f"{name}.png"
        if element:
            element.screenshot(str(seen))
        else:
            self.driver.save_screenshot(str(seen))
        golden = GOLDEN / f"{name}.png"
        if os.environ.get("BLESS") == "1":
            GOLDEN.mkdir(exist_ok=True)
            Image.open(seen).convert("RGB").quantize(64).save(golden, optimize=True)
            return 0.0
        check(golden.is_file(), f"there is no {golden}: BLESS=1 writes it; look at it")
        unlike = difference(golden, seen)
        check(unlike <= share, f"{seen} differs from {golden} in {unlike:.1%} of its area, {share:.1%} at most")
        return unlike


def difference(one, other):
    """The share of the squares of a picture that differ from those of another one."""
    one, other = (Image.open(path).convert("RGB") for path in (one, other))
    check(one.size == other.size, f"the pictures have {one.size} and {other.size} pixels")
    one, other = (picture.reduce(SQUARE) for picture in (one, other))
    red, green, blue = ImageChops.difference(one, other).split()
    worst = ImageChops.lighter(ImageChops.lighter(red, green), blue)
    return sum(worst.histogram()[UNLIKE + 1 :]) / (worst.width * worst.height)
