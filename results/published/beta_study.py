#!/usr/bin/env python3
"""Table of F(Delta) over beta, from the runs below a folder (run by beta_study.sh): means over all packings of a beta."""
import collections
import json
import math
import pathlib
import sys

from packing_study import DELTAS, published


def runs_by_beta(folder):
    runs = collections.defaultdict(list)
    for path in sorted(folder.glob("beta=*/summary.json")):
        runs[float(path.parent.name.split("_")[0].removeprefix("beta="))].append(json.loads(path.read_text()))
    return dict(sorted(runs.items()))


def mean_of(values):
    """Mean and standard error of equally large samples with their own standard errors."""
    n = len(values)
    return sum(v for v, _ in values) / n, math.sqrt(sum(e * e for _, e in values)) / n


def force(summaries, delta):
    points = [f for s in summaries for f in s["forces"]["soft-solid"] if abs(f["delta"] - delta) < 1e-9]
    return mean_of([(f["force"], f["standard_error"]) for f in points])


def error_of_published(summaries, delta):
    """Standard error of a mean of seven packings, as many as were published, that scatter like ours."""
    points = [f for s in summaries for f in s["forces"]["soft-solid"] if abs(f["delta"] - delta) < 1e-9]
    return math.sqrt(sum(f["deviation"]**2 for f in points) / len(points) / 7)


def main():
    runs = runs_by_beta(pathlib.Path(sys.argv[1]))
    packings = {sum(s["packings"]["count"] for s in group) for group in runs.values()}
    counts = " or ".join(str(n) for n in sorted(packings))
    print(f"""# beta of the published packings

Which beta gives the published normal force? beta is the volume of grains that are drawn, over that of the shell; the publication
does not give it. Made by `results/published/beta_study.sh` ({counts} packings of each beta, slow dynamics, errors over packings).

| beta | solid fraction | """ + " | ".join(f"F({d:.2f}) [N]" for d in DELTAS) + " | chi² of five points |")
    print("|" + "---|" * (len(DELTAS) + 3))
    best = None
    for beta, group in runs.items():
        phi = sum(s["packings"]["solid_fraction"] for s in group) / len(group)
        cells, chi2 = [], 0.0
        for delta in DELTAS:
            value, error = force(group, delta)
            chi2 += (value - published(delta))**2 / (error**2 + error_of_published(group, delta)**2)
            cells.append(f"{value:.3f} ± {error:.3f} ({100 * (value / published(delta) - 1):+.0f} %)")
        if best is None or chi2 < best[1]:
            best = (beta, chi2)
        print(f"| {beta:g} | {phi:.4f} | " + " | ".join(cells) + f" | {chi2:.1f} |")
    print("| published | - | " + " | ".join(f"{published(d):.3f}" for d in DELTAS) + " | |")
    print(f"""
chi² counts our errors and those of a mean of seven packings, as many as were published, that scatter like ours. Points of one beta
share their packings, so chi² only ranks the rows: it is smallest at beta = {best[0]:g}. The published law does not determine beta: rows whose
chi² is below about 11 (95 % for five independent points) agree with it. Scenes take beta = 3.""")


if __name__ == "__main__":
    main()
