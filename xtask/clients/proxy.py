"""A bad line: a pty of its own between host and printer that damages what the host sends.

It also keeps account of the commands that a printer takes: each numbered line that comes through unharmed when it is its
turn. Lines without a number have no checksum that could show damage; they pass unharmed.
"""

import os
import pty
import re
import select
import threading
import tty


def corrupt(every):
    """Turns over a bit in one byte of every so many numbered lines: another byte and another bit each time."""

    def damage(count, line):
        if count % every:
            return line
        turn = count // every
        place = 7 * turn % (len(line) - 1)
        changed = line[place] ^ 1 << turn % 7
        # Another line end would be another kind of damage: two lines for one.
        if changed in b"\r\n":
            changed ^= 0x40
        return line[:place] + bytes([changed]) + line[place + 1 :]

    return damage


def drop(every):
    """Loses every so many numbered lines, line end and all; but no M110, which hosts do not repeat, and not the M400 that ends
    a print: behind it no line shows by its number that it was lost."""

    def damage(count, line):
        return line if count % every or b"M110" in line or b"M400" in line else None

    return damage


# What bad lines do, by name.
KINDS = {"corrupt": corrupt(50), "drop": drop(97)}


class Proxy(threading.Thread):
    def __init__(self, printer, damage, link=None):
        super().__init__(daemon=True)
        self.damage = damage
        self.printer = os.open(printer, os.O_RDWR | os.O_NOCTTY)
        self.near, self.far = pty.openpty()
        tty.setraw(self.far)
        self.path = link or os.ttyname(self.far)
        self.link = link
        if link:
            os.symlink(os.ttyname(self.far), link)
        self.stop, self.stopped = os.pipe()
        self.said, self.heard = b"", b""
        # Numbered lines that the host sent, and how many of them were damaged.
        self.count, self.damaged = 0, 0
        self.accepted, self.resends = [], 0
        self.start()

    def run(self):
        ends = [self.near, self.printer, self.stop]
        while True:
            ready = select.select(ends, [], [])[0]
            if self.stop in ready:
                return
            try:
                if self.near in ready:
                    self.pass_on(os.read(self.near, 4096))
                if self.printer in ready:
                    self.listen(os.read(self.printer, 4096))
            except OSError:
                return

    def pass_on(self, data):
        *lines, self.said = (self.said + data).split(b"\n")
        for line in lines:
            line += b"\n"
            if line.startswith(b"N"):
                self.count += 1
                damaged = self.damage(self.count, line)
                self.damaged += damaged != line
                if damaged is None:
                    continue
                if damaged == line:
                    self.account(line)
                line = damaged
            os.write(self.printer, line)

    def listen(self, data):
        os.write(self.near, data)
        *lines, self.heard = (self.heard + data).split(b"\n")
        self.resends += sum(line.startswith(b"Resend:") for line in lines)

    def account(self, line):
        numbered = re.match(rb"N(-?\d+) (.*)\*\d+\s*$", line)
        number, command = int(numbered[1]), numbered[2].decode()
        expected = self.accepted[-1][0] + 1 if self.accepted else number
        if number == expected or command.startswith("M110"):
            self.accepted.append((number, command))

    def end(self):
        os.write(self.stopped, b"x")
        self.join()
        if self.link:
            os.unlink(self.link)
        for end in [self.near, self.far, self.printer, self.stop, self.stopped]:
            os.close(end)
