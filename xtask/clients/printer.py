"""The printer under test: a `corehbot serve` process, and what `corehbot run` makes of the same file."""

import json
import os
import re
import select
import signal
import subprocess
import sys
import tempfile

# `run` prints thousands of seconds in one; a printer that does not end by then never will.
PATIENCE_S = 60

# So long may it take to end by itself when a test has failed.
GRACE_S = 5

# A test that takes longer is ended, and everything that it has started with it. The longest takes 20 s on two cores
# of a small virtual machine.
LIMIT_S = 150


class Failure(Exception):
    """What does not hold."""


class RanDry(Failure):
    """The steps are others because the stream ran dry, which was counted: nothing is said of a stream that does not."""


def check(holds, what):
    if not holds:
        raise Failure(what)


class Printer:
    """A printer at the end of a pty, as fast as its host at speed `max`: `corehbot`, or the board in QEMU if that is what
    `xtask` stands for."""

    def __init__(self, program, link=None, speed="max", settings=None, trace=None):
        command = [program, "serve", "--speed", str(speed), "--storage", "none"]
        if os.path.basename(program) == "xtask":
            command = [program, "qemu", "--serve"]
        if link:
            command += ["--pty", link]
        if settings:
            command += ["--machine", settings]
        if trace:
            command += ["--trace", trace]
        # Its time goes on while QEMU waits for a processor.
        self.is_in_qemu = command[1] == "qemu"
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.path = self.process.stdout.readline().strip()
        check(self.path, "corehbot serve does not start")

    def ask(self, command):
        """What the printer says, to whomever and in answer to a command, within a second of silence."""
        port = os.open(self.path, os.O_RDWR | os.O_NOCTTY)
        os.write(port, command.encode() + b"\n")
        said = b""
        while select.select([port], [], [], 1)[0]:
            said += os.read(port, 4096)
        os.close(port)
        return said.decode()

    def end(self):
        """Ends it as Ctrl-C does; returns its digest of the steps, and the number of underruns; 0 if it does not know."""
        self.process.send_signal(signal.SIGINT)
        words = self.process.communicate(timeout=PATIENCE_S)[0]
        check(self.process.returncode == 0, f"corehbot serve ended with {self.process.returncode}")
        digest = re.search(r"sha256 +(\w+)", words)
        check(digest, f"corehbot serve said: {words}")
        underruns = re.search(r"underruns (\d+)", words)
        return digest[1], int(underruns[1]) if underruns else 0

    def kill(self):
        if self.process.poll() is None:
            # As Ctrl-C first: who is killed cannot end its QEMU, which would go on for ever.
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.communicate(timeout=GRACE_S)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()


def simulate(program, file, settings=None, trace=None):
    """The summary that `corehbot run` writes of a file, on a machine if it is not the prototype; and the trace, if wanted."""
    with tempfile.NamedTemporaryFile(suffix=".json") as summary:
        command = [program, "run", file, "--json", summary.name]
        if settings:
            command += ["--machine", settings]
        if trace:
            command += ["--trace", trace]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=PATIENCE_S)
        # It was written beside and renamed, so the open file is still the empty one.
        with open(summary.name, encoding="utf-8") as written:
            return json.load(written)


def commands(file):
    """The commands of a file as hosts send them, and one that waits for the last motion."""
    with open(file, encoding="utf-8", errors="replace") as lines:
        stripped = [line.split(";")[0].strip() for line in lines]
    return [line for line in stripped if line] + ["M400"]


def same_steps(printer, summary, may_run_dry=False):
    """Holds the steps to those of `corehbot run`. If the stream `may_run_dry` they may be others, but then it was counted; if
    not, a printer whose stream did, because the computer was busy, is told apart by `RanDry`. `corehbot` counts at its end; a
    board in QEMU is asked, for no host is there that would hear the answer."""
    counted = (may_run_dry or printer.is_in_qemu) and int(re.search(r"(\d+) times out of moves", printer.ask("M122"))[1])
    digest, underruns = printer.end()
    if digest == summary["trace_sha256"]:
        return "same steps"
    counted = counted or underruns
    check(counted, "the steps are not those of corehbot run, and the stream did not run dry")
    if not may_run_dry:
        raise RanDry(f"the steps are not those of corehbot run: {counted} times out of moves")
    return f"{counted} times out of moves"


def main(run):
    """Runs a test, and says how it ended."""

    def too_late(_signal, _frame):
        raise Failure(f"it is not done after {LIMIT_S} s")

    signal.signal(signal.SIGALRM, too_late)
    signal.alarm(LIMIT_S)
    try:
        print(run(*sys.argv[1:]))
    except Failure as failure:
        sys.exit(str(failure))
