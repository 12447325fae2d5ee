"""The commands of the program beside `run` and `check`: calibrate, sweep, compare, export, report. Results are read from what the
program writes as JSON, never from its texts."""
import difflib
import operator
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from softgrain.errors import InputError, Mistake
from softgrain.results import Run
from softgrain.running import execute, option, outcome, raise_for, require_unusable, run_directory, scene_file
from softgrain.tables import Tabular, counted, records
from softgrain.toml_text import settings, value_text


def _answer(ended):
    """The JSON object of a command that ended well, else its exception."""
    if ended.status != 0:
        raise_for(ended)
    return ended.objects[0] if ended.objects else {}


# ---- calibrate

class Calibration(Run, Tabular):
    """A fit of laws to measurements: a run directory with the law card. law() evaluates it."""

    @property
    def laws(self):
        """The fitted laws by kind of contact ("soft-solid"), as dicts: status, reason, normal (a, b, c [N], delta with intervals),
        delta_range, packings, points. Empty for a law table."""
        return self.summary.get("laws", {})

    @property
    def converged(self):
        """Whether the fit ended at a minimum, by kind of contact. A fit that did may still not determine a law: see laws[kind]["status"].
        Empty for experiments and law tables, which do not say it."""
        return {kind: fit["fit"].startswith("converged") for kind, fit in self.summary.get("fits", {}).items()}

    def table(self):
        """Parameters with 95 % intervals and standard errors, one a row. F = a Delta^b + c above the threshold delta; a and c in N, b and
        delta without unit."""
        rows = []
        for kind, law in self.laws.items():
            for name in ("a", "b", "c", "delta"):
                if law.get("normal") is None:
                    continue
                low, high = law["normal"].get(f"{name}_interval") or (None, None)
                rows.append({"kind": kind, "status": law["status"], "parameter": name, "value": law["normal"][name], "low": low,
                             "high": high, "standard_error": law["normal"].get(f"{name}_standard_error"),
                             "unit": law["normal"].get("unit", "N") if name in ("a", "c") else "1"})
        return records("law", rows, columns=("kind", "status", "parameter", "value", "low", "high", "standard_error", "unit"))

    def __repr__(self):
        laws = ", ".join(f"{kind} ({law['status']})" for kind, law in self.laws.items())
        return f"<calibration {self.directory}: {laws or self.status}>"


def _data_file(data):
    """What calibrate reads: of a run directory its measurements."""
    path = Path(os.fspath(data))
    if not path.is_dir():
        return str(path)
    several = path / "multi_contact.h5"
    return str(several if several.exists() and not (path / "measurements.h5").exists() else path / "measurements.h5")


def calibrate(*data, set=None, out=None, kind=None, radius=None, modulus=None, seed=None,  # pylint: disable=redefined-builtin
              threads=None, progress=False, unusable="raise", options=()):
    """Fits contact laws to measurements and gives a Calibration, whose law() is the law card.

    data: runs that measured, or files: measurements.h5, multi_contact.h5 (one for each solid fraction: a law table), or the CSV file of
    an experiment.
    set: settings of the fit, {"replicates": 200, "mirror": True}.
    out: run directory; results/NAME of the first file, results/NAME_law of a run.
    kind ("soft-solid" or "soft-soft"), radius (of the soft particle, [m] or "16 mm"), modulus (Young's modulus of its grains, [Pa] or
    "0.5 MPa"): of CSV files which do not say them.
    unusable, threads, seed, progress, options: as in run().

    Raises InputError, IoError; UnusableResult where no law could be determined (its `run` is the Calibration)."""
    if not data:
        raise InputError(["calibrate: no data: give a run that measured, or files"])
    require_unusable(unusable)
    first = Path(os.fspath(data[0]))
    if first.is_dir():
        first = first.with_name(first.resolve().name + "_law.h5")
    directory = Path(out) if out is not None else run_directory(first, None)
    ended = execute(["calibrate", *map(_data_file, data), "--out", str(directory), *settings(set), *option("--kind", kind),
                     *option("--radius", radius), *option("--modulus", modulus), *option("--seed", seed),
                     *option("--threads", threads), *map(str, options)], progress)
    return outcome(ended, directory, unusable, Calibration)


# ---- sweep

