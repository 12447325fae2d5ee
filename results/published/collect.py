#!/usr/bin/env python3
"""Tables and pictures of this folder from two run directories.

  softgrain run pipelines/published.toml --out results/published_run
  softgrain microsim pipelines/relaxation_check.toml --out results/relaxation_check
  python3 results/published/collect.py results/published_run results/relaxation_check
"""
import json
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).parent
FIGURES = {
    "fn-soft-particle-on-a-solid-plane": "normal_law",
    "fn-two-equal-soft-particles": "normal_law_soft_soft",
    "kt-initial-slope-up-to-0-05-soft-solid": "tangential_stiffness",
    "kt-secant-at-1-soft-solid": "tangential_secant",
    "ratio-damped-published-soft-solid": "relaxations_ratio",
    "axial-stress-oedometric": "macro_against_twin",
    "size-distribution-of-the-packed-grains": "size_distribution",
}


def published(delta):
    """The published soft-solid law [N]."""
    return max(73.669 * delta**2.799 - 0.035, 0.0)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(r) + " |" for r in rows]) + "\n"


def pm(value, error, digits=3):
    return f"{value:.{digits}g} ± {error:.2g}"


def law_rows(laws):
    rows = []
    for kind, law in laws.items():
        for part, name in (("normal", "Fn"), ("tangential", "kt, initial slope"), ("tangential_secant", "kt, secant at 1°")):
            p = law.get(part)
            if not p or p.get("a") is None:
                continue
            cells = [kind, name]
            for key in ("a", "b", "c", "delta"):
                low, high = (f"{x:.3g}" if x is not None else "unbounded" for x in p[key + "_interval"])
                cells.append(f"{p[key]:.4g} [{low}, {high}]")
            rows.append(cells + [p.get("unit", ""), law["status"]])
    return rows


def force_rows(relaxation_rows):
    rows = []
    for r in relaxation_rows:
        if r["delta"] < 0.099:
            continue
        target = published(r["delta"])
        rows.append([f"{r['delta']:.2f}", f"{target:.3f}",
                     f"{pm(r['reference'], r['reference_error'])} ({100 * (r['reference'] / target - 1):+.0f} %)",
                     f"{pm(r['candidate'], r['candidate_error'])} ({100 * (r['candidate'] / target - 1):+.0f} %)",
                     pm(r["ratio"], r["ratio_error"]), str(r["packings"])])
    return rows


def ratio_rows(rows):
    return [[f"{r['delta']:.3f}", pm(r["reference"], r["reference_error"]), pm(r["candidate"], r["candidate_error"]),
             pm(r["ratio"], r["ratio_error"]) if r["ratio"] is not None and r["ratio_error"] is not None else "-", str(r["packings"])]
            for r in rows if r["reference"]]


def cost_rows(relaxations):
    rows = []
    for kind in ("soft-solid", "soft-soft"):
        if kind not in relaxations:
            continue
        for which, name in (("reference", relaxations["reference"]), ("candidate", relaxations["candidate"])):
            for part, word in (("cost", "normal"), ("tangential_cost", "rotated")):
                c = relaxations[kind][f"{which}_{part}"]
                if not c["points"]:
                    continue
                rows.append([kind, word, name, str(c["points"]), f"{c['loop_passes_per_point']:.0f}",
                             f"{c['contact_evaluations_per_point']:.3g}", f"{c['seconds_per_point']:.3f}"])
    return rows


