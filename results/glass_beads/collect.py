#!/usr/bin/env python3
"""Writes states.csv, moduli.csv, exponents.csv and cost.csv of this folder from grain-box runs: collect.py RUN_DIR[=SCENE]...
Standard library only (Python 3.11 or later).

Reads summary.json of every run directory; SCENE is what the first column says, by default the name of the directory. The files that are
kept here are of earlier runs (smooth_walls.md): they count sliding at the limit of the rule instead of that of the start of an increment,
and have neither the moment of the wall forces nor the mean normal force. The pages are written by hand.
"""
import csv
import json
import os
import sys
import tomllib

HERE = os.path.dirname(os.path.abspath(__file__))
STRESSES = [10e6, 15e6, 20e6, 30e6, 40e6, 60e6, 80e6, 100e6]
FILES = {
    "states": ["scene", "packing", "grains", "mu", "increment", "sigma_c without friction [MPa]", "solid fraction", "coordination",
               "sigma_c at end of (b) [MPa]", "sliding share at end of (b)", "sigma_c at end [MPa]", "sliding share at end, by mu P of the state",
               "sliding share at end, by mu P of the start of the increment", "coordination at end", "sigma_c of smallest G [MPa]",
               "largest shear/sigma_c", "largest moment/(V sigma_c)"],
    "moduli": ["scene", "packing", "sigma_c [MPa]", "K [GPa]", "K: error [GPa]", "G [GPa]", "G: error [GPa]", "mean normal force [N]",
               "mean normal force: error [N]"],
    "exponents": ["scene", "packing", "modulus", "from [MPa]", "to [MPa]", "exponent", "error", "intervals"],
    "cost": ["scene", "packing", "states", "iterations", "loop passes", "tries that failed", "worst residual", "time [s]", "commit"],
}


def packs_of(arguments):
    for argument in arguments:
        directory, _, name = argument.partition("=")
        with open(os.path.join(directory, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        for pack in summary["packs"]:
            yield [name or os.path.basename(os.path.normpath(directory)), pack["name"]], pack, summary


def text(value, digits=3):
    return "" if value is None else f"{value:.{digits}g}"


def in_mpa(value, digits=3):
    return "" if value is None else text(value / 1e6, digits)


def states(pack, _):
    a, b, c = pack["after_compaction"], pack["after_friction"] or pack["after_compaction"], pack["at_end"]
    end = ["", "", "", ""] if not c else [in_mpa(c["pressure"], 4), text(c["sliding_share"]), text(c["sliding_limit_at_start"]), text(c["coordination"], 4)]
    return [[pack["grains"], pack["mu"], ", ".join(f"{x:g}" for x in pack["increments"]), in_mpa(a["pressure"]), text(a["solid_fraction"], 4),
             text(a["coordination"], 4), in_mpa(b["pressure"]), text(b["sliding_share"]), *end, in_mpa(pack["pressure_of_smallest_G"]),
             text(pack["largest_shear_stress_ratio"], 2), text(pack["largest_wall_moment_ratio"], 2)]]


def moduli(pack, _):
    found = {round(m["pressure"]): m for m in pack["moduli"]}
    for stress in STRESSES:
        m = found.get(round(stress))
        if m is None:
            continue
        cells = [("", "") if m[name] is None else (f"{m[name] / factor:{form}}", f"{m[name + '_error'] / factor:{form}}")
                 for name, factor, form in (("K", 1e9, ".3f"), ("G", 1e9, ".3f"), ("mean_normal_force", 1.0, ".4f"))]
        if any(value for value, _ in cells):
            yield [in_mpa(stress), *(cell for pair in cells for cell in pair)]


def exponents(pack, summary):
    fit = tomllib.loads(summary["provenance"]["scene"])["fit"]
    for modulus in "KG":
        for part in ("low", "high"):
            e = pack["exponents"][f"{modulus}_{part}"]
            if e["exponent"] is not None:
                yield [modulus, *(limit.removesuffix(" MPa") for limit in fit[part]), f"{e['exponent']:.3f}", f"{e['standard_error']:.3f}", e["points"]]


def cost(pack, summary):
    e = pack["effort"]
    return [[e["states"], e["iterations"], e["loop_passes"], e["retries"], text(e["worst_residual"], 2), text(e["seconds"]),
             summary["provenance"]["commit"][:12]]]


def main(arguments):
    packs = list(packs_of(arguments))
    for rows_of in (states, moduli, exponents, cost):
        with open(os.path.join(HERE, rows_of.__name__ + ".csv"), "w", newline="", encoding="utf-8") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(FILES[rows_of.__name__])
            out.writerows(name + row for name, pack, summary in packs for row in rows_of(pack, summary))


if __name__ == "__main__":
    main(sys.argv[1:])