class Sweep(Run, Tabular):
    """Runs of one scene over values of its keys and over seeds: a run directory with one below it for each run."""

    @property
    def runs(self):
        """The runs, in turn, as Run objects: of those that were done."""
        return [Run(self.directory / one["directory"]) for one in self.summary["runs"] if (self.directory / one["directory"]).is_dir()]

    def table(self):
        """One row a run: the values of the keys, what the run came to, its status and its time [s]."""
        return _numbers_table(self.directory.name, self.summary["runs"], ("name", "status", "seconds"), "value")

    def points(self):
        """One row for each choice of values: mean, spread and standard error over the seeds of every number."""
        rows, units = [], {}
        for point in self.summary["points"]:
            for number in point["numbers"]:
                rows.append({**_values(point), "number": number["name"], "unit": number["unit"],
                             **{k: number[k] for k in ("mean", "spread", "standard_error", "least", "largest", "runs")}})
        return records(f"{self.directory.name} points", rows, units)

    def sensitivity(self):
        """How every number depends on every key: rank correlation, regression and Sobol indices, NaN where not determined."""
        return records(f"{self.directory.name} sensitivity", self.summary.get("sensitivity", []))

    def __repr__(self):
        summary = self.summary
        keys = ", ".join(one["key"] for one in summary.get("over", [])) or "seeds"
        return f"<sweep {self.directory} over {keys}: {counted(len(summary['runs']), 'run')}, {summary['status']}>"


