"""OctoPrint connects, prints, pauses, cancels, stops and reconnects; on a clean line and on a bad one.

Arguments: corehbot, G-code file, and what the bad line does: `corrupt` or `drop`.
"""

import os
import re
import tempfile
import time

import octo
import printer
import proxy
from printer import check

# So many times as fast as real time: a minute of printing in seconds, and yet slow enough to break in on it.
MODERATE = 20

# Three questions fit into it.
IDLE_S = 4

# Words that must not be in the logs of a clean line. OctoPrint 1.11.8, util/comm.py: "Communication timeout while
# ...", "No response from printer after ..."; the printer: "echo:Unknown command".
TROUBLE = re.compile(r"timeout while|No response from printer|Unknown|Resend|Got a resend|Unexpected", re.IGNORECASE)


def run(program, file, kind):
    summary = printer.simulate(program, file)
    commands = printer.commands(file)
    with tempfile.TemporaryDirectory(prefix="corehbot-octoprint-") as folder:
        port = os.path.join(folder, "printer")
        host = octo.OctoPrint(folder, port)
        try:
            host.wait_until_up()
            said = [
                clean_print(host, program, port, commands, summary),
                cancel_and_stop(host, program, port, commands),
                bad_print(host, program, port, commands, summary, proxy.KINDS[kind]),
            ]
            return "; ".join(said)
        finally:
            host.end()


# What OctoPrint sends of itself during a print: a poll, the interval of `busy` that it wants, and behind an M115, which
# the file may hold, reports and prompts. The last M400 is its own, too.
OWN = ("M105", "M113 S2", "M154 S5", "M155 S2", "M876 P1", "M400")


def check_order(numbered, commands):
    """Each command must be there once and in order, with nothing between but OctoPrint's own."""
    # A print begins with its line numbers.
    begin = len(numbered) - numbered[::-1].index("M110 N0")
    left = iter(commands)
    awaited = next(left, None)
    for command in numbered[begin:]:
        if command == awaited:
            awaited = next(left, None)
        else:
            check(command in OWN, f"{command} instead of {awaited}")
    check(awaited is None, f"{awaited} is missing")


def clean_print(host, program, port, commands, summary):
    device = printer.Printer(program, port)
    try:
        connected = host.connect()
        host.wait("its capabilities", lambda: "EMERGENCY_PARSER" in host.log("octoprint.log"))
        # Whoever does not print is not asked for lines; the first question would come after half a second.
        time.sleep(IDLE_S)
        begin = time.monotonic()
        host.begin("clean.gcode", commands)
        host.wait_for_state("Operational")
        seconds = time.monotonic() - begin
        numbered = [re.sub(r"^N\d+ |\*\d+$", "", line) for line in host.sent() if line.startswith("N")]
        check_order(numbered, commands)
        known = {words.split('"')[1] for words in summary["warnings"] if "Unknown command" in words}
        for line in (host.log("serial.log") + host.log("octoprint.log")).splitlines():
            is_known = any(f'Unknown command: "{command}' in line for command in known)
            check(is_known or not TROUBLE.search(line), f"on a clean line its log says: {line}")
        printer.same_steps(device, summary)
        return f"connects in {connected:.1f} s, {len(commands)} commands in {seconds:.1f} s, same steps"
    finally:
        device.kill()


def cancel_and_stop(host, program, port, commands):
    """The printer of before was switched off while it was connected."""
    host.wait_until_gone()
    device = printer.Printer(program, port, MODERATE)
    try:
        host.reconnect()
        host.begin("cancelled.gcode", commands)
        host.wait("motion", lambda: len(host.sent()) > 100)
        asked = host.log("serial.log").count("Resend")
        host.command("job", command="pause", action="pause")
        paused = host.wait_for_state("Paused")
        # Whoever pauses is not asked for lines; the first question would come after half a second.
        time.sleep(IDLE_S)
        check(host.log("serial.log").count("Resend") == asked, "it is asked for lines while it is paused")
        sent = len(host.sent())
        host.command("job", command="pause", action="resume")
        host.wait("motion after the pause", lambda: len(host.sent()) > sent + 100)
        host.command("job", command="cancel")
        cancelled = host.wait_for_state("Operational")
        sent = len(host.sent())
        check(sent < len(commands), "it printed to the end instead of cancelling")
        check(any(line.startswith("M108") or " M108" in line for line in host.sent()), "it did not send M108")
        host.begin("stopped.gcode", commands)
        host.wait("motion", lambda: len(host.sent()) > sent + 100)
        host.command("printer/command", commands=["M112"])
        # OctoPrint hangs up after an M112, so somebody else has to ask whether the printer heard it.
        host.wait_until_gone()
        check("Printer halted. kill() called!" in device.ask("M105"), "the printer does not halt at M112")
        device.end()
        return f"pauses in {paused:.1f} s, goes on, cancels in {cancelled:.1f} s, stops"
    finally:
        device.kill()


def bad_print(host, program, port, commands, summary, damage):
    device = printer.Printer(program)
    line = None
    try:
        line = proxy.Proxy(device.path, damage, port)
        host.reconnect()
        begin = time.monotonic()
        host.begin("bad.gcode", commands)
        host.wait_for_state("Operational")
        seconds = time.monotonic() - begin
        check_order([command for _, command in line.accepted], commands)
        check(line.resends >= line.damaged > 0, f"{line.resends} resends of {line.damaged} damaged lines")
        check("timeout while" not in host.log("serial.log"), "it ran into a timeout")
        printer.same_steps(device, summary)
        return f"{line.resends} resends of {line.damaged} damaged lines in {seconds:.1f} s, same steps"
    finally:
        device.kill()
        if line:
            line.end()


printer.main(run)
