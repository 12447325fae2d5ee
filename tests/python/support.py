"""What the tests of the package share: places, the program, a scene of a moment."""
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "pipelines/python"), str(ROOT / "tests")]
try:
    import numpy  # noqa: F401  pylint: disable=unused-import
    import h5py  # noqa: F401  pylint: disable=unused-import
except ImportError as e:
    print(f"skipped: {e} (Debian: python3-numpy python3-h5py)")
    sys.exit(77)
import softgrain  # noqa: E402  pylint: disable=wrong-import-position,unused-import
from softgrain import installation  # noqa: E402  pylint: disable=wrong-import-position

CARD = ROOT / "results/published/law.toml"
TABLE = ROOT / "results/law_table/law_table.toml"


def program_json(*arguments):
    """What the program prints with --json."""
    done = subprocess.run([installation.program(), *map(str, arguments), "--json"], capture_output=True, check=True)
    return json.loads(done.stdout)


def two_beads(**changes):
    """A scene of kind particles: two glass beads that collide."""
    scene = {
        "kind": "particles",
        "material": {"glass": {"density": 2800.0, "E": "48 GPa", "nu": 0.2}},
        "contact": [{"pair": ["glass", "glass"], "law": "hertz-tsuji", "restitution": 1.0, "mu": 0.0}],
        "particle": [{"material": "glass", "radius": 0.01, "position": [-0.0105, 0, 0], "velocity": [10.0, 0, 0]},
                     {"material": "glass", "radius": 0.01, "position": [0.0105, 0, 0]}],
        "time": {"end": 3e-4}, "output": {"every": 1e-5}}
    return {**scene, **changes}


class InEmptyFolder(unittest.TestCase):
    """Every test in a folder of its own, to which nothing was left behind but what it says."""

    def setUp(self):
        self.before = os.getcwd()
        self.folder = tempfile.TemporaryDirectory()
        os.chdir(self.folder.name)

    def tearDown(self):
        os.chdir(self.before)
        self.folder.cleanup()
