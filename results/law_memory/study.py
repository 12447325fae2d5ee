#!/usr/bin/env python3
"""Does a soft particle need a memory? Multi-contact laws with a state in macro scenes, beside the resolved twins of
results/macro_vs_resolved, whose curves are in its pictures and its table.

  study.py --self-test               passivity of every form (needs numpy)
  study.py [--out FOLDER] NAME=RUN...   writes macro.csv; each RUN is one of laws.toml, by the program with
                                     --set law.unloading_ratio=S or by that of tests/bench/law_memory/build.sh (needs numpy and h5py)

All forms share the isotropic law of results/law_table: a soft particle of radius R with the lost volumes nu_c of its contacts
bears F_c = E R^2 (d nu_c/dx) p(S), S = sum nu_c, x the overlap over R. What a form changes is the volume that the pressure sees:

  none      p(S)
  maximum   p(M - s (M - S)), M the largest S so far, s >= 1
  shear     p(S - J), dJ = A dg where p > 0, dg = sum |d nu_c| - |dS|: what is lost at one contact while another gives back
  work      p(S - J), dJ = A max(dg - |dQ|/p, 0), Q the stored energy over E R^3: compaction by what shear does not store
  both      maximum with S - J in place of S, J as in shear

A soft particle has one number of state (both: two), a form one constant (both: two). With P the integral of p, the energy over
E R^3 is P(S), P(M - s (M - S))/s, P(S - J). At fixed places it falls when the state moves (dU/dM = p (1/s - 1) <= 0,
dU/dJ = -p <= 0), so that no closed cycle of overlaps gains energy."""
import argparse
import csv
import itertools
import math
import pathlib
import re
import sys
import tomllib

try:
    import numpy as np
except ImportError:
    print(f"{sys.argv[0]}: needs numpy (Debian: python3-numpy)", file=sys.stderr)
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
TWINS = HERE.parent / "macro_vs_resolved"
PICTURES = ("oedometric-35", "shear-35", "unloading")  # scenes whose curves are there


class Curve:
    """Steffen's monotone cubic, as common/core/monotone_curve.h."""

    def __init__(self, x, y):
        self.x, self.y = list(x), list(y)
        n = len(self.x)
        chord = [(self.y[k + 1] - self.y[k]) / (self.x[k + 1] - self.x[k]) for k in range(n - 1)]
        self.slope = [self.at_point(k, chord) for k in range(n)] if n > 1 else [0.0]
        self.chord = chord

    def at_point(self, k, chord):
        if k == 0:
            return chord[0]
        if k + 1 == len(self.x):
            return chord[-1]
        a, b = chord[k - 1], chord[k]
        h0, h1 = self.x[k] - self.x[k - 1], self.x[k + 1] - self.x[k]
        parabola = (a * h1 + b * h0) / (h0 + h1)
        return (math.copysign(1.0, a) + math.copysign(1.0, b)) * min(abs(a), abs(b), 0.5 * abs(parabola))

    def __call__(self, x):
        if len(self.x) == 1 or x <= self.x[0]:
            return self.y[0]
        if x >= self.x[-1]:
            return self.y[-1]
        k = max(j for j in range(len(self.x)) if self.x[j] <= x)
        h, s, t = self.x[k + 1] - self.x[k], self.chord[k], x - self.x[k]
        return self.y[k] + t * (self.slope[k] + t * ((3 * s - 2 * self.slope[k] - self.slope[k + 1]) / h
                                                     + t * (self.slope[k] + self.slope[k + 1] - 2 * s) / h / h))