def main():
    run_dir, check_dir = (pathlib.Path(p) for p in sys.argv[1:3])
    run = json.loads((run_dir / "summary.json").read_text())
    check = json.loads((check_dir / "summary.json").read_text())
    p, c = run["packings"], run["comparison"]
    text = "# The published experiment\n\n"
    text += (f"Made by `collect.py` from `softgrain run pipelines/published.toml` (version {run['provenance']['version']}, commit "
             f"{run['provenance']['commit']}, {run['seconds']:.0f} s on {run['provenance']['threads']} threads, status {run['status']}) and "
             f"`softgrain microsim pipelines/relaxation_check.toml` (commit {check['provenance']['commit']}).\n\n")
    text += (f"{p['count']} packings: {p['grains']:.0f} grains, solid fraction {p['solid_fraction']:.4f} ± {p['solid_fraction_deviation']:.4f} "
             f"(deviation), {p['contacts_per_grain']:.2f} contacts per grain, re-fitted exponent {p['exponent']:.2f} ± {p['exponent_deviation']:.2f}.\n\n")
    text += "![normal law](normal_law.svg)\n\n## Laws (damped relaxation, 95 % intervals by bootstrap over packings)\n\n"
    text += table(["pair", "quantity", "a", "b", "c", "delta", "unit", "status"], law_rows(run["laws"]))
    text += "\nPublished, soft-solid normal: a = 73.669 N, b = 2.799, c = -0.035 N, delta = 0.065. a, b and delta are nearly degenerate: compare F.\n"
    text += "\n## F(Delta), soft-solid, against the published law: 24 packings, both relaxations [N]\n\n"
    text += table(["Delta", "published law", "published protocol", "damped", "damped / protocol", "packings"],
                  force_rows(check["relaxations"]["soft-solid"]["normal"]))
    text += "\n## F(Delta), soft-soft, 24 packings [N]\n\n"
    text += table(["Delta", "published protocol", "damped", "damped / protocol", "packings"], ratio_rows(check["relaxations"]["soft-soft"]["normal"]))
    for kind in ("soft-solid", "soft-soft"):
        for key, name in (("kt_initial", "initial slope"), ("kt_secant", "secant at 1 degree")):
            text += f"\n## kt, {name}, {kind}, {p['count']} packings [N/m]\n\n"
            text += table(["Delta", "published protocol", "damped", "damped / protocol", "packings"], ratio_rows(run["relaxations"][kind][key]))
    text += "\n## Cost per recorded point\n\n"
    text += table(["pair", "state", "relaxation", "points", "loop passes", "contact evaluations", "seconds"], cost_rows(run["relaxations"]))
    text += "\nSeconds are of one thread on a machine that had other work; loop passes and contact evaluations do not depend on that.\n"
    text += "\n![ratio of the relaxations](relaxations_ratio.svg)\n\n## Macro against its shelled twin\n\n"
    text += (f"{run['macro']['samples']} samples of {run['macro']['bodies']} bodies, {100 * run['macro']['soft_volume_share']:.0f} % soft by volume, "
             f"{run['resolved']['grains_inside']} grains in a twin. Axial stress differs by {100 * c['stress_error']:.0f} % "
             f"(± {100 * c['stress_error_standard_error']:.0f} %, relative L2); at the end the law gives {c['end_stress_ratio']:.2f} of the twin's stress. "
             f"{c['speedup_contact_evaluations']:.0f} times fewer contact evaluations, {c['speedup_seconds']:.0f} times less time. "
             "The pair law is measured with one contact; with neighbours all around a soft particle is stiffer.\n\n![macro](macro_against_twin.svg)\n")
    text += "\n## Remarks of the run\n\n" + "".join(f"- {r}\n" for r in run["remarks"])
    text += "\nHow the packing moves the law: [packing_study.md](packing_study.md). How shell and path of rotation move kt: [rotation_study.md](rotation_study.md).\n"
    (HERE / "README.md").write_text(text)
    for source, name in FIGURES.items():
        shutil.copy(run_dir / "figures" / f"{source}.svg", HERE / f"{name}.svg")
    card = (run_dir / "law.toml").read_text().splitlines()
    # The command as anybody would type it, without the paths of the machine it ran on.
    card = ['command = "softgrain run pipelines/published.toml"' if line.startswith("command = ") else line for line in card]
    (HERE / "law.toml").write_text("\n".join(card) + "\n")


if __name__ == "__main__":
    main()
