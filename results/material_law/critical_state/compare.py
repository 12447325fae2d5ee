#!/usr/bin/env python3
"""NorSand, SANISAND (2004) and the cell law with shear memory beside resolved packings, at the material point.

    python3 compare.py FINES [--blind RUN ...] [--curves FILE.csv]

FINES: folder of a finished run of kind material-law with shear memory. All numbers of each model are fitted to its
fines, one set for loose and dense. RUN: folders of finished runs of kind material or material-models; their packings
are predicted with the same numbers. Equations and sources: models.cpp, which is compiled with g++ into a temporary
folder. Needs numpy and h5py.
"""
import argparse
import csv
import ctypes
import json
import pathlib
import re
import subprocess
import tempfile
import time

import h5py
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent

# Residuals as in the fit of the card (pipelines/kinds/material_law/memory_fit.cpp): ln p, (sigma_z - mean of the
# sides)/p, solid fraction; the last in place of the first where the sides keep their stress.
PRESSURE_UNIT, RATIO_UNIT, FRACTION_UNIT, FLOOR, MOST = 0.08, 0.05, 0.008, 3e-6, 20.0
SHEARED = 0.01  # relative errors count beyond this axial strain, there and back, of the stages that shear

# name, low, high, start, logarithmic
ELASTIC = [("K", 0.01, 0.3, 0.037, True), ("n", 1.2, 2.6, 1.65, False)]
MODELS = {
    "NorSand": (0, ELASTIC + [
        ("r", 0.05, 3.0, 0.6, True), ("e_G", 0.2, 0.7, 0.41, False), ("l", 0.05, 30.0, 2.9, True),
        ("xi", 0.2, 1.2, 0.6, False), ("M", 0.4, 1.3, 0.76, False), ("N", 0.0, 0.7, 0.1, False),
        ("chi", 0.5, 12.0, 7.0, True), ("H_0", 3.0, 3000.0, 260.0, True), ("H_psi", -3000.0, 6000.0, 900.0, False),
        ("R", 1.0, 2.7, 1.1, False)]),
    "SANISAND": (1, ELASTIC + [
        ("r", 0.05, 3.0, 0.84, True), ("e_G", 0.2, 0.7, 0.42, False), ("l", 0.05, 30.0, 2.85, True),
        ("xi", 0.2, 1.2, 0.63, False), ("M", 0.4, 1.3, 0.7, False), ("c", 0.6, 1.0, 0.998, False),
        ("h_0", 0.02, 100.0, 4.5, True), ("c_h", 0.0, 2.0, 1.99, False), ("n_b", 0.0, 15.0, 6.9, False),
        ("A_0", 0.02, 5.0, 0.95, True), ("n_d", 0.0, 15.0, 0.05, False)]),
    "cell law": (2, ELASTIC + [
        ("mu_f", 0.1, 2.0, 0.56, True), ("chi", 0.2, 15.0, 2.6, True), ("A", 0.05, 2.0, 0.84, False),
        ("r_c", 0.7, 1.3, 0.96, False), ("m", 1.0, 200.0, 25.0, True), ("c", 0.1, 0.98, 0.95, False)]),
}
CELL = MODELS["cell law"][1]
MODELS["cell law, strength exp(-m psi)"] = (3, CELL[:-1])
MODELS["cell law, stiffness exp(-k psi)"] = (4, CELL + [("k", -20.0, 60.0, 5.0, False)])
MODELS["cell law, with lambda"] = (5, CELL + [("lambda", -2.0, 2.0, -0.2, False)])


