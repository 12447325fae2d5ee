"""Laws at arrays: the numbers of the program, derivatives that are derivatives, speed."""
import multiprocessing
import os
import pickle
import sys
import threading
import time
import unittest

import numpy as np

from support import CARD, ROOT, TABLE, InEmptyFolder, program_json, softgrain


def fastest(work, times=9):
    """Seconds of the fastest of several calls: what else the machine does only ever adds."""
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def evaluated(law, *options):
    """Columns of softgrain law eval."""
    return program_json("law", "eval", law, *options)


def at_child(delta):
    """Of another process."""
    return softgrain.Law.load(CARD).force(delta)


class CardTest(unittest.TestCase):
    law = softgrain.Law.load(CARD)

    def program(self, kind, beyond="extrapolate"):
        deltas = ["0", "0.05", "0.0942", "0.0943", "0.15", "0.2", "0.3", "0.35"]
        out = evaluated(CARD, "--kind", kind, "--beyond", beyond, "--E", "2e6", "--radius", "0.02", "--delta", *deltas)
        found = out["laws"][0]["values"] if "laws" in out else out["values"]
        return np.array([v["delta"] for v in found]), found

    def test_values_and_intervals_are_those_of_the_program(self):
        units = {"radius": 0.02, "modulus": 2e6}
        for kind in ("soft-solid", "soft-soft"):
            for beyond in ("extrapolate", "clamp"):
                delta, rows = self.program(kind, beyond)
                for name, method, interval in (
                        ("force", self.law.force, self.law.force_interval),
                        ("stiffness", self.law.stiffness, self.law.stiffness_interval),
                        ("kt_initial", self.law.tangential_stiffness, self.law.tangential_interval)):
                    with self.subTest(kind=kind, beyond=beyond, name=name):
                        told = np.array([r[name] for r in rows])
                        # x^y differs by a unit in the last place, of which much is left just above the threshold.
                        np.testing.assert_allclose(method(delta, kind, beyond=beyond, **units), told, rtol=1e-14, atol=1e-15 * told.max())
                        low, high = interval(delta, kind, beyond=beyond, **units)
                        told = np.array([r[f"{name}_interval"] or (np.nan, np.nan) for r in rows], dtype=float)
                        np.testing.assert_allclose(np.stack([low, high], 1), told, rtol=1e-12, atol=1e-300)
                        # 0.35 is beyond what was measured on a plane: nothing says how far off the law is.
                        self.assertEqual(bool(np.isnan(low[-1]) and np.isnan(high[-1])), kind == "soft-solid")

    def test_secant_is_another_stiffness(self):
        _, rows = self.program("soft-solid")
        row = next(r for r in rows if r["delta"] == 0.2)
        secant = self.law.tangential_stiffness(0.2, slope="secant", radius=0.02, modulus=2e6)
        self.assertAlmostEqual(secant / row["kt_secant"], 1.0, delta=1e-13)
        self.assertNotAlmostEqual(row["kt_secant"] / row["kt_initial"], 1.0, delta=0.01)

    def test_shapes_and_types(self):
        self.assertIsInstance(self.law.force(0.2), float)
        self.assertEqual(self.law.force([]).shape, (0,))
        grid = np.linspace(0, 0.3, 35).reshape(5, 7)
        for array in (grid, grid[::2, ::3], np.asfortranarray(grid), grid.astype(np.float32).astype(float), grid.tolist()):
            out = self.law.force(array)
            self.assertEqual(out.shape, np.shape(array))
            flat = [self.law.force(float(d)) for d in np.ravel(array)]
            np.testing.assert_array_equal(out.ravel(), flat)  # the same bits, alone or in an array of any length
        self.assertTrue(np.isnan(self.law.force(np.nan)))
        self.assertEqual(self.law.force(-0.1), 0.0)

    def test_stiffness_is_the_derivative(self):
        delta = np.linspace(0.11, 0.29, 37)
        step = 1e-6
        difference = (self.law.force(delta + step) - self.law.force(delta - step)) / (2 * step * self.law.shell_radius)
        np.testing.assert_allclose(self.law.stiffness(delta), difference, rtol=1e-8)

    def test_dimensions(self):
        dimensionless = self.law.force(0.2, radius=1, modulus=1)
        pair = self.law.pair("soft-solid").normal
        self.assertAlmostEqual(dimensionless, pair.a * (0.2**pair.b - pair.delta**pair.b), delta=1e-15)
        self.assertAlmostEqual(self.law.force(0.2, radius=0.1, modulus=3e5) / (dimensionless * 3e5 * 0.01), 1.0, delta=1e-14)
        for bad in ({"radius": 0.0}, {"modulus": -1.0}, {"radius": np.nan}):
            with self.assertRaisesRegex(softgrain.InputError, "must be above 0"):
                self.law.force(0.2, **bad)

    def test_beyond_the_range(self):
        end = self.law.pair("soft-solid").delta_max
        self.assertEqual(self.law.force(0.9, beyond="clamp"), self.law.force(end, beyond="clamp"))
        self.assertGreater(self.law.force(0.9, beyond="extrapolate"), self.law.force(end))
        with self.assertRaises(softgrain.InputError) as caught:
            self.law.force([0.1, 0.9], beyond="error")
        self.assertEqual((caught.exception.key, caught.exception.mistakes[0].value), ("delta", "0.9"))
        self.assertIn("at most 0.3", caught.exception.allowed)
        self.law.force([0.1, end], beyond="error")

    def test_mistakes_name_key_and_nearest(self):
        for key, nearest, ask in (("kind", "soft-solid", lambda: self.law.force(0.2, "soft-sold")),
                                  ("beyond", "clamp", lambda: self.law.force(0.2, beyond="clmp"))):
            with self.assertRaises(softgrain.InputError) as caught:
                ask()
            self.assertEqual((caught.exception.key, caught.exception.nearest), (key, nearest))
        with self.assertRaises(ValueError):  # InputError is one
            self.law.tangential_stiffness(0.2, slope="steepest")

    def test_other_threads_run_meanwhile(self):
        delta = np.random.default_rng(1).uniform(0, 0.4, 8_000_000)
        ticks = []
        done = threading.Event()

        def tick():
            while not done.is_set():
                ticks.append(time.perf_counter())
                time.sleep(0.0005)

        watch = threading.Thread(target=tick)
        watch.start()
        start = time.perf_counter()
        for _ in range(5):
            self.law.tangential_stiffness(delta)
        end = time.perf_counter()
        done.set()
        watch.join()
        inside = sum(start < t < end for t in ticks)
        self.assertGreater(inside, 20, "the lock of the interpreter was held")

    def test_after_a_fork(self):
        delta = np.linspace(0, 0.3, 200_000)
        here = self.law.force(delta)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            for there in pool.map_async(at_child, [delta, delta]).get(timeout=900):
                np.testing.assert_array_equal(there, here)

    def test_goes_to_another_process(self):
        again = pickle.loads(pickle.dumps(self.law))
        self.assertEqual(again.force(0.2), self.law.force(0.2))

    def test_speed_of_a_million_overlaps(self):
        """As fast as numpy's ** by itself, where that has no vector code; measured figures are in the guide. The bound is generous:
        twice the time of the law written with numpy, in however many cores happen to be free."""
        delta = np.random.default_rng(1).uniform(0.0, 0.4, 1_000_000)
        pair = self.law.pair("soft-solid").normal
        scale = self.law.youngs_modulus * self.law.shell_radius**2

        def with_numpy():
            return np.where(delta >= pair.delta, scale * (pair.a * delta**pair.b + pair.c), 0.0)

        ours, theirs, power = fastest(lambda: self.law.force(delta)), fastest(with_numpy), fastest(lambda: delta**pair.b)
        print(f"1e6 overlaps: law {1e3 * ours:.2f} ms, numpy's ** {1e3 * power:.2f} ms, the law with numpy {1e3 * theirs:.2f} ms",
              file=sys.stderr)
        self.assertLess(ours, 2.0 * theirs)
        np.testing.assert_allclose(self.law.force(delta), with_numpy(), rtol=1e-9, atol=1e-9)

    def test_figure(self):
        try:
            import matplotlib  # noqa: F401  pylint: disable=unused-import,import-outside-toplevel
        except ImportError:
            self.skipTest("no matplotlib")
        self.assertEqual(self.law._repr_png_()[:4], b"\x89PNG")  # pylint: disable=protected-access
        self.assertEqual(softgrain.Law.load(TABLE)._repr_png_()[:4], b"\x89PNG")  # pylint: disable=protected-access


