#!/usr/bin/env python3
"""What `check` says a scene will take beside what it takes, in seconds of one core.

    python3 tests/bench/check_times.py build/release/softgrain [--work DIR] [--only NAME ...] [--whole] [--check-only] [--anew] [--table FILE] [--bound FACTOR]

Each shipped scene is run with one thread, most of them with fewer packings, samples or levels (`--whole`: as shipped), and the
processor time of the process is compared with `core_seconds` of `check --json` for the same settings. What was measured is kept in
DIR/measured.json, so that runs can be spread over hours and `--check-only` compares new estimates with old measurements.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# scene: command, settings that make it smaller
SCENES = {
    "quickstart": ("run", {}),
    "published": ("run", {"packing.count": 2, "macro.samples": 1, "macro.bodies": 100}),
    "calibration": ("run", {"packing.count": 8}),
    "law_table": ("run", {"multi_contact.packings_min": 7, "multi_contact.packings_max": 7, "variant": "[]", "plan": "[]"}),
    "four_decades": ("run", {"multi_contact.packings_min": 4, "multi_contact.packings_max": 4, "hierarchy.levels": 2,
                                  "fixed_point.iterations": 2, "check.packings": 1}),
    "packing_study": ("microsim", {"packing.count": 8}),
    "relaxation_check": ("microsim", {"packing.count": 4}),
    "relaxation_study": ("microsim", {"packing.count": 8}),
    "rotation_study": ("microsim", {"packing.count": 8}),
    "macro_vs_resolved": ("run", {"macro.samples": 1}),
    "inverse": ("run", {"search.budget": 20, "packing.count": 4}),
    "glass_beads": ("microsim", {"box.grains": 800}),
    "glass_beads_small": ("microsim", {}),
    "glass_beads_comparison": ("microsim", {}),
    "glass_beads_sliding": ("microsim", {}),
    "powder_method1": ("microsim", {"samples": 1}),
    "powder_method2": ("microsim", {"samples": 1}),
    "powder_series_b": ("microsim", {"samples": 1}),
    "powder_table": ("microsim", {"samples": 1, "only": '["grains-mu05", "rr-mu015"]'}),
    "powder_variants": ("microsim", {"samples": 1, "only": '["phi-052", "kappa-1e3"]'}),
    "powder_method2_variants": ("microsim", {"samples": 1, "only": '["rr-p0"]'}),
    "powder_consolidation": ("microsim", {"samples": 1, "only": '["dense"]'}),
}


def environment():
    return {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}


def settings_of(changes):
    out = []
    for key, value in changes.items():
        out += ["--set", f"{key}={value}"]
    return out


def expected(program, scene, changes):
    """What check says [s of one core], or None where it says nothing."""
    done = subprocess.run([program, "check", scene, "--json", *settings_of(changes)], env=environment(), cwd=ROOT,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{scene}: check ended with {done.returncode}\n{done.stderr}")
    facts = json.loads(done.stdout)
    return facts.get("core_seconds"), facts.get("core_seconds_parts", {})


def measured(program, command, scene, changes, directory):
    """Processor time of a whole run [s of one core] and its exit status."""
    before = os.times()
    start = time.monotonic()
    done = subprocess.run([program, command, scene, "--out", directory, *settings_of(changes)], env=environment(),
                          cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = os.times()
    if done.returncode not in (0, 3):
        sys.exit(f"{scene}: {command} ended with {done.returncode}")
    return {"core_seconds": after.children_user + after.children_system - before.children_user - before.children_system,
            "seconds": time.monotonic() - start, "status": done.returncode}


HEAD = ["scene", "smaller than shipped", "expected [s]", "measured [s]", "expected over measured"]


def cells(name, changes, says, takes):
    return [name, ", ".join(f"{key}={value}" for key, value in changes.items()), f"{says or 0:.3g}", f"{takes or 0:.3g}",
            f"{says / takes:.2f}" if says and takes else ""]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--work", default="build/check_times")
    parser.add_argument("--only", nargs="+", default=list(SCENES), choices=SCENES)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--check-only", action="store_true")
    parser.add_argument("--anew", action="store_true", help="forgets what was measured before")
    parser.add_argument("--table", help="CSV file to write, as results/check_times/check_times.csv")
    parser.add_argument("--bound", type=float, help="largest factor between the two; above it the exit status is 1")
    options = parser.parse_args()
    program = str(Path(options.program).resolve())
    work = Path(options.work).resolve()
    work.mkdir(parents=True, exist_ok=True)
    kept = work / "measured.json"
    known = json.loads(kept.read_text()) if kept.exists() and not options.anew else {}
    rows = []
    for name in options.only:
        command, smaller = SCENES[name]
        changes = {} if options.whole else smaller
        scene = str(ROOT / "pipelines" / f"{name}.toml")
        key = name + json.dumps(changes)
        if key not in known and not options.check_only:
            known[key] = measured(program, command, scene, changes, str(work / name))
            kept.write_text(json.dumps(known, indent=1))
        says, parts = expected(program, scene, changes)
        takes = known.get(key, {}).get("core_seconds")
        rows.append((name, changes, says, takes))
        print(" | ".join(cells(*rows[-1])), json.dumps(parts), flush=True)
    if options.table:
        with open(options.table, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEAD] + [cells(*row) for row in rows])
    far = [name for name, _, says, takes in rows if options.bound and takes
           and not 1.0 / options.bound <= (says or 0.0) / takes <= options.bound]
    if far:
        sys.exit(f"more than a factor of {options.bound} off: {', '.join(far)}")


if __name__ == "__main__":
    main()
