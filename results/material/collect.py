#!/usr/bin/env python3
"""Makes curves.csv, variants.csv and the pictures of this folder: collect.py TRUTH FOUR_DECADES, two directories of runs.
The pages are written by hand. Standard library only.
"""
import collections
import csv
import json
import math
import os
import statistics
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"]


def read(run):
    with open(os.path.join(run, "summary.json")) as f:
        modulus = json.load(f)["E"]
    variants = collections.OrderedDict()
    with open(os.path.join(run, "material.csv")) as f:
        for row in csv.DictReader(f):
            numbers = {k: float(v) if v else math.nan for k, v in row.items() if k not in ("variant", "sample", "stage")}
            numbers["axial/E"] = numbers["stress_z [Pa]"] / modulus
            numbers["lateral/E"] = (numbers["stress_x [Pa]"] + numbers["stress_y [Pa]"]) / 2 / modulus
            numbers["K0"] = numbers["lateral/E"] / numbers["axial/E"] if numbers["axial/E"] else math.nan
            numbers["stage"] = row["stage"]
            variants.setdefault(row["variant"], collections.OrderedDict()).setdefault(row["sample"], []).append(numbers)
    return variants


def mean_error(values):
    values = [v for v in values if not math.isnan(v)]
    if not values:
        return math.nan, math.nan
    error = statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else math.nan
    return statistics.fmean(values), error


def at(samples, column, strain=None, point=None):
    """Mean and standard error over samples of a column, at the point nearest to a strain or with that number."""
    def pick(points):
        return points[point] if point is not None else min(points, key=lambda p: abs(p["strain_z"] - strain))
    return mean_error([pick(points)[column] for points in samples.values()])


def cells_of(value, error, digits):
    """Two cells, the error of the mean beside it; empty where there is none."""
    return ["" if math.isnan(x) else f"{x:.{digits}f}" for x in (value, error)]


def write_curves(variants):
    mean_only = ["solid_fraction", "rattlers", "coordination", "coarse-coarse 0.3333", "coarse-fine 0.3333", "fine-fine 0.3333"]
    both = ["p/E", "axial/E", "lateral/E", "q/p"]
    with open(os.path.join(HERE, "curves.csv"), "w") as f:
        f.write(",".join(["variant", "samples", "stage", "strain_z"] + [c for b in both for c in (b, "error of " + b)] + mean_only) + "\n")
        for name, samples in variants.items():
            first = next(iter(samples.values()))
            for k, p in enumerate(first):
                cells = [name, str(len(samples)), p["stage"], f"{p['strain_z']:.5g}"]
                for b in both:
                    cells += ["" if math.isnan(x) else f"{x:.4g}" for x in at(samples, b, point=k)]
                cells += [f"{at(samples, c, point=k)[0]:.4g}" for c in mean_only]
                f.write(",".join(cells) + "\n")


COLUMNS = [("solid fraction", 4), ("1000 axial/E at 2 % strain", 3), ("1000 axial/E at 5 % strain", 3), ("1000 axial/E at 8 % strain", 3),
           ("K0 at 5 % strain", 3), ("K0 at 8 % strain", 3), ("rattlers", 3), ("coordination", 2), ("q/p in shear at 2 % strain", 2),
           ("q/p in shear at 6 % strain", 2)]


def write_variants(variants):
    """One row per packing: means over samples of the oedometric test and of shear at constant volume, and their standard errors."""
    none = (math.nan, math.nan)
    grains = {"2.4": 1500, "3": 1500, "12": 8000, "30": 80000}
    rows = [["variant", "grains", "samples"] + [c for name, _ in COLUMNS for c in (name, "error of " + name)]]
    for name, samples in variants.items():
        if not name.endswith("-oedometric"):
            continue
        base = name[:-len("-oedometric")]
        shear = variants.get(base + "-shear")
        means = [at(samples, "solid_fraction", point=0)]
        means += [tuple(1000 * x for x in at(samples, "axial/E", e)) for e in (0.02, 0.05, 0.08)]
        means += [at(samples, "K0", e) for e in (0.05, 0.08)]
        means += [at(samples, column, point=0) for column in ("rattlers", "coordination")]
        means += [at(shear, "q/p", e) if shear else none for e in (0.02, 0.058)]
        cells = [c for mean, (_, digits) in zip(means, COLUMNS) for c in cells_of(*mean, digits)]
        rows.append([base, grains.get(base.split("-")[-1], 2500), len(samples)] + cells)
    with open(os.path.join(HERE, "variants.csv"), "w", newline="") as f:
        csv.writer(f, lineterminator="\n").writerows(rows)


