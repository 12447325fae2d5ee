#!/usr/bin/env python3
"""Table of F(Delta) for several packings, from the summaries below a folder (run by packing_study.sh)."""
import json
import pathlib
import sys

DELTAS = [0.10, 0.15, 0.20, 0.25, 0.30]


def published(delta):
    """The published soft-solid law [N]."""
    return max(73.669 * delta**2.799 - 0.035, 0.0)


def row(summary):
    settings, packings = summary["provenance"]["scene"], summary["packings"]
    values = {}
    for line in settings.splitlines():
        key, _, value = line.partition("=")
        values[key.strip()] = value.split("#")[0].strip().strip("'\"")
    cells = [values["beta"], values["trials"], f"{float(values['rmax_over_shell']):.2f}", f"{packings['grains']:.0f}",
             f"{packings['solid_fraction']:.3f}", f"{packings['exponent']:.2f}"]
    forces = {round(f["delta"], 6): f for f in summary["forces"].get("soft-solid", [])}
    for delta in DELTAS:
        f = forces.get(delta)
        if f is None:
            cells.append("-")
            continue
        cells.append(f"{f['force']:.3f} ± {f['standard_error']:.3f} ({100 * (f['force'] / published(delta) - 1):+.0f} %)")
    return cells


def main():
    head = ["beta", "I", "rmax/Rs", "grains", "solid fraction", "exponent"] + [f"F({d:.2f}) [N]" for d in DELTAS]
    rows = [row(json.loads(p.read_text())) for p in sorted(pathlib.Path(sys.argv[1]).glob("*/summary.json"))]
    rows.append(["published", "?", "?", "?", "?", "3.5"] + [f"{published(d):.3f}" for d in DELTAS])
    print("Normal force of a soft particle on a plane, mean of 24 packings ± standard error, difference from the published law;")
    print("damped relaxation, E = 5e5 Pa, Rs = 0.016 m, nu = 0.3, mu = 0.3. Made by `results/published/packing_study.sh`.\n")
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for cells in rows:
        print("| " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
