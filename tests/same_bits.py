#!/usr/bin/env python3
"""Whether two versions of the program leave the same results: HDF5, JSON and CSV number by number, law files, reports,
logs and messages as text.

  same_bits.py RUN RUN                    compares two run directories, or folders of such
  same_bits.py --programs A B SCENES OUT  runs every tiny scene (every_kind_scenes SCENES) with both programs, on one
                                          thread, on two and, macro scenes, through LAMMPS, and compares. A runs twice:
                                          what differs between its own runs (times) does not count
  same_bits.py --self-test

Status 1 when anything differs. What says when, where, how fast and by which version a run was made is left out: provenance,
times, names of directories, and the seals that cover them. Needs h5py (Debian: python3-h5py).
"""
import argparse
import csv
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(f"{sys.argv[0]}: needs h5py and numpy (Debian: python3-h5py)" if "--self-test" not in sys.argv else 77)

LEFT_OUT = ("provenance", "seconds", "table_id", "belongs_to")
# What changes from run to run in a text, and what stands for it. Digits alone are never taken for a hash.
CHANGING = [
    (re.compile(r"^\d{4}-\d\d-\d\d \d\d:\d\d:\d\d ", re.M), ""),
    (re.compile(r"\b\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d)?Z?"), "DATE"),
    (re.compile(r"\bsoftgrain \d+\.\d+\.\d+ \([0-9a-f]{7,12}(-modified)?\)"), "softgrain VERSION"),
    (re.compile(r"(?<![.0-9a-f])(?=[0-9]*[a-f])[0-9a-f]{12}(-modified)?\b"), "COMMIT"),
    (re.compile(r"(?<![.0-9a-f])(?=[0-9]*[a-f])[0-9a-f]{16}\b"), "HASH"),
    (re.compile(r"\b\d+(\.\d+)?(e-?\d+)? (s|min|h|ms)( \d+ (s|min))?\b"), "TIME"),
    (re.compile(r"\b[\d.e+]+ times (faster|less time)"), "N times faster"),
    (re.compile(r"\bthreads?( = |: | )\d+"), "threads N"),
    (re.compile(r"\b\d+ threads?\b"), "N threads"),
]
NUMBERED = (".json", ".csv", ".h5")
TEXTS = (".toml", ".txt", ".html", ".svg", ".md", ".vtp", ".vtu", ".xdmf", ".pvd", ".lmp")


def left_out(name):
    return any(word in name for word in LEFT_OUT)


def same(u, v):
    u, v = np.asarray(u), np.asarray(v)
    return np.array_equal(u, v, equal_nan=u.dtype.kind == "f" and v.dtype.kind == "f")


def objects(file):
    names = {"/"}
    file.visit(names.add)
    return {n for n in names if not left_out(n)}


def hdf5_differences(first, second):
    found, compared = [], 0
    with h5py.File(first) as a, h5py.File(second) as b:
        names = objects(a) & objects(b)
        found += [(n, "in one of them only") for n in sorted(objects(a) ^ objects(b))]
        for n in sorted(names):
            attributes = {k for k in (set(a[n].attrs) | set(b[n].attrs)) if not left_out(k)}
            for k in sorted(attributes):
                compared += 1
                if k not in a[n].attrs or k not in b[n].attrs or not same(a[n].attrs[k], b[n].attrs[k]):
                    found.append((f"{n} {k}", ""))
            if isinstance(a[n], h5py.Dataset) and isinstance(b[n], h5py.Dataset):
                compared += a[n].size
                if not same(a[n][()], b[n][()]):
                    found.append((n, ""))
    return found, compared


def leaves(value, path=""):
    """Every number and text of a JSON value, by its path."""
    if isinstance(value, dict):
        for k, v in value.items():
            if not left_out(k):
                yield from leaves(v, f"{path}.{k}")
    elif isinstance(value, list):
        for k, v in enumerate(value):
            yield from leaves(v, f"{path}[{k}]")
    else:
        yield path, value


