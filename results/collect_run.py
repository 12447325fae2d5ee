#!/usr/bin/env python3
"""Copies what a committed results folder keeps of a run: collect_run.py RUN_DIR RESULTS_DIR FIGURE... Standard library only.

Writes into RESULTS_DIR
- the laws: law_table.toml with its .h5 (refits, from which intervals follow), cell_law.toml, material_card.toml,
- the tables: table.csv and recipe.csv as the run wrote them; laws.csv and friction.csv of a law table; levels.csv, changes.csv and
  check.csv of a hierarchy; levels.csv and shells.csv of a recipe (a column without any value is left out),
- the named figures of the report (FIGURE.svg),
- run.md: title, command, version, seed and remarks of the run.

README.md and notes.md are written by hand; this script does not touch them.
"""
import csv
import json
import os
import re
import shutil
import sys


# What the script of a report reads off a drawing; alone it needs none of it.
VALUES = re.compile(r' data-[xy]="[^"]*"')
COPIED = ("table.csv", "recipe.csv", "law_table.h5")
CARDS = ("law_table.toml", "cell_law.toml", "material_card.toml")


def write_csv(path, rows):
    """Rows are dictionaries with the same keys; writes nothing without rows."""
    columns = [key for key in rows[0] if any(row[key] != "" for row in rows)] if rows else []
    if columns:
        with open(path, "w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


def number(x, digits=3):
    return "" if x is None or x != x else f"{x:.{digits}g}"


def fixed(x, digits):
    return "" if x is None else f"{x:.{digits}f}"


def with_error(name, e):
    e = e or {}
    return {name: number(e.get("value")), name + " error": number(e.get("standard_error"), 2)}


def percent(x):
    return number(None if x is None else 100 * x)


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
    laws, friction = [], []
    for entry in summary.get("entries", []):
        head = {"solid fraction": f"{entry['solid_fraction']:.3f}", "packings": entry["packings"]}
        for law in entry["laws"]:
            row = head | {"form": law["form"], "best": "yes" if law["form"] == entry["best"] else "no"}
            for key in ("a", "b", "delta", "m0", "m1", "m2"):
                row |= with_error(key, law[key])
            laws.append(row | {"error fitted [%]": percent(law["error_fitted"]), "held out [%]": percent(law["error_held_out"]),
                               "leave one out [%]": percent(law["error_cross"]), "information criterion": number(law["criterion"], 4)})
        for kind in ("plane", "solid", "soft"):
            slide = entry["slide_" + kind]
            friction.append(head | {"neighbour": kind} | with_error("friction limit", slide["friction"]) |
                            with_error("kt/kn", slide["kt_ratio"]))
    return {"laws.csv": laws, "friction.csv": friction}


def hierarchy_tables(summary):
    if "levels" not in summary or "fixed_point" not in summary:
        return {}
    levels, changes = [], []
    for level in summary["levels"]:
        inner, sensitivity = level.get("inner", {}), level.get("sensitivity", {})
        levels.append({"level": level["level"], "own grains [% of the shell]": number(level["grain_percent"]),
                       "soft particles inside": number(inner.get("mean", 0)), "their volume [% of the shell]": number(inner.get("volume_percent", 0)),
                       "next level over own grains": number(inner.get("next_volume")), "all grains [% of the shell]": number(level["solid_percent"]),
                       "grains if resolved": number(level["resolved_grains"]),
                       "a": number(level["law"]["a"]), "b": number(level["law"]["b"]), "delta": number(level["law"]["delta"]),
                       "standard error of forces [%]": number(level.get("error_percent")),
                       "sensitivity to the law below": fixed(sensitivity.get("value"), 2),
                       "sensitivity error": fixed(sensitivity.get("error"), 2),
                       "law against the level below [%]": number(level.get("distance_percent")), "noise [%]": number(level.get("noise_percent")),
                       "contact evaluations": number(level["contact_evaluations"]), "seconds": number(level["seconds"])})
        changes += [{"level": level["level"], "configuration": c["configuration"], "force over that of the level below": fixed(c["ratio"], 3),
                     "error": fixed(c["error"], 3)} for c in level.get("changes", [])]
    check = [{"h/Rs": number(p["overlap"]), "law [F/(E Rs^2)]": number(p["law"], 4), "law error": number(p["law_error"], 2),
              "all grains [F/(E Rs^2)]": number(p["resolved"], 4), "all grains error": number(p["resolved_error"], 2),
              "law over all grains": fixed(p["ratio"], 3), "ratio error": fixed(p["ratio_error"], 3)}
             for p in summary.get("check", {}).get("points", [])]
    return {"levels.csv": levels, "changes.csv": changes, "check.csv": check}


def diameters(level):
    return {"diameter from [mm]": number(1e3 * level["diameter_low"]), "to [mm]": number(1e3 * level["diameter_high"])}


def recipe_tables(summary):
    recipe = summary.get("recipe") or {}
    levels = []
    for level in recipe.get("levels", []):
        e = level["onset_with_finer"]
        levels.append({"level": level["level"]} | diameters(level) |
                      {"share of the volume [%]": percent(level["volume_share"]), "phi_J alone": number(level["onset"], 4),
                       "phi_J with all finer": number(e["value"], 4), "low (95 %)": number(e["interval"][0], 4), "high (95 %)": number(e["interval"][1], 4),
                       "finer grains over its voids": number(level.get("filling"), 2), "grains in a cubic metre": number(level["grains_per_cubic_metre"], 2)})
    shells = [{"level of the shell hierarchy": s["level"]} | diameters(s) |
              {"one plane at h/Rs = 0.2 [F/(E Rs^2)]": number(s["force_over_E_Rs2"]), "grains in a soft particle": number(s["grains"])}
              for s in recipe.get("shells", [])]
    return {"levels.csv": levels, "shells.csv": shells} if recipe else {}


def about(summary):
    p = summary.get("provenance", {})
    time = f", {summary['seconds']:.0f} s on {p.get('threads')} threads" if "seconds" in summary else ""
    text = f"# Run: {summary.get('title', '')}\n\n`{plain(p.get('command', ''))}`, version {p.get('version')}, commit {p.get('commit')}, "
    text += f"seed {p.get('seed')}, status {summary['status']}{time}. Written by `results/{os.path.basename(__file__)}`.\n"
    for key in ("fixed_point", "check"):
        if "text" in summary.get(key, {}):
            text += "\n" + summary[key]["text"] + "\n"
    if summary.get("remarks"):
        text += "\n## Remarks of the run\n\n" + "".join(f"- {r}\n" for r in summary["remarks"])
    return text


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    run, out, figures = sys.argv[1], sys.argv[2], sys.argv[3:]
    with open(os.path.join(run, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    os.makedirs(out, exist_ok=True)
    raw = summary.get("provenance", {}).get("command", "")
    for name in sorted(os.listdir(run)):
        of_level = name.startswith("law_table_level_")
        if name in COPIED or of_level and name.endswith(".h5"):
            shutil.copy(os.path.join(run, name), out)
        elif name in CARDS or of_level and name.endswith(".toml"):
            with open(os.path.join(run, name), encoding="utf-8") as file:
                card = file.read()
            with open(os.path.join(out, name), "w", encoding="utf-8") as file:
                file.write(card.replace(raw, plain(raw)) if raw else card)
    for name in figures:
        with open(os.path.join(run, "figures", name + ".svg"), encoding="utf-8") as file:
            drawing = file.read()
        with open(os.path.join(out, name + ".svg"), "w", encoding="utf-8") as file:
            file.write(VALUES.sub("", drawing))
    for name, rows in (law_tables(summary) | hierarchy_tables(summary) | recipe_tables(summary)).items():
        write_csv(os.path.join(out, name), rows)
    with open(os.path.join(out, "run.md"), "w", encoding="utf-8") as file:
        file.write(about(summary))


if __name__ == "__main__":
    main()