class Path:
    """One loading of one sample: logarithmic strains, stresses over E, void ratio, lateral stress where it is kept."""

    def __init__(self, name, strain, stress, fraction, kind):
        self.name, self.strain, self.stress, self.fraction, self.kind = name, strain, stress, fraction, kind
        self.void_ratio = 1.0 / fraction - 1.0
        self.kept = np.array([k > 0 and one == "triaxial" for k, one in enumerate(kind)])
        self.lateral = np.ascontiguousarray(np.where(self.kept, stress[:, :2].mean(axis=1), 0.0))
        self.pressure = stress[0].mean()
        shears = [k > 0 and one != "isotropic" for k, one in enumerate(kind)]
        self.shears = np.array(shears)
        first = max(shears.index(True) - 1, 0) if True in shears else 0
        run = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(strain[:, 2])))])
        self.beyond = self.shears & (run - run[first] > SHEARED)
        self.unloads = np.array([one == "unload" for one in kind])

    @classmethod
    def of_group(cls, name, group):
        modulus = float(group.attrs["youngs_modulus"])
        take = lambda key: np.asarray(group[key], dtype=float)
        stages = [line.split()[0] for line in group.attrs["stages"].decode().strip().split("\n")]
        return cls(name, -np.log1p(-np.stack([take(f"strain_{a}") for a in "xyz"], axis=1)),
                   np.stack([take("stress_x"), take("stress_y"), take("stress_axial")], axis=1) / modulus,
                   take("more/solid_fraction"), [stages[int(s)] for s in take("stage")])

    @classmethod
    def of_rows(cls, name, rows):
        """Rows of ../../material/curves.csv: means over samples."""
        take = lambda key: np.array([float(row[key]) for row in rows])
        axial = -np.log1p(-take("strain_z"))
        x, y = {"isotropic": (1, 1), "shear": (-1, 0)}.get(rows[0]["stage"], (0, 0))
        return cls(name, np.stack([x * axial, y * axial, axial], axis=1),
                   np.stack([take("lateral/E"), take("lateral/E"), take("axial/E")], axis=1), take("solid_fraction"),
                   [row["stage"] for row in rows])


def read(file, name):
    """All curves of a file that a run wrote, in the order of samples."""
    with h5py.File(file) as f:
        root = f["curves"] if "curves" in f else f
        return [Path.of_group(name, root[key]) for key in sorted(root) if key.startswith("curve_")]


def compile_models():
    folder = tempfile.mkdtemp()
    library = pathlib.Path(folder) / "models.so"
    subprocess.run(["nice", "-n", "5", "g++", "-std=c++20", "-O2", "-shared", "-fPIC", str(HERE / "models.cpp"), "-o",
                    str(library)], check=True)
    lib = ctypes.CDLL(str(library))
    pointer = ctypes.POINTER(ctypes.c_double)
    lib.run.argtypes = [ctypes.c_int, pointer] + [ctypes.c_double] * 2 + [pointer, ctypes.c_int] + [pointer] * 3
    lib.run.restype = None
    return lib


class Model:
    """A model with its numbers."""

    def __init__(self, lib, name, tail):
        self.lib, self.name, self.tail = lib, name, tail
        self.code, self.numbers = MODELS[name]
        self.cells = self.code >= 2

    def follow(self, values, path, grading):
        """Stresses and void ratios along a path. `grading`: shift and factor of void ratios; cell law: e_J."""
        out = np.zeros((len(path.strain), 4))
        par = np.array(([self.tail] if self.cells else []) + list(values))
        grading = np.array(grading, dtype=float)
        as_pointer = lambda a: a.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        strain = np.ascontiguousarray(path.strain)
        self.lib.run(self.code, as_pointer(par), path.pressure, path.void_ratio[0], as_pointer(grading),
                     len(strain), as_pointer(strain), as_pointer(path.lateral), as_pointer(out))
        return np.nan_to_num(out[:, :3], nan=1.0, posinf=1.0), np.nan_to_num(out[:, 3], nan=1.0)

    def onset(self, values, path):
        """Void ratio at which the packing of a path jams, by the equation of state."""
        x = (path.pressure / values[0]) ** (1.0 / values[1])
        return 1.0 / ((path.fraction[0] - x) / (1.0 - x)) - 1.0


def ratio(stress, p):
    return (stress[:, 2] - stress[:, :2].mean(axis=1)) / p


def residuals(path, stress, void_ratio):
    p = path.stress.mean(axis=1)
    first = np.where(path.kept, (1.0 / (1.0 + void_ratio) - path.fraction) / FRACTION_UNIT,
                     np.log((np.maximum(stress.mean(axis=1), 0.0) + FLOOR) / (p + FLOOR)) / PRESSURE_UNIT)
    second = (ratio(stress, p + FLOOR) - ratio(path.stress, p + FLOOR)) / RATIO_UNIT
    both = np.concatenate([first[1:], second[1:]]) / np.sqrt(len(p) - 1)
    return np.clip(both, -MOST, MOST)


