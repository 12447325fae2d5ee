"""Run directories: summary, arrays by name with their units, measurements, macro curves; laws and states through the other modules."""
import html
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from softgrain.figures import Drawn, Picture, new_figure
from softgrain.hdf5 import is_group, open_file, text_attribute
from softgrain.law import Law
from softgrain.snapshot import read_snapshots
from softgrain.tables import Table, Tabular, counted, joined, read_csv


@dataclass(frozen=True, repr=False)
class MeasuredRun(Tabular):
    """All points of one packing under one relaxation."""

    packing: int
    kind: str  # "soft-solid" or "soft-soft"
    relaxation: str
    delta: np.ndarray  # Delta = hn/Rs
    force: np.ndarray  # normal, compression positive [N]
    converged: np.ndarray
    tangential: dict  # columns delta, angle [degree], force_parallel [N], force_perpendicular [N], converged

    def table(self):
        """Normal points: delta (hn/Rs), force [N], converged."""
        return Table(f"{self.kind} of packing {self.packing}", {"delta": self.delta, "force": self.force, "converged": self.converged},
                     {"delta": "1", "force": "N"})

    def __repr__(self):
        return f"<{self.kind} of packing {self.packing}, {self.relaxation}: {counted(len(self.delta), 'point')}, {len(self.tangential['delta'])} turned>"


@dataclass(frozen=True, repr=False)
class Measurements(Tabular):
    spec: dict  # shell_radius [m], youngs_modulus [Pa], poisson_ratio, friction, ...
    runs: tuple

    def select(self, kind, relaxation=None):
        return [r for r in self.runs if r.kind == kind and relaxation in (None, r.relaxation)]

    def table(self):
        """Normal points of all packings, one a row: kind, packing, relaxation, delta (hn/Rs), force [N], converged."""
        return joined("measurements", [r.table() for r in self.runs],
                      [{"kind": r.kind, "packing": r.packing, "relaxation": r.relaxation} for r in self.runs])

    def __repr__(self):
        kinds = ", ".join(dict.fromkeys(r.kind for r in self.runs))
        packings = counted(len({r.packing for r in self.runs}), "packing")
        return f"<measurements of {kinds}: {packings}, {counted(sum(len(r.delta) for r in self.runs), 'point')}>"


def _require(file, path, wanted):
    if "format" not in file.attrs or text_attribute(file, "format") != wanted:
        raise ValueError(f"{path}: holds no {wanted}")


def read_measurements(path):
    """measurements.h5."""
    with open_file(path) as file:
        _require(file, path, "soft-particle measurements")
        spec = {k: (v.decode() if isinstance(v, bytes) else v) for k, v in file["spec"].attrs.items()}
        runs = file["runs"]
        names = [text_attribute(runs, f"relaxation_{k}") for k in range(int(runs.attrs["relaxations"]))]
        normal = {k: file["normal"][k][()] for k in ("delta", "force", "converged")}
        turned = {k: file["tangential"][k][()] for k in ("delta", "angle", "force_parallel", "force_perpendicular", "converged")}
        turned["converged"] = turned["converged"] != 0
        out = []
        first = first_turned = 0
        for k in range(len(runs["packing"])):
            end = first + int(runs["normal_points"][k])
            end_turned = first_turned + int(runs["tangential_points"][k])
            out.append(MeasuredRun(int(runs["packing"][k]), ("soft-solid", "soft-soft")[int(runs["kind"][k])],
                                   names[int(runs["relaxation"][k])], normal["delta"][first:end],
                                   normal["force"][first:end], normal["converged"][first:end] != 0,
                                   {n: v[first_turned:end_turned] for n, v in turned.items()}))
            first, first_turned = end, end_turned
        return Measurements(spec, tuple(out))


