#!/usr/bin/env python3
"""Writes tables.md, relaxations.csv, cost.csv, law.toml and the pictures of this folder from three runs and a comparison; README.md and
notes.md are written by hand. The second run repeats the first with the damped relaxation, the third has the damped relaxation and the
published protocol on 24 packings, and the comparison is that of results/relaxation/study.sh.

  softgrain run pipelines/published.toml --out results/published_run
  softgrain run pipelines/published.toml --set measure.relaxation=damped --set measure.least_work={} --out results/published_damped
  softgrain microsim pipelines/relaxation_check.toml --out results/relaxation_check
  results/relaxation/study.sh results/relaxation_study
  python3 results/published/collect.py results/published_run results/published_damped results/relaxation_check \\
    results/relaxation_study/dynamics-finer.json
"""
import csv
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
    "ratio-slow-dynamics-published-soft-solid": "relaxations_ratio",
    "axial-stress-oedometric": "macro_against_twin",
    "size-distribution-of-the-packed-grains": "size_distribution",
}
QUANTITIES = {"normal": ("Fn", "N"), "kt_initial": ("kt, initial slope", "N/m"), "kt_secant": ("kt, secant at 1 degree", "N/m")}
RELAXATION_HEAD = ["pair", "quantity", "unit", "Delta", "packings"] + [
    name + end for name in ("published protocol", "slow dynamics") for end in (" [unit]", ": error [unit]")] + [
    "slow dynamics over published", "slow dynamics over published: error", "damped [unit]", "damped: error [unit]",
    "damped over published", "damped over published: error"]
COST_HEAD = ["pair", "state", "relaxation", "points", "loop passes per point", "contact evaluations per point", "time per point [s]"]


def published(delta):
    """The published soft-solid law [N]."""
    return max(73.669 * delta**2.799 - 0.035, 0.0)


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(r) + " |" for r in rows]) + "\n"


def write_csv(name, head, rows):
    with open(HERE / name, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head] + rows)


def pm(value, error):
    return " ± ".join(digits(value, error))


def digits(value, error):
    return [f"{value:.3g}", f"{error:.2g}"]


def law_rows(laws):
    rows = []
    for kind, law in laws.items():
        for part, name in (("normal", "Fn"), ("tangential", "kt, initial slope"), ("tangential_secant", "kt, secant at {:g}°")):
            p = law.get(part)
            if not p or p.get("a") is None:
                continue
            cells = [kind, name.format(p.get("angle_deg", 0.0))]
            for key in ("a", "b", "c", "delta"):
                low, high = (f"{x:.3g}" if x is not None else "unbounded" for x in p[key + "_interval"])
                cells.append(f"{p[key]:.4g} [{low}, {high}]")
            rows.append(cells + [p.get("unit", ""), law["status"]])
    return rows


def against_law(value, error, target):
    return f"{pm(value, error)} ({100 * (value / target - 1):+.0f} %)"


def ratio(r):
    return pm(r["ratio"], r["ratio_error"]) if r["ratio"] is not None and r["ratio_error"] is not None else "-"


def study_rows(study, pair, scale):
    """Rows of `softgrain compare` [over E Rs^2] in the form of a run's own: fast and slow mean with error, ratio."""
    rows = []
    for r in next(m for m in study["measurements"] if m["pair"] == pair)["normal_force"]:
        rows.append({"delta": r["delta"], "packings": r["reference"]["n"], "ratio": r["ratio"], "ratio_error": r["ratio_standard_error"],
                     "reference": scale * r["reference"]["mean"], "reference_error": scale * r["reference"]["standard_error"],
                     "candidate": scale * r["candidate"]["mean"], "candidate_error": scale * r["candidate"]["standard_error"]})
    return rows


def force_rows(checked, studied, law=None):
    """Published protocol and damped on the packings of the check; published protocol and slow-dynamics on those of the study."""
    rows = []
    for old, new in zip(checked, studied):
        assert abs(old["delta"] - new["delta"]) < 1e-9
        target = law(old["delta"]) if law else None
        cells = [f"{old['delta']:.2f}"] + ([f"{target:.3f}"] if law else [])
        for r in (new, old):
            for key in ("reference", "candidate"):
                value, error = r[key], r[key + "_error"]
                cells.append(against_law(value, error, target) if law else pm(value, error))
            cells.append(ratio(r))
        rows.append(cells)
    return rows


def ratio_digits(r):
    return digits(r["ratio"], r["ratio_error"]) if r["ratio"] is not None and r["ratio_error"] is not None else ["", ""]


def relaxation_rows(run, damped):
    """Three relaxations on the packings of the run: mean, error and ratio by pair, quantity and overlap."""
    out = []
    for pair in ("soft-solid", "soft-soft"):
        for key, (quantity, unit) in QUANTITIES.items():
            by_delta = {round(r["delta"], 6): r for r in damped["relaxations"][pair][key]}
            for r in run["relaxations"][pair][key]:
                d = by_delta.get(round(r["delta"], 6))
                if not r["reference"] or not d:
                    continue
                out.append([pair, quantity, unit, f"{r['delta']:.3f}", r["packings"], *digits(r["reference"], r["reference_error"]),
                            *digits(r["candidate"], r["candidate_error"]), *ratio_digits(r), *digits(d["candidate"], d["candidate_error"]), *ratio_digits(d)])
    return out


