#!/usr/bin/env python3
"""The page of `flexarm dashboard` in headless Chromium, as an operator uses it: an experiment is
started, watched and stopped; a trip is explained; on a phone; with the keyboard alone; without
motion and colours. The pictures are in build/browser and are looked at here and by people."""

import signal
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "e2e"))
# pylint: disable=wrong-import-position
from dashboard_client import Dashboard
from page import Page
from program import ROOT, ProgramTest, doublet, realtime_permitted
from selenium.webdriver.common.keys import Keys

# A wide motion that goes on: the arm is seen to move, and a stop is what ends it.
LONG = doublet("long", 60.0, move_deg=20.0) + """
[[move]]
start_s = 3.0
to_deg = [25.0, -35.0]
duration_s = 2.0
"""
BLUE, ORANGE = (0, 114, 178), (180, 83, 0)  # --blue and --orange of dashboard.css


class DashboardPage(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.page = Page(ROOT / "build/browser")

    @classmethod
    def tearDownClass(cls):
        cls.page.close()

    def start(self, *arguments):
        self.start_idle_daemon()
        (self.folder / "experiments").mkdir(exist_ok=True)
        (self.folder / "experiments/long.toml").write_text(LONG, encoding="utf-8")
        self.dashboard = Dashboard(self.folder, "--experiments", self.folder / "experiments", *arguments)
        self.addCleanup(self.dashboard.end)
        self.page.prefer(prefers_color_scheme="light", prefers_reduced_motion="no-preference")
        return self.dashboard

    def start_idle_daemon(self):
        self.daemon = self.start_daemon(*(["--without-realtime"] if realtime_permitted() else []))
        self.wait_for_state("Idle")

    def open(self, *arguments, **view):
        self.page.open(self.dashboard.url, *arguments, **view)
        self.page.wait_for_text("#freshness", "live")

    def arm(self):
        """By the page. The arm must have been at rest for half a second."""
        for _ in range(100):
            self.page.click("[data-command=arm]")
            time.sleep(0.3)
            if self.page.text("#state-name") == "Armed":
                return
        self.fail(self.page.text("#controls"))

    def run_long(self):
        self.arm()
        self.page.click("#run-form button")
        self.page.wait_for_text("#state-name", "Running")

    def curve_points(self, number):
        return self.page.run("return document.querySelectorAll('.plot-measured')[arguments[0]]"
                             ".getAttribute('d').split(/[ML]/).length - 1", number)

    def test_an_experiment_is_started_watched_and_stopped(self):
        self.start("--allow-control")
        self.open()
        self.assertNotIn("token", self.page.run("return location.href"))
        self.assertEqual(self.page.text("#state-name"), "Idle")
        self.run_long()
        self.assertIn("long", self.page.text("#state-what"))
        shapes = set()
        for _ in range(20):
            shapes.add(self.page.run("return document.querySelectorAll('.arm-link')[1].getAttribute('d')"))
            time.sleep(0.1)
        self.assertGreater(len(shapes), 10, "the arm moves")
        self.assertGreater(self.curve_points(0), 15)
        self.assertIn("reference", self.page.text(".plot figcaption"))
        self.page.run("scrollTo(0, 0)")
        picture = self.page.picture("running")
        self.assertGreater(len(picture.colours()), 50)
        arm = self.page.picture("arm", "#arm")
        self.assertGreater(arm.share(BLUE), 0.005, "the links")
        plot = self.page.picture("plot", ".plot svg")
        self.assertGreater(plot.share(BLUE), 0.002, "measured")
        self.assertGreater(plot.share(ORANGE), 0.0005, "the reference")
        strain = self.page.picture("strain", "#strain")
        self.assertGreater(len(strain.colours()), 10)
        self.assertEqual(self.page.run("return document.querySelectorAll('#strain .bar').length"), 22)
        self.page.click("#stop")
        self.page.wait_for_text("#answers", "stop: ok")
        self.page.wait_for(lambda: self.page.text("#state-name") in ("Stopping", "Armed"), "stops")
        self.page.wait_for_text("#state-name", "Armed")
        self.page.wait_for_text("#run", "stopped")
        self.assertEqual(self.wait_for_state("Armed")["run"]["outcome"], "stopped")
        self.page.click("[data-command=disarm]")
        self.page.wait_for_text("#state-name", "Idle")
        self.assertEqual(self.page.complaints(), [])

    def test_a_trip_is_explained_and_reset(self):
        self.start("--allow-control")
        self.open()
        self.assertFalse(self.page.shown("#trips"))
        self.arm()
        self.page.click("[data-sim='emergency-stop,0']")
        self.page.wait_for_text("#state-name", "Tripped")
        self.page.wait_for_text("#trips", "TRIP: emergency-stop")
        for text in ("what happened", "check", "what to do", "present: emergency-stop"):
            self.assertIn(text, self.page.text("#trips"))
        self.assertIn("OPEN", self.page.text("#lamps"))
        self.page.picture("tripped")
        self.page.click("[data-command=reset]")  # too early: the daemon says why
        self.page.wait_for_text("#answers", "reset: ")
        self.page.click("[data-sim='emergency-stop,1']")
        self.page.wait_for(lambda: "present" not in self.page.text("#trips"), "gone")
        self.page.click("[data-sim='reset-button']")
        for _ in range(50):
            self.page.click("[data-command=reset]")
            time.sleep(0.3)
            if self.page.text("#state-name") == "Idle":
                break
        self.page.wait_for_text("#state-name", "Idle")
        self.page.wait_for(lambda: not self.page.shown("#trips"), "no trip is shown")

    def test_on_a_phone_nothing_needs_a_horizontal_scroll(self):
        self.start("--allow-control")
        self.open(360, 740, mobile=True)
        self.run_long()
        time.sleep(1.0)
        widths = self.page.run("return [document.documentElement.scrollWidth, innerWidth]")
        self.assertLessEqual(widths[0], 360)
        self.assertEqual(widths[1], 360)
        outside = self.page.run("""
            return [...document.querySelectorAll("main *, header *")].filter((e) => {
              const box = e.getBoundingClientRect();
              return e.checkVisibility() && !e.closest("svg, .sr") && box.width && box.right > 361;
            }).map((e) => e.outerHTML.slice(0, 80));""")
        self.assertEqual(outside, [])
        self.page.picture("phone-top")
        self.page.run("scrollTo(0, document.body.scrollHeight)")
        box = self.page.run("const b = document.getElementById('stop').getBoundingClientRect();"
                            "return [b.top, b.bottom, b.left, b.right, b.height]")
        self.assertGreaterEqual(box[0], 0)
        self.assertLessEqual(box[1], 740)
        self.assertGreaterEqual(box[4], 44, "a finger hits it")
        small = self.page.run("""
            return [...document.querySelectorAll("button, select, input:not([type=checkbox])")].filter((e) =>
              e.checkVisibility() && e.getBoundingClientRect().height < 40).map((e) => e.outerHTML);""")
        self.assertEqual(small, [])
        self.page.run("scrollTo(0, 0)")
        height = self.page.run("return document.body.scrollHeight")
        self.page.resize(360, height, mobile=True)
        time.sleep(0.5)
        self.page.picture("phone")
        self.page.click("#stop")
        self.page.wait_for_text("#state-name", "Armed")

    def test_everything_is_reached_with_the_keyboard_and_space_stops(self):
        self.start("--allow-control")
        self.open()
        self.page.tab_to("stop")
        outline = self.page.run("return getComputedStyle(document.activeElement).outlineStyle")
        self.assertEqual(outline, "solid", "the focus is seen")
        for _ in range(100):  # until it is at rest
            self.page.tab_to("Arm")
            self.page.keys(Keys.ENTER)
            time.sleep(0.3)
            if self.page.text("#state-name") == "Armed":
                break
        for stop in (Keys.SPACE, Keys.ESCAPE):
            self.page.tab_to("Start")
            self.page.keys(Keys.ENTER)
            self.page.wait_for_text("#state-name", "Running")
            self.page.keys(stop)  # on the button Start: it stops and does not start again
            self.page.wait_for_text("#state-name", "Armed")
        self.page.tab_to("move-1")
        self.page.keys(Keys.CONTROL + "a" + Keys.CONTROL, "4", Keys.ENTER)
        self.page.wait_for_text("#run", "move: done")
        self.assertAlmostEqual(self.wait_for_state("Armed")["joint_angle_deg"][0], 4.0, delta=1.0)
        self.page.tab_to("J1 +")
        self.page.keys(Keys.ENTER)
        self.page.wait_for(lambda: self.wait_for_state("Armed", "Running", "Stopping")
                           ["joint_angle_deg"][0] > 7.0, "it jogs by 5 degrees")
        names = self.page.run("""
            return [...document.querySelectorAll("button, select, input")].filter((e) =>
              e.checkVisibility() && !(e.innerText || e.labels?.length || e.getAttribute("aria-label")))
              .map((e) => e.outerHTML);""")
        self.assertEqual(names, [], "each has a label")

    def test_without_control_it_shows_and_offers_nothing(self):
        self.start()
        self.page.prefer(prefers_color_scheme="dark", prefers_reduced_motion="reduce")
        self.open()
        self.assertFalse(self.page.shown("#controls"))
        self.assertFalse(self.page.shown("#stop"))
        self.assertIn("read only", self.page.text("#control-mode"))
        self.page.keys(Keys.ESCAPE)
        time.sleep(0.5)
        picture = self.page.picture("dark")
        self.assertGreater(picture.share((20, 23, 26)), 0.1, "--paper of dashboard.css when dark")
        moving = self.page.run("return getComputedStyle(document.querySelector('.bar-fill')).transitionDuration")
        self.assertEqual(moving, "0s")

    def test_a_token_can_be_typed_and_a_wrong_one_is_told(self):
        token = self.folder / "token"
        token.write_text("0123456789abcdefghij\n", encoding="utf-8")
        token.chmod(0o600)
        self.start("--allow-control", "--token-file", token)
        self.page.open(self.dashboard.url)
        self.page.run("sessionStorage.clear()")
        self.open()
        self.page.wait_for(lambda: self.page.shown("#token"), "asks for the token")
        self.assertFalse(self.page.shown("#stop"))
        self.page.click("#token")
        self.page.keys("a wrong one of 20 or more", Keys.ENTER)
        self.page.click("[data-command=arm]")
        self.page.wait_for_text("#answers", "the token is wrong")
        self.page.wait_for(lambda: self.page.shown("#token"), "asks again")
        self.page.click("#token")
        self.page.keys("0123456789abcdefghij", Keys.ENTER)
        self.arm()

    def test_old_values_are_told_and_live_ones_come_back_by_themselves(self):
        self.start("--allow-control")
        self.open()
        self.end_daemons()
        self.page.wait_for_text("#alarm", "NO LIVE VALUES")
        self.page.wait_for_text("#freshness", "OLD")
        self.page.wait_for_text("#alarm", "start flexarmd")
        self.page.picture("gone")
        self.start_idle_daemon()
        self.page.wait_for_text("#freshness", "live")
        self.assertFalse(self.page.shown("#alarm"))
        self.dashboard.process.send_signal(signal.SIGSTOP)  # it says nothing any more
        self.page.wait_for_text("#freshness", "OLD")
        self.dashboard.process.send_signal(signal.SIGCONT)
        self.page.wait_for_text("#freshness", "live")
        self.dashboard.end()
        self.page.wait_for_text("#alarm", "the server does not answer")
        self.page.keys(Keys.ESCAPE)
        self.page.wait_for_text("#stop-answer", "NOT SENT")


if __name__ == "__main__":
    unittest.main()