def _number(text):
    """The value of a key as a number where it is one."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return text


def _values(entry):
    seed = {"seed": entry["seed"]} if "seed" in entry else {}
    return {**{key: _number(value) for key, value in entry.get("values", {}).items()}, **seed}


def _numbers_table(name, entries, more, value):
    rows, units = [], {"seconds": "s"}
    for entry in entries:
        row = {"name": entry["name"], **_values(entry)}
        for number in entry.get("numbers", []):
            row[number["name"]] = number[value]
            units[number["name"]] = number["unit"]
        rows.append({**row, **{k: entry.get(k) for k in more}})
    return records(name, rows, units)


def _choices(key, values):
    """--over of a key: a text as it is ("20..40"), else a list of values."""
    if isinstance(values, str):
        return f"{key}={values}"
    if isinstance(values, Mapping) or not isinstance(values, Iterable) or getattr(values, "ndim", 1) == 0:
        raise InputError([f'over: {key} = {values!r:.60}: must be a list of values or a text such as "1..8"'])
    return f"{key}=" + ",".join(v if isinstance(v, str) else value_text(v, key) for v in values)


def _seeds(seeds):
    """"1..8" of a text or a range, "1,3,4" of a list."""
    if seeds is None or isinstance(seeds, str):
        return seeds
    if isinstance(seeds, range) and seeds.step == 1 and len(seeds):
        return f"{seeds.start}..{seeds.stop - 1}"
    try:
        return ",".join(str(operator.index(s)) for s in seeds)
    except TypeError as e:
        raise InputError([f'seeds = {seeds!r:.60}: must be a range, a list of whole numbers or a text such as "1..8"']) from e


def sweep(scene, over=None, *, seeds=None, sample=None, jobs=None, set=None, out=None,  # pylint: disable=redefined-builtin
          law=None, threads=None, seed=None, resume=False, bands=None, progress=True, unusable="raise", options=()):
    """Runs a scene for each choice of values and seeds and gives a Sweep.

    over: {"material.mu": [0.1, 0.3]}, every choice of all keys; a text is as on the command line: "1..8", and with `sample` a range,
    "0.1..0.8" or "1e6..1e8:log".
    seeds: range(1, 9), [1, 2, 3] or "1..8". sample: "lhs:32", "sobol:64" or "saltelli:16". jobs: runs at once.
    The rest: as in run(). Raises what run() raises; the `run` of an UnusableResult is the Sweep."""
    if over is not None and not isinstance(over, Mapping):
        raise InputError([f'over = {over!r:.60}: must be a dict of keys and values, {{"material.mu": [0.1, 0.3]}}'])
    require_unusable(unusable)
    directory = Path(out) if out is not None else run_directory(scene, set)
    choices = [word for key, values in (over or {}).items() for word in ("--over", _choices(key, values))]
    with scene_file(scene) as (file, paths):
        ended = execute(["sweep", file, "--out", str(directory), *choices, *settings(set), *option("--seeds", _seeds(seeds)),
                         *option("--sample", sample), *option("--jobs", jobs), *option("--law", law),
                         *option("--threads", threads), *option("--seed", seed), *option("--bands", bands),
                         *(["--resume"] if resume else []), *map(str, options)], progress)
        return outcome(ended, directory, unusable, Sweep, file, paths)


# ---- compare

class Comparison(Tabular):
    """What differs between runs: data is all that the program says. differences: keys in which the scenes differ, dicts with key and
    values, the reference last; macro, measurements, laws: of the curves; directory: where the report is, None unless it was written."""

    def __init__(self, data, directory=None):
        self.data = data
        self.directory = directory

    parts = property(lambda self: tuple(self.data.get("comparisons", (self.data,))),
                     doc="One for each run that is compared with the reference.")
    reference = property(lambda self: self.data["reference"])
    status = property(lambda self: self.data["status"])

    def _all(self, name):
        return [item for part in self.parts for item in part.get(name, [])]

    differences = property(lambda self: self.data.get("scene_differences", []))
    remarks = property(lambda self: self.data.get("remarks", []))
    macro = property(lambda self: self._all("macro"))
    measurements = property(lambda self: self._all("measurements"))
    laws = property(lambda self: self._all("laws"))

    def table(self):
        """Error norms of macro runs and ratios of measured forces, one a row: what, of which run, mean over samples, standard error, n.
        All are without unit; a difference of 0.1 is 10 % of the reference, a ratio is that of candidate to reference."""
        rows = []
        for part in self.parts:
            for pair in part.get("macro", []):
                label = f"{pair['candidate_engine']} against {pair['reference_engine']}"
                rows += [{"run": part["candidate"], "what": label, "number": name, **_mean(value)}
                         for name, value in pair.items() if isinstance(value, Mapping) and "mean" in value and value["n"]]
            for measured in part.get("measurements", []):
                rows += [{"run": part["candidate"], "what": f"{measured['pair']} at Delta = {one['delta']:g}", "number": "force_ratio",
                          "mean": one["ratio"], "standard_error": one["ratio_standard_error"], "n": one["candidate"]["n"]}
                         for one in measured["normal_force"]]
        return records("comparison", rows, columns=("run", "what", "number", "mean", "standard_error", "n"))

    def numbers(self):
        """What every run came to, one row a run, the reference last: the keys in which they differ, the numbers, status and time [s]."""
        return _numbers_table("numbers", self.data.get("runs", []), ("name", "status", "seconds"), "value")

    def __repr__(self):
        what = ", ".join(f"{len(items)} {name}" for name, items in (("laws", self.laws), ("measurements", self.measurements),
                                                                     ("macro", self.macro)) if items)
        runs = ", ".join(run["name"] for run in self.data.get("runs", [])[:-1]) or self.data["candidate"]
        return f"<comparison of {runs} with {self.reference}: scenes differ in {counted(len(self.differences), 'key')}; {what or 'no common curves'}>"


def _mean(value):
    return {name: value[name] for name in ("mean", "standard_error", "n")}


def compare(*runs, out=None, different=False, threads=None, options=()):
    """Compares runs with the last one, the reference; one run alone: what it holds in itself, a law with its resolved twin. Gives a
    Comparison.

    runs: runs, run directories or result files. out: writes a report there. different: error norms also of runs that differ in
    particles, materials, loadings or packings. Raises InputError (runs that cannot be compared), IoError, UnusableResult."""
    ended = execute(["compare", *(os.fspath(r) for r in runs), *option("--out", out), *(["--different"] if different else []),
                     *option("--threads", threads), *map(str, options)])
    return Comparison(_answer(ended), None if out is None else Path(out))


# ---- export, report, examples

class Export:
    """Files that export() wrote. directory: where; series: dicts with name, kind, states and the files to open; files: paths of these."""

    def __init__(self, data):
        self.directory = Path(data["directory"])
        self.form = data["to"]
        self.series = tuple(data["series"])

    @property
    def files(self):
        """What to open, one or a few for each series of states."""
        return [self.directory / name for one in self.series for name in one["open"]]

    def __repr__(self):
        states = sum(one["states"] for one in self.series)
        return f"<export {self.directory}: {self.form}, {len(self.series)} series, {counted(states, 'state')}>"


def export(run, to="vtp", *, out=None, threads=None, options=()):
    """Writes the states of a run for other programs: to is "vtp" (ParaView), "lammps-dump" (OVITO), "lammps-data" or "csv". Gives an
    Export.

    run: a run, its directory, or one of its files with states. out: RUN/export-FORM unless given. Lengths are in metres, forces in
    newtons. Raises InputError, IoError."""
    ended = execute(["export", os.fspath(run), "--to", to, *option("--out", out), *option("--threads", threads), *map(str, options)])
    return Export(_answer(ended))


def report(run, *, threads=None, options=()):
    """Writes report.html of a run directory anew, with curves/*.csv and figures/*.svg, and gives its path. Raises InputError, IoError."""
    ended = execute(["report", os.fspath(run), *option("--threads", threads), *map(str, options)])
    return Path(_answer(ended)["files"]["report"])


def examples():
    """The scenes that come with the program, a Table: name, kind, title, time, file. IoError where none are installed."""
    return records("examples", _answer(execute(["examples"]))["examples"])


def example(name, out=None):
    """Path of a scene that comes with the program: run(example("quickstart")). out: a file to copy it to, which must not be there; laws
    that the scene names are found from there too. InputError for a name that there is not, IoError where no scenes are installed."""
    listed = examples()
    files = dict(zip(map(str, listed["name"]), listed["file"]))
    if name not in files:
        nearest = next(iter(difflib.get_close_matches(str(name), files, 1)), None)
        raise InputError([Mistake(f"example {name}: no such scene" + (f"; nearest is '{nearest}'" if nearest else ""), nearest=nearest)])
    if out is None:
        return Path(files[name])
    if os.path.lexists(out):
        raise InputError([f"{out}: is there already and would be overwritten; choose another name"])
    _answer(execute(["examples", name, "--out", os.fspath(out)], form=()))  # a copy has no JSON
    return Path(out)
