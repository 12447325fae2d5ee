#!/usr/bin/env python3
"""Tables and pictures of this folder from what was measured: python3 results/performance/collect.py DIRECTORY

Writes contact_loop.csv, scaling.csv, engines.csv, threads.csv, tables.md (the narrow tables), floor.svg and growth.svg.
README.md and the pages beside it are written by hand. README.md says how to make the files that DIRECTORY holds; what
needs a missing one is not written, or marked as not measured in tables.md:
  loop.json     bench_softgrain --benchmark_filter='Contact|Bare|Roofline' --benchmark_format=json
  scaling.json  tests/bench/scaling --json
  engines.json  tests/bench/compare_engines --json
  instructions.json  the same with --callgrind, when counted in another run
  macro.json    tests/bench/scaling --macro --json
"""
import csv
import json
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).parent


class Work:
    """Operations of one scene, counted by hand in common/dynamics/block_gather.h and block_loop.cpp: what the physics needs, not what the
    loop happens to do. Per listed pair, then per touching contact. A gather is a record of 32 bytes of a body, a scatter
    one that is added to; streams are bytes of the list, once each."""

    def __init__(self, pair_flops, flops, roots, divisions, gathers, scatters, pair_bytes, bytes_):
        self.pair_flops, self.flops, self.roots, self.divisions = pair_flops, flops, roots, divisions
        self.gathers, self.scatters, self.pair_bytes, self.bytes = gathers, scatters, pair_bytes, bytes_

    def times(self, machine, listed, locality):
        """ns per touching contact of each kind of work; `listed`: listed pairs per contact."""
        return {"sums and products": (self.flops + listed * self.pair_flops) * machine["RooflineFlop"],
                "roots, divisions": self.roots * machine["RooflineRoot"] + self.divisions * machine["RooflineDivision"],
                "gathers": (self.gathers + 2 * listed) * machine[f"RooflineGather/{locality}"],
                "scatters": self.scatters * machine[f"RooflineScatter/{locality}"],
                "list": (self.bytes + listed * self.pair_bytes) * machine["RooflineRead/6291456"]}


# Distance and test of a pair 14 (11 without periodicity); elastic 15 and 6 to add; motion of two points 35, spring and
# limit 50, dashpot 3 along and 12 across the normal, total and moment 12, torques 12.
FULL = Work(14, 145, 4, 2, 4, 4, 13, 80)
ELASTIC = Work(14, 21, 2, 1, 0, 2, 12, 16)
CASES = {  # benchmark: words, work
    "ContactLoop/full": ("full: friction, damping, rotation, periodic", FULL),
    "ContactLoop/as_read": ("full, grains in the order of the file", FULL),
    "ContactLoop/undamped": ("no damping", Work(14, 130, 3, 2, 4, 4, 13, 80)),
    "ContactLoop/frictionless": ("no friction, no rotation", Work(14, 35, 3, 1, 2, 2, 12, 16)),
    "ContactLoop/frictionless_undamped": ("no friction, rotation or damping", ELASTIC),
    "ContactLoop/frictionless_undamped_as_read": ("the same, grains in the order of the file", ELASTIC),
    "ContactLoop/rescaled": ("rescaled spring", Work(14, 150, 4, 3, 4, 4, 13, 96)),
    "ContactLoop/open_cell": ("open cell", Work(11, 142, 4, 2, 4, 4, 9, 80)),
    "ContactLoop/polydisperse": ("radii 0.1-1 m (scene B)", FULL),
    "ContactLoopDiscs/full": ("2D", Work(10, 85, 4, 2, 3, 3, 13, 48)),
    "ContactLoopDiscs/frictionless_undamped": ("2D, neither friction nor damping", Work(10, 15, 2, 1, 0, 2, 12, 16)),
}
OTHERS = {  # no count by hand: what they are compared with
    "ContactLoopScalar/full": ("scalar loop, full", "ContactLoop/full"),
    "ContactLoopScalar/frictionless_undamped": ("scalar loop, no friction, rotation or damping", "ContactLoop/frictionless_undamped"),
    "ContactLoopWalls/full": ("walls only, full", "ContactLoopScalar/full"),
    "ContactLoopWalls/frictionless_undamped": ("walls only, no friction, rotation or damping", "ContactLoopScalar/frictionless_undamped"),
    "ContactLoopOutput/full": ("pass and records of all contacts", "ContactLoop/full"),
    "ContactLoopStiffnessOff/full": ("pass, list read, forces set to zero", "ContactLoop/full"),
    "ContactLoopStiffnessOn/full": ("the same with sums of stiffness", "ContactLoopStiffnessOff/full"),
    "ContactLoopSoft/touching": ("soft grains, threshold 0.001", "ContactLoopScalar/full"),
}
SOFT = {"ContactLoopSoft/below_threshold": "threshold 0.1, margins as scene A has them",
        "ContactLoopSoft/below_threshold_listed": "threshold 0.1, margins of 0.2 m"}
