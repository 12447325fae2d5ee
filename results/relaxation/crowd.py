#!/usr/bin/env python3
"""crowd.md of this folder from the crowd runs of study.sh: python3 results/relaxation/crowd.py WORK_DIRECTORY (needs h5py)"""
import math
import pathlib
import sys

import h5py
import numpy as np

HERE = pathlib.Path(__file__).parent
# name of the run: what it is
SETTINGS = {
    "crowd-scenes": "scenes' choice: step x 4, settling 240",
    "crowd-finer": "step x 2, settling 480",
    "crowd-longer": "step x 4, settling 480",
    "crowd-short": "step x 2, settling 120",
    "crowd-damped": "damped, increment 0.005",
    "crowd-damped-half": "damped, increment 0.0025",
}
EXTRAPOLATED = "damped, extrapolated to no increment"
NAMES = {"one-plane": "one plane", "cube-plane": "six planes", "tetrahedron-plane": "four planes",
         "cube-plane-slide": "six planes, one slides", "one-soft-1": "one soft neighbour", "cube-soft-1": "six soft neighbours"}


class Points:
    """(configuration, packing): list of (slide, overlap, mean normal force, drag of the first neighbour); loop passes by configuration."""

    def __init__(self, file):
        with h5py.File(file) as f:
            names = [f["configurations"].attrs[f"name_{k}"].decode() for k in range(len(f["configurations/held_out"]))]
            runs = f["runs"]
            normal, overlap = runs["neighbours/normal"][:], runs["neighbours/overlap"][:]
            drag = np.sqrt(sum(runs[f"neighbours/tangential_{c}"][:] ** 2 for c in "xyz"))
            slide, neighbours = runs["points/slide"][:], runs["points/neighbours"][:]
            self.states, self.passes = {}, {}
            point = row = 0
            for k, count in enumerate(runs["point_count"][:]):
                name = names[runs["configuration"][k]]
                states = self.states[name, int(runs["packing"][k])] = []
                for _ in range(count):
                    n = neighbours[point]
                    states.append((slide[point], overlap[row], normal[row:row + n].mean(), drag[row]))
                    point, row = point + 1, row + n
                self.passes.setdefault(name, []).append(runs["loop_passes"][k] / count)

    def column(self, name, state, quantity, packings):
        return np.array([self.states[name, p][state][quantity] for p in packings])


def bias(ours, reference):
    """Of the ratio of means in per cent, with its jackknife error."""
    n = len(ours)
    left = np.array([(ours.sum() - o) / (reference.sum() - r) for o, r in zip(ours, reference)])
    return 100 * (ours.sum() / reference.sum() - 1), 100 * math.sqrt((n - 1) / n * ((left - left.mean()) ** 2).sum())


def table(name, runs, reference):
    packings = sorted(p for c, p in reference.states if c == name and all((c, p) in r.states for r in runs.values()))
    states = reference.states[name, packings[0]]
    columns = [(k, 2, f"F {s[1]:.3f}" if s[0] == 0 else f"F slid {s[0]:.2f}") for k, s in enumerate(states)]
    columns += [(k, 3, f"drag {s[0]:.2f}") for k, s in enumerate(states) if s[0] > 0]
    columns = [c for c in columns if c[1] == 3 or abs(reference.column(name, c[0], 2, packings).mean()) > 1e-5]
    head = ["relaxation"] + [c[2] for c in columns] + ["passes/point"]
    lines = [f"### {NAMES[name]} ({len(packings)} packings)\n", "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]

    def line(words, values, passes):
        cells = []
        for k, quantity, _ in columns:
            value, error = bias(values(k, quantity), reference.column(name, k, quantity, packings))
            cells.append(f"{value:+.1f} ± {error:.1f}")
        lines.append(f"| {words} | " + " | ".join(cells) + f" | {passes} |")

    for key, words in SETTINGS.items():
        if key in runs:
            run = runs[key]
            line(words, lambda k, q, run=run: run.column(name, k, q, packings), f"{np.mean(run.passes[name]):.0f}")
    if "crowd-damped" in runs and "crowd-damped-half" in runs:
        coarse, fine = runs["crowd-damped"], runs["crowd-damped-half"]
        line(EXTRAPOLATED, lambda k, q: 2 * fine.column(name, k, q, packings) - coarse.column(name, k, q, packings),
             f"{np.mean(coarse.passes[name]) + np.mean(fine.passes[name]):.0f}")
    means = [f"{reference.column(name, k, q, packings).mean():.3g}" for k, q, _ in columns]
    lines.append("| *published: mean over E Rs²* | " + " | ".join(means) + f" | {np.mean(reference.passes[name]):.0f} |")
    return "\n".join(lines) + "\n"


def main():
    work = pathlib.Path(sys.argv[1])
    runs = {key: Points(work / key / "crowd.h5") for key in SETTINGS if (work / key / "crowd.h5").exists()}
    reference = Points(work / "crowd-published" / "crowd.h5")
    (HERE / "crowd.md").write_text("\n".join(table(name, runs, reference) for name in NAMES))


if __name__ == "__main__":
    main()
