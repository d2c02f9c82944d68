"""Printrun's printcore prints a file: each command arrives once and in order, and the steps are the simulator's.

Arguments: corehbot, G-code file, and `clean`, `corrupt` or `drop`; a fourth one is the printer if it is not corehbot.
"""

import logging
import threading
import time

import printer
import proxy
from printer import check
from printrun import gcoder
from printrun.printcore import printcore

# A printer that says nothing for so long is done for. In QEMU, whose time passes slowly while it waits, the second
# question for a lost line comes after 6 s, and three times that beside other work.
SILENCE_S = 60


# So often is a print begun whose stream runs dry, because the computer was busy.
TRIES = 3


def run(program, file, kind, other=None):
    """The same steps, in one of so many prints that did not run dry. Whatever else does not hold ends it at once."""
    for _ in range(TRIES - 1):
        try:
            return print_once(program, file, kind, other)
        except printer.RanDry:
            pass
    return print_once(program, file, kind, other)


def print_once(program, file, kind, other):
    summary = printer.simulate(program, file)
    device = printer.Printer(other or program)
    line = None
    try:
        damage = proxy.KINDS.get(kind)
        line = damage and proxy.Proxy(device.path, damage)
        path = line.path if line else device.path
        sent, heard, seconds = stream(path, printer.commands(file))
        expected = printer.commands(file)
        resends = sum(reply.startswith("Resend") for reply in heard)
        if not line:
            check(resends == 0, f"{resends} resends on a clean line")
            check(sent == expected, "printcore did not send the file")
        else:
            check(resends >= line.damaged > 0, f"{resends} resends of {line.damaged} damaged lines")
            accepted = [command for _, command in line.accepted if command != "M110 N-1"]
            check(accepted == expected, f"{len(accepted)} of {len(expected)} commands arrived, or not in order")
        unclear = [reply for reply in whole_errors(heard) if "Last Line" not in reply]
        check(not unclear, f"the printer said {unclear[:3]}")
        if line:
            # It would hear what the printer says to others, too.
            line.end()
            line = None
        # The time of the board in QEMU goes on while QEMU waits for a processor: there the stream may run dry.
        seen = printer.same_steps(device, summary, may_run_dry=other is not None and kind == "drop")
        return f"{len(expected)} commands in {seconds:.1f} s, {resends} resends, {seen}"
    finally:
        if line:
            line.end()
        device.kill()


def whole_errors(heard):
    """The errors among replies. printcore hands on the begin of a line whose rest keeps it waiting: both are one."""
    errors, is_part = [], False
    for reply in heard:
        if is_part:
            errors[-1] += reply
        elif reply.startswith("Error"):
            errors.append(reply)
        else:
            continue
        is_part = not errors[-1].endswith("\n")
    return errors


def stream(path, commands):
    """Prints the commands; returns the numbered commands that were sent, the replies, and how long it took."""
    host = printcore()
    sent, heard, done = [], [], threading.Event()
    online = threading.Event()
    host.onlinecb = online.set
    host.endcb = done.set
    host.recvcb = heard.append
    host.printsendcb = lambda line: sent.append(line.raw.strip())
    host.connect(path, 115200)
    try:
        check(online.wait(SILENCE_S), "printcore does not get online")
        begin = time.monotonic()
        host.startprint(gcoder.LightGCode(commands))
        replies = -1
        while not done.wait(SILENCE_S):
            check(len(heard) > replies, f"printcore stalls at line {host.lineno}")
            replies = len(heard)
        return sent, heard, time.monotonic() - begin
    finally:
        if host.printing:
            host.cancelprint()
        # printcore starts a thread after its print has ended, and fails if it is told to end before that.
        while not (host.send_thread and host.send_thread.is_alive()):
            time.sleep(0.01)
        host.disconnect()


# It logs every resend as an error.
logging.disable()
printer.main(run)
