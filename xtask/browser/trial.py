"""A trial: a function that gets `corehbot` and a folder for files, and returns what it has measured in a line."""

import os
import pathlib
import subprocess
import sys
import tempfile
import traceback

from chromium import Failure, check
from selenium.common.exceptions import WebDriverException

ROOT = pathlib.Path(__file__).resolve().parents[2]


def print_report(corehbot, file, folder, *options, ends_well=True):
    """Prints a file in the simulator; returns the path of its report."""
    report = pathlib.Path(folder) / "report.html"
    # Relative, since the page shows it.
    command = [corehbot, "run", os.path.relpath(file, ROOT), "--report", str(report), *map(str, options)]
    ran = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    check((ran.returncode == 0) == ends_well, f"corehbot run {file}: {ran.stdout}{ran.stderr}")
    return report


def main(trial):
    """Runs a trial; its words go to standard output if it succeeds, otherwise to standard error."""
    with tempfile.TemporaryDirectory(prefix="corehbot-browser-") as folder:
        try:
            print(trial(sys.argv[1], pathlib.Path(folder)))
        except Failure as failure:
            sys.exit(str(failure))
        except WebDriverException as failure:
            # The line of the trial tells more than the driver does.
            traceback.print_exc()
            sys.exit(f"{type(failure).__name__}: {failure.msg}")