def svg(name, title, x_label, y_label, series, log_x=False, log_y=False):
    """series: (label, colour, line?, [(x, y, error)])"""
    points = [(x, y) for s in series for x, y, _ in s[3]]
    fx, fy = (math.log10 if log_x else float), (math.log10 if log_y else float)
    xs, ys = [fx(p[0]) for p in points], [fy(p[1]) for p in points]
    x0, x1, y0, y1 = min(xs), max(xs), min(ys), max(ys)
    x0, x1, y0, y1 = x0 - 0.04 * (x1 - x0), x1 + 0.04 * (x1 - x0), y0 - 0.05 * (y1 - y0), y1 + 0.05 * (y1 - y0)
    w, h, left, top = 460, 300, 62, 28

    def sx(v):
        return left + (fx(v) - x0) / (x1 - x0) * w

    def sy(v):
        return top + h - (fy(v) - y0) / (y1 - y0) * h

    def ticks(low, high, log):
        if log:
            steps = [m * 10.0 ** k for k in range(-8, 6) for m in (1, 2, 5)]
            return [t for t in steps if low <= math.log10(t) <= high]
        step = 10 ** math.floor(math.log10(high - low))
        step = step / 5 if (high - low) / step < 2 else step / 2 if (high - low) / step < 5 else step
        return [k * step for k in range(math.ceil(low / step), math.floor(high / step) + 1)]
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {left + w + 150} {top + h + 48}" font-family="sans-serif" font-size="12">',
           f'<rect width="100%" height="100%" fill="white"/><text x="{left}" y="17" font-weight="bold">{title}</text>',
           f'<rect x="{left}" y="{top}" width="{w}" height="{h}" fill="none" stroke="#444"/>']
    for t in ticks(x0, x1, log_x):
        out.append(f'<path d="M{sx(t):.1f} {top + h}v-5" stroke="#444"/><text x="{sx(t):.1f}" y="{top + h + 15}" text-anchor="middle">{t:g}</text>')
    for t in ticks(y0, y1, log_y):
        out.append(f'<path d="M{left} {sy(t):.1f}h5" stroke="#444"/><text x="{left - 5}" y="{sy(t) + 4:.1f}" text-anchor="end">{t:.4g}</text>')
    out.append(f'<text x="{left + w / 2}" y="{top + h + 36}" text-anchor="middle">{x_label}</text>')
    out.append(f'<text transform="translate(14,{top + h / 2}) rotate(-90)" text-anchor="middle">{y_label}</text>')
    for k, (label, colour, line, data) in enumerate(series):
        if line:
            out.append('<path d="M' + "L".join(f"{sx(x):.1f} {sy(y):.1f}" for x, y, _ in data) + f'" fill="none" stroke="{colour}" stroke-width="1.3"/>')
        for x, y, e in data:
            if not line or len(data) < 12:
                out.append(f'<circle cx="{sx(x):.1f}" cy="{sy(y):.1f}" r="3" fill="{colour}"/>')
            if e and not math.isnan(e) and y - e > 0:
                out.append(f'<path d="M{sx(x):.1f} {sy(y - e):.1f}V{sy(y + e):.1f}" stroke="{colour}"/>')
        out.append(f'<circle cx="{left + w + 14}" cy="{top + 10 + 16 * k}" r="4" fill="{colour}"/><text x="{left + w + 23}" y="{top + 14 + 16 * k}">{label}</text>')
    with open(os.path.join(HERE, name), "w") as f:
        f.write("\n".join(out) + "\n</svg>\n")


def span_of(name):
    return float(name.rsplit("-", 1)[0].split("-")[-1])


def pictures(truth, four):
    def over_span(variants, prefix, loading, column, strain=None, point=None):
        return [(span_of(n), *at(s, column, strain, point)) for n, s in variants.items() if n.startswith(prefix) and n.endswith(loading)]
    modulus, exponent = 0.0566, 1.996
    onset = {1.5: 0.5663, 2.4: 0.5838, 3: 0.5960, 4.2: 0.6163, 6: 0.6411}
    large = {name: mean_onset(samples, modulus, exponent) for name, samples in four.items() if name in ("fast-12-oedometric", "fast-30-oedometric")}
    onset.update({span_of(n): v for n, v in large.items()})
    series = []
    for k, (name, samples) in enumerate((n, s) for n, s in four.items() if n.endswith("oedometric")):
        j = onset[span_of(name)]
        data = [((at(samples, "solid_fraction", point=i)[0] - j) / (1 - j), at(samples, "p/E", point=i)[0], math.nan) for i in range(17)]
        series.append((f"span {span_of(name):g}", COLORS[k], True, [d for d in data if d[0] > 0]))
    svg("collapse.svg", "Oedometric compression, fast", "x = (φ - φ_J)/(1 - φ_J)", "p/E", series, True, True)
    svg("solid-fraction.svg", "Solid fraction at p = 1e-4 E", "largest over smallest radius", "solid fraction",
        [("fast", COLORS[0], False, over_span(four, "fast", "oedometric", "solid_fraction", point=0)),
         ("slow", COLORS[1], False, over_span(truth, "slow", "oedometric", "solid_fraction", point=0)),
         ("dense", COLORS[2], False, over_span(truth, "dense", "oedometric", "solid_fraction", point=0))], True)
    svg("ratios.svg", "Ratios of stress at 5 % strain", "largest over smallest radius", "K0, q/p",
        [("K0, fast", COLORS[0], False, over_span(four, "fast", "oedometric", "K0", 0.05)),
         ("K0, slow", COLORS[1], False, over_span(truth, "slow", "oedometric", "K0", 0.05)),
         ("q/p, fast", COLORS[2], False, over_span(four, "fast", "oedometric", "q/p", 0.05)),
         ("q/p, slow", COLORS[3], False, over_span(truth, "slow", "oedometric", "q/p", 0.05))], True)
    svg("shares.svg", "Shares of the pressure at 5 % strain (split at 1/2, fast)", "largest over smallest radius", "share of p",
        [(pair, COLORS[k], False, over_span(four, "fast", "oedometric", pair + " 0.5", 0.05)) for k, pair in
         enumerate(("coarse-coarse", "coarse-fine", "fine-fine"))], True)


def mean_onset(samples, modulus, exponent):
    onsets = []
    for points in samples.values():
        u = [((p["p/E"] / modulus) ** (1 / exponent), p["solid_fraction"]) for p in points]
        onsets.append(sum((1 - a) * (phi - a) for a, phi in u) / sum((1 - a) ** 2 for a, phi in u))
    return statistics.fmean(onsets)


if __name__ == "__main__":
    truth, four = read(sys.argv[1]), read(sys.argv[2])
    write_curves(truth)
    write_variants(truth)
    pictures(truth, four)
