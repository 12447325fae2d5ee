"""Headless Chromium for tests and pictures of reports. Debian packages: chromium chromium-driver python3-selenium."""
import os
import shutil
import sys

SKIPPED = 77  # status of what could not run because packages are missing

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    # A Python beside the system's does not see the packages of the system.
    system = "/usr/bin/python3"
    if os.path.exists(system) and os.path.realpath(sys.executable) != os.path.realpath(system):
        os.execv(system, [system] + sys.argv)
    print("skipped: python3-selenium is not installed")
    sys.exit(SKIPPED)


def chromium():
    return shutil.which("chromium") or shutil.which("chromium-browser")


def missing():
    """What has to be installed first, or an empty text."""
    if not chromium():
        return "chromium is not installed"
    return "" if shutil.which("chromedriver") else "chromium-driver is not installed"


def start_browser(width=1200, height=900):
    """WebGL is drawn by the processor, so that no graphics card is needed."""
    options = Options()
    options.binary_location = chromium()
    for word in ("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                 "--disable-quic", "--no-first-run", "--disable-background-networking", "--hide-scrollbars",
                 f"--window-size={width},{height}"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


# Where the point number arguments[1] of the series arguments[0] is, from the middle of its plot [px].
PLACE_OF_POINT = """
const [group, index] = arguments;
const svg = group.closest("svg");
const numbers = (t) => t.split(",").map(Number);
const [left, top, width, height] = numbers(svg.dataset.frame);
const share = (axis, v) => { const [scale, low, high] = axis.split(","); const f = scale === "log" ? Math.log : (x) => x;
  return (f(v) - f(Number(low))) / (f(Number(high)) - f(Number(low))); };
const x = left + width * share(svg.dataset.xAxis, numbers(group.dataset.x)[index]);
const y = top + height * (1 - share(svg.dataset.yAxis, numbers(group.dataset.y)[index]));
const p = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
const box = svg.getBoundingClientRect();
return [p.x - box.left - box.width / 2, p.y - box.top - box.height / 2];
"""
