#!/usr/bin/env python3
"""Opens the report of a small run in headless Chromium and uses it as a reader would.

    test_report.py PROGRAM ROOT [--keep DIR]     status 77: Chromium or Selenium is not installed (skipped)

Debian packages: chromium chromium-driver python3-selenium, and libjs-three for the packing in 3D (without it that part is
skipped and said). --keep: the report and pictures of it are left in DIR.
"""
import argparse
import csv
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from browser import PLACE_OF_POINT, SKIPPED, missing, start_browser
from selenium.webdriver import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

# The quickstart in seconds: few coarse grains, few points. Its laws are underdetermined, so that it may end with status 3.
SETTINGS = [
    "packing.trials=100", "packing.polydispersity=5", "packing.beta=8", "packing.count=4", "measure.relaxation=damped",
    "measure.damped.increment=0.02", "measure.soft_solid.deltas=[0.1,0.2,0.3,0.35,0.4,0.45]",
    "measure.soft_solid.tangential_deltas=[0.35,0.4,0.45]", "measure.soft_solid.angles_deg=[-0.05,0.05]",
    "measure.soft_soft.deltas=[0.2,0.3,0.4,0.45,0.5,0.55,0.6]", "measure.soft_soft.tangential_deltas=[0.5,0.6]",
    "measure.soft_soft.angles_deg=[-0.05,0.05]", "reference.relaxation=least-work",
    "reference.soft_solid.deltas=[0.4]", "reference.count=1", "measure.least_work.settle_time=8",
    "calibrate.min_packings=2", "calibrate.replicates=20", "macro.bodies=8", "macro.samples=1", "macro.steps=4",
    "macro.strain=0.3", "macro.bands=8", "multi_contact.packings_min=4", "multi_contact.packings_max=4", "multi_contact.increment=0.05", "multi_contact.settle_time=5", "multi_contact.tolerance=0.1",
    "calibrate.multi_contact.replicates=10",
    'configuration=[{arrangement="one",partner="plane",overlap=0.45},{arrangement="cube",partner="plane",overlap=0.3},'
    '{arrangement="one",partner="solid",ratio=1.0,overlap=0.45},{arrangement="one",partner="soft",ratio=1.0,overlap=0.55}]']

# Share of the canvas that is not white.
PAINTED = """
const canvas = document.querySelector("#packing-view canvas");
const copy = Object.assign(document.createElement("canvas"), { width: 120, height: 80 });
const pen = copy.getContext("2d");
pen.drawImage(canvas, 0, 0, 120, 80);
const d = pen.getImageData(0, 0, 120, 80).data;
let n = 0;
for (let k = 0; k < d.length; k += 4) if (d[k] + d[k + 1] + d[k + 2] < 720) ++n;
return n / (120 * 80);
"""

# Keeps what the link arguments[0] would save. The page may fetch nothing, not even that.
WATCH_LINK = """
const make = URL.createObjectURL;
URL.createObjectURL = (blob) => { window.saved = blob; return make.call(URL, blob); };
arguments[0].addEventListener("click", (e) => e.preventDefault(), { once: true });
"""