class Law:
    """The isotropic law of the main entry of a table."""

    def __init__(self, path):
        with open(path, "rb") as f:
            table = tomllib.load(f)
        entry = next(e for e in table["entry"] if e.get("main"))
        law = next(e for e in entry["law"] if e["form"] in ("bag", "isotropic"))
        self.a, self.b, self.delta = (law[k]["value"] for k in ("a", "b", "delta"))
        rows = {kind: [(r["ratio"], math.log(r["weight"]["value"]), r["exponent"]["value"]) for r in law["partner"] if r["kind"] == kind]
                for kind in ("solid", "soft", "plane")}
        x = [math.log(r[0]) for r in rows["solid"]] + [math.log(max(100.0, 2.0 * rows["solid"][-1][0]))]
        self.solid = Curve(x, [r[1] for r in rows["solid"]] + [0.0])
        self.solid_exponent = Curve(x, [r[2] for r in rows["solid"]] + [1.0])
        mirrored = [(-math.log(r[0]), r[1]) for r in reversed(rows["soft"]) if r[0] > 1.0]
        mirrored += [(math.log(r[0]), r[1]) for r in rows["soft"]]
        self.soft = Curve(*zip(*mirrored))
        self.soft_exponent = rows["soft"][0][2]
        self.smooth = (math.exp(rows["plane"][0][1]), rows["plane"][0][2])
        d = np.linspace(0.0, 1.6, 16001)
        force = np.where(d > self.delta, self.a * (d ** self.b - self.delta ** self.b), 0.0)
        disk = 0.75 * d * (2.0 - d)
        self.depth_volume = 0.75 * d * d * (1.0 - d / 3.0)
        self.depth = d
        p = np.divide(force, disk, out=np.zeros_like(d), where=disk > 0.0)
        self.energy_at = np.concatenate([[0.0], np.cumsum(0.5 * (p[1:] + p[:-1]) * np.diff(self.depth_volume))])

    def pressure(self, s):
        d = float(np.interp(s, self.depth_volume, self.depth)) if s > 0.0 else 0.0
        return self.a * (d ** self.b - self.delta ** self.b) / (0.75 * d * (2.0 - d)) if d > self.delta else 0.0

    def energy(self, s):
        return float(np.interp(s, self.depth_volume, self.energy_at)) if s > 0.0 else 0.0

    def constants(self, kind, ratio, smooth=False):
        if kind == "wall":
            return self.smooth if smooth else (1.0, 1.0)
        if kind == "solid":
            return math.exp(self.solid(math.log(ratio))), self.solid_exponent(math.log(ratio))
        return math.exp(self.soft(math.log(ratio))), self.soft_exponent

    @staticmethod
    def lost(x, curvature, w, m):
        """nu and d nu/dx, as common/contact/multi_contact_form.h."""
        if not x > 0.0:
            return 0.0, 0.0
        s, kx = 1.0 + curvature, curvature * x
        over = 1.0 / (s - kx)
        depth = 0.5 * x * (2.0 - kx) * over
        volume = 0.75 * x * x * (1.0 + x * (kx / 12.0 - s / 3.0)) * over
        slope = 0.75 * depth * (2.0 - depth)
        nu = w * volume ** m
        return nu, (w * slope if m == 1.0 else m * nu / volume * slope)


class Side:
    """One contact of a soft particle: its name, kind (solid, wall, soft), overlap x over R, R over the radius of the other, w and m."""
    __slots__ = ("key", "kind", "x", "curvature", "w", "m")

    def __init__(self, law, key, kind, x, ratio, smooth=False):
        self.key, self.kind, self.x, self.curvature = key, kind, x, 0.0 if kind == "wall" else 1.0 / ratio
        self.w, self.m = law.constants(kind, ratio, smooth)


class Particle:
    """A soft particle with its state; push() takes it to the next places and returns the force of every contact over E R^2."""

    def __init__(self, law, form="none", s=1.0, A=0.0):
        self.law, self.form, self.s, self.A = law, form, s, A
        self.maximum, self.J, self.nu, self.S, self.Q = 0.0, 0.0, {}, 0.0, 0.0

    def seen(self, S):
        e = S - self.J
        if self.form in ("maximum", "both"):
            self.maximum = max(self.maximum, e)
            e = self.maximum - self.s * (self.maximum - e)
        return e

    def push(self, sides):
        now, slopes = {}, {}
        for c in sides:
            now[c.key], slopes[c.key] = self.law.lost(c.x, c.curvature, c.w, c.m)
        S = sum(now.values())
        if self.form in ("shear", "work", "both") and self.A > 0.0:
            moves = [now.get(k, 0.0) - self.nu.get(k, 0.0) for k in sorted(set(now) | set(self.nu))]
            g = sum(abs(d) for d in moves) - abs(sum(moves))
            p = self.law.pressure(0.5 * (S + self.S) - self.J)
            if p > 0.0:
                if self.form == "work":
                    g = max(g - abs(self.law.energy(S - self.J) - self.Q) / p, 0.0)
                self.J += self.A * g
        self.nu, self.S = now, S
        self.Q = self.law.energy(S - self.J)
        p = self.law.pressure(self.seen(S))
        return {k: p * slopes[k] for k in now}

    def stored(self):
        """U over E R^3."""
        if self.form in ("maximum", "both"):
            return self.law.energy(self.seen(self.S)) / self.s
        return self.law.energy(self.S - self.J)


def self_test():
    law = Law(HERE.parent / "law_table" / "law_table.toml")
    random = np.random.default_rng(7)
    numbers = {"none": {}, "maximum": {"s": 1.3}, "shear": {"A": 0.3}, "work": {"A": 0.3}, "both": {"s": 1.3, "A": 0.3}}
    contacts = [("wall", 0.0), ("solid", 1.0), ("soft", 1.5), ("wall", 0.0)]
    for form, constants in numbers.items():
        worst = math.inf
        for _ in range(8):  # closed random cycles of four overlaps; the second time round counts too
            corners = random.uniform(0.0, 0.3, (5, 4))
            path = np.concatenate([np.linspace(a, b, 60, endpoint=False) for a, b in itertools.pairwise([*corners, corners[0]])])
            particle = Particle(law, form, **constants)
            sides = lambda row: [Side(law, k, kind, x, ratio) for k, ((kind, ratio), x) in enumerate(zip(contacts, row))]
            force, last = particle.push(sides(path[0])), path[0]
            for _ in range(2):
                work, stored = 0.0, particle.stored()
                for row in [*path[1:], path[0]]:
                    after = particle.push(sides(row))
                    work += sum(0.5 * (force[k] + after[k]) * (row[k] - last[k]) for k in range(4))
                    force, last = after, row
                worst = min(worst, work + stored - particle.stored())
        assert worst > -2e-5, f"{form}: a cycle gains {-worst}"
        print(f"{form}: least loss in a closed cycle {worst:.2e} E R^3")
    gains = Particle(law, "maximum", s=0.7)  # a branch that is flatter than loading must be found out
    there, back = np.linspace(0.0, 0.3, 200), np.linspace(0.3, 0.0, 200)
    work, last, force = 0.0, 0.0, 0.0
    for x in [*there, *back]:
        after = gains.push([Side(law, 0, "wall", x, 0.0)])[0]
        work, last, force = work + 0.5 * (force + after) * (x - last), x, after
    assert work < -1e-4, work
    one = Particle(law).push([Side(law, 0, "wall", 0.2, 0.0)])[0]
    assert abs(one - law.a * (0.2 ** law.b - law.delta ** law.b)) < 1e-6 * one, one
    print("self-test passed")


