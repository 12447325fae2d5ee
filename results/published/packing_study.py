#!/usr/bin/env python3
"""F(Delta) for several packings, from the summaries below a folder (run by packing_study.sh): prints packing_study.md and writes
packing_study.csv, which has all columns."""
import csv
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).parent
DELTAS = [0.10, 0.15, 0.20, 0.25, 0.30]
SHOWN = [0.10, 0.20, 0.30]  # in the Markdown table
SETTINGS = ["beta", "trials", "rmax/Rs", "grains", "solid fraction", "exponent"]


def published(delta):
    """The published soft-solid law [N]."""
    return max(73.669 * delta**2.799 - 0.035, 0.0)


def setting_cells(summary):
    values = {}
    for line in summary["provenance"]["scene"].splitlines():
        key, _, value = line.partition("=")
        values[key.strip()] = value.split("#")[0].strip().strip("'\"")
    packings = summary["packings"]
    return [values["beta"], values["trials"], f"{float(values['rmax_over_shell']):.2f}", f"{packings['grains']:.0f}",
            f"{packings['solid_fraction']:.3f}", f"{packings['exponent']:.2f}"]


def force_cells(summary, delta):
    """Force and standard error [N], difference from the published law [%]."""
    for f in summary["forces"].get("soft-solid", []):
        if round(f["delta"], 6) == delta:
            return [f"{f['force']:.3f}", f"{f['standard_error']:.3f}", f"{100 * (f['force'] / published(delta) - 1):+.0f}"]
    return ["", "", ""]


def shown(cells):
    return "{} ± {} ({} %)".format(*cells) if cells[0] else "-"


def main():
    summaries = [json.loads(p.read_text()) for p in sorted(pathlib.Path(sys.argv[1]).glob("*/summary.json"))]
    head = SETTINGS + [f"F({d:.2f}){end}" for d in DELTAS for end in (" [N]", ": error [N]", ": from the published law [%]")]
    with open(HERE / "packing_study.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(head)
        for s in summaries:
            out.writerow(setting_cells(s) + [cell for d in DELTAS for cell in force_cells(s, d)])
        out.writerow(["published", "", "", "", "", "3.5"] + [cell for d in DELTAS for cell in (f"{published(d):.3f}", "", "")])
    print("""# How the packing moves the force on a plane

Mean of 24 packings ± standard error; in brackets the difference from the published law. Damped relaxation, E = 5e5 Pa, Rs = 0.016 m,
nu = 0.3, mu = 0.3. I is the number of trials, which was not published, and neither were beta and rmax/Rs. Made by
`results/published/packing_study.sh`; all overlaps and the re-fitted exponents: [packing_study.csv](packing_study.csv).
""")
    print("| " + " | ".join(["beta", "I", *SETTINGS[2:5]] + [f"F({d:.2f}) [N]" for d in SHOWN]) + " |\n" + "|---" * 8 + "|")
    for s in summaries:
        print("| " + " | ".join(setting_cells(s)[:5] + [shown(force_cells(s, d)) for d in SHOWN]) + " |")
    print("| published | ? | ? | ? | ? | " + " | ".join(f"{published(d):.3f}" for d in SHOWN) + " |")


if __name__ == "__main__":
    main()
