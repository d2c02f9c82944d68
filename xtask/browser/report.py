"""The report of a print opens from its file, on a desk and on a phone, and says nothing to console and network.

Arguments: corehbot.
"""

from chromium import DESK, PHONE, Chromium, check
from trial import ROOT, main, print_report


def run(corehbot, folder):
    report = print_report(corehbot, ROOT / "examples/first-print.gcode", folder)
    times = []
    with Chromium() as browser:
        for size, is_dark in ((DESK, False), (DESK, True), (PHONE, False)):
            browser.resize(size, is_dark)
            times.append(browser.open(report))
            check("first-print" in browser.driver.title, f"the title is {browser.driver.title}")
            browser.check_width()
            browser.check_quiet()
    size = report.stat().st_size / 1e6
    return f"loaded in {max(times):.2f} s, {size:.1f} MB"


main(run)
