#!/usr/bin/env python3
"""Writes multi_contact.csv from the multi-contact runs of study.sh (needs h5py); multi_contact.md is written by hand.

  python3 results/relaxation/multi_contact.py WORK_DIRECTORY
"""
import csv
import math
import pathlib
import sys

import h5py
import numpy as np

HERE = pathlib.Path(__file__).parent
# name of the run: what it is
SETTINGS = {
    "multi-contact-scenes": "scenes' choice: step x 4, settling 240",
    "multi-contact-finer": "step x 2, settling 480",
    "multi-contact-longer": "step x 4, settling 480",
    "multi-contact-short": "step x 2, settling 120",
    "multi-contact-damped": "damped, increment 0.005",
    "multi-contact-damped-half": "damped, increment 0.0025",
}
EXTRAPOLATED = "damped, extrapolated to no increment"
HEAD = ["configuration", "packings", "relaxation", "quantity", "overlap [Rs]", "slide [Rs]", "bias [%]", "error [%]", "passes per point",
        "published mean [E Rs^2]", "published passes per point"]
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


def rows_of(name, runs, reference):
    packings = sorted(p for c, p in reference.states if c == name and all((c, p) in r.states for r in runs.values()))
    states = reference.states[name, packings[0]]
    columns = [(k, 2, "normal force", s) for k, s in enumerate(states)] + [(k, 3, "drag", s) for k, s in enumerate(states) if s[0] > 0]
    columns = [c for c in columns if c[1] == 3 or abs(reference.column(name, c[0], 2, packings).mean()) > 1e-5]
    rows = []

    def add(words, values, passes):
        for k, quantity, meaning, (slide, overlap, *_) in columns:
            value, error = bias(values(k, quantity), reference.column(name, k, quantity, packings))
            rows.append([NAMES[name], len(packings), words, meaning, f"{overlap:.3f}" if slide == 0 else "", f"{slide:.2f}", f"{value:+.1f}",
                         f"{error:.1f}", f"{passes:.0f}", f"{reference.column(name, k, quantity, packings).mean():.3g}",
                         f"{np.mean(reference.passes[name]):.0f}"])

    for key, words in SETTINGS.items():
        if key in runs:
            run = runs[key]
            add(words, lambda k, q, run=run: run.column(name, k, q, packings), np.mean(run.passes[name]))
    if "multi-contact-damped" in runs and "multi-contact-damped-half" in runs:
        coarse, fine = runs["multi-contact-damped"], runs["multi-contact-damped-half"]
        add(EXTRAPOLATED, lambda k, q: 2 * fine.column(name, k, q, packings) - coarse.column(name, k, q, packings),
            np.mean(coarse.passes[name]) + np.mean(fine.passes[name]))
    return rows


def main():
    work = pathlib.Path(sys.argv[1])
    runs = {key: Points(work / key / "multi_contact.h5") for key in SETTINGS if (work / key / "multi_contact.h5").exists()}
    reference = Points(work / "multi-contact-published" / "multi_contact.h5")
    with open(HERE / "multi_contact.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(HEAD)
        for name in NAMES:
            out.writerows(rows_of(name, runs, reference))


if __name__ == "__main__":
    main()
