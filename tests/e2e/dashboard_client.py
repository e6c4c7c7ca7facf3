"""A running `flexarm dashboard`, and what browsers do with it."""

import contextlib
import http.client
import json
import re
import socket
import subprocess
import time
from pathlib import Path

from program import BIN

WITHIN_S = 20.0


class Dashboard:
    """Runs `flexarm dashboard` for the daemon at FOLDER/socket, on a free port."""

    def __init__(self, folder, *arguments):
        self.address = "127.0.0.1"
        self.errors_file = folder / "dashboard.log"
        with open(self.errors_file, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(
                [BIN / "flexarm", "dashboard", "--socket", folder / "socket", "--port", "0", "--json",
                 *map(str, arguments)], cwd=folder, stdout=subprocess.PIPE, stderr=log, text=True)
        line = self.process.stdout.readline()
        if not line:
            raise AssertionError(f"the dashboard does not start: {self.errors()}")
        told = json.loads(line)
        self.url, self.port = told["url"], told["port"]
        found = re.search(r"#token=(\w+)$", self.url)
        self.token = found.group(1) if found else ""

    def end(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def errors(self):
        return self.errors_file.read_text(encoding="utf-8")

    def resident_mb(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8")
        return int(status.split("VmRSS:")[1].split()[0]) / 1024

    @contextlib.contextmanager
    def connection(self):
        connection = http.client.HTTPConnection(self.address, self.port, timeout=WITHIN_S)
        try:
            yield connection
        finally:
            connection.close()

    def socket(self, receive_bytes=None):
        client = socket.socket()
        if receive_bytes is not None:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
        client.settimeout(WITHIN_S)
        client.connect((self.address, self.port))
        return client

    def ask(self, method, path, body=None, **headers):
        """Status and body. A header with the value None is left out."""
        all_headers = {"Host": f"{self.address}:{self.port}", **headers}
        with self.connection() as connection:
            connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            for name, value in all_headers.items():
                if value is not None:
                    connection.putheader(name, value)
            if body is not None:
                connection.putheader("Content-Length", str(len(body)))
            connection.endheaders(body)
            reply = connection.getresponse()
            return reply.status, reply.read().decode("utf-8")

    def get(self, path, **headers):
        return self.ask("GET", path, **headers)

    def json(self, path):
        status, text = self.get(path)
        if status != 200:
            raise AssertionError(f"{path}: {status} {text}")
        return json.loads(text)

    def post(self, body, **headers):
        """A command as the page sends it; `headers` replace its own."""
        status, text = self.ask("POST", "/api/command", body.encode(), **{
            "Origin": f"http://{self.address}:{self.port}", "Content-Type": "application/json",
            "Authorization": f"Bearer {self.token}", **headers})
        return status, json.loads(text)

    def command(self, name, **keys):
        headers = {key: keys.pop(key) for key in list(keys) if key[0].isupper()}
        return self.post(json.dumps({"command": name, **keys}), **headers)


class Stream:
    """The events of /api/stream."""

    def __init__(self, dashboard, client=None):
        self.client = client
        if client is None:
            self.client = dashboard.socket()
            self.client.sendall(
                f"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{dashboard.port}\r\n\r\n".encode())
        self.reply = http.client.HTTPResponse(self.client)
        self.reply.begin()
        if self.reply.status != 200:
            raise AssertionError(f"stream: {self.reply.status} {self.reply.read()}")
        self.events = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.client.close()
        self.reply.close()

    def event(self):
        """Name and data of the next one."""
        name = self.line().removeprefix("event: ")
        data = json.loads(self.line().removeprefix("data: "))
        assert self.line() == ""
        self.events += 1
        return name, data

    def line(self):
        return self.reply.readline().decode("utf-8").rstrip("\n")

    def wait_for_event(self, name):
        end = time.monotonic() + WITHIN_S
        while time.monotonic() < end:
            event = self.event()
            if event[0] == name:
                return event
        raise AssertionError(f"no event {name}")

    def status(self):
        return self.wait_for_event("status")[1]

    def wait_for(self, true_of, within_s=WITHIN_S):
        """The first status of which it is true."""
        end = time.monotonic() + within_s
        status = None
        while time.monotonic() < end:
            status = self.status()
            if true_of(status):
                return status
        raise AssertionError(f"not within {within_s} s: {status}")
