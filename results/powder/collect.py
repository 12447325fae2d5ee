#!/usr/bin/env python3
"""README.md of this folder: collect.py RUN_DIR[:FIGURE,FIGURE...] ... Standard library only.

RUN_DIR is a run of a scene of kind "cohesive-powder", with or without variants. The hand-written notes (notes.md) come
first, then per run its command, its table, and the named figures of its report (made by `softgrain report RUN_DIR`), which
are copied here under NAME-FIGURE.svg.
"""
import json
import math
import os
import shutil
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
COLUMNS = [("Phi", "Phi", 4), ("z", "z", 3), ("x0", "x_0", 3), ("x1", "x_1", 3), ("x2", "x_2", 3), ("x3", "x_3", 3),
           ("mean_normal", "<N>", 4), ("mean_repulsive", "<N> repulsive", 3), ("mean_tensile", "<N> tensile", 3),
           ("quadratic_mean_normal", "sqrt <N²>", 3), ("rumpf_ratio", "Rumpf/P", 3), ("F_perc", "F_perc", 3),
           ("zero_share", "unstressed share", 3), ("h", "h", 1), ("k", "k", 1), ("solid_fraction_3d", "Phi in 3D", 3),
           ("R_w", "<R>_w [a]", 3), ("time", "time [T0]", 0), ("loop_passes", "loop passes", 0)]


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
        return "-"
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


def one(summary):
    samples = [s for s in summary["samples"] if s["usable"]]
    text = f"{len(samples)} of {len(summary['samples'])} samples at rest; mean ± standard deviation of a sample.\n\n"
    text += "| " + " | ".join(c[1] for c in COLUMNS) + " |\n|" + "---|" * len(COLUMNS) + "\n"
    text += "| " + " | ".join(cell(samples, c[0], c[2]) for c in COLUMNS) + " |\n\n"
    return text + (fit_text(summary["scattering"]) if summary.get("scattering") else "")


def folded(remarks):
    """What several variants say alike, once."""
    said = {}
    for remark in remarks:
        who, colon, what = remark.partition(": ")
        said.setdefault(what if colon else remark, []).append(who if colon else "")
    return [what if names == [""] else f"{', '.join(names) if len(names) < 5 else f'{len(names)} of them'}: {what}"
            for what, names in said.items()]


def run_text(argument):
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
            rows = file.read().splitlines()
        left = [r.split("|")[1].strip() for r in rows if "| not run |" in r]
        text += "\n".join(r for r in rows if "| not run |" not in r) + "\n\n"
        if left:
            text += "Not run: " + ", ".join(left) + ".\n\n"
    else:
        text += one(summary)
    for figure in filter(None, figures.split(",")):
        shutil.copy(os.path.join(directory, "figures", figure + ".svg"), os.path.join(HERE, f"{name}-{figure}.svg"))
        text += f"![{figure.replace('-', ' ')}]({name}-{figure}.svg)\n\n"
    if summary.get("remarks"):
        text += "".join(f"- {r}\n" for r in folded(summary["remarks"])) + "\n"
    return text


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    with open(os.path.join(HERE, "notes.md"), encoding="utf-8") as file:
        text = file.read() + "\n"
    text += "".join(run_text(a) for a in sys.argv[1:])
    with open(os.path.join(HERE, "README.md"), "w", encoding="utf-8") as file:
        file.write(text.rstrip("\n") + "\n")


if __name__ == "__main__":
    main()
