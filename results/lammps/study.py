#!/usr/bin/env python3
"""Both engines on the same packings: study.py PROGRAM [--samples N] [--page]. Needs h5py, numpy; pictures matplotlib.

Every sample is strained by our engine, by our engine with a friction that differs in the twelfth digit (what chaos alone
makes of a rounding), and by softgrain-lammps on one rank. Long runs are held together by their statistics: the mean over
the samples of the relative difference of axial stress, against its standard error. --page writes agreement.csv, cost.csv,
agreement.json and agreement.png beside this script; README.md and notes.md are written by hand.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
RESULTS = os.path.dirname(HERE)
SCENE = """kind = "macro"
title = "1000 soft and solid grains"
law = "{law}"
seed = 3
{choice}
[macro]
bodies = 1000
soft_share = 0.45
solid_polydispersity = 3.0
strain = 0.15
steps = 15
increments_per_step = 4
samples = {samples}
resolved = false
mu = {macro_mu}
"""
# Friction of the soft particles is a key of its own with law tables, that of all with cards.
LAWS = {"pair": ("published/law.toml", "", True), "directional": ("law_table/law_table.toml", 'form = "directional"\nmu = {mu}', False)}
RUNS = {"own": ("0.3", []), "own, mu + 1e-12": ("0.300000000001", []), "lammps": ("0.3", ["--engine", "lammps"])}


def curves(directory):
    """strain and axial stress [samples, points], passes, contact evaluations and seconds per pass of one run."""
    with h5py.File(os.path.join(directory, "macro.h5")) as f:
        groups = [f["curves"][name] for name in sorted(f["curves"])]
        strain = groups[0]["strain"][()]
        stress = np.array([g["stress_axial"][()] for g in groups])
    with open(os.path.join(directory, "summary.json")) as f:
        summary = json.load(f)
    return strain, stress, summary


def cost(summary):
    found = {}

    def look(node):
        if isinstance(node, dict):
            if "loop_passes" in node:
                for key in ("loop_passes", "contact_evaluations", "seconds"):
                    found[key] = found.get(key, 0.0) + node[key]
                return
            for value in node.values():
                look(value)
        elif isinstance(node, list):
            for value in node:
                look(value)

    look(summary.get("macro", summary))
    return found


def run_law(program, name, samples, directory):
    law, choice, for_all = LAWS[name]
    out = {}
    for run, (mu, options) in RUNS.items():
        scene = os.path.join(directory, "scene.toml")
        with open(scene, "w") as f:
            f.write(SCENE.format(law=os.path.join(RESULTS, law), choice=choice.format(mu=mu), samples=samples,
                                 macro_mu=mu if for_all else "0.3"))
        target = os.path.join(directory, f"{name}-{run}")
        done = subprocess.run([program, "macrosim", scene, "--out", target, "--quiet", *options],
                              env={**os.environ, "OMP_NUM_THREADS": "1"}, capture_output=True, text=True)
        if done.returncode not in (0, 3):
            sys.exit(f"{run}: status {done.returncode}: {done.stderr}")
        out[run] = curves(target)
    return out


def compare(a, b):
    """Mean of the relative difference over the samples, its standard error, and the spread of one sample."""
    difference = (b - a) / a.mean(axis=0)
    n = len(difference)
    return difference.mean(axis=0), difference.std(axis=0, ddof=1) / np.sqrt(n), difference.std(axis=0, ddof=1)


def study(program, samples):
    result = {}
    with tempfile.TemporaryDirectory() as directory:
        for name in LAWS:
            runs = run_law(program, name, samples, directory)
            strain, own, summary = runs["own"]
            entry = {"strain": strain.tolist(), "own": own.tolist(), "lammps": runs["lammps"][1].tolist(), "against": {}}
            for run in list(RUNS)[1:]:
                mean, error, spread = compare(own, runs[run][1])
                entry["against"][run] = {"mean": mean.tolist(), "error": error.tolist(), "spread": spread.tolist()}
            entry["cost"] = {run: cost(runs[run][2]) for run in RUNS}
            result[name] = entry
    return result


def agreement_rows(result):
    names = {"own, mu + 1e-12": "own engine with mu + 1e-12", "lammps": "LAMMPS"}
    rows = [["law", "strain", "axial stress [Pa]"] + [f"{names[run]}: {what} [%]" for run in list(RUNS)[1:]
                                                      for what in ("difference", "error", "spread of one sample")]]
    for name, entry in result.items():
        strain = np.array(entry["strain"])
        for at in (0.05, 0.1, 0.15):
            k = int(np.argmin(abs(strain - at)))
            row = [name, f"{strain[k]:.2f}", f"{np.mean(entry['own'], axis=0)[k]:.4g}"]
            for run in list(RUNS)[1:]:
                a = entry["against"][run]
                row += [f"{100 * a['mean'][k]:+.2f}", f"{100 * a['error'][k]:.2f}", f"{100 * a['spread'][k]:.2f}"]
            rows.append(row)
    return rows


def cost_rows(result):
    rows = [["law", "engine", "loop passes", "near pairs per pass", "time per pass over that of the own engine"]]
    for name, entry in result.items():
        ours = entry["cost"]["own"]
        for run in ("own", "lammps"):
            c = entry["cost"][run]
            ratio = c["seconds"] / c["loop_passes"] / (ours["seconds"] / ours["loop_passes"])
            rows.append([name, run, f"{c['loop_passes']:.0f}", f"{c['contact_evaluations'] / c['loop_passes']:.0f}", f"{ratio:.2f}"])
    return rows


def picture(result, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(result), figsize=(10, 4), constrained_layout=True)
    for axis, (name, entry) in zip(axes, result.items()):
        for run, colour in (("own", "tab:blue"), ("lammps", "tab:orange")):
            for k, stress in enumerate(entry[run]):
                axis.plot(entry["strain"], stress, color=colour, lw=0.8, label=("our engine" if run == "own" else "LAMMPS") if k == 0 else None)
        axis.set(title=f"{name} law", xlabel="axial strain", ylabel="axial stress [Pa]")
        axis.legend(frameon=False)
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--samples", type=int, default=12)
    parser.add_argument("--page", action="store_true")
    arguments = parser.parse_args()
    result = study(os.path.abspath(arguments.program), arguments.samples)
    tables = {"agreement": agreement_rows(result), "cost": cost_rows(result)}
    for rows in tables.values():
        csv.writer(sys.stdout).writerows(rows)
    if arguments.page:
        for name, rows in tables.items():
            with open(os.path.join(HERE, name + ".csv"), "w", newline="") as f:
                csv.writer(f, lineterminator="\n").writerows(rows)
        with open(os.path.join(HERE, "agreement.json"), "w") as f:
            json.dump(result, f)
        picture(result, os.path.join(HERE, "agreement.png"))


if __name__ == "__main__":
    main()
