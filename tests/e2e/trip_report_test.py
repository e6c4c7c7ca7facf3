#!/usr/bin/env python3
"""The report that the daemon writes of every trip, and the same page made from a log."""

import contextlib
import html.parser
import json
import re
import signal
import subprocess
import time
import unittest
from pathlib import Path

from program import HIL, ProgramTest, doublet, in_real_time

SMALL = ("--set", "log.reserve_mb=1", "--set", "log.keep_free_mb=0")
VOID = {"meta", "img", "input"}
SECTIONS = ("What happened", "What to check, and how to continue", "Chain of causes",
            "Signals of the last 10 s", "Timing of the threads", "Buses", "Commands and events",
            "Config changes since the last good run", "The log and the program")


class Page(html.parser.HTMLParser):
    """Checks that tags are closed in order; collects headings, rows of tables, and what is loaded."""

    def __init__(self, text):
        super().__init__()
        self.open, self.headings, self.rows, self.loads, self.charts = [], [], [], [], 0
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        self.loads += [(tag, value) for key, value in attributes
                       if key in ("src", "href", "xlink:href") and not value.startswith("#")]
        self.charts += tag == "svg"
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)
        if self.open and self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data


class TripReport(ProgramTest):
    def arm(self):
        self.wait_for_state("Idle")
        time.sleep(0.8)  # at rest means half a second of rest
        self.operate("arm")
        self.wait_for_state("Armed")

    def status(self):
        return json.loads(self.operate("status", "--json").stdout)

    def wait_for_report(self, within_s=20):
        """The report comes when the log of the trip is closed, 5 s after it."""
        end = time.monotonic() + within_s
        while time.monotonic() < end:
            if report := self.status()["trip"]["report"]:
                return report
            time.sleep(0.1)
        self.fail(f"no report\n{self.daemon_log()}")

    def reset(self, line):
        self.operate("sim", line, "1")
        time.sleep(0.8)
        self.operate("sim", "reset-button", "1")
        time.sleep(0.1)
        self.operate("sim", "reset-button", "0")
        self.operate("reset")
        self.wait_for_state("Idle")

    def page(self, file, cause):
        text = Path(file).read_text(encoding="utf-8")
        page = Page(text)
        self.assertEqual(page.loads, [], "it needs no other file and no network")
        self.assertIsNone(re.search(r"https?:|url\(|@import|<script", text))
        for section in SECTIONS:
            self.assertIn(section, page.headings)
        self.assertGreaterEqual(page.charts, 15)
        self.assertIn(cause, page.rows[1][1])
        advice = self.flexarm_json("explain", cause)["trips"][0]
        self.assertIn([cause, advice["check"], advice["remedy"]], page.rows)
        return page

    @in_real_time
    def test_a_trip_in_each_state_has_its_page_and_status_names_it(self):
        self.start_daemon(*SMALL)
        seen = []
        for state, line, cause in (("Running", "limit-1-high", "limit-switch-1-high"),
                                   ("Armed", "emergency-stop", "emergency-stop"),
                                   ("Idle", "limit-2-low", "limit-switch-2-low")):
            self.wait_for_state("Idle")
            if state != "Idle":
                self.arm()
            if state == "Running":
                self.operate("run", self.experiment(doublet("<b>moved</b>", 20.0)))
                self.wait_for_state("Running")
                time.sleep(3.0)  # after the move: an arm whose torque is cut in it coasts far
            self.operate("sim", line, "0")
            tripped = self.wait_for_state("Tripped")
            self.assertIsNone(tripped["trip"]["report"], "not before it is written")
            report = self.wait_for_report()
            self.assertIn(f"report: {report}", self.operate("status").stdout)
            page = self.page(report, cause)
            self.assertIn(["state before", state], page.rows)
            self.assertTrue(any(row[:3] == ["+0.000 s", state, "Tripped"] for row in page.rows))
            self.assertTrue(any(row[:2] == ["replay", row[1]] and "bit exact: yes" in row[1]
                                for row in page.rows if len(row) == 2))
            if state != "Idle":
                self.assertTrue(any("arm by" in row[-1] for row in page.rows if row[1:2] == ["operator"]),
                                "who armed it")
            self.assertTrue(any(row[0] == "safety" for row in page.rows if row), "all threads")
            self.assertNotIn(report, seen)
            seen.append(report)
            self.reset(line)
            self.assertIsNone(self.status()["trip"])
        self.assertEqual(len(list((self.folder / "runs").glob("*.trip.html"))), 3)
        # The same page, made from the log.
        log = seen[0].replace(".trip.html", ".flexarm")
        made = self.folder / "made.html"
        self.flexarm("trip-report", log, "-o", made)
        self.assertEqual(made.read_text(encoding="utf-8"), Path(seen[0]).read_text(encoding="utf-8"))

    @in_real_time
    def test_status_shows_all_present_causes(self):
        self.start_daemon(*SMALL)
        self.arm()
        self.operate("sim", "emergency-stop", "0")
        self.operate("sim", "limit-2-high", "0")
        self.wait_for_state("Tripped")
        time.sleep(0.2)
        text = self.operate("status").stdout
        for cause in ("emergency-stop", "limit-switch-2-high"):
            self.assertRegex(text, rf"present cause +{cause}: value 0.0000, limit 1.0000 level")
        page = self.page(self.wait_for_report(), "emergency-stop")
        later = [row for row in page.rows if row[0] == "limit-switch-2-high" and row[-1] == "later"]
        self.assertEqual(len(later), 1)
        self.assertEqual(later[0][3:6], ["0 (open)", "1 (closed)", "joint 2"])

    @in_real_time
    def test_a_full_disk_is_told_and_the_report_comes_when_there_is_room(self):
        runs = self.folder / "runs"
        runs.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16m", "none", runs],
                                 capture_output=True, text=True, check=False)
        if mounted.returncode != 0:
            self.skipTest(f"no disk of its own: {mounted.stderr}")
        self.addCleanup(subprocess.run, ["umount", "-l", runs], check=True)
        # Less than the log of a trip takes: what is reserved does not let it off.
        self.start_daemon(*SMALL, "--set", "log.reserve_mb=0.1", "--state-dir", self.folder / "state")
        self.arm()
        self.operate("sim", "emergency-stop", "0")
        self.wait_for_state("Tripped")
        self.wait_for_line("recording to")  # from what was reserved for the next run
        filler = runs / "filler"
        with contextlib.suppress(OSError), open(filler, "wb", buffering=0) as file:
            while True:
                file.write(bytes(4096))
        self.wait_for_line("No space left")
        self.reset("emergency-stop")  # nothing else suffers
        filler.unlink()
        self.wait_for_line("trip report: ")
        page, = runs.glob("*.trip.html")
        self.page(page, "emergency-stop")

    @in_real_time
    def test_a_killed_daemon_leaves_a_log_of_which_the_next_makes_the_page(self):
        daemon = self.start_daemon(*SMALL)
        self.arm()
        self.operate("run", self.experiment(doublet("killed", 20.0)))
        self.wait_for_state("Running")
        time.sleep(1.5)
        daemon.send_signal(signal.SIGKILL)
        daemon.wait()
        made = self.folder / "made.html"
        self.flexarm("trip-report", self.only_run(), "-o", made)
        self.page(made, "ended-while-armed")
        (self.folder / "socket").unlink()
        self.start_daemon(*SMALL)
        self.wait_for_state("Tripped")
        self.page(self.wait_for_report(), "ended-while-armed")

    def test_a_log_without_a_trip_is_refused_and_a_file_is_not_replaced(self):
        run, _ = self.simulate("good.flexarm")
        self.assert_refused(self.run_program("flexarm", "trip-report", run), "has no trip")
        switch = doublet("switch", 2.0) + '[[sim_event]]\nat_s = 0.5\nline = "limit-1-high"\nlevel = 0\n'
        tripped = self.folder / "tripped.flexarm"
        self.flexarm("simulate", "-c", HIL, "--set", "limits.soft_angle_deg=[80, 80]", "--experiment",
                     self.experiment(switch), "-o", tripped, expect=1)
        self.flexarm("trip-report", tripped)
        page = self.page(self.folder / "tripped.trip.html", "limit-switch-1-high")
        changed = [row for row in page.rows if row[0] == "limits.soft_angle_deg"]
        self.assertEqual(len(changed), 1, "the good run beside it has another limit")
        self.flexarm("trip-report", tripped)
        self.assertTrue((self.folder / "tripped.trip-2.html").exists())
        other = self.folder / "other.html"
        other.write_text("mine", encoding="utf-8")
        self.assert_refused(self.run_program("flexarm", "trip-report", tripped, "-o", other), "other.html")
        self.assertEqual(other.read_text(encoding="utf-8"), "mine")


if __name__ == "__main__":
    unittest.main()
