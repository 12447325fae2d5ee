#!/usr/bin/env python3
"""Tables, details and pictures of powder runs: collect.py RUN_DIR[:FIGURE,FIGURE...] ... Standard library only.

RUN_DIR is a run of a scene of kind "cohesive-powder", with or without variants, and with its report (`softgrain report RUN_DIR`).
One call names all runs and writes into this folder:

    NAME.csv         of a run with variants: a row for each variant, mean and standard error over samples
    details.csv      a row for each run without variants, mean and standard deviation of a sample
    details.md       of every run its command, its fit of I(k), its remarks and its pictures
    NAME-FIGURE.svg  the named figures of the report

README.md and the other pages are written by hand.
"""
import csv
import json
import math
import os
import re
import shutil
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
# Of the table of runs without variants: key in the summary, name, digits.
COLUMNS = [("Phi", "Phi", 4), ("z", "z", 3), ("x0", "x_0", 3), ("x1", "x_1", 3), ("x2", "x_2", 3), ("x3", "x_3", 3),
           ("mean_normal", "mean_normal", 4), ("mean_repulsive", "mean_repulsive", 3), ("mean_tensile", "mean_tensile", 3),
           ("quadratic_mean_normal", "quadratic_mean_normal", 3), ("rumpf_ratio", "rumpf_ratio", 3), ("F_perc", "F_perc", 3),
           ("zero_share", "zero_share", 3), ("h", "h", 1), ("k", "k", 1), ("solid_fraction_3d", "Phi in 3D", 3),
           ("R_w", "R_w", 3), ("time", "time", 0), ("loop_passes", "loop_passes", 0)]
UNITS = {"mean_normal": "F0", "mean_repulsive": "F0", "mean_tensile": "F0", "quadratic_mean_normal": "F0", "F_perc": "F0",
         "bulk": "F0/a", "shear": "F0/a", "xi": "a", "R_w": "a", "time": "T0"}
# "0.7250 +- 0.0020", "0.7250 ± 0.0020", "+0.0021 (+0.9)", "4/4"
PAIR = re.compile(r"(\S+?)(?: (?:\+-|±) |/| \()(\S+?)\)?")


def plain(command):
    words, out, skip = command.split(), ["softgrain"], False
    for word in words[1:]:
        if skip:
            skip = False
        elif word == "--out":
            skip = True
        elif word not in ("--quiet", "--resume"):
            out.append(word)
    return " ".join(out)


def names(column, second):
    """Headers of a column and of the second number of its cells."""
    if column == "at rest":
        return "samples at rest", "samples"
    if column.endswith(" (in errors)"):
        return column.removesuffix(" (in errors)"), column.replace("(in errors)", "in errors")
    unit = f" [{UNITS[column]}]" if column in UNITS else ""
    return column + unit, f"{column} {second}{unit}"


