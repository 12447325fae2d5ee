#!/usr/bin/env python3
"""Makes a committed results folder of a run: collect_run.py RUN_DIR RESULTS_DIR FIGURE... Standard library only.

Copies the laws (law_table.toml with its .h5, from which intervals follow, cell_law.toml, material_card.toml), table.csv and recipe.csv where the run has
them and the named figures of its report, and writes README.md: the hand-written notes (RESULTS_DIR/notes.md) after a heading with command, version and seed, then the tables of the run.
"""
import json
import os
import re
import shutil
import sys


# What the script of a report reads off a drawing; alone it needs none of it.
VALUES = re.compile(r' data-[xy]="[^"]*"')


def row(cells):
    return "| " + " | ".join(cells) + " |\n"


def table(header, rows):
    return row(header) + "|" + "---|" * len(header) + "\n" + "".join(row(r) for r in rows) + "\n"


def number(x, digits=3):
    return "-" if x is None or x != x else f"{x:.{digits}g}"


def with_error(e, digits=3):
    return f"{e['value']:.{digits}g} ± {e['standard_error']:.2g}"


def plain(command):
    """The command without what only says where things are kept."""
    words, out, skip = command.split(), ["softgrain"], False
    for word in words[1:]:
        if skip:
            skip = False
        elif word in ("--out", "--law-cache", "--packing-cache", "--twin-cache"):
            skip = True
        elif word not in ("--quiet", "--resume"):
            out.append(word)
    return " ".join(out)


def law_tables(summary):
    text = ""
    for entry in summary.get("entries", []):
        text += f"## Laws at solid fraction {entry['solid_fraction']:.3f} ({entry['packings']} packings)\n\n"
        text += table(["law", "a", "b", "delta", "m0", "m1", "m2", "error, fitted [%]", "held out [%]", "leave one out [%]",
                       "information criterion"],
                      [[law["form"] + (" (best)" if law["form"] == entry["best"] else "")] +
                       [with_error(law[k]) for k in ("a", "b", "delta", "m0", "m1", "m2")] +
                       [number(None if law[k] is None else 100 * law[k]) for k in ("error_fitted", "error_held_out", "error_cross")] +
                       [number(law["criterion"], 4)] for law in entry["laws"]])
        text += table(["neighbour", "friction limit", "kt/kn"],
                      [[k, with_error(entry["slide_" + k]["friction"]), with_error(entry["slide_" + k]["kt_ratio"])]
                       for k in ("plane", "solid", "soft")])
    return text


def hierarchy_tables(summary):
    if "levels" not in summary or "fixed_point" not in summary:
        return ""
    contents, laws, changes = [], [], []
    for level in summary["levels"]:
        k = str(level["level"])
        inner = level.get("inner", {})
        contents.append([k, number(level["grain_percent"]), number(inner.get("mean", 0)), number(inner.get("volume_percent", 0)),
                         number(inner.get("next_volume")), number(level["solid_percent"]), number(level["resolved_grains"])])
        laws.append([k, number(level["law"]["a"]), number(level["law"]["b"]), number(level["law"]["delta"]),
                     number(level.get("error_percent")),
                     "{value:.2f} ± {error:.2f}".format(**level["sensitivity"]) if "sensitivity" in level else "-",
                     number(level.get("distance_percent")), number(level["contact_evaluations"]), number(level["seconds"])])
        changes += [[k, c["configuration"], f"{c['ratio']:.3f} ± {c['error']:.3f}"] for c in level.get("changes", [])]
    text = summary["fixed_point"]["text"] + "\n\n"
    text += table(["level", "own grains [% of the shell]", "soft particles inside", "their volume [%]",
                   "next level over own grains", "all grains [%]", "grains if resolved"], contents)
    text += table(["level", "a", "b", "delta", "standard error of forces [%]", "follows the law below by",
                   "distance to it [%]", "contact evaluations", "seconds"], laws)
    text += table(["level", "configuration", "force over that of the level below"], changes)
    if "check" in summary:
        check = summary["check"]
        text += "## Two decades with all grains\n\n" + check["text"] + "\n\n"
        text += table(["h/Rs", "law [F/(E Rs²)]", "all grains", "law over all grains"],
                      [[number(p["overlap"]), f"{p['law']:.4g} ± {p['law_error']:.2g}",
                        f"{p['resolved']:.4g} ± {p['resolved_error']:.2g}",
                        f"{p['ratio']:.3f} ± {p['ratio_error']:.3f}"] for p in check["points"]])
    return text


