"""The page of `flexarm dashboard` in headless Chromium."""

import os
import struct
import time
import zlib
from pathlib import Path

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

WITHIN_S = 30.0
CHROMIUM = os.environ.get("FLEXARM_CHROMIUM", "/usr/bin/chromium")
DRIVER = os.environ.get("FLEXARM_CHROMEDRIVER", "/usr/bin/chromedriver")


class Page:
    """One browser with one page."""

    def __init__(self, pictures):
        self.pictures = pictures
        pictures.mkdir(parents=True, exist_ok=True)
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu",
                         "--disable-dev-shm-usage", "--hide-scrollbars"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.driver.set_script_timeout(WITHIN_S)

    def close(self):
        self.driver.quit()

    def open(self, url, width=1400, height=1000, mobile=False):
        self.resize(width, height, mobile)
        self.driver.get(url)

    def resize(self, width, height, mobile=False):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})

    def prefer(self, **features):
        """Features of the system as CSS asks for them: prefers_color_scheme="dark"."""
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [
            {"name": name.replace("_", "-"), "value": value} for name, value in features.items()]})

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0])?.innerText ?? ''", selector)

    def shown(self, selector):
        return self.run("return document.querySelector(arguments[0])?.checkVisibility() ?? false",
                        selector)

    def wait_for(self, true_of, what, within_s=WITHIN_S):
        end = time.monotonic() + within_s
        while not (found := true_of()):
            if time.monotonic() > end:
                raise AssertionError(f"not within {within_s} s: {what}\n{self.text('body')}")
            time.sleep(0.05)
        return found

    def wait_for_text(self, selector, text, within_s=WITHIN_S):
        return self.wait_for(lambda: text in self.text(selector), f"{text!r} in {selector}", within_s)

    def click(self, selector):
        """As a user who has scrolled to it."""
        element = self.driver.find_element(By.CSS_SELECTOR, selector)
        self.run("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    def keys(self, *keys):
        """To the element that has the focus."""
        self.driver.switch_to.active_element.send_keys(*keys)

    def focused(self):
        """What a user of the keyboard would say has the focus: its id, text or label."""
        return self.run("""
            const e = document.activeElement;
            return e === document.body ? "" : e.id || e.innerText || e.getAttribute("aria-label");""")

    def tab_to(self, name, most=60):
        """Presses Tab until the element of that id or text has the focus."""
        for _ in range(most):
            if self.focused() == name:
                return
            self.keys(Keys.TAB)
        raise AssertionError(f"Tab does not reach {name}")

    def complaints(self):
        """What the browser has logged since the last call: errors of scripts, what the policy has
        blocked; not answers such as 409, which are told on the page."""
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] in ("SEVERE", "WARNING") and entry["source"] != "network"]

    def picture(self, name, selector=None):
        """Stores a picture of the page, or of an element, and returns it."""
        file = self.pictures / f"{name}.png"
        if selector is None:
            self.driver.save_screenshot(str(file))
        else:
            element = self.driver.find_element(By.CSS_SELECTOR, selector)
            self.run("arguments[0].scrollIntoView({block: 'center'})", element)
            element.screenshot(str(file))
        return Picture(file)


class Picture:
    """The pixels of a PNG file as the browser writes it: 8 bits a channel, RGB or RGBA."""

    def __init__(self, file: Path):
        data = file.read_bytes()
        packed = b""
        at = 8
        while at < len(data):
            length, kind = struct.unpack(">I4s", data[at:at + 8])
            if kind == b"IHDR":
                self.width, self.height, depth, colour = struct.unpack(">IIBB", data[at + 8:at + 18])
            if kind == b"IDAT":
                packed += data[at + 8:at + 8 + length]
            at += length + 12
        assert depth == 8 and colour in (2, 6), (depth, colour)
        self.channels = 3 if colour == 2 else 4
        self.rows = self._unfiltered(zlib.decompress(packed))

    def _unfiltered(self, raw):
        size, step = self.width * self.channels, self.channels
        rows, before = [], bytes(size)
        for y in range(self.height):
            kind = raw[y * (size + 1)]
            row = bytearray(raw[y * (size + 1) + 1:(y + 1) * (size + 1)])
            for i in range(size if kind else 0):
                left = row[i - step] if i >= step else 0
                up, corner = before[i], before[i - step] if i >= step else 0
                row[i] = (row[i] + (left, up, (left + up) // 2,
                                    paeth(left, up, corner))[kind - 1]) & 0xFF
            before = bytes(row)
            rows.append(before)
        return rows

    def colours(self):
        """How often each colour (red, green, blue) is there."""
        counts = {}
        for row in self.rows:
            for x in range(0, len(row), self.channels):
                colour = tuple(row[x:x + 3])
                counts[colour] = counts.get(colour, 0) + 1
        return counts

    def share(self, colour, within=12):
        """The share of the pixels whose channels differ by so much at most."""
        near = sum(count for other, count in self.colours().items()
                   if max(abs(a - b) for a, b in zip(colour, other)) <= within)
        return near / (self.width * self.height)


def paeth(left, up, corner):
    estimate = left + up - corner
    return min((left, up, corner), key=lambda value: abs(estimate - value))