def json_differences(first, second, plain):
    a, b = (dict(leaves(json.loads(p.read_text()))) for p in (first, second))
    shown = [{k: plain(v, n) if isinstance(v, str) else repr(v) for k, v in x.items()} for n, x in enumerate((a, b))]
    keys = sorted(set(a) | set(b))
    return [(k, f"{shown[0].get(k)} | {shown[1].get(k)}") for k in keys if shown[0].get(k) != shown[1].get(k)], len(keys)


def csv_cells(path, plain, which):
    rows = list(csv.reader(path.read_text().splitlines()))
    head = next((r for r in rows if r and not r[0].startswith("#")), [])
    skipped = {k for k, name in enumerate(head) if left_out(name)}
    return [[plain(cell, which) for k, cell in enumerate(r) if k not in skipped] for r in rows]


def csv_differences(first, second, plain):
    a, b = csv_cells(first, plain, 0), csv_cells(second, plain, 1)
    found = [("rows", f"{len(a)} and {len(b)}")] if len(a) != len(b) else []
    found += [(f"row {n}", f"{u} | {v}") for n, (u, v) in enumerate(zip(a, b)) if u != v]
    return found, sum(len(r) for r in a)


def text_lines(path, plain, which):
    text = plain(path.read_text(errors="replace"), which)
    # Progress depends on the clock: how often it is written, and what it says.
    lines = [line for line in text.splitlines() if not re.search(r"\d+ %, .*so far", line) and not left_out(line.split(" ")[0])]
    return [line for line in lines if line.strip()]


def text_differences(first, second, plain):
    a, b = text_lines(first, plain, 0), text_lines(second, plain, 1)
    found = [("lines", f"{len(a)} and {len(b)}")] if len(a) != len(b) else []
    found += [(f"line {n}", f"{u[:200]} | {v[:200]}") for n, (u, v) in enumerate(zip(a, b)) if u != v]
    return found, len(a)


def plainer(roots):
    """Takes the roots of the two directories, and what changes from run to run, out of a text."""
    def plain(text, which):
        for root in roots[which]:
            text = text.replace(root, "ROOT")
        for pattern, word in CHANGING:
            text = pattern.sub(word, text)
        return text
    return plain


def file_differences(first, second, plain):
    """What differs, as places in the file and what stands there, and how many numbers and texts were compared."""
    if first.suffix == ".h5":
        return hdf5_differences(first, second)
    by_kind = {".json": json_differences, ".csv": csv_differences}
    return by_kind.get(first.suffix, text_differences)(first, second, plain)


def files_of(root):
    return {str(p.relative_to(root)): p for p in root.rglob("*") if p.is_file() and p.suffix in NUMBERED + TEXTS}


def compare(first, second, roots=None, known=frozenset(), quiet=False):
    """Places (file, place in it) that differ, but for those that are known to; prints a line per file."""
    plain = plainer(roots or ([str(first)], [str(second)]))
    a, b = files_of(first), files_of(second)
    places = {(name, "in one of them only") for name in set(a) ^ set(b)} - known
    lines = [f"{name}: {what}" for name, what in sorted(places)]
    total = 0
    for name in sorted(set(a) & set(b)):
        found, compared = file_differences(a[name], b[name], plain)
        found = [(place, text) for place, text in found if (name, place) not in known]
        total += compared
        places |= {(name, place) for place, _ in found}
        if found:
            lines.append(f"{name}: {compared} compared, {len(found)} differ")
            lines += [f"    {place}: {text}" for place, text in found[:5]]
    if not quiet:
        print("\n".join(lines + [f"{len(set(a) & set(b))} files, {total} numbers and texts compared, {len(places)} differ"]))
    return places