def fit(model, paths, base, starts, seed=1):
    """Levenberg and Marquardt's method within bounds, from several starts. `base`: path that gives e_J."""
    low, high, start, logarithmic = (np.array([n[k] for n in model.numbers]) for k in (1, 2, 3, 4))
    logarithmic = logarithmic.astype(bool)
    inward = lambda v: np.where(logarithmic, np.log(np.where(logarithmic, v, 1.0)), v)
    outward = lambda x: np.where(logarithmic, np.exp(np.where(logarithmic, x, 0.0)), x)
    a, b = inward(low), inward(high)
    calls = [0]

    def all_residuals(x):
        calls[0] += 1
        values = outward(x)
        grading = [model.onset(values, base)] if model.cells else [0.0, 1.0]
        return np.concatenate([residuals(p, *model.follow(values, p, grading)) for p in paths])

    random = np.random.default_rng(seed)
    best = None
    ends = []
    for s in range(starts):
        x = inward(start) if s == 0 else np.clip(inward(start) + 0.15 * (b - a) * random.standard_normal(len(a)), a, b)
        r = all_residuals(x)
        damping = 1e-2
        for turn in range(60):
            if turn == 8 and best is not None and r @ r > 2.5 * best[0]:
                break
            step = 1e-4 * (b - a)
            step = np.where(x + step > b, -step, step)
            J = np.stack([(all_residuals(x + np.eye(len(x))[k] * step[k]) - r) / step[k] for k in range(len(x))], 1)
            JJ, before = J.T @ J, r @ r
            for _ in range(8):
                dx = np.linalg.solve(JJ + damping * np.diag(np.diag(JJ) + 1e-9), -J.T @ r)
                trial = np.clip(x + dx, a, b)
                new = all_residuals(trial)
                if new @ new < r @ r:
                    x, r, damping = trial, new, max(damping / 5, 1e-9)
                    break
                damping *= 4
            if r @ r > before * (1 - 1e-5):
                break
        ends.append(r @ r)
        if best is None or r @ r < best[0]:
            best = (r @ r, outward(x))
    at_bound = [n[0] for k, n in enumerate(model.numbers) if min(inward(best[1])[k] - a[k], b[k] - inward(best[1])[k])
                < 1e-3 * (b[k] - a[k])]
    printed(f"{model.name}: cost {best[0]:.2f} of starts {np.round(sorted(ends), 1)}, {calls[0]} evaluations, bounds: "
          f"{at_bound}\n  " + ", ".join(f"{n[0]} = {v:.4g}" for n, v in zip(model.numbers, best[1])))
    return best[1], at_bound


def errors(path, stress, void_ratio):
    """Root mean squares over the points of a path; relative errors of stresses that the test does not prescribe."""
    rms = lambda v: float(np.sqrt(np.mean(np.square(v)))) if len(v) else float("nan")
    p, own = path.stress.mean(axis=1), np.maximum(stress.mean(axis=1), 1e-9)
    axial = stress[:, 2] / path.stress[:, 2] - 1.0
    lateral = stress[:, :2].mean(axis=1) / path.stress[:, :2].mean(axis=1) - 1.0
    out = {"q/p": rms((ratio(stress, own) - ratio(path.stress, p))[path.shears]),
           "(q model - q)/p": rms((ratio(stress, p) - ratio(path.stress, p))[1:]),
           "axial": rms(axial[path.beyond]), "axial at the end": float(axial[-1]),
           "lateral": rms(lateral[path.beyond & ~path.kept]),
           "void ratio": rms((void_ratio - path.void_ratio)[path.kept]),
           "void ratio at the end": float(void_ratio[-1] - path.void_ratio[-1]) if path.kept[-1] else float("nan"),
           "pressure, isotropic": rms((own / p - 1.0)[1:][~path.shears[1:]]), "unloading modulus": float("nan")}
    if path.unloads.any():
        k = int(np.argmax(path.unloads))
        slope = lambda s: s[k, 2] - s[k - 1, 2]
        out["unloading modulus"] = float(slope(stress) / slope(path.stress) - 1.0)
    return out



def printed(line):
    print(line, flush=True)


def fines_of(folder):
    """Paths of the fines of a card, the isotropic one of its preparation first."""
    files = sorted(folder.glob("material_fines*.h5"), key=lambda f: (f.stem != "material_fines", f.stem))
    return [p for f in files for p in read(f, re.sub("^material_", "", f.stem))]


