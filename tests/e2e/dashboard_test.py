#!/usr/bin/env python3
"""`flexarm dashboard` over HTTP, as browsers and others ask it: who may do what, many and slow
clients, a daemon that ends and comes back. tests/browser has the page itself."""

import contextlib
import json
import os
import resource
import select
import signal
import socket
import sys
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from dashboard_client import Dashboard, Stream
from program import ProgramTest, StallWitness, despite_stalls, doublet, realtime_permitted

LONG = doublet("long", 60.0, move_deg=3.0)
WITHIN_S = 20.0
MOST_STREAMS = 256  # DashboardServer::kMostStreams
FLOOD_STREAMS = 200
QUIET_S = 2.0
FLOOD_S = 3.0


class DashboardTest(ProgramTest):
    def setUp(self):
        super().setUp()
        # Space for the connections of a crowd, in this program and in its children.
        hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, hard), hard))

    def start(self, *arguments, realtime=False):
        """A daemon that is idle, and a dashboard that shows it."""
        self.start_idle_daemon(realtime)
        dashboard = self.start_dashboard(*arguments)
        self.wait_for(lambda: dashboard.get("/api/status")[0] == 200, "a status")
        return dashboard

    def start_idle_daemon(self, realtime=False):
        ordinary = ["--without-realtime"] if realtime_permitted() and not realtime else []
        self.daemon = self.start_daemon(*ordinary)
        self.wait_for_state("Idle")

    def start_dashboard(self, *arguments):
        dashboard = Dashboard(self.folder, *arguments)
        self.addCleanup(dashboard.end)
        return dashboard

    def wait_for(self, true_of, what, within_s=WITHIN_S):
        end = time.monotonic() + within_s
        while not (found := true_of()):
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.02)
        return found

    def arm(self, dashboard):
        """The arm must have been at rest for half a second."""
        self.wait_for(lambda: dashboard.command("arm")[0] == 200, "armed")