def cost_rows(relaxations, damped):
    rows = []
    for kind in ("soft-solid", "soft-soft"):
        if kind not in relaxations:
            continue
        for source, which in ((relaxations, "reference"), (relaxations, "candidate"), (damped, "candidate")):
            for part, word in (("cost", "normal"), ("tangential_cost", "rotated")):
                c = source[kind][f"{which}_{part}"]
                if not c["points"]:
                    continue
                rows.append([kind, word, source[which], str(c["points"]), f"{c['loop_passes_per_point']:.0f}",
                             f"{c['contact_evaluations_per_point']:.3g}", f"{c['seconds_per_point']:.3f}"])
    return rows


def tables_page(run, old, check, study):
    p, c, macro = run["packings"], run["comparison"], run["macro"]
    scale = 5e5 * 0.016**2  # E Rs^2 [N]
    text = "# Tables of the published experiment\n\n"
    text += (f"Written by `collect.py` from the runs named there: `pipelines/published.toml` (slow dynamics, version {run['provenance']['version']}, "
             f"commit {run['provenance']['commit']}, status {run['status']}), the same with the damped relaxation (commit {old['provenance']['commit']}), "
             f"`pipelines/relaxation_check.toml` (commit {check['provenance']['commit']}) and the [study of the relaxations](../relaxation/README.md).\n\n")
    text += (f"{p['count']} packings: {p['grains']:.0f} grains, solid fraction {p['solid_fraction']:.4f} ± {p['solid_fraction_deviation']:.4f} "
             f"(deviation), {p['contacts_per_grain']:.2f} contacts per grain, re-fitted exponent {p['exponent']:.2f} ± {p['exponent_deviation']:.2f}.\n\n")
    law_head = ["pair", "quantity", "a", "b", "c", "delta", "unit", "status"]
    text += "## Laws by slow dynamics\n\n95 % intervals by bootstrap over packings.\n\n" + table(law_head, law_rows(run["laws"]))
    text += "\nPublished, soft-solid normal: a = 73.669 N, b = 2.799, c = -0.035 N, delta = 0.065. a, b and delta are nearly degenerate: compare F.\n"
    text += "\n## Laws by the damped relaxation, same packings\n\n" + table(law_head, law_rows(old["laws"]))
    sides = ["published protocol (B)", "slow dynamics (B)", "ratio", "published protocol (A)", "damped (A)", "ratio"]
    text += "\n## F(Delta), soft-solid, against the published law [N]\n\nA: 24 packings (seed 1). B: 24 others (seed 2001) that no setting was chosen on.\n\n"
    text += table(["Delta", "published law"] + sides, force_rows(check["relaxations"]["soft-solid"]["normal"], study_rows(study, "soft-solid", scale), published))
    text += "\n## F(Delta), soft-soft [N]\n\n"
    text += table(["Delta"] + sides, force_rows(check["relaxations"]["soft-soft"]["normal"], study_rows(study, "soft-soft", scale)))
    text += "\n## Macro scene against its shelled twin\n\n"
    text += (f"{macro['samples']} samples of {macro['bodies']} particles, {100 * macro['soft_volume_share']:.0f} % soft by volume, "
             f"{run['resolved']['grains_inside']} grains in a twin. The axial stress differs by {100 * c['stress_error']:.0f} % "
             f"(± {100 * c['stress_error_standard_error']:.0f} %, relative L2). At the end the law gives {c['end_stress_ratio']:.2f} of the twin's stress. "
             f"It takes {c['speedup_contact_evaluations']:.0f} times fewer contact evaluations and {c['speedup_seconds']:.0f} times less time.\n")
    text += "\n## Remarks of the run\n\n" + "".join(f"- {r}\n" for r in run["remarks"])
    return text


def main():
    run_dir, damped_dir, check_dir, study_file = (pathlib.Path(p) for p in sys.argv[1:5])
    run, old, check = (json.loads((d / "summary.json").read_text()) for d in (run_dir, damped_dir, check_dir))
    (HERE / "tables.md").write_text(tables_page(run, old, check, json.loads(study_file.read_text())))
    write_csv("relaxations.csv", RELAXATION_HEAD, relaxation_rows(run, old))
    write_csv("cost.csv", COST_HEAD, cost_rows(run["relaxations"], old["relaxations"]))
    for source, name in FIGURES.items():
        shutil.copy(run_dir / "figures" / f"{source}.svg", HERE / f"{name}.svg")
    card = (run_dir / "law.toml").read_text().splitlines()
    # The command as anybody would type it, without the paths of the machine it ran on.
    card = ['command = "softgrain run pipelines/published.toml"' if line.startswith("command = ") else line for line in card]
    (HERE / "law.toml").write_text("\n".join(card) + "\n")


if __name__ == "__main__":
    main()