class TableTest(unittest.TestCase):
    law = softgrain.Law.load(TABLE)

    def test_values_are_those_of_the_program(self):
        for form in ("pair", "isotropic", "directional"):
            for partner, ratio in (("plane", 1.0), ("solid", 0.5), ("soft", 0.8)):
                for arrangement in ("one", "cube", "icosahedron"):
                    with self.subTest(form=form, partner=partner, arrangement=arrangement):
                        sized = [] if partner == "plane" else ["--ratio", str(ratio)]
                        out = evaluated(TABLE, "--form", form, "--partner", partner, *sized, "--arrangement", arrangement, "--delta", "0.02",
                                        "0.13", "0.26", "--solid-fraction", "0.69", "--E", "2e6", "--radius", "0.02")
                        rows = (out["laws"][0] if "laws" in out else out)["values"]
                        choice = {"form": form, "ratio": ratio, "arrangement": arrangement, "solid_fraction": 0.69,
                                  "radius": 0.02, "modulus": 2e6}
                        delta = [r["delta"] for r in rows]
                        self.assertGreater(rows[-1]["force"], 0.0)
                        for name, method in (("force", self.law.force), ("stiffness", self.law.stiffness),
                                             ("kt_secant", self.law.tangential_stiffness)):
                            np.testing.assert_allclose(method(delta, partner, **choice), [r[name] for r in rows], rtol=1e-11, atol=1e-10)
                        for name, method in (("force", self.law.force_interval), ("stiffness", self.law.stiffness_interval)):
                            told = np.array([r[f"{name}_interval"] or (np.nan, np.nan) for r in rows], dtype=float)
                            np.testing.assert_allclose(np.stack(method(delta, partner, **choice), 1), told, rtol=1e-9, atol=1e-9)
                        volume = self.law.volume(delta, partner, **{k: v for k, v in choice.items() if k not in ("radius", "modulus")})
                        np.testing.assert_allclose(volume, [r["equivalent_volume"] for r in rows], rtol=1e-11)

    def test_forces_of_any_neighbours(self):
        """A cube of planes asked as an arrangement and as six neighbours; with one of them away it is softer."""
        cube = np.concatenate([np.eye(3), -np.eye(3)])
        overlap = np.full((4, 6), 0.1) * np.array([[0.5], [0.8], [1.0], [1.2]])
        forces = self.law.forces(overlap, 3.0 * cube)
        self.assertEqual(forces.shape, (4, 6))
        np.testing.assert_allclose(forces, np.repeat(self.law.force(overlap[:, 0], arrangement="cube")[:, None], 6, 1), rtol=1e-12)
        overlap[:, 5] = -0.3
        fewer = self.law.forces(overlap, cube)
        self.assertTrue((fewer[:, 5] == 0.0).all())
        self.assertTrue((fewer[1:, :5] < forces[1:, :5]).all())

    def test_mixed_neighbours_act_through_one_pressure(self):
        direction = [[1, 0, 0], [0, 1, 0]]
        alone = self.law.forces([0.12, 0.0], direction, ["plane", "solid"], [1, 0.5])[0]
        both = self.law.forces([0.12, 0.12], direction, ["plane", "solid"], [1, 0.5])[0]
        self.assertGreater(both, alone)
        self.assertEqual(self.law.forces([0.12, 0.12], direction, ["plane", "solid"], [1, 0.5], form="pair")[0],
                         self.law.forces([0.12, 0.0], direction, ["plane", "solid"], [1, 0.5], form="pair")[0])

    def test_stiffness_is_the_derivative(self):
        delta = np.linspace(0.12, 0.24, 13)
        step = 1e-6
        difference = (self.law.force(delta + step) - self.law.force(delta - step)) / (2 * step * self.law.shell_radius)
        np.testing.assert_allclose(self.law.stiffness(delta), difference, rtol=1e-6)

    def test_refusals(self):
        for ask in (lambda: self.law.force(0.1, solid_fraction=0.9), lambda: self.law.force(0.1, form="bagg"),
                    lambda: self.law.force(0.1, "solid", ratio=0.0), lambda: self.law.force(0.1, arrangement="cub"),
                    lambda: self.law.force(0.3, arrangement="cube", beyond="error"),
                    lambda: self.law.forces([[0.1, 0.1]], [[1, 0, 0]]), lambda: self.law.forces([0.1], [[0, 0, 0]])):
            with self.assertRaises(softgrain.InputError):
                ask()
        self.assertEqual(self.law.about(solid_fraction=0.9, range="clamp")["solid_fraction"], max(
            e["solid_fraction"] for e in self.law.card["entry"]))


