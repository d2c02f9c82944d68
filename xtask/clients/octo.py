"""OctoPrint without a screen: a server on this computer only, driven through its REST API."""

import http.client
import json
import os
import re
import secrets
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import uuid

from printer import Failure, check

# Time for anything that OctoPrint does by itself: it starts in 6 s on two cores of a small virtual machine, and prints
# 5,000 lines in 3 s. With much other work beside it, it takes five times as long.
PATIENCE_S = 60

# A connection that lasts so long stays.
STAYS_S = 2

# What it says of a connection last, and for how long that is waited for.
LAST_WORD = "Connection closed, closing down monitor"
LAST_WORD_S = 10

# No wizard, no look into the network, a global API key. Keys as in octoprint/schema/config of 1.11.
CONFIG = """
accessControl: {{autologinLocal: true, autologinAs: admin, salt: {salt}}}
api: {{key: {key}}}
serial:
  additionalPorts: [{port}]
  autoconnect: false
  log: true
server:
  firstRun: false
  onlineCheck: {{enabled: false}}
  pluginBlacklist: {{enabled: false}}
plugins:
  _disabled: [softwareupdate, announcements, tracking, errortracking, pluginmanager, discovery, achievements, backup,
    health_check]
"""


class OctoPrint:
    def __init__(self, folder, port):
        self.base = os.path.join(folder, "octoprint")
        self.port = port
        self.key = secrets.token_hex(16)
        self.connections = 0
        # How much of the logs belongs to former connections.
        self.logged = {"serial.log": 0, "octoprint.log": 0}
        os.mkdir(self.base)
        with open(os.path.join(self.base, "config.yaml"), "w") as config:
            config.write(CONFIG.format(salt=secrets.token_hex(16), key=self.key, port=port))
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.url = f"http://127.0.0.1:{free.getsockname()[1]}/api/"
        number = self.url.split(":")[2].split("/")[0]
        # The interpreter's own folder holds the program of the same virtual environment.
        program = os.path.join(os.path.dirname(sys.executable), "octoprint")
        command = [program, "serve", "--basedir", self.base, "--host", "127.0.0.1", "--port", number]
        with open(os.path.join(self.base, "output"), "w") as output:
            self.process = subprocess.Popen([*command, "--iknowwhatimdoing"], stdout=output, stderr=output)

    def ask(self, path, data=None, kind="application/json"):
        """One request; returns what was answered."""
        request = urllib.request.Request(self.url + path, data, {"X-Api-Key": self.key, "Content-Type": kind})
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                text = answer.read()
        except urllib.error.HTTPError as error:
            raise Failure(f"OctoPrint says {error} to {path}: {error.read()[:200]}") from error
        return json.loads(text) if text else None

    def command(self, path, **words):
        self.ask(path, json.dumps(words).encode())

    def state(self):
        return self.ask("connection")["current"]["state"]

    def wait(self, what, holds):
        """Waits until something holds, for as long as anything goes on."""
        begin = time.monotonic()
        while not holds():
            check(time.monotonic() < begin + PATIENCE_S, f"{what} does not come; the state is {self.state()}")
            check(self.process.poll() is None, "OctoPrint ended")
            time.sleep(0.05)
        return time.monotonic() - begin

    def wait_for_state(self, *states):
        return self.wait(states[0], lambda: self.state() in states)

    def wait_until_up(self):
        def is_up():
            try:
                return bool(self.ask("version"))
            except (Failure, OSError, http.client.HTTPException):
                return False

        begin = time.monotonic()
        while not is_up():
            check(self.process.poll() is None and time.monotonic() < begin + PATIENCE_S, "OctoPrint does not start")
            time.sleep(0.2)

    def connect(self):
        self.logged = {name: len(self.log(name)) + logged for name, logged in self.logged.items()}
        self.connections += 1
        # Without a rate it would go looking for one, and a pty has them all.
        self.command("connection", command="connect", port=self.port, baudrate=115200)
        return self.wait_for_state("Operational")

    def reconnect(self):
        """Connects behind another connection. OctoPrint's last leave of that may come seconds later and end this one."""
        for _ in range(3):
            connected = self.connect()
            stays_until = time.monotonic() + STAYS_S
            while self.state() == "Operational":
                if time.monotonic() > stays_until:
                    return connected
                time.sleep(0.1)
        raise Failure("no connection stays")

    def wait_until_gone(self):
        """Waits for the end of the connection, and for OctoPrint's last word on it, which it now and then leaves out. It takes
        leave more than once (on_comm_state_change), and of a connection that is made in between as well."""
        self.wait_for_state("Closed")
        said_by = time.monotonic() + LAST_WORD_S
        while LAST_WORD not in self.log("octoprint.log") and time.monotonic() < said_by:
            time.sleep(0.05)
        self.wait_for_state("Closed")

    def begin(self, name, commands):
        """Uploads commands as a file, and begins to print it; again if its leave of a former connection comes between."""
        boundary = uuid.uuid4().hex
        parts = [
            f'--{boundary}\r\nContent-Disposition: form-data; name="print"\r\n\r\ntrue\r\n',
            f'--{boundary}\r\nContent-Disposition: form-data; name="file"; filename="{name}"\r\n\r\n',
            "\n".join(commands),
            f"\r\n--{boundary}--\r\n",
        ]
        begun = ["Printing", "Starting print from SD", "Starting"]
        ended = ["Closed"] if self.connections > 1 else []
        for _ in range(3):
            self.ask("files/local", "".join(parts).encode(), f"multipart/form-data; boundary={boundary}")
            seen = []
            self.wait("Printing", lambda seen=seen: seen.append(self.state()) or seen[-1] in begun + ended)
            if seen[-1] in begun:
                return
            self.reconnect()
        raise Failure("no connection stays")

    def log(self, name):
        """What a log says of the present connection."""
        path = os.path.join(self.base, "logs", name)
        if not os.path.exists(path):
            return ""
        with open(path, encoding="utf-8", errors="replace", newline="") as log:
            return log.read()[self.logged[name] :]

    def sent(self):
        return re.findall(r"Send: (.*)", self.log("serial.log"))

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(10)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
