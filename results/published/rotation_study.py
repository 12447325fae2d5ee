#!/usr/bin/env python3
"""Writes rotation_study.md, rotation_study.csv and the pictures of force over angle from what rotation_study.sh has run in WORK.

  python3 results/published/rotation_study.py WORK
"""
import csv
import json
import math
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).parent
E, RS = 5e5, 0.016
DEGREE = math.pi * RS / 180.0  # ht of one degree [m]
ANGLES = ("0.5", "1", "2")
HEAD = ["pair", "Delta", "Fn published [N]", "Fn [N]", "Fn: error [N]", "kt published [N/degree]"] + [
    name + end for name in ("initial slope", "secant 0.5 degree", "secant 1 degree", "secant 2 degrees")
    for end in (" [N/degree]", ": error [N/degree]")] + ["secant 1 degree over published", "secant 1 degree over published: error"]
PICTURES = {"ft-ht-along-the-displacement-soft-particle-on-a-solid-plane": "force_over_angle",
            "ft-ht-along-the-displacement-two-equal-soft-particles": "force_over_angle_soft_soft"}


def published_force(delta):
    return 73.669 * delta**2.799 - 0.035


def published_stiffness(delta):
    """[N per degree]"""
    return 0.740 * delta**2.100 - 0.0024


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(r) + " |" for r in rows]) + "\n"


def part(work, name, pair, which):
    """Rows of a comparison by Delta."""
    found = next(m for m in json.loads((work / name / "summary.json").read_text())["measurements"] if m["pair"] == pair)
    return {round(r["delta"], 6): r for r in found[which]}


def per_degree(row, side="reference"):
    unit = E * RS * DEGREE
    return row[side]["mean"] * unit, row[side]["standard_error"] * unit


def stiffness_rows(work, pair):
    """Rows of rotation_study.csv, as texts."""
    forces = part(work, "angle-1-angle-1", pair, "normal_force")
    initial = part(work, "angle-1-angle-1", pair, "stiffness_initial")
    secants = [part(work, f"angle-{a}-angle-{a}", pair, "stiffness_secant") for a in ANGLES]
    on_plane = pair == "soft-solid"
    digits = "{:.4f} {:.4f}" if on_plane else "{:.3g} {:.2g}"
    rows = []
    for delta in sorted(secants[0]):
        mean, error = (E * RS * RS * forces[delta]["reference"][k] for k in ("mean", "standard_error"))
        stiffness = [per_degree(s[delta]) for s in [initial] + secants]
        target = published_stiffness(delta)
        rows.append([pair, f"{delta:.3g}", f"{published_force(delta):.3g}" if on_plane else "", f"{mean:.3g}", f"{error:.2g}",
                     f"{target:.4f}" if on_plane else ""] + [cell for pair_of in stiffness for cell in digits.format(*pair_of).split()]
                    + ([f"{x / target:.2f}" for x in stiffness[2]] if on_plane else ["", ""]))
    return rows


def shown(rows, columns):
    """Columns of HEAD as cells of a Markdown table, with their error where one follows."""
    return [[" ± ".join(row[k:k + 2] if ": error" in (HEAD + [""])[k + 1] else row[k:k + 1]) for k in columns] for row in rows]


def variant_rows(work):
    names = (("stays", "shell stays"), ("cumulative", "each angle from the relaxed one before"), ("slower", "a quarter of the speed"))
    rows = []
    for name, meaning in names:
        for which, quantity in (("stiffness_initial", "initial slope"), ("stiffness_secant", "secant at 1°")):
            ratios = part(work, f"{name}-few", "soft-solid", which)
            rows.append([meaning, quantity] + [f"{ratios[d]['ratio']:.3f} ± {ratios[d]['ratio_standard_error']:.3f}" for d in sorted(ratios)])
    return rows


def main():
    work = pathlib.Path(sys.argv[1])
    on_plane, of_two = (stiffness_rows(work, pair) for pair in ("soft-solid", "soft-soft"))
    with open(HERE / "rotation_study.csv", "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEAD] + on_plane + of_two)
    text = "# Tangential stiffness by a slow turn, beside the published one\n\n"
    text += ("Made by `results/published/rotation_study.sh` with 24 packings that no setting was chosen on, by slow dynamics; errors are those of packings. "
             "The soft particle turns slowly while its grains move, as published. The force on its partner is read at each angle, for both signs. "
             "All columns: [rotation_study.csv](rotation_study.csv).\n\n")
    text += "## On a plane: the published table beside ours\n\nkt in N per degree of rotation (times 3,581 for N/m).\n\n"
    text += table(["Delta", "Fn published [N]", "Fn here", "kt published", "initial slope", "secant 0.5°", "secant 1°", "secant 1° over the published"],
                  shown(on_plane, (1, 2, 3, 5, 6, 8, 10, 14)))
    text += ("\nPublished: Fn = 73.669 Delta^2.799 - 0.035, kt = 0.740 Delta^2.100 - 0.0024. The law takes the secant at 1°. Where all grains turn at once with "
             "nothing relaxing on the way, as up to version 0.2.0, the same secant is 0.3 to 0.5 of the published one.\n\n")
    text += "## Two soft particles: a prediction\n\nThe law takes the secant at 0.5°. kt in N per degree.\n\n"
    text += table(["Delta", "Fn [N]", "initial slope", "secant 0.5°", "secant 1°", "secant 2°"], shown(of_two, (1, 3, 6, 8, 10, 12)))
    text += "\n## Force over angle\n\nMean over packings in both directions. The force at no rotation (prestrain) averages to zero within its error.\n\n"
    text += "".join(f"![{name}]({name}.svg)\n\n" for name in PICTURES.values())
    deltas = sorted(part(work, "slower-few", "soft-solid", "stiffness_secant"))
    text += "## What the turn makes of it\n\nRatio to the usual turn, on a plane, the first 6 packings.\n\n"
    text += table(["variant", "quantity"] + [f"Delta {d:.2f}" for d in deltas], variant_rows(work))
    text += ("\nWith a shell that stays, the turn only drives the grains and does not constrain them. Friction on the shell holds them back, so that they hardly turn. "
             "How the publication held its shell is not known.\n")
    (HERE / "rotation_study.md").write_text(text)
    for source, name in PICTURES.items():
        found = sorted((work / "turns" / "figures").glob(source + "*.svg"))
        shutil.copy(found[0], HERE / f"{name}.svg")


if __name__ == "__main__":
    main()
