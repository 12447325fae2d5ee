"""The commands beside run and check: what they give, what they refuse, and the student's way of the guide from end to end."""
import json
import types
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

from support import ROOT, InEmptyFolder, softgrain, two_beads

NOTEBOOK = ROOT / "pipelines/python/student.ipynb"
# The student's way in seconds: few coarse grains, few bodies. Laws of so few packings are not to be relied on, and say so.
QUICKLY = (('"polydispersity": 10.0', '"polydispersity": 5.0'), ('"trials": 10000', '"trials": 1000'), ('"slow-dynamics"', '"least-work"'),
           ("0.3, 0.35, 0.4]  #", "0.3, 0.35, 0.4, 0.5, 0.6, 0.7]  #"), ('"bodies": 40', '"bodies": 10'), ('"strain": 0.16, "steps": 8', '"strain": 0.3, "steps": 3'))


def cells():
    """The code of the notebook."""
    return ["".join(cell["source"]) for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]


class CommandsTest(InEmptyFolder):
    def test_sweep_and_its_tables(self):
        swept = softgrain.sweep(two_beads(), {"time.end": [1e-4, 3e-4]}, out="swept", progress=False)
        self.assertEqual([run.status for run in swept.runs], ["good", "good"])
        table = swept.table()
        np.testing.assert_allclose(table["time.end"], [1e-4, 3e-4])
        self.assertEqual(table.rows, 2)
        self.assertEqual(repr(swept).count("\n"), 0)
        self.assertIn("2 runs", repr(swept))
        with self.assertRaisesRegex(softgrain.InputError, "time.ent"):
            softgrain.sweep(two_beads(), {"time.ent": [1e-4]}, out="wrong", progress=False)
        with self.assertRaisesRegex(softgrain.InputError, "must be a dict"):
            softgrain.sweep(two_beads(), ["time.end=1"], progress=False)

    def test_calibrate_an_experiment(self):
        fit = softgrain.calibrate(ROOT / "pipelines/press_test.csv", set={"mirror": True}, out="fit")
        law = fit.law()
        self.assertGreater(law.force(0.25), law.force(0.2))
        rows = fit.table()
        self.assertEqual(set(rows["parameter"]), {"a", "b", "c", "delta"})
        at = list(rows["parameter"]).index("b")
        self.assertLess(rows["low"][at], rows["value"][at])
        self.assertLess(rows["value"][at], rows["high"][at])
        with self.assertRaises(softgrain.InputError) as refused:
            softgrain.calibrate()
        self.assertEqual(refused.exception.status, 2)
        with self.assertRaises(softgrain.IoError) as absent:
            softgrain.calibrate("absent.csv", out="none")
        self.assertEqual(absent.exception.status, 4)

    def test_export_and_report(self):
        run = softgrain.run(two_beads(), out="beads", progress=False)
        written = softgrain.export(run, "csv", out="table")
        self.assertTrue(written.files and all(file.exists() for file in written.files), written)
        Path("beads/report.html").unlink()
        self.assertTrue(softgrain.report(run).exists())
        with self.assertRaises(softgrain.InputError):
            softgrain.export(run, "vtb", out="none")

    def test_compare(self):
        runs = [softgrain.run(two_beads(time={"end": end}), out=name, progress=False) for name, end in (("a", 3e-4), ("b", 2e-4), ("c", 1e-4))]
        two = softgrain.compare(*runs[:2])
        self.assertEqual([(one["key"], list(map(float, one["values"]))) for one in two.differences], [("time.end", [3e-4, 2e-4])])
        force = two.numbers()["largest force of a contact"]
        self.assertAlmostEqual(force[0], runs[0].summary["contacts"][0]["max_force"], delta=1e-9 * force[0])
        self.assertIn("a with ", repr(two))
        self.assertIn("differ in 1 key;", repr(two))
        self.assertEqual((two.table().rows, two.directory), (0, None))
        several = softgrain.compare(*runs, out="compared")
        self.assertEqual(list(several.numbers()["name"]), ["a", "b", "c"])
        self.assertIn("of a, b with ", repr(several))
        self.assertTrue(several.directory.is_dir())
        with self.assertRaises(softgrain.InputError):
            softgrain.compare()
        with self.assertRaises(softgrain.IoError):
            softgrain.compare("absent", "a")

    def test_wrong_arguments_are_refused_before_any_work(self):
        for wrong in (3, ["x"], [1.5]):
            with self.assertRaisesRegex(softgrain.InputError, "seeds = .*whole numbers"):
                softgrain.sweep(two_beads(), seeds=wrong, out="wrong", progress=False)
        for wrong in (1e-4, None, {"low": 1e-4}, np.float64(1e-4), np.array(1e-4)):
            with self.assertRaisesRegex(softgrain.InputError, "over: time.end = .*list of values"):
                softgrain.sweep(two_beads(), {"time.end": wrong}, out="wrong", progress=False)
        with self.assertRaisesRegex(softgrain.InputError, "unusable"):
            softgrain.sweep(two_beads(), {"time.end": [1e-4]}, out="wrong", progress=False, unusable="drop")
        with self.assertRaisesRegex(softgrain.InputError, "unusable"):
            softgrain.calibrate(ROOT / "pipelines/press_test.csv", out="wrong", unusable="drop")
        self.assertFalse(Path("wrong").exists())

    def test_examples(self):
        self.assertIn("quickstart", softgrain.examples()["name"])
        self.assertEqual(softgrain.check(softgrain.example("quickstart")).kind, "pipeline")
        self.assertEqual(softgrain.check(softgrain.example("quickstart", "mine.toml")).kind, "pipeline")
        with self.assertRaisesRegex(softgrain.InputError, "is there already"):
            softgrain.example("quickstart", "mine.toml")
        with self.assertRaises(softgrain.InputError) as refused:
            softgrain.example("quickstrt")
        self.assertEqual((refused.exception.nearest, refused.exception.status), ("quickstart", 2))

    def test_what_pandas_is_given(self):
        """By a substitute, as most machines of the tests have none: the columns by name and the units."""
        pandas = types.SimpleNamespace(DataFrame=lambda columns: types.SimpleNamespace(columns=columns, attrs={}))
        with unittest.mock.patch.dict("sys.modules", pandas=pandas):
            frame = softgrain.Table("t", {"x": [1.0, 2.0], "word": ["a", "b"]}, {"x": "m"}).dataframe()
        self.assertEqual((list(frame.columns), frame.attrs["units"]), (["x", "word"], {"x": "m", "word": ""}))
        np.testing.assert_array_equal(frame.columns["x"], [1.0, 2.0])

    def test_tables_need_no_pandas(self):
        table = softgrain.Table("t", {"x": [1.0, 2.0], "word": ["a", "b"]}, {"x": "m"})
        self.assertEqual((table.rows, list(table), table.heading("x")), (2, ["x", "word"], "x [m]"))
        try:
            frame = table.dataframe()
        except ImportError as e:
            self.assertIn("python3-pandas", str(e))
        else:
            self.assertEqual(frame.attrs["units"]["x"], "m")

    def test_the_students_way(self):
        names = {}
        for code in cells():
            for long, short in QUICKLY:
                code = code.replace(long, short)
            code = code.replace(', out="results/experiment"', ', out="results/experiment", unusable="return"')
            code = code.replace('out="results/fit"', 'out="results/fit", unusable="return"')
            code = code.replace('out="results/macro"', 'out="results/macro", unusable="return"')
            exec(compile(code, str(NOTEBOOK), "exec"), names)  # pylint: disable=exec-used
        self.assertGreater(names["law"].force(0.4), 0.0)
        self.assertGreater(names["with_law"]["stress_axial"][-1], 0.0)
        self.assertEqual(names["with_law"]["strain"][-1], names["twin"]["strain"][-1])
        self.assertTrue(Path("results/stress.svg").read_text(encoding="utf-8").startswith("<"))

    def test_the_notebook_is_the_script(self):
        script = (ROOT / "pipelines/python/student.py").read_text(encoding="utf-8")
        of_cells = "\n".join(cells())
        lines = [line.strip() for line in script.splitlines() if line.strip() and not line.startswith('"""')]
        self.assertEqual(lines, [line.strip() for line in of_cells.splitlines() if line.strip()])
        self.assertLessEqual(len(lines), 32)


if __name__ == "__main__":
    unittest.main()
