#!/usr/bin/python3
"""Opens the report of `evaluate --report` in a browser that has a screen and no network.

Needs chromium, chromedriver, python3-selenium and Xvfb; skips where one of them is missing. Environment:
as for evaluate_report_test.py.
"""
import io
import os
import pathlib
import shutil
import subprocess
import unittest

import numpy
import PIL.Image
from evaluate_report_test import DUAL_ARM, ReportTest
from evaluate_run import CONFIGS

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    webdriver = None

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
TOUCHED = (0xe3, 0x00, 0x1b)
PATIENCE_S = 120
# No network: whatever is asked for goes to a closed port, and no name is known. WebGL by software.
OPTIONS = ("--no-sandbox", "--disable-dev-shm-usage", "--window-size=1366,768", "--window-position=0,0",
           "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--proxy-server=127.0.0.1:9", "--host-resolver-rules=MAP * ~NOTFOUND",
           "--disable-background-networking", "--disable-component-update", "--no-first-run")
ERRORS = """
window.failures = [];
window.addEventListener("error", event => window.failures.push(event.message));
window.addEventListener("unhandledrejection", event => window.failures.push(String(event.reason)));
window.addEventListener("securitypolicyviolation", event => window.failures.push(event.blockedURI));
"""


class Browser:
    """On a virtual screen."""

    def __init__(self, profile):
        read, write = os.pipe()
        self.screen = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1366x768x24"],
                                       pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as answer:
            os.environ["DISPLAY"] = ":" + answer.readline().strip()
        options = webdriver.ChromeOptions()
        options.binary_location = BROWSER
        for option in OPTIONS + (f"--user-data-dir={profile}",):
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.driver.set_script_timeout(PATIENCE_S)
        self.run = self.driver.execute_script

    def close(self):
        self.driver.quit()
        self.screen.terminate()
        self.screen.wait()

    def open(self, path, before=""):
        """@param before a script that runs before the page's."""
        script = self.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument",
                                             {"source": ERRORS + before})
        self.driver.get(path.as_uri())
        self.wait("return document.body.dataset.ready || !document.getElementById('note').hidden")
        self.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", script)

    def wait(self, script, *arguments):
        return WebDriverWait(self.driver, PATIENCE_S, 0.2).until(
            lambda _driver: self.run(script, *arguments))

    def note(self):
        return self.run("return document.getElementById('note').textContent")

    def turn(self, name):
        """Opens what can be turned. @return its pixels, rows of rgb."""
        self.run("document.querySelector('button[data-scene=' + arguments[0] + ']').click()", name)
        plot = self.wait("const plot = document.getElementById('plot-' + arguments[0]);"
                         "return plot && plot.dataset.drawn && plot", name)
        self.run("arguments[0].scrollIntoView()", plot)
        self.run("return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return numpy.array(PIL.Image.open(io.BytesIO(plot.screenshot_as_png)).convert("RGB"), dtype=int)

    def errors(self):
        log = [entry["message"] for entry in self.driver.get_log("browser")
               if entry["level"] == "SEVERE"]
        return self.run("return window.failures") + log


def count_of(color, pixels):
    return int(numpy.count_nonzero(numpy.abs(pixels - color).max(axis=2) <= 4))


class InBrowser(ReportTest):
    def setUp(self):
        super().setUp()
        for what, there in (("chromium", BROWSER), ("chromium-driver", DRIVER),
                            ("python3-selenium", webdriver), ("xvfb", shutil.which("Xvfb"))):
            if not there:
                self.skipTest(f"{what} is not installed")
        self.browser = Browser(self.path("profile"))
        self.addCleanup(self.browser.close)

    def assertFits(self):
        wide, page = self.browser.run("return [innerWidth, document.documentElement.scrollWidth]")
        self.assertTrue(1300 < wide <= 1366, wide)
        self.assertLessEqual(page, wide, "it scrolls to the side")

    def assertOfflineToo(self):
        names = self.browser.run("return performance.getEntriesByType('resource').map(e => e.name)")
        for name in names:
            self.assertRegex(name, "^(file|data|blob):")

    def assertShows(self, folder, stop):
        """@param stop that is about a touch."""
        self.browser.open(folder / "report.html")
        self.assertEqual(self.browser.note(), "")
        self.assertFits()
        self.assertTrue(self.browser.run(
            "return [...document.images].every(image => image.complete && image.naturalWidth > 100)"))
        self.browser.wait("return document.querySelector('#plot-timeline .main-svg')")
        touched = self.browser.turn(stop)
        self.assertGreater(count_of(TOUCHED, touched), 100, "what is touched is red")
        self.browser.turn("map_in_3d")
        self.assertEqual(self.browser.run("return document.querySelectorAll('.plot canvas').length > 1"),
                         True)
        self.assertFits()
        self.assertOfflineToo()
        self.assertEqual(self.browser.errors(), [])

    def test_a_stop_can_be_turned_and_shows_what_was_touched(self):
        folder = self.report(*self.slid())
        self.assertShows(folder, "stop_02")
        # It turns: dragged, it looks otherwise.
        before = self.browser.run("return JSON.stringify(document.getElementById('plot-stop_02')"
                                  "._fullLayout.scene.camera)")
        actions = webdriver.ActionChains(self.browser.driver)
        plot = self.browser.run("return document.getElementById('plot-stop_02')")
        self.browser.run("arguments[0].scrollIntoView()", plot)
        actions.move_to_element(plot).click_and_hold().move_by_offset(120, 30).release().perform()
        self.browser.wait("return JSON.stringify(document.getElementById('plot-stop_02')"
                          "._fullLayout.scene.camera) !== arguments[0]", before)

    def test_a_browser_that_cannot_unpack_shows_the_pictures(self):
        folder = self.report(*self.slid())
        for before, words in (("delete window.DecompressionStream;", "too old"),
                              ("HTMLCanvasElement.prototype.getContext = () => null;", "no WebGL")):
            with self.subTest(before):
                self.browser.open(folder / "report.html", before)
                self.assertIn(words, self.browser.note())
                self.assertTrue(self.browser.run(
                    "return document.querySelector('#stop_01 img').clientWidth > 500"))
                self.assertTrue(self.browser.run(
                    "return [...document.querySelectorAll('button')].every(button => button.hidden)"))

    def test_the_pr2_at_its_table_can_be_looked_at(self):
        data = os.environ.get("TCCM_SHARED_DATA", "")
        if not os.path.isdir(os.path.join(data, "bags", "pr2_at_table")):
            self.skipTest("TCCM_SHARED_DATA names no folder with bags/pr2_at_table")
        folder = self.report(os.path.join(data, "bags/pr2_at_table/hands_dip_into_table.bag"),
                             os.path.join(data, "robots/pr2_moveit/pr2.urdf"),
                             os.path.join(CONFIGS, "pr2.yaml"))
        self.assertShows(folder, "stop_01")
        self.assertGreater(count_of(TOUCHED, self.browser.turn("stop_02")), 100, "of the stop before")

    def test_names_run_no_script(self):
        bag, _urdf, config = self.slid()
        urdf = self.text("hostile.urdf", pathlib.Path(self.path("robot.urdf")).read_text(
            encoding="utf-8").replace('"hand"', '"&lt;img src=x onerror=document.title=1&gt;"'))
        self.browser.open(self.report(bag, urdf, config) / "report.html")
        self.browser.turn("stop_01")
        self.assertEqual(self.browser.driver.title, "What stopped sliding")
        self.assertEqual(self.browser.errors(), [])

    def test_an_arm_in_a_box_is_shown(self):
        bag = self.simulated("--obstacle", "box", "--appear-s", "4", "--duration-s", "10")
        folder = self.report(bag, DUAL_ARM, os.path.join(CONFIGS, "simulation.yaml"))
        self.browser.open(folder / "report.html")
        self.assertFits()
        self.browser.turn("map_in_3d")
        self.assertEqual(self.browser.errors(), [])


if __name__ == "__main__":
    unittest.main()