def twin_curves(scene):
    """Per sample: strain [%] and axial stress [Pa] of the shelled twin, from the picture."""
    text = (TWINS / f"axial-stress-{scene}.svg").read_text()
    unit = 1000.0 if re.search(r'data-y-label="axial stress \[kPa\]"', text) else 1.0
    out = {}
    for sample, x, y in re.findall(r"<title>resolved twin \(shelled\), sample (\d+): x = ([-\d.e+]+), y = ([-\d.e+]+)</title>", text):
        out.setdefault(int(sample), []).append((float(x), unit * float(y)))
    return {k: np.array(v) for k, v in out.items()}


def law_curves(run, scene):
    """Per sample: strain [%], axial stress [Pa] and stage."""
    import h5py
    with h5py.File(pathlib.Path(run) / f"macro_{scene}.h5") as f:
        return {int(g.attrs["sample"]): (100.0 * g["strain"][:], g["stress_axial"][:], g["stage"][:]) for g in f["curves"].values()}


def pairs_of(run, scene):
    """Stresses of law and twin at the points of the picture that bear, samples by points; points of a test in stages go by number."""
    law, twin = law_curves(run, scene), twin_curves(scene)
    rows = []
    for sample, points in sorted(twin.items()):
        strain, stress, _ = law[sample]
        if scene == "oedometric-35":
            x = twin[0][-7:, 0]
            rows.append((np.interp(x, strain, stress), np.interp(x, points[:, 0], points[:, 1])))
        else:
            rows.append((stress[-len(points):], points[:, 1]))
    return np.array([r[0] for r in rows]), np.array([r[1] for r in rows])


def error_of_mean(law, twin):
    """Root mean square deviation of the mean curve over that of the twin's mean curve [%]."""
    return 100.0 * math.sqrt(np.mean((law.mean(0) - twin.mean(0)) ** 2) / np.mean(twin.mean(0) ** 2))


def mean_error(values):
    return f"{np.mean(values):.3f}({np.std(values, ddof=1) / math.sqrt(len(values)):.3f})"


def unloaded(run):
    """Ratios of law and twin per sample in the scene `unloading`: fall over the first step back, stress at its end, and reloaded."""
    law, twin = pairs_of(run, "unloading")
    top, low = law.shape[1] - 8, law.shape[1] - 4
    return ((law[:, top] - law[:, top + 1]) / (twin[:, top] - twin[:, top + 1]), law[:, low] / twin[:, low], law[:, -1] / twin[:, -1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("runs", nargs="*", metavar="NAME=RUN")
    parser.add_argument("--out", type=pathlib.Path, default=HERE)
    a = parser.parse_args()
    if a.self_test:
        return self_test()
    if not a.runs or not all("=" in r for r in a.runs):
        parser.error("name runs of laws.toml as NAME=RUN, or --self-test")
    with open(TWINS / "table.csv") as f:
        ends = {r["scene"]: float(r["axial stress [Pa]"].split()[0]) for r in csv.DictReader(f) if r["engine"] == "shelled"}
    rows = []
    for name, run in (r.split("=", 1) for r in a.runs):
        row = {"form": name}
        for scene in PICTURES:
            row[f"{scene}: error of the mean [%]"] = f"{error_of_mean(*pairs_of(run, scene)):.1f}"
        row.update(zip(("fall at first: law/twin", "unloaded: law/twin", "reloaded: law/twin"), map(mean_error, unloaded(run))))
        for scene, end in ends.items():
            if (pathlib.Path(run) / f"macro_{scene}.h5").exists():
                row[f"{scene}: end, law/twin"] = f"{np.mean([c[1][-1] for c in law_curves(run, scene).values()]) / end:.3f}"
        rows.append(row)
    columns = list(dict.fromkeys(k for row in rows for k in row))
    with open(a.out / "macro.csv", "w", newline="") as f:
        out = csv.DictWriter(f, columns, restval="", lineterminator="\n")
        out.writeheader()
        out.writerows(rows)
    print((a.out / "macro.csv").read_text(), end="")
    return None


if __name__ == "__main__":
    sys.exit(main())