BARE = {"ContactLoop/full": "BareFull/sorted", "ContactLoop/as_read": "BareFull/as_read",
        "ContactLoop/frictionless_undamped": "BareElastic/sorted",
        "ContactLoop/frictionless_undamped_as_read": "BareElastic/as_read"}
MACHINE = {
    "RooflineFlop": "sum or product", "RooflineRoot": "square root", "RooflineDivision": "division",
    "RooflineGather/anywhere": "record gathered, random body", "RooflineGather/nearby": "record gathered, body near the last",
    "RooflineScatter/anywhere": "record added to, random body", "RooflineScatter/nearby": "record added to, body near the last",
    "RooflineRead/6291456": "byte read, 6 MB", "RooflineRead/268435456": "byte read, 256 MB",
    "RooflineUpdate/6291456": "byte updated, 6 MB", "RooflineUpdate/268435456": "byte updated, 256 MB",
}


def write_csv(name, head, rows):
    with open(HERE / name, "w", newline="") as f:
        csv.writer(f, lineterminator="\n").writerows([head, *rows])


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


class Loop:
    """Medians of the repetitions of every benchmark."""

    def __init__(self, report):
        runs = {}
        for b in report["benchmarks"]:
            if b.get("run_type", "iteration") == "iteration" and not b.get("error_occurred"):
                runs.setdefault(b["run_name"], []).append(b)
        self.rows = {name: sorted(of, key=lambda b: b["cpu_time"])[(len(of) - 1) // 2] for name, of in runs.items()}
        self.machine = {name: 1e9 * self.rows[name]["each"] for name in MACHINE if name in self.rows}

    def ns(self, name, counter="per_contact"):
        row = self.rows.get(name)
        return 1e9 * row[counter] if row and counter in row else None

    def parts(self, name):
        row = self.rows[name]
        locality = "anywhere" if name.endswith("as_read") else "nearby"
        return CASES[name][1].times(self.machine, row["listed"] / row["touching"], locality)


def number(x, digits=1):
    return "" if x is None else f"{x:.{digits}f}"


def feature_rows(loop):
    reference = {False: "ContactLoop/full", True: "ContactLoopDiscs/full"}
    for name, (words, work) in CASES.items():
        if loop.ns(name) is None:
            continue
        full = reference[name.startswith("ContactLoopDiscs")]
        parts, all_parts = loop.parts(name), loop.parts(full)
        said = sum(parts.values()) / sum(all_parts.values())
        yield (words, number(loop.ns(name)), number(loop.ns(name, "per_pair")), number(loop.ns(name) / loop.ns(full), 2),
               number(said, 2), number(loop.ns(BARE.get(name, ""))), number(max(parts.values())), number(sum(parts.values())),
               work.flops, work.pair_flops, work.roots, work.divisions, work.gathers, 2, work.scatters, work.bytes,
               work.pair_bytes)


FEATURES = ("scene", "time per contact [ns]", "time per listed pair [ns]", "time over the full loop",
            "counted work over that of the full loop", "program for this scene alone [ns per contact]",
            "largest kind of work [ns per contact]", "sum of all kinds of work [ns per contact]", "flops per contact",
            "flops per listed pair", "square roots per contact", "divisions per contact", "gathers per contact",
            "gathers per listed pair", "scatters per contact", "list bytes per contact", "list bytes per listed pair")


def others(loop):
    rows = []
    for name, (words, against) in OTHERS.items():
        if loop.ns(name) is not None:
            rows.append((words, number(loop.ns(name)), number(loop.ns(name) / loop.ns(against), 2),
                         CASES[against][0] if against in CASES else OTHERS[against][0]))
    return table(("case", "time per contact [ns]", "over the compared case", "compared with"), rows)


def soft(loop):
    rows = [(words, f"{loop.rows[name]['listed']:.0f}", f"{loop.rows[name]['touching']:.0f}",
             number(loop.ns(name, "per_pair"))) for name, words in SOFT.items() if name in loop.rows]
    return table(("soft grains", "listed pairs", "of these with a force", "time per listed pair [ns]"), rows)


def machine(loop):
    rows = [(words, number(loop.machine[name], 3)) for name, words in MACHINE.items() if name in loop.machine]
    return table(("operation", "time [ns]"), rows)


def lists(loop):
    rows = []
    words = {"A": "A", "A_as_read": "A, grains in the order of the file", "B": "B", "C": "C"}
    for name in (f"ContactList/{key}" for key in words if f"ContactList/{key}" in loop.rows):
        rows.append((words[name.split("/")[1]], number(loop.ns(name, "per_grain"), 0),
                     number(loop.ns(name, "per_pair"), 0), number(loop.rows[name]["cpu_time"] / 1e3, 2)))
    return table(("scene", "time per grain [ns]", "time per listed pair [ns]", "whole list [ms]"), rows)


def steps(loop):
    names = {"full": "full", "frictionless": "no friction, no rotation", "frictionless_undamped": "no friction, rotation or damping"}
    rows = []
    for key, words in names.items():
        step, whole = loop.ns(f"ContactLoop/{key}"), loop.ns(f"ContactStep/{key}")
        if step and whole:
            rows.append((words, number(whole), number(step), number(loop.ns(f"ContactStep/{key}", "per_grain")),
                         number(whole / loop.ns("ContactStep/full"), 2)))
    return table(("scene A", "step [ns per contact]", "its pass [ns per contact]", "step [ns per grain]", "over the full step"),
                 rows)


SCALING = ("scene", "threads", "grains", "touching pairs per grain", "listed over touching pairs", "time per grain and step [ns]",
           "time per contact [ns]", "time per listed pair [ns]", "lists per 1000 steps", "memory per grain [B]",
           "memory over 400 B per grain and 150 B per contact", "speed-up over one thread (wall clock)", "load of the machine",
           "cores")


def scaling_rows(report):
    single = {r["title"]: r for r in report["rows"] if r["threads"] == 1}
    for r in report["rows"]:
        gain = ("", "", "")
        if r["threads"] > 1 and r["title"] in single:
            gain = (number(single[r["title"]]["seconds"] / r["seconds"], 2), number(report["load"][0]), report["cores"])
        yield (r["title"], r["threads"], r["grains"], number(r["contacts_per_grain"], 2),
               number(r["listed_pairs"] / max(r["contacts"], 1), 2), number(r["ns_per_particle_step"]),
               number(r["ns_per_contact"]), number(r["ns_per_listed_pair"]), number(r["rebuilds_per_1000_steps"]),
               number(r["bytes_per_grain"], 0), number(r["bytes_of_target"], 2), *gain)


ENGINES = ("scene", "engine", "time per contact [ns]", "fastest round [ns]", "slowest round [ns]", "forces alone [ns per contact]",
           "time over softgrain on one thread", "contacts per grain", "pressure [Pa]", "peak memory [MB]")


def engine_rows(report):
    for scene, result in report["scenes"].items():
        ours = result["engines"].get("softgrain", {}).get("ns_per_contact")
        for name, f in result["engines"].items():
            spread = f["ns_per_contact_rounds"]
            yield (scene.replace("_", " "), name, number(f["ns_per_contact"]), number(min(spread)), number(max(spread)),
                   number(f.get("force_ns_per_contact")), number(f["ns_per_contact"] / ours, 2) if ours else "",
                   number(f["coordination_number"], 4), number(f["pressure"], 2), number(f["peak_memory"] / 1e6, 0))


def how_compared(report):
    return (f"{report['rounds']} rounds of {report['steps']} steps after {report['warm_up']}, {report['clock']} time, "
            f"{report['processor']}.")


def expected(share, threads):
    """Amdahl: how many times as fast so many threads are when that share of the work runs on one."""
    return 1.0 / (share + (1.0 - share) / threads)


THREADS = ("scene", "speed-up by a second thread of softgrain", "by a second rank of LAMMPS classic",
           "by a second rank of LAMMPS granular", "time of LAMMPS classic over softgrain on two cores",
           "time of LAMMPS granular over softgrain on two cores", "loss as serial share [%]", "speed-up on 8 threads at least",
           "speed-up on 64 threads at least")


def thread_rows(report):
    """The gain of a second thread, and of more when all that is lost is taken for work that one thread does alone."""
    for scene, result in report["scenes"].items():
        gains, ratios = result.get("gains", {}), result.get("ratios_on_all_cores", {})
        ours = next((gain for name, gain in gains.items() if name.startswith("softgrain")), None)
        if ours is None:
            continue
        share = min(1.0, max(0.0, 2.0 / ours - 1.0))
        # Of the ways in which an engine uses several cores, the fastest.
        lammps = [number(max((g for name, g in gains.items() if name.startswith(f"LAMMPS {law}")), default=None), 2)
                  for law in ("classic", "granular")]
        against = [number(min((r for name, r in ratios.items() if name.startswith(f"LAMMPS {law}")), default=None), 2)
                   for law in ("classic", "granular")]
        yield (scene.replace("_", " "), number(ours, 2), *lammps, *against, number(100 * share, 0),
               number(expected(share, 8)), number(expected(share, 64)))


def instructions(report):
    rows = [(scene.replace("_", " "), number(result["instructions_per_contact"], 0))
            for scene, result in report["scenes"].items() if "instructions_per_contact" in result]
    return table(("scene", "instructions per contact and step"), rows) if rows else None


def growth(report):
    """Macro scenes: passes, seconds and memory, and the exponents from each size to the next."""
    rows, before = [], None
    for r in report["rows"]:
        whole = r["preparation_seconds"] + r["test_seconds"]
        exponent = None
        if before:
            exponent = math.log(whole / before[1]) / math.log(r["bodies"] / before[0])
        before = (r["bodies"], whole)
        rows.append((f"{r['bodies']:,}", f"{r['preparation_passes']:,.0f}", f"{r['test_passes']:,.0f}",
                     number(r["preparation_seconds"], 2), number(r["test_seconds"], 2), number(exponent, 2),
                     number(r["memory_mb"], 0)))
    return table(("particles", "passes of the preparation", "passes of the loading", "preparation [s]", "loading [s]",
                  "exponent of the whole", "peak memory [MB]"), rows)


COLOURS = {"sums and products": "#0072b2", "roots, divisions": "#d55e00", "gathers": "#009e73", "scatters": "#56b4e9",
           "list": "#e69f00"}


def picture(loop):
    """Counted work as bars, one part after the other; what was measured as marks."""
    names = [name for name in CASES if loop.ns(name) is not None]
    left, top, height, width = 275, 46, 26, 480
    longest = max(max(loop.ns(name), sum(loop.parts(name).values())) for name in names)
    scale = width / (5 * (int(longest / 5) + 1))
    out = []
    for tick in range(0, int(width / scale) + 1, 5):
        x = left + tick * scale
        out.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{top + height * len(names)}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{top + height * len(names) + 16}" text-anchor="middle">{tick}</text>')
    for row, name in enumerate(names):
        y = top + row * height
        out.append(f'<text x="{left - 8}" y="{y + 17}" text-anchor="end">{CASES[name][0]}</text>')
        at = left
        for part, ns in loop.parts(name).items():
            out.append(f'<rect x="{at:.1f}" y="{y + 5}" width="{ns * scale:.1f}" height="{height - 10}" '
                       f'fill="{COLOURS[part]}"/>')
            at += ns * scale
        x = left + loop.ns(name) * scale
        out.append(f'<line x1="{x:.1f}" y1="{y + 1}" x2="{x:.1f}" y2="{y + height - 1}" stroke="#000" stroke-width="3"/>')
        bare = loop.ns(BARE.get(name, ""))
        if bare is not None:
            out.append(f'<circle cx="{left + bare * scale:.1f}" cy="{y + height / 2}" r="5" fill="#fff" stroke="#000" '
                       'stroke-width="2"/>')
    x = 8
    for words, colour in COLOURS.items():
        out.append(f'<rect x="{x}" y="10" width="12" height="12" fill="{colour}"/>'
                   f'<text x="{x + 16}" y="20">{words}</text>')
        x += 40 + 6.4 * len(words)
    out.append(f'<line x1="{x + 4}" y1="8" x2="{x + 4}" y2="24" stroke="#000" stroke-width="3"/>'
               f'<text x="{x + 12}" y="20">measured</text>')
    out.append(f'<circle cx="{x + 90}" cy="16" r="5" fill="#fff" stroke="#000" stroke-width="2"/>'
               f'<text x="{x + 100}" y="20">program for that scene alone</text>')
    bottom = top + height * len(names)
    out.append(f'<text x="{left + width / 2}" y="{bottom + 34}" text-anchor="middle">ns per touching contact</text>')
    size = f'width="{left + width + 100}" height="{bottom + 44}"'
    return (f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="12">\n'
            '<title>Counted and measured time of the contact loop</title>\n<rect width="100%" height="100%" fill="#fff"/>\n'
            + "\n".join(out) + "\n</svg>\n")


def curves(scaling_report, macro_report):
    """Cost per grain or body over their number: words -> points (number, ns)."""
    out = {}
    for r in (scaling_report or {"rows": []})["rows"]:
        if r["axis"] == "grains":
            words = f"grains, whole step, {r['threads']} thread" + ("s" if r["threads"] > 1 else "")
            out.setdefault(words, []).append((r["grains"], 1e9 * r["seconds"] / (r["grains"] * r["steps"])))
    for r in (macro_report or {"rows": []})["rows"]:
        for what in ("preparation", "test"):
            words = f"macro, {what}, a pass, {r['threads']} threads"
            out.setdefault(words, []).append((r["bodies"], 1e9 * r[f"{what}_seconds"] / (r["bodies"] * r[f"{what}_passes"])))
    return out


def growth_picture(of):
    """Curves in one plot, both axes logarithmic."""
    left, top, width, height = 70, 20, 520, 300
    points = [point for curve in of.values() for point in curve]
    low_x, high_x = (f(math.log10(n) for n, _ in points) for f in (min, max))
    low_y, high_y = math.floor(min(math.log10(y) for _, y in points)), math.ceil(max(math.log10(y) for _, y in points))
    low_x, high_x = math.floor(low_x), math.ceil(high_x)

    def at(n, y):
        return (left + width * (math.log10(n) - low_x) / (high_x - low_x),
                top + height * (high_y - math.log10(y)) / (high_y - low_y))

    out = []
    for tick in range(low_x, high_x + 1):
        x, _ = at(10.0 ** tick, 10.0 ** low_y)
        out.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{top + height}" stroke="#ddd"/>'
                   f'<text x="{x:.1f}" y="{top + height + 16}" text-anchor="middle">{10 ** tick:,}</text>')
    for tick in range(low_y, high_y + 1):
        for digit in (1, 2, 5) if tick < high_y else (1,):
            _, y = at(10.0 ** low_x, digit * 10.0 ** tick)
            out.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + width}" y2="{y:.1f}" stroke="#ddd"/>'
                       f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{digit * 10 ** tick:,}</text>')
    for k, ((words, curve), colour) in enumerate(zip(of.items(), COLOURS.values())):
        places = [at(*point) for point in sorted(curve)]
        out.append(f'<polyline points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in places)}" fill="none" stroke="{colour}" '
                   'stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>' for x, y in places]
        out.append(f'<rect x="{left + width + 14}" y="{top + 22 * k}" width="12" height="12" fill="{colour}"/>'
                   f'<text x="{left + width + 32}" y="{top + 11 + 22 * k}">{words}</text>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 36}" text-anchor="middle">grains or particles</text>')
    out.append(f'<text x="16" y="{top + height / 2}" text-anchor="middle" transform="rotate(-90 16 {top + height / 2})">'
               'ns per body and step or pass, on the wall</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + width + 280}" height="{top + height + 48}" '
            'font-family="sans-serif" font-size="12">\n<title>Cost per body over the number of bodies</title>\n'
            '<rect width="100%" height="100%" fill="#fff"/>\n' + "\n".join(out) + "\n</svg>\n")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    directory = pathlib.Path(sys.argv[1])
    read = {key: json.loads((directory / f"{key}.json").read_text()) if (directory / f"{key}.json").exists() else None
            for key in ("loop", "scaling", "engines", "instructions", "macro")}
    loop = Loop(read["loop"]) if read["loop"] else None
    for name, head, rows, source in (("contact_loop.csv", FEATURES, feature_rows, loop),
                                     ("scaling.csv", SCALING, scaling_rows, read["scaling"]),
                                     ("engines.csv", ENGINES, engine_rows, read["engines"]),
                                     ("threads.csv", THREADS, thread_rows, read["engines"])):
        if source:
            write_csv(name, head, rows(source))
    text = "# Tables of the speed measurements\n\nWritten by `collect.py`; the [page](README.md) links to what they mean.\n"
    for title, make, source in (("Other loops (processor time)", others, loop), ("Soft grains below the threshold", soft, loop),
                                ("Whole steps", steps, loop), ("Making a list", lists, loop),
                                ("What this machine can do", machine, loop), ("Macro scenes", growth, read["macro"]),
                                ("How engines.csv was measured", how_compared, read["engines"]),
                                ("Instructions of a whole step", instructions, read["instructions"] or read["engines"])):
        text += f"\n## {title}\n\n{(make(source) if source else None) or '*Not measured.*'}\n"
    (HERE / "tables.md").write_text(text)
    if loop:
        (HERE / "floor.svg").write_text(picture(loop))
    of = curves(read["scaling"], read["macro"])
    if of:
        (HERE / "growth.svg").write_text(growth_picture(of))


if __name__ == "__main__":
    main()