@dataclass(frozen=True, repr=False)
class Quantity:
    """Numbers with their unit, "1" where they have none and "" where the file does not say. np.asarray() gives the numbers."""

    name: str
    values: np.ndarray
    unit: str

    def __array__(self, dtype=None, copy=None):
        return np.array(self.values, dtype=dtype) if copy else np.asarray(self.values, dtype=dtype)

    def __len__(self):
        return len(self.values)

    def __getitem__(self, k):
        return self.values[k]

    def __repr__(self):
        unit = f" [{self.unit}]" if self.unit not in ("", "1") else ""
        return f"<{self.name}{unit}: {self.values.dtype} {self.values.shape}>"


@dataclass(frozen=True, repr=False)
class MacroCurve(Tabular):
    engine: str  # "law" or another law's name, "shelled", "free"
    sample: int
    test: str
    usable: bool
    columns: dict  # strain, stress_axial [Pa], stress_lateral [Pa], coordination, ...
    units: dict  # of the columns, as the file says them

    def __getitem__(self, name):
        return self.columns[name]

    def table(self):
        """The columns with one number for each recorded strain, with their units."""
        shape = self.columns["strain"].shape
        return Table(f"{self.engine}, sample {self.sample}, {self.test}",
                     {k: v for k, v in self.columns.items() if v.shape == shape and "/" not in k},
                     self.units)

    def __repr__(self):
        usable = "" if self.usable else ", not usable"
        return f"<{self.test} curve of {self.engine}, sample {self.sample}: {counted(len(self.columns['strain']), 'strain')}{usable}>"


class MacroCurves(list, Tabular):
    """Curves of a macro run, a list."""

    def table(self):
        """All of them, one strain a row, with the columns engine, sample, test and usable in front."""
        return joined("macro curves", [c.table() for c in self],
                      [{"engine": c.engine, "sample": c.sample, "test": c.test, "usable": c.usable} for c in self])


def _data_sets(group):
    """Data sets by name; those of a group inside come as "group/name"."""
    found = {}
    for name in group:
        if is_group(group[name]):
            found.update({f"{name}/{k}": v for k, v in _data_sets(group[name]).items()})
        else:
            found[name] = group[name]
    return found


def _unit(data):
    return text_attribute(data, "unit") if "unit" in data.attrs else ""


def read_macro(path):
    """macro.h5 or macro_SCENE.h5: a list of curves."""
    with open_file(path) as file:
        _require(file, path, "macro curves")
        curves = MacroCurves()
        for name in sorted(file["curves"]):
            group = file["curves"][name]
            curves.append(MacroCurve(text_attribute(group, "engine"), int(group.attrs["sample"]),
                                     text_attribute(group, "test"), bool(group.attrs["usable"]),
                                     {k: v[()] for k, v in _data_sets(group).items()},
                                     {k: _unit(v) for k, v in _data_sets(group).items()}))
        return curves


def read_summary(path):
    """summary.json of a run directory (or the file itself) as a dictionary."""
    path = Path(path)
    return json.loads((path / "summary.json" if path.is_dir() else path).read_text(encoding="utf-8-sig"))


def _named(found, name):
    if name not in found:
        raise KeyError(f"{name!r}: not in the report of this run: {', '.join(found) or 'it has no figures'}")
    return found[name]