class ArraysTest(unittest.TestCase):
    """Masks and empty arrays, of cards and tables alike."""

    def asks(self):
        card, table = softgrain.Law.load(CARD), softgrain.Law.load(TABLE)
        return (card.force, card.stiffness, card.tangential_stiffness, card.force_interval, table.force, table.stiffness,
                table.volume, table.force_interval)

    def test_what_is_masked_stays_masked(self):
        delta = np.ma.array([0.1, 99.0, 0.2], mask=[False, True, False])
        for ask in self.asks():
            with self.subTest(ask=ask.__qualname__):
                got, told = ask(delta, beyond="error"), ask(delta.compressed())
                for masked, plain in zip(got, told) if isinstance(got, tuple) else ((got, told),):
                    self.assertTrue(np.ma.isMaskedArray(masked))
                    np.testing.assert_array_equal(masked.mask, delta.mask)
                    np.testing.assert_array_equal(masked.compressed(), plain)
        inside = softgrain.Law.load(CARD).inside(delta)
        self.assertEqual(inside.tolist(), [True, None, True])

    def test_empty_arrays_give_empty_arrays(self):
        for ask in self.asks():
            for empty in ([], np.array([]), np.empty((0, 3)), np.empty((2, 0)), np.array([0.1])[[False]], np.array([], dtype=bool)):
                got = ask(empty)
                for one in got if isinstance(got, tuple) else (got,):
                    self.assertEqual(np.shape(one), np.shape(empty), ask.__qualname__)
        table = softgrain.Law.load(TABLE)
        self.assertEqual(table.forces(np.empty((0, 2)), [[1, 0, 0], [-1, 0, 0]]).shape, (0, 2))

    def test_flags_and_what_is_no_number_are_refused(self):
        table = softgrain.Law.load(TABLE)
        for wrong in (np.array([True, False]), True, ["0.1"], "0.1", [[0.1], [0.1, 0.2]], np.array([0.1j])):
            for ask in (*self.asks(), lambda d: table.forces(d, [[1, 0, 0]])):
                with self.assertRaisesRegex(softgrain.InputError, "array of numbers"):
                    ask(wrong)
        with self.assertRaisesRegex(softgrain.InputError, "flags choose elements"):
            table.force(np.array([True]))
        with self.assertRaisesRegex(softgrain.InputError, "one column per neighbour"):
            table.forces([], [[1, 0, 0]])


