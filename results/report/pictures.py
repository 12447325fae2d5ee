#!/usr/bin/env python3
"""The pictures of this folder, taken of reports in headless Chromium.

    pictures.py QUICKSTART [PUBLISHED] [--to DIR]    directories of `softgrain run pipelines/quickstart.toml` and
                                                     `pipelines/published.toml`; DIR: where to (this folder)

Debian packages: chromium chromium-driver python3-selenium python3-pil libjs-three.
"""
import argparse
import base64
import io
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "tests/browser"))

from browser import PLACE_OF_POINT, missing, start_browser  # noqa: E402
from PIL import Image  # noqa: E402
from selenium.webdriver import ActionChains  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402

SET = """const s = document.querySelector(`#packing-view [name=${arguments[0]}]`);
if (s.type === "checkbox") s.checked = arguments[1]; else s.value = arguments[1];
s.dispatchEvent(new Event("change")); s.dispatchEvent(new Event("input"));"""


class Photographer:
    def __init__(self, page, folder, prefix=""):
        self.prefix = prefix
        self.browser = start_browser(1200, 900)
        self.browser.get(page.as_uri())
        self.folder = folder
        time.sleep(3.0)

    def take(self, name, x, y, width, height):
        """A part of the page, in its own coordinates [px]."""
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        shot = self.browser.execute_cdp_cmd("Page.captureScreenshot", {"clip": clip, "captureBeyondViewport": False})
        # 256 colours are enough and take a third of the place.
        image = Image.open(io.BytesIO(base64.b64decode(shot["data"]))).convert("RGB")
        # Plots keep their own few colours, packings the ends of the scale.
        method = Image.Quantize.MAXCOVERAGE if name.startswith("packing") else Image.Quantize.MEDIANCUT
        image.quantize(256, method=method, kmeans=1).save(self.folder / f"{self.prefix}{name}.png", optimize=True)

    def box(self, element):
        return self.browser.execute_script(
            "const b = arguments[0].getBoundingClientRect(); return [b.left + scrollX, b.top + scrollY, b.width, b.height]", element)

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def show(self, element, block="center"):
        self.browser.execute_script("arguments[0].scrollIntoView({block: arguments[1]})", element, block)
        time.sleep(0.4)

    def row(self, name, selector, margin=8):
        element = self.find(selector)
        self.show(element)
        x, y, width, height = self.box(element)
        self.take(name, x - margin, y - margin, width + 2 * margin, height + 2 * margin)

    def head(self):
        self.browser.execute_script("scrollTo(0, 0)")
        time.sleep(0.4)
        x, y, width, height = self.box(self.find(".remarks"))
        self.take("head", x - 20, 0, width + 40, y + height + 15)

    def normal(self):
        plot = self.find("svg.plot[aria-label='Fn(Δ), soft particle on a solid plane']")
        self.show(plot)
        series = plot.find_elements(By.CSS_SELECTOR, ".series[data-name^='packing']")
        there = max(series, key=lambda s: float(s.get_attribute("data-y").split(",")[-3]))
        x, y = self.browser.execute_script(PLACE_OF_POINT, there, there.get_attribute("data-x").count(",") - 2)
        ActionChains(self.browser).move_to_element_with_offset(plot, round(x), round(y)).perform()
        time.sleep(0.4)
        left, top, width, height = self.box(plot.find_element(By.XPATH, "ancestor::div[@class='row']"))
        self.take("normal_force", left - 8, top - 8, width + 16, height + 16)
        ActionChains(self.browser).move_to_element(plot.find_element(By.XPATH, "preceding::h3[1]")).perform()

    def packing(self, name, series, click=None, **settings):
        options = self.browser.execute_script("return [...document.querySelector('#packing-view [name=series]').options].map(o => o.label)")
        index = next(k for k, label in enumerate(options) if series in label)
        self.browser.execute_script(SET, "series", str(index))
        for key, value in {"color": "force", "grains": "solid", "chains": False, "cut": "", **settings}.items():
            self.browser.execute_script(SET, key, value)
        canvas = self.find("#packing-view canvas")
        self.show(canvas)
        if click:
            ActionChains(self.browser).move_to_element_with_offset(canvas, *click).click().perform()
        time.sleep(1.5)
        x, y, width, height = self.box(self.find("#packing-view"))
        self.take(name, x - 4, y - 4, width + 8, height + 8)

    def phone(self):
        self.browser.set_window_size(500, 1000)
        self.browser.execute_script("scrollTo(0, 0)")
        time.sleep(0.5)
        self.take("phone", *self.browser.execute_script("return [0, 0, innerWidth, innerHeight]"))


def quickstart(run, folder):
    photographer = Photographer(run / "report.html", folder)
    photographer.head()
    photographer.normal()
    photographer.row("macro", "#macro .row")
    photographer.row("error_cost", "#cost figure")
    photographer.row("sizes", "#radii figure")
    photographer.packing("packing_soft_particle", "soft-solid", cut="1", place="0.5", click=(20, 10))
    photographer.packing("packing_force_chains", "soft-solid", grains="faint", chains=True)
    photographer.packing("packing_law", "law", color="body")
    photographer.packing("packing_twin", "shelled", cut="1", place="0.55")
    photographer.packing("packing_twin_chains", "shelled", grains="off", chains=True)
    photographer.phone()
    photographer.browser.quit()


def published(run, folder):
    photographer = Photographer(run / "report.html", folder, "published_")
    photographer.head()
    photographer.row("normal_force", "#normal .row")
    photographer.row("stiffness", "#stiffness .row")
    photographer.row("relaxations", "#relaxations .row")
    photographer.row("macro", "#macro .row")
    photographer.row("error_cost", "#cost figure")
    photographer.packing("packing_twin", "shelled", cut="1", place="0.55")
    photographer.packing("packing_twin_contacts", "shelled", cut="1", place="0.55", color="contacts")
    photographer.browser.quit()


def main():
    if missing():
        sys.exit(missing())
    parser = argparse.ArgumentParser()
    parser.add_argument("quickstart", type=Path)
    parser.add_argument("published", type=Path, nargs="?")
    parser.add_argument("--to", type=Path, default=HERE)
    o = parser.parse_args()
    quickstart(o.quickstart.resolve(), o.to)
    if o.published:
        published(o.published.resolve(), o.to)


if __name__ == "__main__":
    main()