class Run(Drawn):
    """A run directory. Files are read when they are asked for."""

    def __init__(self, directory):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            raise FileNotFoundError(f"{directory}: no such run directory")

    def __fspath__(self):  # wherever a run directory is asked for
        return str(self.directory)

    @property
    def summary(self):
        return read_summary(self.directory)

    @property
    def status(self):
        """"good", "not usable"..."""
        return self.summary["status"]

    def law(self):
        """The law that the run measured: of the table, else of the card."""
        return Law.load(self.directory)

    def measurements(self):
        return read_measurements(self.directory / "measurements.h5")

    def macro(self, scene=None):
        """Curves; of a comparison those of a scene."""
        return read_macro(self.directory / ("macro.h5" if scene is None else f"macro_{scene}.h5"))

    def snapshots(self, last=False):
        """States (see snapshot.py); `last`: of every series the last alone."""
        return read_snapshots(self.directory, last)

    def names(self):
        """Names of all arrays of the run: "macro/curves/0000/stress_axial" is in macro.h5."""
        found = []
        for path in sorted(self.directory.glob("*.h5")):
            with open_file(path) as file:
                found += [f"{path.stem}/{name}" for name in sorted(_data_sets(file))]
        return found

    def array(self, name):
        """An array by its name, or by the end of it where only one ends so: a Quantity. KeyError names what there is."""
        names = self.names()
        fitting = [n for n in names if n == name] or [n for n in names if n.endswith("/" + name)]
        if len(fitting) != 1:
            shown = ", ".join((fitting or names)[:12]) + (", ..." if len(fitting or names) > 12 else "")
            raise KeyError(f"{name!r}: {'several arrays end so' if fitting else 'no such array'}: {shown}")
        file, _, place = fitting[0].partition("/")
        with open_file(self.directory / f"{file}.h5") as opened:
            data = opened[place]
            return Quantity(fitting[0], data[()], _unit(data))

    def report(self):
        """Path of report.html, which is written where it is not there yet."""
        path = self.directory / "report.html"
        if not path.exists():
            from softgrain.commands import report
            report(self)
        return path

    def _of_report(self, folder, ending):
        self.report()
        return sorted((self.directory / folder).glob("*" + ending))

    def pictures(self):
        """The figures of the report by name, Picture objects that a notebook shows; no matplotlib is needed."""
        return {path.stem: Picture(path) for path in self._of_report("figures", ".svg")}

    def picture(self, name):
        """One of pictures(). KeyError names what there is."""
        return _named(self.pictures(), name)

    def curves(self):
        """The data of those figures by name, as Table objects with units."""
        return {path.stem: read_csv(path) for path in self._of_report("curves", ".csv")}

    def figure(self):
        """What the run is about, as a matplotlib figure: macro curves, else measured forces, else the last state. None for other runs."""
        for draw in (self._macro_figure, self._force_figure, self._state_figure):
            try:
                figure = draw()
            except (FileNotFoundError, KeyError, ValueError):
                continue
            if figure is not None:
                return figure
        return None

    def _macro_figure(self):
        curves = [c for c in self.macro() if c.usable]
        if not curves:
            return None
        figure, axes = new_figure()
        colors = {engine: f"C{k}" for k, engine in enumerate(dict.fromkeys(c.engine for c in curves))}
        named = set()
        for curve in curves:
            axes.plot(curve["strain"], curve["stress_axial"], color=colors[curve.engine], alpha=0.8,
                      label=None if curve.engine in named else curve.engine)
            named.add(curve.engine)
        axes.set_xlabel("strain")
        axes.set_ylabel("axial stress [Pa]")
        axes.legend(frameon=False)
        return figure

    def _force_figure(self):
        measured = self.measurements()
        figure, axes = new_figure()
        for k, kind in enumerate(dict.fromkeys(r.kind for r in measured.runs)):
            for n, one in enumerate(measured.select(kind)):
                axes.plot(one.delta, one.force, color=f"C{k}", alpha=0.5, linewidth=0.8, label=kind if n == 0 else None)
        axes.set_xlabel("overlap h/R")
        axes.set_ylabel("normal force [N]")
        axes.legend(frameon=False, title="single packings")
        return figure

    def _state_figure(self):
        states = self.snapshots(last=True)
        return states[-1].figure() if states else None

    def _repr_html_(self):
        summary = self.summary
        rows = {"status": summary.get("status"), "remarks": "; ".join(map(str, summary.get("remarks", []))),
                "version": f"{summary.get('version', '')} ({summary.get('commit', '')})",
                "files": ", ".join(sorted(p.name for p in self.directory.iterdir() if not p.name.startswith(".")))}
        body = "".join(f"<tr><th style='text-align:left'>{k}</th><td style='text-align:left'>{html.escape(str(v))}</td></tr>"
                       for k, v in rows.items() if v)
        return f"<b>{html.escape(str(self.directory))}</b><table>{body}</table>{self._image()}"

    def __repr__(self):
        return f"<run {self.directory}: {self.summary.get('status', 'has not ended')}>"