def run_all(program, scenes, out):
    """Runs every scene in its forms; output of the program is kept beside the run directories."""
    for row in csv.DictReader((scenes / "scenes.csv").read_text().splitlines()):
        forms = [("threads-1", ["--threads", "1"]), ("threads-2", ["--threads", "2"])]
        if row["name"] == "macro":
            forms.append(("lammps", ["--engine", "lammps"]))
        for form, options in forms:
            place = out / row["name"] / form
            place.parent.mkdir(parents=True, exist_ok=True)
            words = [program, row["command"], scenes / row["name"] / "scene.toml", "--out", place, *options]
            done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
            Path(f"{place}.out.txt").write_text(done.stdout)
            Path(f"{place}.err.txt").write_text(done.stderr)
            print(f"{row['name']} {form}: status {done.returncode}", flush=True)


def compare_programs(first, second, scenes, out):
    scenes, out = Path(scenes).resolve(), Path(out).resolve()
    roots = {}
    for which, program in (("before", first), ("again", first), ("after", second)):
        run_all(Path(program).resolve(), scenes, out / which)
        roots[which] = [str(out / which), str(Path(program).resolve()), program]
    changing = compare(out / "before", out / "again", [roots["before"], roots["again"]], quiet=True)
    print(f"{len(changing)} places differ from run to run and are left out")
    return compare(out / "before", out / "after", [roots["before"], roots["after"]], changing)


def self_test():
    """Each kind of file with one change that must be found, and with what changes from run to run alone."""
    cases = {
        "a.json": ('{"x": 1.0, "seconds": 2, "note": "took 3 s"}', '{"x": 1.0, "seconds": 5, "note": "took 4 s"}',
                   '{"x": 1.0000000000000002, "seconds": 2, "note": "took 3 s"}'),
        "a.csv": ("x,core_seconds\n1,2\n", "x,core_seconds\n1,3\n", "x,core_seconds\n2,2\n"),
        "b.csv": ("hash,x,time [s]\n0123456789abcdef,0.1234567890123456,1\n", "hash,x,time [s]\nf123456789abcdef,0.1234567890123456,1\n",
                  "hash,x,time [s]\n0123456789abcdef,0.1234567890123457,1\n"),
        "c.csv": ("x,time [s]\n1,1\n", "x,time [s]\n1,1\n", "x,time [s]\n1,2\n"),
        "a.txt": ("2026-01-01 10:00:00 F = 2 N in 3 min\n", "2026-01-02 11:00:00 F = 2 N in 4 min\n",
                  "2026-01-01 10:00:00 F = 3 N in 3 min\n"),
        "a.toml": ('value = 1.5\ntable_id = "a"\n', 'value = 1.5\ntable_id = "b"\n', 'value = 1.25\ntable_id = "a"\n'),
    }
    with tempfile.TemporaryDirectory() as root:
        for name, (text, harmless, changed) in cases.items():
            folders = [Path(root) / name / k for k in ("a", "b", "c")]
            for folder, content in zip(folders, (text, harmless, changed)):
                folder.mkdir(parents=True)
                (folder / name).write_text(content)
            assert not compare(folders[0], folders[1]), f"{name}: what changes from run to run was taken for a difference"
            assert compare(folders[0], folders[2]), f"{name}: a difference was missed"
        h5 = [Path(root) / "h5" / k for k in ("a", "b", "c")]
        for folder, value in zip(h5, (1.0, 1.0, 1.0 + 2e-16)):
            folder.mkdir(parents=True)
            with h5py.File(folder / "a.h5", "w") as f:
                f["memory"] = [value, np.nan]
                f.attrs["seconds"] = len(str(folder))
        assert not compare(h5[0], h5[1]) and len(compare(h5[0], h5[2])) == 1
    print("same_bits: finds what differs in every kind of file")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", nargs=4, metavar=("A", "B", "SCENES", "OUT"))
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("runs", nargs="*", metavar="RUN")
    options = parser.parse_args()
    if options.self_test:
        return self_test()
    if options.programs:
        return 1 if compare_programs(*options.programs) else 0
    if len(options.runs) != 2:
        parser.error("give two run directories, --programs or --self-test")
    return 1 if compare(*(Path(p).resolve() for p in options.runs)) else 0


if __name__ == "__main__":
    sys.exit(main())
