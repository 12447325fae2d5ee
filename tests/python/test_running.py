"""Scenes that run and those that are refused, as exceptions and objects."""
import importlib.util
import os
import pickle
import re
import signal
import unittest
from pathlib import Path

import numpy as np

from support import ROOT, InEmptyFolder, softgrain, two_beads
from run_blocks import SMALL_PIPELINE

# Collisions in steps so small that it takes seconds: progress is told after two.
LONG = two_beads(time={"end": 2e-2}, output={"every": 4e-3})
SMALL_STEPS = {"time.step": 2e-9}
def processor_time_of_children():
    times = os.times()
    return times.children_user + times.children_system


SOFT = ROOT / "pipelines/grainlearning_example/soft_particle.toml"


class RunTest(InEmptyFolder):
    def test_a_dict(self):
        run = softgrain.run(two_beads(), progress=False)
        self.assertEqual(str(run.directory), "results/particles")
        self.assertEqual(run.status, "good")
        contact = run.summary["contacts"][0]
        # Hertz: E* = E/(2 (1 - nu^2)), R* = R/2, m* = m/2; delta = (15 m* v^2/(16 E* sqrt(R*)))^(2/5).
        modulus, radius, mass = 48e9 / (2 * (1 - 0.04)), 0.005, 0.5 * 2800 * 4 / 3 * np.pi * 1e-6
        overlap = (15 * mass * 100 / (16 * modulus * np.sqrt(radius)))**0.4
        self.assertAlmostEqual(contact["max_overlap"] / overlap, 1.0, delta=1e-3)
        self.assertEqual(os.listdir("."), ["results"])  # the scene's own file went

    def test_a_file_with_a_byte_order_mark(self):
        from softgrain.toml_text import scene_text
        with open("beads.toml", "wb") as file:
            file.write(b"\xef\xbb\xbf" + scene_text(two_beads())[0].encode())
        self.assertEqual(softgrain.run("beads.toml", progress=False).status, "good")
        self.assertEqual(softgrain.check("beads.toml").kind, "particles")

    def test_masked_values_are_refused(self):
        for masked in (np.ma.array([0.1, 0.2], mask=[False, True]), np.ma.masked):
            with self.assertRaisesRegex(softgrain.InputError, "time.end .*masked"):
                softgrain.check(two_beads(time={"end": masked}))

    def test_arrays_have_names_and_units(self):
        run = softgrain.run(two_beads(), out="beads", progress=False)
        velocity = run.array("trajectory/velocity")
        self.assertEqual((velocity.name, velocity.unit, velocity.values.shape[1:]), ("run/trajectory/velocity", "m/s", (2, 3)))
        np.testing.assert_allclose(np.asarray(velocity)[0, :, 0], [10, 0])
        np.testing.assert_allclose(velocity[-1][:, 0], [0, 10], atol=1e-3)
        self.assertIn("run/trajectory/time", run.names())
        with self.assertRaisesRegex(KeyError, "no such array"):
            run.array("velocty")
        with self.assertRaisesRegex(KeyError, "several"):
            run.array("velocity")

    def test_settings_win_over_the_scene(self):
        slow = softgrain.run(two_beads(), set={"particle.0.velocity": [5.0, 0, 0], "time": {"end": 4e-4}}, out="slow", progress=False)
        self.assertEqual(slow.array("trajectory/velocity")[0][0][0], 5.0)
        self.assertAlmostEqual(slow.array("trajectory/time")[-1], 4e-4, delta=1e-5)

    def test_a_file_with_numpy_settings_and_seed(self):
        run = softgrain.run(SOFT, set={"packing.count": np.int64(2), "measure.soft_solid.deltas": np.linspace(0.2, 0.4, 3)}, seed=5,
                            threads=1, out="soft", progress=False)
        measured = run.measurements()
        self.assertEqual(len(measured.runs), 2)
        np.testing.assert_allclose(measured.runs[0].delta, [0.2, 0.3, 0.4])
        shown = run._repr_html_()  # pylint: disable=protected-access
        self.assertTrue(shown.startswith("<b>soft</b><table>"))
        self.assertEqual("data:image/png;base64,iVBORw0" in shown, importlib.util.find_spec("matplotlib") is not None)
        self.assertTrue(run.report().read_text().lstrip().lower().startswith("<!doctype html"))

    def test_paths_in_a_dict_are_relative_to_the_working_directory(self):
        with open("beads.xyzr", "w", encoding="utf-8") as file:
            file.write("2 0.1 0.1 0.1\n0 0 0 0.01\n0.03 0 0 0.01\n")
        scene = two_beads(particles={"file": "beads.xyzr", "material": "glass"})
        del scene["particle"]
        try:
            run = softgrain.run(scene, progress=False)
        except softgrain.InputError as e:
            self.assertNotIn("no such file", str(e))
            raise
        self.assertEqual(len(run.array("bodies/radius")), 2)

    def test_progress_comes_to_a_function(self):
        told = []
        softgrain.run(LONG, out="long", set=SMALL_STEPS, progress=lambda share, text: told.append((share, text)))
        shares = [share for share, _ in told if share is not None]
        self.assertGreater(len(shares), 1)
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(shares[-1], 1.0)
        self.assertTrue(all(re.search(r"\d+ %", text) for share, text in told if share is not None))

    def test_an_error_in_that_function_stops_the_run(self):
        def broken(share, text):
            raise ZeroDivisionError(text)
        with self.assertRaises(ZeroDivisionError):
            softgrain.run(LONG, set=SMALL_STEPS, out="x", progress=broken)
        self.assertFalse(os.path.exists("x/summary.json"))

    def test_interrupted_and_resumed(self):
        stops = []

        def stop(share, _):
            if share is not None and not stops:
                stops.append(share)
                os.kill(os.getpid(), signal.SIGINT)
        before = processor_time_of_children()
        with self.assertRaises(softgrain.Interrupted) as caught:
            softgrain.run(LONG, set=SMALL_STEPS, out="stopped", progress=stop)
        stopped = processor_time_of_children() - before
        self.assertIsInstance(caught.exception, KeyboardInterrupt)
        self.assertEqual(str(caught.exception.directory), "stopped")
        self.assertEqual(os.listdir("."), ["stopped"])
        self.assertFalse(os.path.exists("stopped/summary.json"))
        other = {**LONG, "time": {"end": 1e-2}}
        with self.assertRaisesRegex(softgrain.InputError, "another scene"):
            softgrain.run(other, set=SMALL_STEPS, out="stopped", resume=True, progress=False)
        before = processor_time_of_children()
        run = softgrain.run(LONG, set=SMALL_STEPS, out="stopped", resume=True, progress=False)
        self.assertLess(stopped, processor_time_of_children() - before)  # most of the work was left
        np.testing.assert_allclose(run.array("trajectory/time")[:], np.arange(6) * 4e-3, atol=1e-8)
        np.testing.assert_allclose(run.array("trajectory/velocity")[-1][:, 0], [0, 10], atol=1e-3)

    def test_not_usable(self):
        """The quickstart with too few grains: its laws are underdetermined, status 3; what it wrote is there."""
        options = [word for setting in SMALL_PIPELINE for word in ("--set", setting)]
        with self.assertRaises(softgrain.UnusableResult) as caught:
            softgrain.run(ROOT / "pipelines/quickstart.toml", out="few", options=options, progress=False)
        run = caught.exception.run
        self.assertEqual(run.status, "not usable")
        card = softgrain.Law.load(run.directory / "law.toml")
        self.assertIn("underdetermined", [card.pair(kind).status for kind in ("soft-solid", "soft-soft")])
        self.assertIn("isotropic", repr(run.law()))
        curve = run.macro()[0]
        self.assertEqual((curve.units["stress_axial"], curve.units["strain"]), ("Pa", "1"))
        self.assertEqual(len(curve["strain"]), len(curve["stress_axial"]))
        if importlib.util.find_spec("matplotlib") is not None:
            self.assertIsNotNone(run.figure())
        again = softgrain.run(ROOT / "pipelines/quickstart.toml", out="few", options=options, progress=False, resume=True,
                              unusable="return")
        self.assertEqual(again.status, "not usable")