class LoadTest(InEmptyFolder):
    def test_a_byte_order_mark_is_no_mistake(self):
        with open("law.toml", "wb") as file:
            file.write(b"\xef\xbb\xbf" + CARD.read_bytes())
        self.assertEqual(softgrain.Law.load("law.toml").force(0.2), softgrain.Law.load(CARD).force(0.2))
        with open("law_table.toml", "wb") as file:
            file.write(b"\xef\xbb\xbf" + TABLE.read_bytes())
        self.assertEqual(softgrain.Law.load("law_table.toml").force(0.2), softgrain.Law.load(TABLE).force(0.2))

    def test_wrong_files(self):
        with self.assertRaises(softgrain.IoError):
            softgrain.Law.load("nothing.toml")
        text = CARD.read_text().replace("delta_max = 0.3", "delta_mx = 0.3", 1)
        with open("law.toml", "w", encoding="utf-8") as file:
            file.write(text)
        with self.assertRaises(softgrain.InputError) as caught:
            softgrain.Law.load("law.toml")
        error = caught.exception
        self.assertEqual((error.file, error.key, error.nearest), ("law.toml", "delta_max", "delta_mx"))
        self.assertEqual(text.splitlines()[error.line - 1], "[pair.validity]")
        with self.assertRaisesRegex(softgrain.InputError, "cell law"):
            softgrain.Law.load(next((ROOT / "results/material_law").glob("cell_law*.toml")))
        with self.assertRaisesRegex(softgrain.InputError, "without"):
            os.mkdir("empty")
            softgrain.Law.load("empty")


class LibraryTest(InEmptyFolder):
    def test_a_law_by_the_material_and_by_a_press_test(self):
        known = softgrain.Law.from_library("known.toml", mu=0.3, exponent=3.5, ratio=10, solid_fraction=0.7)
        pressed = softgrain.Law.from_library("pressed.toml", press_test=ROOT / "pipelines/press_test.csv", mu=0.3)
        delta = [0.2, 0.3]
        self.assertEqual(pressed.about()["form"], "isotropic")
        # The example is a press test of that material.
        np.testing.assert_allclose(pressed.force(delta, arrangement="cube"), known.force(delta, arrangement="cube"), rtol=0.2)
        told = program_json("law", "get", "--press-test", ROOT / "pipelines/press_test.csv", "--mu", "0.3")
        self.assertAlmostEqual(told["material"]["mu"], 0.3)
        self.assertNotIn("exponent", told["material"])

    def test_what_is_missing_is_said(self):
        with self.assertRaisesRegex(softgrain.InputError, "--exponent is needed"):
            softgrain.Law.from_library("x.toml", mu=0.3)
        with self.assertRaisesRegex(softgrain.InputError, "needs the friction of the grains"):
            softgrain.Law.from_library("x.toml", press_test=ROOT / "pipelines/press_test.csv")


if __name__ == "__main__":
    unittest.main()