class ReportInABrowser(unittest.TestCase):
    """The tests share one page; each leaves it as it was."""

    page: Path
    keep: Path

    @classmethod
    def setUpClass(cls):
        cls.browser = start_browser()
        cls.browser.get(cls.page.as_uri())
        time.sleep(1.0)

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def wait_for(self, condition, what, seconds=300.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = condition()
            if value:
                return value
            time.sleep(0.1)
        self.fail(what)

    def picture(self, name):
        if self.keep:
            self.browser.save_screenshot(str(self.keep / f"{name}.png"))

    def plot(self, title):
        found = [p for p in self.browser.find_elements(By.CSS_SELECTOR, "svg.plot") if p.get_attribute("aria-label") == title]
        self.assertEqual(len(found), 1, title)
        self.script("arguments[0].scrollIntoView({block: 'center'})", found[0])
        return found[0]

    def to_canvas(self):
        found = self.browser.find_elements(By.CSS_SELECTOR, "#packing-view canvas")
        if not found:
            section = self.browser.find_element(By.ID, "packing").text
            if "three.js is not installed" in section:
                self.skipTest("libjs-three is not installed")
            self.fail("no canvas: " + section)
        self.script("arguments[0].scrollIntoView({block: 'center'})", found[0])
        self.wait_for(lambda: self.script(PAINTED) > 0.02, "nothing is drawn")
        return found[0]

    def test_1_opens_without_errors_and_without_network(self):
        bad = [e for e in self.browser.get_log("browser") if e["level"] in ("SEVERE", "WARNING") and "GPU stall" not in e["message"]
               and "GL Driver" not in e["message"]]
        self.assertEqual(bad, [])
        self.assertEqual(self.script("return performance.getEntriesByType('resource').map(e => e.name)"), [])

    def test_2_has_the_plots_and_the_links_lead_to_them(self):
        plots = self.browser.find_elements(By.CSS_SELECTOR, "svg.plot")
        self.assertGreaterEqual(len(plots), 8)
        for plot in plots:
            self.assertGreater(len(plot.find_elements(By.CSS_SELECTOR, ".series")), 0, plot.get_attribute("aria-label"))
        targets = [a.get_attribute("href").split("#")[1] for a in self.browser.find_elements(By.CSS_SELECTOR, ".contents a")]
        self.assertIn("normal", targets)
        for target in targets:
            self.browser.find_element(By.ID, target)

    def test_3_the_pointer_shows_packing_overlap_and_force(self):
        plot = self.plot("Fn(Δ), soft particle on a solid plane")
        series = plot.find_elements(By.CSS_SELECTOR, ".series[data-name^='packing']")[2]
        x, y = self.script(PLACE_OF_POINT, series, 4)
        ActionChains(self.browser).move_to_element_with_offset(plot, round(x), round(y)).perform()
        tip = self.browser.find_element(By.CSS_SELECTOR, ".tip")
        self.wait_for(tip.is_displayed, "no value is shown")
        self.assertRegex(tip.text, r"packing \d+ \(seed \d+\)\nnormal overlap Δ = hn/Rs: 0\.4\nnormal force Fn: [0-9.]+ N")
        self.assertEqual(len(plot.find_elements(By.CSS_SELECTOR, ".series.on")), 1)
        self.picture("hover")
        ActionChains(self.browser).move_to_element(self.browser.find_element(By.CSS_SELECTOR, "#normal h2")).perform()
        self.wait_for(lambda: not tip.is_displayed(), "the value stays")

    def test_4_the_legend_hides_and_shows(self):
        plot = self.plot("Fn(Δ), soft particle on a solid plane")
        series = plot.find_elements(By.CSS_SELECTOR, ".series[data-name^='packing']")
        entry = plot.find_element(By.CSS_SELECTOR, ".entry[data-entry^='one packing']")
        for expected in (False, True):
            ActionChains(self.browser).move_to_element(entry).click().perform()
            self.assertEqual([s.is_displayed() for s in series], [expected] * len(series))

    def test_5_a_click_picks_a_grain(self):
        canvas = self.to_canvas()
        ActionChains(self.browser).move_to_element(canvas).click().perform()
        card = self.browser.find_element(By.CSS_SELECTOR, "#packing-view .card")
        self.wait_for(card.is_displayed, "nothing was picked")
        self.assertRegex(card.text, r"(grain|particle).*\d+\nradius [0-9.]+ .?m\n")
        self.assertIn("contacts", card.text)
        self.picture("packing")

    def test_6_turns_zooms_and_goes_through_states(self):
        canvas = self.to_canvas()
        drawn = "return document.querySelector('#packing-view canvas').toDataURL()"
        before = self.script(drawn)
        ActionChains(self.browser).move_to_element(canvas).click_and_hold().move_by_offset(150, 40).release().perform()
        self.wait_for(lambda: self.script(drawn) != before, "it does not turn")
        share = self.script(PAINTED)
        ActionChains(self.browser).scroll_from_origin(ScrollOrigin.from_element(canvas), 0, -300).perform()
        self.wait_for(lambda: self.script(PAINTED) > 1.1 * share, "it does not zoom")
        self.browser.find_element(By.CSS_SELECTOR, "#packing-view button:not([name=play])").click()
        self.wait_for(lambda: self.script(PAINTED) < 1.1 * share, "the view is not reset")
        label = self.browser.find_element(By.CSS_SELECTOR, "#packing-view .below span")
        last = label.text
        self.script("const s = document.querySelector('#packing-view [name=state]'); s.value = 0; s.dispatchEvent(new Event('input'))")
        self.assertRegex(label.text, r"(Δ|strain) = ")
        self.assertNotEqual(label.text, last)
        self.browser.find_element(By.CSS_SELECTOR, "#packing-view [name=play]").click()
        self.wait_for(lambda: label.text == last, "it does not play to the last state")

    def test_7_every_state_colour_and_cut_can_be_shown(self):
        self.to_canvas()
        choose = """const s = document.querySelector(`#packing-view [name=${arguments[0]}]`); s.value = arguments[1];
                    s.dispatchEvent(new Event("change")); s.dispatchEvent(new Event("input"));"""
        options = "return [...document.querySelector(`#packing-view [name=${arguments[0]}]`).options].map(o => o.value)"
        series = self.script(options, "series")
        labels = self.script("return [...document.querySelector('#packing-view [name=series]').options].map(o => o.label)")
        for kind in ("soft-solid", "law", "shelled"):
            self.assertTrue(any(kind in label for label in labels), labels)
        for one in series:
            self.script(choose, "series", one)
            for color in self.script(options, "color"):
                self.script(choose, "color", color)
                time.sleep(0.15)
                self.assertGreater(self.script(PAINTED), 0.02, (one, color))
        whole = self.script(PAINTED)
        self.script(choose, "cut", "0")
        self.script(choose, "place", "0.1")
        time.sleep(0.5)
        self.assertLess(self.script(PAINTED), whole)
        self.script(choose, "cut", "")
        self.script("document.querySelector('#packing-view [name=chains]').click()")
        self.script(choose, "grains", "off")
        time.sleep(0.5)
        self.assertGreater(self.script(PAINTED), 0.0)
        self.script(choose, "grains", "faint")
        time.sleep(0.5)
        self.picture("chains")
        self.assertEqual([e for e in self.browser.get_log("browser") if e["level"] == "SEVERE"], [])

    def test_8_a_link_below_every_plot_saves_its_values(self):
        plot = self.plot("Fn(Δ), soft particle on a solid plane")
        links = self.browser.find_elements(By.CSS_SELECTOR, "figure a.csv")
        self.assertEqual(len(links), len(self.browser.find_elements(By.CSS_SELECTOR, "svg.plot")))
        link = self.script("return arguments[0].nextElementSibling", plot)
        name = link.get_attribute("download")
        self.script(WATCH_LINK, link)
        link.send_keys(Keys.ENTER)
        self.assertTrue(link.get_attribute("href").startswith("blob:"), link.get_attribute("href"))
        made = self.browser.execute_async_script("window.saved.text().then(arguments[0])")
        beside = (self.page.parent / "curves" / name).read_text(encoding="utf-8-sig")
        made, beside = (list(csv.reader(text.splitlines())) for text in (made, beside))
        self.assertEqual(made[0], beside[0])
        self.assertEqual(len(made), len(beside))
        for a, b in zip(made[1:], beside[1:]):
            self.assertEqual(a[:2], b[:2])
            for u, v in zip(a[2:], b[2:]):
                self.assertEqual(u == "", v == "")
                if u:
                    self.assertAlmostEqual(float(u), float(v), delta=1e-4 * abs(float(v)))

    def test_9_fits_a_phone_and_paper(self):
        self.browser.set_window_size(500, 900)  # the narrowest that Chromium takes
        time.sleep(0.5)
        wide, there = self.script("return [document.documentElement.scrollWidth, document.documentElement.clientWidth]")
        self.picture("phone")
        self.browser.set_window_size(1200, 900)
        self.assertLessEqual(wide, there)
        self.assertGreater(len(self.browser.print_page()), 50_000)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("root")
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    if missing():
        print("skipped: " + missing())
        return SKIPPED
    with tempfile.TemporaryDirectory() as place:
        out = options.keep or Path(place)
        out.mkdir(parents=True, exist_ok=True)
        command = [options.program, "run", str(Path(options.root) / "pipelines/quickstart.toml"), "--out", str(out / "run"), "--quiet"]
        for setting in SETTINGS:
            command += ["--set", setting]
        status = subprocess.run(command, stdout=subprocess.DEVNULL).returncode
        if status not in (0, 3):
            print(f"the run ended with status {status}")
            return 1
        ReportInABrowser.page = (out / "run/report.html").resolve()
        ReportInABrowser.keep = options.keep
        result = unittest.main(argv=[sys.argv[0], "-v"], exit=False).result
        return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