def blind_of(folder):
    """Paths of a run of kind material or material-models, and for each that of the packing prepared as the card's."""
    files = [f for f in sorted(folder.glob("material_*.h5")) if not f.stem.startswith("material_initial")]
    paths = [p for f in files for p in read(f, re.sub("^material_", "", f.stem))]
    # Of a dense packing of another grading nothing is known of the loose one.
    paths = [p for p in paths if "-dense" not in p.name]
    fast = [p for p in paths if p.name.startswith("fast")]
    return [(p, fast[0] if re.match("(fast|slow|dense)-", p.name) else p) for p in paths]


def curves_of(file):
    """The same of curves.csv, without other frictions."""
    rows = {}
    with open(file) as f:
        for row in csv.DictReader(f):
            if not row["variant"].startswith("mu"):
                rows.setdefault(row["variant"], []).append(row)
    paths = {name: Path.of_rows(name, same) for name, same in rows.items()}
    return [(p, paths.get(re.sub("^(slow|dense)-(.*)-.*", r"fast-\2-oedometric", p.name), p)) for p in paths.values()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fines", type=pathlib.Path)
    parser.add_argument("--blind", type=pathlib.Path, nargs="*", default=[])
    parser.add_argument("--curves", type=pathlib.Path, help="../../material/curves.csv")
    parser.add_argument("--starts", type=int, default=1)
    parser.add_argument("--numbers", type=pathlib.Path, help="numbers of an earlier fit; without it they are fitted")
    parser.add_argument("--out", type=pathlib.Path, default=HERE)
    options = parser.parse_args()
    lib = compile_models()
    paths = fines_of(options.fines)
    base = paths[0]
    summary = json.loads((options.fines / "summary.json").read_text())["cell_law"]
    card = {n["name"]: n["value"] for n in summary["numbers"]}
    models = {name: Model(lib, name, card["x_r"]) for name in MODELS}
    sets = {"cell law, card": (models["cell law"], np.array([card[n[0]] for n in MODELS["cell law"][1]]))}
    if options.numbers:
        with open(options.numbers) as f:
            known = {(r["model"], r["number"]): float(r["value"]) for r in csv.DictReader(f)}
        for name, model in models.items():
            sets[name] = (model, np.array([known[name, n[0]] for n in model.numbers]))
    else:
        rows = []
        for name, model in models.items():
            before = time.process_time()
            values, at_bound = fit(model, paths, base, options.starts)
            printed(f"  {time.process_time() - before:.0f} s of one core")
            sets[name] = (model, values)
            rows += [{"model": name, "number": n[0], "value": f"{v:.6g}", "low": n[1], "high": n[2],
                      "at a bound": "yes" if n[0] in at_bound else "no"} for n, v in zip(model.numbers, values)]
        write(options.out / "numbers.csv", rows)
    cases = [("fines (fitted)", p, base) for p in paths]
    for folder in options.blind:
        cases += [(folder.name, p, own) for p, own in blind_of(folder)]
    if options.curves:
        cases += [("curves.csv", p, own) for p, own in curves_of(options.curves)]
    rows = []
    for data, path, own in cases:
        for title, (model, values) in sets.items():
            if model.cells:
                grading = {"": [card["e_J"] if title.endswith("card") and own is base else model.onset(values, own)]}
            else:
                grading = {", scaled": [0.0, own.void_ratio[0] / base.void_ratio[0]],
                           ", shifted": [own.void_ratio[0] - base.void_ratio[0], 1.0]}
            for how, g in grading.items():
                if how == ", shifted" and (own is base or data == "curves.csv"):
                    continue
                rows.append({"data": data, "test": path.name, "model": title + (how if own is not base else ""),
                             **errors(path, *model.follow(values, path, g))})
    for r in rows:
        printed(" ".join([r["test"].ljust(28), r["model"].ljust(15)] +
                         [f"{k} {v:.3f}" for k, v in r.items() if isinstance(v, float) and v == v]))
    write(options.out / "errors.csv", rows)


def write(file, rows):
    with open(file, "w", newline="") as f:
        out = csv.DictWriter(f, rows[0].keys(), lineterminator="\n")
        out.writeheader()
        for r in rows:
            out.writerow({k: ("" if isinstance(v, float) and v != v else f"{v:.4g}" if isinstance(v, float) else v)
                          for k, v in r.items()})


if __name__ == "__main__":
    main()