def interval(e, digits=4):
    low, high = e["interval"]
    return f"{number(e['value'], digits)} ({number(low, digits)} to {number(high, digits)})"


def recipe_tables(summary):
    r = summary.get("recipe")
    if not r or not r["levels"]:
        return ""
    rows = []
    for level in r["levels"]:
        mm = f"{number(1e3 * level['diameter_low'])} to {number(1e3 * level['diameter_high'])}"
        rows.append([str(level["level"]), mm, number(100 * level["volume_share"]), number(level["onset"], 4), interval(level["onset_with_finer"]),
                     number(level.get("filling"), 2), number(level["grains_per_cubic_metre"], 2)])
    text = table(["level", "diameters [mm]", "share of the volume [%]", "phi_J alone", "phi_J with all finer", "finer grains over its voids", "grains in a cubic metre"], rows)
    rows = [[c["name"], number(c["strain"][-1]), number(c["axial"][-1]),
             f"{number(c['axial_low'][-1])} to {number(c['axial_high'][-1])}" if c["axial_low"] else "-", number(c["lateral"][-1])]
            for c in r["curves"] if c["strain"]]
    text += table(["curve", "strain", "axial stress over E", "band", "lateral stress over E"], rows)
    rows = [[str(s["level"]), f"{number(1e3 * s['diameter_low'])} to {number(1e3 * s['diameter_high'])}", number(s["force_over_E_Rs2"]), number(s["grains"])] for s in r["shells"]]
    return text + (table(["level of the shell hierarchy", "diameters [mm]", "one plane at h/Rs = 0.2 [F/(E Rs²)]", "grains in a soft particle"], rows) if rows else "")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    run, out, figures = sys.argv[1], sys.argv[2], sys.argv[3:]
    with open(os.path.join(run, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    os.makedirs(out, exist_ok=True)
    for name in ("table.csv", "recipe.csv"):
        if os.path.exists(os.path.join(run, name)):
            shutil.copy(os.path.join(run, name), out)
    levels = sorted(n for n in os.listdir(run) if n.startswith("law_table_level_"))
    cards = [n for n in ("law_table.toml", "cell_law.toml", "material_card.toml") if os.path.exists(os.path.join(run, n))]
    for name in cards + [n for n in levels if n.endswith(".toml")]:
        with open(os.path.join(run, name), encoding="utf-8") as file:
            card = file.read()
        raw = summary.get("provenance", {}).get("command", "")
        with open(os.path.join(out, name), "w", encoding="utf-8") as file:
            file.write(card.replace(raw, plain(raw)) if raw else card)
    for name in ["law_table.h5"] + [n for n in levels if n.endswith(".h5")]:
        if os.path.exists(os.path.join(run, name)):
            shutil.copy(os.path.join(run, name), out)
    for name in figures:
        with open(os.path.join(run, "figures", name + ".svg"), encoding="utf-8") as file:
            drawing = file.read()
        with open(os.path.join(out, name + ".svg"), "w", encoding="utf-8") as file:
            file.write(VALUES.sub("", drawing))
    p = summary.get("provenance", {})
    text = f"# {summary.get('title', '')}\n\nMade by `{os.path.basename(__file__)}` from `{plain(p.get('command', ''))}` "
    text += f"(version {p.get('version')}, commit {p.get('commit')}, seed {p.get('seed')}, status {summary['status']}"
    text += f", {summary['seconds']:.0f} s on {p.get('threads')} threads).\n\n" if "seconds" in summary else ").\n\n"
    notes = os.path.join(out, "notes.md")
    if os.path.exists(notes):
        with open(notes, encoding="utf-8") as file:
            text += file.read() + "\n"
    for name in figures:
        text += f"![{name.replace('-', ' ')}]({name}.svg)\n\n"
    text += law_tables(summary) + hierarchy_tables(summary) + recipe_tables(summary)
    if os.path.exists(os.path.join(run, "table.md")):
        with open(os.path.join(run, "table.md"), encoding="utf-8") as file:
            text += file.read() + "\n"
    if summary.get("remarks"):
        text += "## Remarks of the run\n\n" + "".join(f"- {r}\n" for r in summary["remarks"])
    with open(os.path.join(out, "README.md"), "w", encoding="utf-8") as file:
        file.write(text.rstrip("\n") + "\n")


if __name__ == "__main__":
    main()
