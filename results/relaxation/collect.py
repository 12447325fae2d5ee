#!/usr/bin/env python3
"""Writes one_contact.csv, stiffness.csv and error_against_cost.svg from the runs of study.sh; the pages are written by hand.

  python3 results/relaxation/collect.py WORK_DIRECTORY
"""
import csv
import json
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).parent
# name of the run: what it is, colour
SETTINGS = {
    "dynamics-finer": ("scenes' choice: dynamics only, step x 2", "#0072b2"),
    "dynamics-only": ("dynamics only, step x 4", "#56b4e9"),
    "least-work": ("least-work, key defaults", "#d55e00"),
    "half-increment": ("least-work, increment halved", "#e69f00"),
    "short-path-settling": ("least-work, path settles 16", "#009e73"),
    "no-settling": ("least-work, no settling", "#cc79a7"),
    "damped": ("damped, increment 0.005", "#000000"),
}
FILLED = ("dynamics-finer", "least-work", "damped")
SHELL_STIFFNESS = 5e5 * 0.016  # E Rs [N/m], by which the comparison divides kt
QUANTITIES = {"normal_force": "Fn", "stiffness_initial": "kt, initial slope", "stiffness_secant": "kt, secant at 1 degree"}
HEAD = ["pair", "relaxation", "quantity", "Delta", "bias [%]", "error [%]", "passes per point", "published mean [Fn: E Rs^2, kt: E Rs]",
        "published passes per point"]
STIFFNESS_HEAD = ["quantity", "Delta", "part", "packings", "bias [%]", "error [%]"]


def load(work):
    runs = {}
    for name in SETTINGS:
        file = work / f"{name}.json"
        if file.exists():
            runs[name] = {m["pair"]: m for m in json.loads(file.read_text())["measurements"]}
    return runs


def bias(row):
    return 100.0 * (row["ratio"] - 1.0), 100.0 * row["ratio_standard_error"]


def cells(row):
    if row["ratio"] is None or row["ratio_standard_error"] is None:
        return ["", ""]
    value, error = bias(row)
    return [f"{value:+.1f}", f"{error:.1f}"]


def write_csv(name, head, rows):
    with open(HERE / name, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head] + rows)


def passes(m, which="candidate"):
    """Loop passes per recorded point: along the overlaps, and after a rotation."""
    return [m["cost"][f"{which}_{k}"]["loop_passes_per_point"] for k in ("normal", "tangential")]


def bias_rows(runs):
    rows = []
    for pair in ("soft-solid", "soft-soft"):
        for name, by_pair in runs.items():
            m = by_pair[pair]
            for key, quantity in QUANTITIES.items():
                ours, published = (passes(m, which)[key != "normal_force"] for which in ("candidate", "reference"))
                rows += [[pair, SETTINGS[name][0], quantity, f"{r['delta']:.2f}", *cells(r), f"{ours:.0f}", f"{r['reference']['mean']:.3g}",
                          f"{published:.0f}"] for r in m[key]]
    return rows


def stiffness_parts(work, runs):
    """kt on a plane: by quantity and overlap, (packings, reference mean, ratio, error of the ratio) of every part."""
    parts = {}

    def add(quantity, delta, part):
        parts.setdefault((quantity, round(delta, 6)), []).append(part)

    for quantity in ("initial", "secant"):
        for r in runs["dynamics-finer"]["soft-solid"][f"stiffness_{quantity}"]:
            add(quantity, r["delta"], (r["reference"]["n"], SHELL_STIFFNESS * r["reference"]["mean"], r["ratio"], r["ratio_standard_error"]))
        for file in sorted(work.glob("stiffness-*/summary.json")):
            for r in json.loads(file.read_text())["relaxations"]["soft-solid"][f"kt_{quantity}"]:
                add(quantity, r["delta"], (r["packings"], r["reference"], r["ratio"], r["ratio_error"]))
    return parts


def stiffness_rows(work, runs):
    """Every part, and the ratio of the means over all their packings (parts weigh with packings times mean). A part in which a packing
    rearranged during the rotation shows an error above 100 %: it has no slope, stays empty and does not count."""
    rows = []
    for (quantity, delta), parts in sorted(stiffness_parts(work, runs).items()):
        name = [QUANTITIES["stiffness_" + quantity], f"{delta:.2f}"]
        rows += [name + [f"part {k}", n] + ([f"{100 * (r - 1):+.1f}", f"{100 * e:.1f}"] if e < 1.0 else ["", ""])
                 for k, (n, _, r, e) in enumerate(parts, 1)]
        parts = [p for p in parts if p[3] < 1.0]
        if not parts:
            continue
        weights = [n * mean for n, mean, _, _ in parts]
        ratio = sum(w * r for w, (_, _, r, _) in zip(weights, parts)) / sum(weights)
        error = math.sqrt(sum((w * e) ** 2 for w, (_, _, _, e) in zip(weights, parts))) / sum(weights)
        rows.append(name + ["all", sum(p[0] for p in parts), f"{100 * (ratio - 1):+.1f}", f"{100 * error:.1f}"])
    return rows