class WhoMayDoWhat(DashboardTest):
    def test_without_allow_control_it_is_read_only_and_for_this_page_and_programs_here(self):
        dashboard = self.start()
        self.assertNotIn("token", dashboard.url)
        self.assertFalse(dashboard.json("/api/about")["control"])
        self.assertEqual(dashboard.json("/api/status")["state"], "Idle")
        for headers in ({}, {"Authorization": "Bearer "}, {"Authorization": "Bearer x"}):
            status, answer = dashboard.command("arm", **headers)
            self.assertEqual((status, answer["ok"]), (403, False))
            self.assertIn("read only", answer["error"])
        self.assertEqual(dashboard.json("/api/status")["state"], "Idle")
        for path in ("/", "/main.js", "/api/status", "/api/about", "/api/explain", "/api/stream"):
            self.assertEqual(dashboard.get(path, Host=f"rig.example:{dashboard.port}")[0], 403, path)
        for path in ("/api/status", "/api/stream"):
            self.assertEqual(dashboard.get(path, Origin="http://rig.example")[0], 403, path)
            self.assertEqual(dashboard.get(path, **{"Sec-Fetch-Site": "cross-site"})[0], 403, path)
        self.assertEqual(dashboard.get("/api/status", Origin=f"http://127.0.0.1:{dashboard.port}")[0], 200)
        with dashboard.connection() as connection:
            connection.request("GET", "/")
            reply = connection.getresponse()
            for name, value in (("X-Content-Type-Options", "nosniff"), ("Cache-Control", "no-store"),
                                ("X-Frame-Options", "DENY")):
                self.assertEqual(reply.headers[name], value)
            policy = reply.headers["Content-Security-Policy"]
            self.assertIn("default-src 'none'", policy)
            self.assertNotIn("unsafe", policy)
            self.assertIsNone(reply.headers["Access-Control-Allow-Origin"])
        self.assertEqual(dashboard.ask("POST", "/api/status")[0], 405)
        self.assertEqual(dashboard.ask("OPTIONS", "/api/command")[0], 405)
        self.assertEqual(dashboard.get("/../etc/passwd")[0], 404)

    def test_a_command_needs_token_origin_host_and_type(self):
        dashboard = self.start("--allow-control")
        own = f"http://127.0.0.1:{dashboard.port}"
        cases = (
                (401, {"Authorization": None}),
                (401, {"Authorization": "Bearer " + "0" * 64}),
                (401, {"Authorization": f"Bearer {dashboard.token}0"}),
                (401, {"Authorization": f"Basic {dashboard.token}"}),
                (403, {"Origin": None}),
                (403, {"Origin": "null"}),
                (403, {"Origin": "http://rig.example"}),
                (403, {"Origin": f"http://localhost:{dashboard.port}"}),
                (403, {"Host": "rig.example"}),
                (403, {"Host": f"rig.example:{dashboard.port}", "Origin": f"http://rig.example:{dashboard.port}"}),
                (403, {"Host": "127.0.0.1"}),
                (403, {"Sec-Fetch-Site": "cross-site"}),
                (415, {"Content-Type": None}),
                (415, {"Content-Type": "text/plain"}),
                (415, {"Content-Type": "application/x-www-form-urlencoded"}))
        with ThreadPoolExecutor(8) as pool:  # a wrong token is answered after a second
            answers = list(pool.map(lambda case: dashboard.command("arm", **case[1]), cases))
        for (status, headers), (told, answer) in zip(cases, answers):
            with self.subTest(**headers):
                self.assertEqual((told, answer["ok"]), (status, False), answer)
        self.assertEqual(dashboard.json("/api/status")["state"], "Idle")
        self.assertEqual(dashboard.json("/api/about")["wrong_tokens"], 4)
        self.assertIn("no token or a wrong one", dashboard.errors())
        self.assertNotIn(dashboard.token, dashboard.errors())
        self.arm(dashboard)
        for host in (f"localhost:{dashboard.port}", f"[::1]:{dashboard.port}"):
            told, answer = dashboard.command("stop", Host=host, Origin=f"http://{host}")
            self.assertIn(told, (200, 409), answer)  # 409: the daemon has nothing to stop
            self.assertIn("state", answer)
        self.assertEqual(dashboard.command("disarm", Origin=own)[0], 200)

    def test_wrong_tokens_are_answered_late_and_hold_up_no_stop(self):
        dashboard = self.start("--allow-control")
        begun = time.monotonic()
        self.assertEqual(dashboard.command("arm", Authorization="Bearer guess")[0], 401)
        self.assertGreater(time.monotonic() - begun, 0.9)  # a second, less the clock's grain
        body = b'{"command":"arm"}'
        guess = (f"POST /api/command HTTP/1.1\r\nHost: 127.0.0.1:{dashboard.port}\r\n"
                 f"Origin: http://127.0.0.1:{dashboard.port}\r\nContent-Type: application/json\r\n"
                 f"Authorization: Bearer guess\r\nContent-Length: {len(body)}\r\n\r\n").encode() + body
        with contextlib.ExitStack() as stack:
            guesses = [stack.enter_context(dashboard.socket()) for _ in range(100)]
            for one in guesses:
                one.sendall(guess)
            self.assertIn(dashboard.command("stop")[0], (200, 409))
            firsts = [one.recv(64).split(b" ")[1] for one in guesses]
        # 32 wait (kMostDelayed), the others are turned away; a late one may have a free place.
        self.assertLessEqual(firsts.count(b"401"), 64)
        self.assertEqual(firsts.count(b"401") + firsts.count(b"429"), 100)

    def test_a_token_file_is_used_and_never_printed(self):
        token = self.folder / "token"
        token.write_text("0123456789abcdefghij\n", encoding="utf-8")
        token.chmod(0o644)
        refused = self.run_program("flexarm", "dashboard", "--allow-control", "--token-file", token)
        self.assert_refused(refused, "chmod 600")
        token.chmod(0o600)
        for arguments, said in (
                (["--token-file", token], "allow-control"),
                (["--bind", "0.0.0.0"], "every address"),
                (["--bind", "192.0.2.7"], "ssh -L"),
                (["--bind", "192.0.2.7", "--allow-control"], "--token-file"),
                (["--bind", "rig.example"], "no address"),
                (["--port", "65536"], "port"),
                (["--period", "nan"], "period"),
                (["--experiments", self.folder / "none"], "folder")):
            self.assert_refused(self.run_program("flexarm", "dashboard", *arguments), said)
        dashboard = self.start("--allow-control", "--token-file", token)
        self.assertNotIn("token", dashboard.url)
        dashboard.token = "0123456789abcdefghij"
        self.arm(dashboard)
        self.assertEqual(dashboard.command("disarm")[0], 200)

    def test_what_other_computers_reach_needs_the_token_for_values_too(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.connect(("192.0.2.1", 9))  # sends nothing: asks which address would
            except OSError:
                self.skipTest("this computer has no address but its own")
            address = probe.getsockname()[0]
        token = self.folder / "token"
        token.write_text("0123456789abcdefghij\n", encoding="utf-8")
        token.chmod(0o600)
        self.start_idle_daemon()
        dashboard = self.start_dashboard("--allow-control", "--token-file", token, "--bind", address)
        self.assertIn("not encrypted", dashboard.errors())
        dashboard.token, dashboard.address = "0123456789abcdefghij", address
        with_token = {"Authorization": f"Bearer {dashboard.token}"}
        self.wait_for(lambda: dashboard.get("/api/status", **with_token)[0] == 200, "a status")
        for path in ("/api/status", "/api/stream", "/api/about", "/api/explain"):
            self.assertEqual(dashboard.get(path)[0], 401, path)
        self.assertEqual(dashboard.get("/")[0], 200, "the page, which asks for the token")
        self.assertEqual(dashboard.get("/api/status", Host=f"localhost:{dashboard.port}", **with_token)[0], 403)


class Requests(DashboardTest):
    def test_an_experiment_is_started_watched_and_stopped(self):
        (self.folder / "experiments").mkdir()
        (self.folder / "experiments/long.toml").write_text(LONG, encoding="utf-8")
        (self.folder / "experiments/note.txt").touch()
        dashboard = self.start("--allow-control", "--experiments", self.folder / "experiments")
        self.assertEqual(dashboard.json("/api/about")["experiments"], ["long.toml"])
        self.arm(dashboard)
        status, answer = dashboard.command("run", experiment="long.toml")
        self.assertEqual((status, answer["state"]), (200, "Running"), answer)
        with Stream(dashboard) as stream:
            status = stream.wait_for(lambda s: s["run"] and s["run"]["elapsed_s"] > 0.2)
            self.assertEqual(status["run"]["name"], "long")
            self.assertIsNotNone(status["reference_deg"])
            self.assertEqual(len(status["link_tip_slope_per_m"][1]), 2)
            self.assertEqual(dashboard.command("stop")[0], 200)
            stream.wait_for(lambda s: s["state"] == "Armed" and s["run"]["outcome"] == "stopped")
            status, answer = dashboard.command("move", to_deg=[2.0, -1.0])
            self.assertEqual(status, 200, answer)
            stream.wait_for(lambda s: s["state"] == "Armed" and s["run"]["outcome"] == "done")
            self.assertEqual(dashboard.command("sim", line="emergency-stop", level=0)[0], 200)
            status = stream.wait_for(lambda s: s["state"] == "Tripped")
        explained = {row["name"]: row for row in dashboard.json("/api/explain")["trips"]}
        self.assertTrue(explained[status["trip"]["name"]]["remedy"])

    def test_huge_and_odd_requests_are_refused_and_leave_it_as_it_is(self):
        dashboard = self.start("--allow-control")
        host = f"Host: 127.0.0.1:{dashboard.port}\r\n"
        big = "x" * 60_000
        for request, status in (
                (f"GET / HTTP/1.1\r\n{host}X: {big}\r\n\r\n", ("431", "400", "413")),
                (f"GET /{big} HTTP/1.1\r\n{host}\r\n", ("414", "431", "400")),
                (f"GET / HTTP/1.1\r\n{host}{host}\r\n", ("400",)),
                ("GET / HTTP/1.1\r\n\r\n", ("400", "403")),
                (f"POST /api/command HTTP/1.1\r\n{host}Content-Length: 99999999999\r\n\r\n", ("413",)),
                (f"POST /api/command HTTP/1.1\r\n{host}Content-Length: -1\r\n\r\n", ("400", "413")),
                (f"POST /api/command HTTP/1.1\r\n{host}Transfer-Encoding: chunked\r\n\r\n", ("411",)),
                (f"BREW / HTTP/1.1\r\n{host}\r\n", ("405",)),
                ("\r\n\r\n\x00\xff{}\r\n\r\n", ("400", ""))):
            with self.subTest(request=request[:60]), dashboard.socket() as client:
                line = ""
                with contextlib.suppress(ConnectionError, OSError):  # it has closed a huge one already
                    client.sendall(request.encode("latin-1"))
                    client.shutdown(socket.SHUT_WR)
                with contextlib.suppress(ConnectionError):
                    line = client.makefile("rb").readline().decode("latin-1")
                self.assertIn((line.split(" ") + [""])[1] if line else "", status, line)
        for body in ("", "{", "[]", '{"command":"zero"}', '{"command":"run","experiment":"../hil.toml"}',
                     "[" * 4000):
            status, answer = dashboard.post(body)
            self.assertEqual((status, answer["ok"]), (400, False), body[:60])
        self.assertEqual(dashboard.post("x" * 5000)[0], 413)
        self.assertEqual(dashboard.json("/api/status")["state"], "Idle")

    def test_it_ends_at_a_signal_with_streams_open_and_a_command_under_way(self):
        dashboard = self.start("--allow-control")
        with Stream(dashboard) as stream, dashboard.socket() as client:
            stream.event()
            self.daemon.send_signal(signal.SIGSTOP)  # it does not answer
            body = '{"command":"arm"}'
            client.sendall((f"POST /api/command HTTP/1.1\r\nHost: 127.0.0.1:{dashboard.port}\r\n"
                            f"Origin: http://127.0.0.1:{dashboard.port}\r\n"
                            "Content-Type: application/json\r\n"
                            f"Authorization: Bearer {dashboard.token}\r\n"
                            f"Content-Length: {len(body)}\r\n\r\n{body}").encode())
            time.sleep(0.2)
            begun = time.monotonic()
            dashboard.process.terminate()
            self.assertEqual(dashboard.process.wait(timeout=10), 0)
            self.assertLess(time.monotonic() - begun, 5.0)  # the daemon has 10 s for an answer


class ManyClients(DashboardTest):
    def sockets_of_daemon(self):
        """The least in half a second: a client that has just asked for the status is not counted."""
        def now():
            found = 0
            for fd in Path(f"/proc/{self.daemon.pid}/fd").iterdir():
                with contextlib.suppress(FileNotFoundError):
                    found += os.readlink(fd).startswith("socket:")
            return found
        counts = []
        for _ in range(10):
            counts.append(now())
            time.sleep(0.05)
        return min(counts)

    def test_the_daemon_has_one_connection_however_many_watch(self):
        self.start_idle_daemon()
        before = self.sockets_of_daemon()
        dashboard = self.start_dashboard()
        with contextlib.ExitStack() as stack:
            streams = [stack.enter_context(Stream(dashboard)) for _ in range(MOST_STREAMS)]
            for stream in streams:
                stream.event()
            self.assertEqual(self.sockets_of_daemon(), before + 1)
            self.assertEqual(dashboard.json("/api/about")["streams"], MOST_STREAMS)
            status, answer = dashboard.get("/api/stream")
            self.assertEqual(status, 503)
            self.assertIn("too many browsers", json.loads(answer)["error"])
        self.wait_for(lambda: dashboard.json("/api/about")["streams"] == 0, "no stream is left")

    def test_a_client_that_does_not_read_delays_no_other_and_skips(self):
        dashboard = self.start()
        with contextlib.ExitStack() as stack:
            slow = [stack.enter_context(dashboard.socket(receive_bytes=4096)) for _ in range(30)]
            for one in slow:
                one.sendall(f"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{dashboard.port}\r\n\r\n".encode())
            quick = stack.enter_context(Stream(dashboard))
            quick.event()
            begun_mb = dashboard.resident_mb()
            times = [quick.status()["time_s"] for _ in range(25)]
            # The period is 0.1 s, of the daemon's clock; a stall of the machine delays one of them.
            self.assertLess(times[-1] - times[0], 25 * 0.1 + 3.0)
            self.assertLess(dashboard.resident_mb() - begun_mb, 8.0)
            # What lay in the buffers of the system, then what is new: it does not follow years behind.
            behind = Stream(dashboard, slow[0])
            newest = behind.wait_for(lambda s: s["time_s"] >= times[-1], within_s=10)
            self.assertLess(behind.events, 50, newest["time_s"])

    def test_silent_connections_end_and_do_not_keep_commands_out(self):
        dashboard = self.start("--allow-control")
        with contextlib.ExitStack() as stack:
            for k in range(520):  # more than kMostConnections
                client = stack.enter_context(dashboard.socket())
                client.sendall(b"" if k % 2 else b"GET / HT")
            self.wait_for(lambda: dashboard.get("/")[0] == 503, "a clear refusal")
            self.assertIn(dashboard.command("stop")[0], (200, 409))
        self.wait_for(lambda: dashboard.get("/")[0] == 200, "free again")

    def test_it_follows_a_daemon_that_ends_and_comes_back(self):
        self.start_idle_daemon()
        dashboard = self.start_dashboard("--allow-control")
        with Stream(dashboard) as stream:
            self.assertEqual(stream.status()["state"], "Idle")
            self.end_daemons()
            name, data = stream.wait_for_event("gone")
            self.assertIn("start flexarmd", data["error"])
            self.assertEqual(dashboard.get("/api/status")[0], 502)
            status, answer = dashboard.command("stop")
            self.assertEqual((status, answer["ok"]), (502, False))
            self.start_idle_daemon()
            stream.wait_for(lambda s: s["state"] == "Idle")
        self.assertEqual(dashboard.json("/api/status")["state"], "Idle")


def processor_s(pid):
    """What a process has used of the processors since its start."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Flood(DashboardTest):
    def counts(self, dashboard):
        """Missed deadlines and skipped periods of the threads of the loop, so far."""
        names = ("safety", "control") if realtime_permitted() else ()
        threads = {t["name"]: t for t in dashboard.json("/api/status")["threads"]}
        return {name: threads[name]["missed_deadlines"] + threads[name]["skipped_periods"]
                for name in names}

    def watched_for(self, seconds, dashboard, streams):
        """Reads the streams. How often the threads were late, what the machine alone explains, the
        share of a processor that dashboard and daemon took, and the bytes that came."""
        before, pids, read = self.counts(dashboard), (dashboard.process.pid, self.daemon.pid), 0
        used = [processor_s(pid) for pid in pids]
        with StallWitness() as witness:
            begun = time.monotonic()
            while time.monotonic() < begun + seconds:
                for one in select.select(streams, [], [], 0.05)[0]:
                    got = len(one.recv(65536))
                    self.assertGreater(got, 0, "the stream goes on")
                    read += got
            took = time.monotonic() - begun
            stalls = sum(int(wait) + 1 for wait in witness.waits_ms)
        shares = [(processor_s(pid) - was) / took for pid, was in zip(pids, used)]
        after = self.counts(dashboard)
        return {name: after[name] - before[name] for name in before}, stalls, shares, read

    @despite_stalls
    def test_200_streams_leave_loop_and_safety_as_punctual_as_before(self):
        dashboard = self.start(realtime=True)
        status_bytes = len(dashboard.get("/api/status")[1])
        quiet, quiet_allowed, quiet_shares, _ = self.watched_for(QUIET_S, dashboard, [])
        with contextlib.ExitStack() as stack:
            streams = [stack.enter_context(dashboard.socket()) for _ in range(FLOOD_STREAMS)]
            for one in streams:
                one.sendall(f"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{dashboard.port}\r\n\r\n".encode())
            late, allowed, shares, read = self.watched_for(FLOOD_S, dashboard, streams)
            memory_mb = dashboard.resident_mb()
        each_per_s = read / FLOOD_STREAMS / status_bytes / FLOOD_S
        print(f"{FLOOD_STREAMS} streams: late before {quiet} in {QUIET_S:.0f} s (the machine:"
              f" {quiet_allowed}), during {late} in {FLOOD_S:.0f} s (the machine: {allowed});"
              f" {each_per_s:.1f} statuses a second each, of {status_bytes} bytes; dashboard"
              f" {100 * quiet_shares[0]:.1f} % of a processor before, {100 * shares[0]:.1f} % during,"
              f" {memory_mb:.0f} MB; daemon {100 * quiet_shares[1]:.1f} %, {100 * shares[1]:.1f} %",
              file=sys.stderr)
        self.assertGreater(each_per_s * FLOOD_S, 1.0, "each has got a status")
        for name, count in late.items():  # twice as often as before, as tests/e2e/flood_test.py
            per_s = max(quiet[name], 1) / QUIET_S
            self.assertLessEqual(count, 2 * per_s * FLOOD_S + 2 * allowed + 5, name)


if __name__ == "__main__":
    unittest.main()
