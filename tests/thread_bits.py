#!/usr/bin/env python3
"""Whether every kind leaves the same bits on any number of threads, in scenes that are large enough to use them.

  thread_bits.py PROGRAM SCENES [--counts 1,2,3,5,8] [--only NAME,NAME] [--out FOLDER]

SCENES are the tiny scenes of all kinds (every_kind_scenes SCENES). Where a kind sums over pairs, its scene is run with so many
bodies that passes go on all threads (8,000 pairs, 16,000 contacts of the least-work solver); other kinds, whose samples and
tasks run side by side, are run as they are. All files of a run but times are compared with those of the first count.
Slow: minutes; with a program built with the thread sanitizer an hour. Status 1 when something differs or fails. Needs h5py.
"""
import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
from same_bits import compare  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
# Soft particles and solid grains by a law for all neighbours, whose forces need sums over them.
SOFT = f"""kind = "macro"
seed = 1
law = "{ROOT / 'results/law_table/law_table.toml'}"
[macro]
bodies = 2500
samples = 1
steps = 2
strain = 0.05
bands = 0
resolved = false
"""
# Scene (a file, a text or the name of a tiny scene), and what makes it large; by name.
LARGE = {
    "particles-sheared": (ROOT / "tests/bench/scenes/B_shear.toml", ["time.warm_up_steps=10", "time.steps=40"]),
    "macro-soft": (SOFT, []),
    "material-large": ("material", ["grains.count=2500", "samples=1"]),
    "grain-box-large": ("grain-box", ["box.grains=5000", "loading.end_strain=2e-3", 'generation.pressure="1 MPa"',
                                      "generation.increment=0.02"]),
    "powder-large": ("powder", ["disks.count=1200", "samples=1", "assembly.stiffening_time=2.0"]),
    "cells-large": ("material-law", ["law.cells=1500", "samples=1"]),
    "particles-rolling": (ROOT / "tests/bench/scenes/A_shear.toml", ["time.warm_up_steps=10", "time.steps=40",
                                                                    "contact.0.mu_r=0.1", "contact.0.kr_ratio=0.3"]),
}


def command_of(scenes, name, out):
    """Words of the command; a scene that is a text is written to `out`."""
    if name in LARGE:
        scene, settings = LARGE[name]
        path = scene if isinstance(scene, Path) else scenes / scene / "scene.toml"
        if scene is SOFT:
            path = out / f"{name}.toml"
            out.mkdir(parents=True, exist_ok=True)
            path.write_text(scene)
        return ["run", path, *(word for s in settings for word in ("--set", s))]
    return ["run", scenes / name / "scene.toml"]


def run(program, words, threads, place):
    # No more waiting than a machine with fewer cores than threads stands.
    environment = {**os.environ, "GOMP_SPINCOUNT": "300"}
    done = subprocess.run([str(w) for w in [program, *words, "--quiet", "--threads", threads, "--out", place]],
                          capture_output=True, text=True, env=environment)
    return done.returncode, done.stderr


def different(program, scenes, name, counts, out):
    """What differs or fails, in words; empty: nothing. The first count runs twice: what then differs (times) does not count."""
    words = command_of(scenes, name, out)
    runs, statuses = [], []
    for number, threads in enumerate([counts[0], *counts]):
        place = out / name / f"{number}" / "run"
        place.parent.mkdir(parents=True, exist_ok=True)
        status, errors = run(program, words, threads, place)
        if status not in (0, 3):
            return f"{threads} threads: status {status}: {errors.strip()[-600:]}"
        runs.append(place)
        statuses.append(status)
    if len(set(statuses)) > 1:
        return f"statuses {statuses}"
    changing = frozenset(compare(runs[0], runs[1], quiet=True))
    for threads, place in zip(counts[1:], runs[2:]):
        # Reports, logs and tables of comparisons hold threads and times, rounded, which two runs may share; their other
        # numbers stand in the other files.
        aside = (".html", "log.txt", "table.csv", "table.md")
        found = [f for f in compare(runs[0], place, known=changing, quiet=True) if not f[0].endswith(aside) and
                 not f[1].endswith(("threads", "memory_before_scene"))]
        if found:
            return f"{threads} threads: {len(found)} places differ: {sorted(found)[:3]}"
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("scenes", type=Path)
    parser.add_argument("--counts", default="1,2,3,5,8", help="numbers of threads, comma-separated")
    parser.add_argument("--only", default="", help="names, comma-separated: those alone")
    parser.add_argument("--out", type=Path, help="keeps the runs there")
    options = parser.parse_args()
    counts = options.counts.split(",")
    tiny = [row["name"] for row in csv.DictReader((options.scenes / "scenes.csv").read_text().splitlines())]
    names = [n for n in [*tiny, *LARGE] if not options.only or n in options.only.split(",")]
    failed = 0
    with tempfile.TemporaryDirectory() as temporary:
        for name in names:
            trouble = different(options.program.resolve(), options.scenes.resolve(), name, counts,
                                (options.out or Path(temporary)).resolve())
            failed += bool(trouble)
            print(f"{name}: {trouble or 'same bits'}", flush=True)
    print(f"{len(names) - failed} of {len(names)} scenes leave the same bits on {', '.join(counts)} threads")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