class Panel:
    """One picture: bias in per cent over loop passes per point, logarithmic."""

    def __init__(self, x, y, title, limit):
        self.x, self.y, self.limit = x, y, limit
        self.w, self.h = 330.0, 250.0
        self.low, self.high = 2.0, 5.0
        self.parts = [f'<text x="{x + self.w / 2}" y="{y - 8}" text-anchor="middle" font-weight="bold">{title}</text>',
                      f'<rect x="{x}" y="{y}" width="{self.w}" height="{self.h}" fill="none" stroke="#000"/>']
        for p in range(int(self.low), int(self.high) + 1):
            at = self.at_x(10.0**p)
            self.line(at, y + self.h, at, y + self.h + 4)
            self.text(at, y + self.h + 17, f"10<tspan dy='-5' font-size='9'>{p}</tspan>")
        for k in range(-2, 3):
            value = k * limit / 2
            self.line(x - 4, self.at_y(value), x, self.at_y(value))
            self.text(x - 7, self.at_y(value) + 4, f"{value:+g}" if value else "0", "end")
        self.line(x, self.at_y(0), x + self.w, self.at_y(0), "#888")

    def at_x(self, passes_per_point):
        return self.x + self.w * (math.log10(passes_per_point) - self.low) / (self.high - self.low)

    def at_y(self, percent):
        return self.y + self.h * (0.5 - 0.5 * max(-1.0, min(1.0, percent / self.limit)))

    def line(self, x1, y1, x2, y2, colour="#000", width=1.0):
        self.parts.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" stroke-width="{width}"/>')

    def text(self, x, y, words, anchor="middle"):
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>')

    def band(self, percent, words):
        top, bottom = self.at_y(percent), self.at_y(-percent)
        self.parts.append(f'<rect x="{self.x}" y="{top:.1f}" width="{self.w}" height="{bottom - top:.1f}" fill="#009e73" opacity="0.15"/>')
        self.text(self.x + self.w - 4, top - 3, words, "end")

    def point(self, cost, value, error, name, shape, label):
        words, colour = SETTINGS[name]
        x, y = self.at_x(cost), self.at_y(value)
        title = f"<title>{words}, {label}: {value:+.1f} ± {error:.1f} %</title>"
        self.line(x, self.at_y(value - error), x, self.at_y(value + error), colour)
        if abs(value) > self.limit:  # off the picture: an arrow at the edge
            y += 6 if value > 0 else -6
        mark = {"circle": f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5"', "square": f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8"',
                "triangle": f'<path d="M{x:.1f} {y - 5.5:.1f}l5 9h-10z"'}[shape]
        tag = mark[1:].split()[0]
        fill = colour if name in FILLED else "#fff"
        self.parts.append(f'{mark} fill="{fill}" stroke="{colour}" stroke-width="1.6">{title}</{tag}>')


def rows_near(m, key, deltas):
    return [r for r in m[key] if any(abs(r["delta"] - d) < 1e-6 for d in deltas) and r["ratio"] is not None]


def picture(runs):
    panels = [
        (Panel(60, 40, "Fn of a soft particle on a plane", 20), "soft-solid", 0, 2, "good: 2 %",
         [("normal_force", 0.10, "triangle"), ("normal_force", 0.15, "square"), ("normal_force", 0.25, "circle")]),
        (Panel(460, 40, "Fn of two soft particles", 60), "soft-soft", 0, 10, "good: 10 %",
         [("normal_force", 0.25, "triangle"), ("normal_force", 0.30, "square"), ("normal_force", 0.40, "circle")]),
        (Panel(60, 370, "kt on a plane, Delta = 0.20", 40), "soft-solid", 1, 5, "good: 5 %",
         [("stiffness_initial", 0.20, "circle"), ("stiffness_secant", 0.20, "square")]),
        (Panel(460, 370, "kt of two, Delta = 0.35", 150), "soft-soft", 1, 5, "",
         [("stiffness_initial", 0.35, "circle"), ("stiffness_secant", 0.35, "square")]),
    ]
    marks = ["triangle 0.10, square 0.15, circle 0.25", "triangle 0.25, square 0.30, circle 0.40",
             "circle: initial slope, square: secant at 1°", "circle: initial slope, square: secant at 1°"]
    for (panel, pair, cost, good, words, points), mark in zip(panels, marks):
        if words:
            panel.band(good, words)
        panel.text(panel.x + 6, panel.y + panel.h - 8, mark, "start")
        panel.text(panel.x + panel.w / 2, panel.y + panel.h + 34, "loop passes per recorded point")
        reference = next(iter(runs.values()))[pair]["cost"][("reference_normal", "reference_tangential")[cost]]["loop_passes_per_point"]
        panel.line(panel.at_x(reference), panel.y, panel.at_x(reference), panel.y + panel.h, "#000", 2)
        panel.text(panel.at_x(reference) - 5, panel.y + 14, "published", "end")
        for name, by_pair in runs.items():
            for key, delta, shape in points:
                for r in rows_near(by_pair[pair], key, [delta]):
                    panel.point(passes(by_pair[pair])[cost], *bias(r), name, shape, f"Delta = {delta:.2f}")
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 820 760" font-family="sans-serif" font-size="12">',
           '<rect width="820" height="760" fill="#fff"/>',
           '<text x="16" y="350" transform="rotate(-90 16 350)" text-anchor="middle">bias of the mean against the published protocol [%]</text>']
    for panel, *_ in panels:
        out += panel.parts
    for k, name in enumerate(runs):
        x, y = 60 + 260 * (k % 3), 680 + 18 * (k // 3)
        words, colour = SETTINGS[name]
        fill = colour if name in FILLED else "#fff"
        out.append(f'<circle cx="{x}" cy="{y - 4}" r="4.5" fill="{fill}" stroke="{colour}" stroke-width="1.6"/><text x="{x + 9}" y="{y}">{words}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def main():
    work = pathlib.Path(sys.argv[1])
    runs = load(work)
    (HERE / "error_against_cost.svg").write_text(picture(runs))
    write_csv("one_contact.csv", HEAD, bias_rows(runs))
    write_csv("stiffness.csv", STIFFNESS_HEAD, stiffness_rows(work, runs))


if __name__ == "__main__":
    main()
