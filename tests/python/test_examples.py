"""The examples of pipelines/python, and the Python of the guide, as somebody would run them."""
import contextlib
import importlib.util
import io
import json
import os
import re
import shutil
import subprocess
import sys
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from support import CARD, ROOT, InEmptyFolder, softgrain

EXAMPLES = ROOT / "pipelines/python"


def missing(*modules):
    """The first of these that is not installed."""
    return next((m for m in modules if importlib.util.find_spec(m) is None), None)


def output_of(*words, **environment):
    """Of a command that ends well."""
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          env={**os.environ, **environment}, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise AssertionError(f"{words} ended with status {done.returncode}:\n{done.stdout}")
    return done.stdout


def python_of(page):
    """The Python blocks of a page."""
    return re.findall(r"^```python\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)


def numbers(text):
    """All numbers in a line."""
    return [float(n) for n in re.findall(r"-?\d+(?:\.\d+)?", text)]


class ExamplesTest(InEmptyFolder):
    @unittest.skipIf(missing("scipy"), "no scipy")
    def test_scipy_finds_the_modulus_of_a_press_test(self):
        sys.path.insert(0, str(EXAMPLES))
        import fit_press_test as press  # pylint: disable=import-outside-toplevel,import-error
        law = softgrain.Law.load(CARD)
        # What the law itself says, from another modulus and zero, comes back.
        h = np.linspace(0.0, 0.3, 61) * law.shell_radius
        force = law.force((h + 2e-4) / law.shell_radius, modulus=0.8e6)
        (modulus, shift), errors = press.fit(law, h, force, law.shell_radius)
        self.assertAlmostEqual(modulus, 0.8, delta=1e-6)
        self.assertAlmostEqual(shift, 0.2, delta=1e-6)
        self.assertLess(errors[0], 1e-6)
        # And the readings that come with the scenes, made with 0.5 MPa.
        text = output_of(sys.executable, EXAMPLES / "fit_press_test.py")
        modulus, error = numbers(text)[:2]
        self.assertLess(abs(modulus - 0.5), 2.5 * error)
        self.assertLess(error, 0.05)

    def test_grainlearning_files(self):
        text = output_of(sys.executable, EXAMPLES / "grainlearning_press_test.py", "--out", "search", "--samples", "100")
        modulus, radius = numbers(text)
        self.assertAlmostEqual(modulus, 0.5, delta=0.05)
        self.assertAlmostEqual(radius, 16.0, delta=1.0)
        folder = Path("search/sim_data/iter0")
        self.assertEqual(len(list(folder.glob("press_test_Iter0_Sample??_sim.txt"))), 100)
        self.assertEqual((folder / "press_test_Iter0_Sample07_param.txt").read_text().splitlines()[0], "# E R")
        self.assertEqual(Path("search/press_test.dat").read_text().splitlines()[0], "# h Fn")

    @unittest.skipIf(missing("grainlearning"), "no GrainLearning")
    def test_grainlearning(self):
        text = output_of(sys.executable, EXAMPLES / "grainlearning_press_test.py", "--out", "search", "--samples", "60",
                         "--grainlearning")
        self.assertAlmostEqual(numbers(text.splitlines()[-1])[0], 0.5, delta=0.1)

    @unittest.skipIf(shutil.which("yade") is None, "no YADE")
    def test_yade(self):
        """The force in YADE is that of the law to the last digits, and what bounces keeps its speed: the law has an energy."""
        text = output_of("yade", "-n", "-x", EXAMPLES / "yade_soft_particle.py", SOFTGRAIN_LAW=str(CARD))
        if "No module named" in text:
            self.skipTest("YADE of another Python")
        told = json.loads(text[text.index("YADE ") + 5:].splitlines()[0])
        self.assertGreater(told["largest_delta"], 0.15)
        self.assertGreater(told["largest_force"], 0.3)
        self.assertLess(told["largest_difference"], 1e-12 * told["largest_force"])
        self.assertAlmostEqual(told["speed_after"], 0.4, delta=1e-5)

    def test_the_guide(self):
        """Its Python blocks, one after the other, in a folder with links to what they name."""
        for name in ("pipelines", "results"):
            os.makedirs(name)
            for entry in (ROOT / name).iterdir():
                if name == "pipelines" or (entry / "README.md").exists():
                    os.symlink(entry, Path(name) / entry.name)
        blocks = python_of(ROOT / "pipelines/guide/python.md")
        self.assertGreater(len(blocks), 4)
        space = {}
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            for block in blocks:
                if missing("matplotlib") and "figure(" in block:
                    continue
                exec(compile(block, "guide", "exec"), space)  # pylint: disable=exec-used
        for told in re.findall(r"^ +# (time\.end .*|materal .*)$", "".join(blocks), re.M):
            self.assertIn(told, printed.getvalue())
        self.assertIn("m/s (32, 2, 3)", printed.getvalue())

    def test_the_readme(self):
        """Its block, with a law in the place of three minutes."""
        block, = python_of(ROOT / "README.md")
        seen = {}
        published = softgrain.Run(CARD.parent)
        with unittest.mock.patch("softgrain.run", lambda scene, set: seen.update(scene=scene, set=set) or published):
            exec(compile(block, "README", "exec"), {})  # pylint: disable=exec-used
        self.assertEqual(softgrain.check(ROOT / seen["scene"], set=seen["set"]).kind, "pipeline")


if __name__ == "__main__":
    unittest.main()