class RefusedTest(InEmptyFolder):
    def bad(self):
        scene = two_beads(materal={})
        scene["time"] = {"end": -1.0}
        scene["particle"][0]["raduis"] = 0.3
        scene["particle"][1]["radius"] = 0.0
        return scene

    def test_all_mistakes_of_a_dict_at_once(self):
        for ask in (softgrain.check, softgrain.run):
            with self.assertRaises(softgrain.InputError) as caught:
                ask(self.bad(), set={"material.glass.nu": 0.7})
            found = {m.path or m.setting: m for m in caught.exception.mistakes}
            self.assertEqual(set(found), {"particle[0].raduis", "particle[1].radius", "time.end", "materal", "material.glass.nu"})
            self.assertEqual((found["particle[0].raduis"].nearest, found["materal"].nearest), ("radius", "material"))
            self.assertEqual((found["time.end"].allowed, found["time.end"].value), ("must be above 0", "-1"))
            self.assertIn("at most 0.5", found["material.glass.nu"].allowed)
            self.assertEqual({m.file for m in caught.exception.mistakes if m.path}, {"<scene>"})
            self.assertNotIn(".softgrain-", str(caught.exception))
            again = pickle.loads(pickle.dumps(caught.exception))
            self.assertEqual((str(again), again.mistakes), (str(caught.exception), caught.exception.mistakes))
            self.assertEqual(os.listdir("."), [])

    def test_a_file_names_its_line(self):
        Path("scene.toml").write_text(SOFT.read_text().replace('E = "0.5 MPa"', 'E = "0.5 kg"'), encoding="utf-8")
        with self.assertRaises(softgrain.InputError) as caught:
            softgrain.run("scene.toml", progress=False)
        error = caught.exception
        self.assertEqual((error.file, error.key), ("scene.toml", "E"))
        self.assertIn('E = "0.5 kg"', Path("scene.toml").read_text(encoding="utf-8").splitlines()[error.line - 1])
        self.assertIn("MPa", error.allowed)

    def test_what_toml_cannot_say(self):
        with self.assertRaises(softgrain.InputError) as caught:
            softgrain.run(two_beads(time={"end": object()}))
        self.assertEqual(caught.exception.mistakes[0].path, "time.end")

    def test_kinds(self):
        with self.assertRaises(softgrain.InputError) as caught:
            softgrain.run({"kind": "particels"})
        self.assertIn('"particles"', caught.exception.allowed)  # of all commands

    def test_missing_files(self):
        with self.assertRaises(softgrain.IoError) as caught:
            softgrain.run("nothing.toml", progress=False)
        self.assertEqual(str(pickle.loads(pickle.dumps(caught.exception))), "nothing.toml: no such file")
        before = os.environ.get("SOFTGRAIN_PROGRAM")
        os.environ["SOFTGRAIN_PROGRAM"] = "/nowhere/softgrain"
        try:
            with self.assertRaisesRegex(softgrain.IoError, "/nowhere/softgrain"):
                softgrain.run(two_beads())
        finally:
            if before is None:
                del os.environ["SOFTGRAIN_PROGRAM"]
            else:
                os.environ["SOFTGRAIN_PROGRAM"] = before

    def test_findings(self):
        found = softgrain.check(ROOT / "pipelines/quickstart.toml")
        self.assertEqual(found.kind, "pipeline")
        self.assertGreater(found.core_seconds, 1.0)
        self.assertGreater(found["twin_grains"], 1000)
        self.assertTrue(any("bodies are few" in w for w in found.warnings))
        self.assertIn("warning: ", str(found))
        self.assertIn("scene of kind pipeline", found.lines)
        self.assertIn("time_step", list(found))
        self.assertNotIn("status", found)
        self.assertIn("bodies are few", found._repr_html_())  # pylint: disable=protected-access
        self.assertNotIn(".softgrain-", str(softgrain.check(two_beads())))
        law = softgrain.check(ROOT / "results/published/law.toml")
        self.assertTrue(len(law))


if __name__ == "__main__":
    unittest.main()
