#!/usr/bin/env python3
"""Tables of grain-box runs: collect.py RUN_DIR... for one part of tables.md. Standard library only (Python 3.11 or later).

Reads summary.json of every run directory and sets their packs side by side. RUN_DIR=NAME renames the pack of a run of one.
"""
import json
import os
import sys
import tomllib

STRESSES = [10e6, 15e6, 20e6, 30e6, 40e6, 60e6, 80e6, 100e6]


def packs_of(directories):
    for argument in directories:
        directory, _, name = argument.partition("=")
        with open(os.path.join(directory, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
        for pack in summary["packs"]:
            if name:
                pack["name"] = name
            yield pack, summary


def text(value, digits=3):
    return "-" if value is None else f"{value:.{digits}g}"


def in_mpa(value):
    return None if value is None else value / 1e6


def row(cells):
    print("| " + " | ".join(cells) + " |")


def header(cells):
    row(cells)
    print("|" + "---|" * len(cells))


def states(packs):
    header(["pack", "grains", "mu", "increment", "sigma_c(mu=0) [MPa]", "solid fraction", "z", "sigma_c at end of (b) [MPa]",
            "sliding there", "sigma_c at end [MPa]", "sliding at end", "Q = mu P of the start of an increment", "z at end",
            "sigma_c of smallest G [MPa]", "largest shear/sigma_c", "largest moment/(V sigma_c)"])
    for pack, _ in packs:
        a, b, c = pack["after_compaction"], pack["after_friction"] or pack["after_compaction"], pack["at_end"]
        row([pack["name"], str(pack["grains"]), str(pack["mu"]), ", ".join(f"{x:g}" for x in pack["increments"]),
             text(a["pressure"] / 1e6), text(a["solid_fraction"], 4), text(a["coordination"], 4), text(b["pressure"] / 1e6),
             text(b["sliding_share"]), text(c["pressure"] / 1e6, 4) if c else "-", text(c["sliding_share"]) if c else "-",
             text(c["sliding_limit_at_start"]) if c else "-", text(c["coordination"], 4) if c else "-",
             text(in_mpa(pack["pressure_of_smallest_G"])), text(pack["largest_shear_stress_ratio"], 2),
             text(pack["largest_wall_moment_ratio"], 2)])


def side_by_side(packs, name, unit, factor, form):
    header([f"{name.replace('_', ' ')} [{unit}] at sigma_c"] + [f"{s / 1e6:g} MPa" for s in STRESSES])
    for pack, _ in packs:
        found = {round(m["pressure"]): m for m in pack["moduli"]}
        cells = []
        for stress in STRESSES:
            m = found.get(round(stress))
            cells.append("-" if m is None or m[name] is None else f"{m[name] / factor:{form}} ± {m[name + '_error'] / factor:{form}}")
        row([pack["name"]] + cells)


def exponents(packs):
    fit = tomllib.loads(packs[0][1]["provenance"]["scene"])["fit"]
    low, high = (" to ".join(fit[k]) for k in ("low", "high"))
    header(["growth exponent", f"K, {low}", f"K, {high}", f"G, {low}", f"G, {high}"])
    for pack, _ in packs:
        e = pack["exponents"]
        row([pack["name"]] + [
            "-" if e[k]["exponent"] is None else f"{e[k]['exponent']:.3f} ± {e[k]['standard_error']:.3f} ({e[k]['points']} intervals)"
            for k in ("K_low", "K_high", "G_low", "G_high")])


def cost(packs):
    header(["pack", "states", "iterations", "loop passes", "tries that failed", "worst residual", "seconds", "commit"])
    for pack, summary in packs:
        e = pack["effort"]
        row([pack["name"], str(e["states"]), str(e["iterations"]), str(e["loop_passes"]), str(e["retries"]),
             text(e["worst_residual"], 2), text(e["seconds"]), summary["provenance"]["commit"][:12]])


def main(directories):
    packs = list(packs_of(directories))
    states(packs)
    for what in (("K", "GPa", 1e9, ".3f"), ("G", "GPa", 1e9, ".3f"), ("mean_normal_force", "N", 1.0, ".4f")):
        print()
        side_by_side(packs, *what)
    print()
    exponents(packs)
    print()
    cost(packs)


if __name__ == "__main__":
    main(sys.argv[1:])