def write_csv(name, head, rows, second):
    """A column for each number of the cells; columns without any number are left out."""
    columns = []
    for title, *cells in zip(head, *rows):
        pairs = [PAIR.fullmatch(c) for c in cells]
        values = [p[1] if p else c for p, c in zip(pairs, cells)]
        seconds = [p[2] if p else "" for p in pairs]
        columns += [(label, *column) for label, column in zip(names(title, second), (values, seconds)) if any(column)]
    with open(os.path.join(HERE, name), "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(zip(*columns))


def markdown_cells(lines):
    """Head and rows of a table of Markdown."""
    cells = [[c.strip() for c in line.strip().strip("|").split("|")] for line in lines if line.startswith("|")]
    return cells[0], cells[2:]


def value(sample, key):
    if key[0] == "x" and key[1:].isdigit():
        shares = sample["shares"]
        return shares[int(key[1:])] if int(key[1:]) < len(shares) else 0.0
    if key == "F_perc":
        return sample["F_perc"]["either"]
    if key in "hk":
        return sample["rigidity"]["fixed"][key] if sample.get("rigidity") else None
    if key == "R_w":
        return sample.get("holes", {}).get("mean_radius")
    return sample.get(key)


def cell(samples, key, digits):
    known = [v for v in (value(s, key) for s in samples) if v is not None]
    if not known:
        return ""
    mean = sum(known) / len(known)
    if len(known) < 2:
        return f"{mean:.{digits}f}" if digits else f"{mean:.3g}"
    deviation = math.sqrt(sum((v - mean) ** 2 for v in known) / (len(known) - 1))
    return f"{mean:.{digits}f} ± {deviation:.{digits}f}" if digits else f"{mean:.3g}"


def fit_text(fit):
    if not fit.get("usable"):
        return f"Common fit of I(k) not to be relied on: {fit.get('reason', 'none made')}.\n\n"
    low, high = fit["k_range"]
    return (f"Common fit of I(k) for k a in {low:.2g} to {high:.2g}: dF {fit['dF']:.3f} ± {fit['dF_error']:.3f}, xi "
            f"{fit['xi']:.2f} ± {fit['xi_error']:.2f} a, c {fit['c']:.3g} ± {fit['c_error']:.2g}, chi² per degree of freedom "
            f"{fit['chi2_per_degree']:.2f}.\n\n")


def folded(remarks):
    """What several variants say alike, once."""
    said = {}
    for remark in remarks:
        who, colon, what = remark.partition(": ")
        said.setdefault(what if colon else remark, []).append(who if colon else "")
    return [what if names == [""] else f"{', '.join(names) if len(names) < 5 else f'{len(names)} of them'}: {what}"
            for what, names in said.items()]


def run_text(argument, single_runs):
    """The section of details.md; a run without variants is added to single_runs."""
    directory, _, figures = argument.partition(":")
    name = os.path.basename(os.path.normpath(directory))
    with open(os.path.join(directory, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    p = summary.get("provenance", {})
    text = f"## {summary.get('title', '')} ({name})\n\n`{plain(p.get('command', ''))}` (version {p.get('version')}, commit "
    text += f"{p.get('commit')}, seed {p.get('seed')}, status {summary['status']})\n\n"
    table = os.path.join(directory, "table.md")
    if os.path.exists(table):
        with open(table, encoding="utf-8") as file:
            head, rows = markdown_cells(file)
        write_csv(f"{name}.csv", head, [row for row in rows if "not run" not in row], "error")
        left = [row[0] for row in rows if "not run" in row]
        text += f"Table: [{name}.csv]({name}.csv).{' Not run: ' + ', '.join(left) + '.' if left else ''}\n\n"
    else:
        samples = [s for s in summary["samples"] if s["usable"]]
        single_runs.append([name, f"{len(samples)}/{len(summary['samples'])}", *(cell(samples, c[0], c[2]) for c in COLUMNS)])
        text += "Table: [details.csv](details.csv).\n\n" + (fit_text(summary["scattering"]) if summary.get("scattering") else "")
    if summary.get("remarks"):
        text += "".join(f"- {r}\n" for r in folded(summary["remarks"])) + "\n"
    for figure in filter(None, figures.split(",")):
        shutil.copy(os.path.join(directory, "figures", figure + ".svg"), os.path.join(HERE, f"{name}-{figure}.svg"))
        text += f"![{figure.replace('-', ' ')}]({name}-{figure}.svg)\n\n"
    return text


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    single_runs = []
    text = "# Details of the runs\n\nMade by `collect.py`. [README](README.md) says what was found.\n\n"
    text += "".join(run_text(a, single_runs) for a in sys.argv[1:])
    if single_runs:
        write_csv("details.csv", ["run", "at rest", *(c[1] for c in COLUMNS)], single_runs, "deviation")
    with open(os.path.join(HERE, "details.md"), "w", encoding="utf-8") as file:
        file.write(text.rstrip("\n") + "\n")


if __name__ == "__main__":
    main()
