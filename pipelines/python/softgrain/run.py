"""Run directories: summary, measurements, macro curves; laws and states through the other modules."""
import json
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from softgrain.law import read_law
from softgrain.snapshot import read_snapshots


def text_attribute(group, name):
    """A text attribute as str."""
    value = group.attrs[name]
    return value.decode() if isinstance(value, bytes) else str(value)


@dataclass(frozen=True)
class MeasuredRun:
    """All points of one packing under one relaxation."""

    packing: int
    kind: str  # "soft-solid" or "soft-soft"
    relaxation: str
    delta: np.ndarray  # Delta = hn/Rs
    force: np.ndarray  # normal, compression positive [N]
    converged: np.ndarray
    tangential: dict  # columns delta, angle [degree], force_parallel [N], force_perpendicular [N]


@dataclass(frozen=True)
class Measurements:
    spec: dict  # shell_radius [m], youngs_modulus [Pa], poisson_ratio, friction, ...
    runs: tuple

    def select(self, kind, relaxation=None):
        return [r for r in self.runs if r.kind == kind and relaxation in (None, r.relaxation)]


def _require(file, path, wanted):
    if "format" not in file.attrs or text_attribute(file, "format") != wanted:
        raise ValueError(f"{path}: holds no {wanted}")


def read_measurements(path):
    """measurements.h5."""
    with h5py.File(path, "r") as file:
        _require(file, path, "soft-particle measurements")
        spec = {k: (v.decode() if isinstance(v, bytes) else v) for k, v in file["spec"].attrs.items()}
        runs = file["runs"]
        names = [text_attribute(runs, f"relaxation_{k}") for k in range(int(runs.attrs["relaxations"]))]
        normal = {k: file["normal"][k][()] for k in ("delta", "force", "converged")}
        turned = {k: file["tangential"][k][()] for k in ("delta", "angle", "force_parallel", "force_perpendicular")}
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


@dataclass(frozen=True)
class MacroCurve:
    engine: str  # "law" or another law's name, "shelled", "free"
    sample: int
    test: str
    usable: bool
    columns: dict  # strain, stress_axial [Pa], stress_lateral [Pa], coordination, ...

    def __getitem__(self, name):
        return self.columns[name]


def _columns(group):
    """Data sets by name; those of a group inside come as "group/name"."""
    columns = {}
    for name in group:
        if isinstance(group[name], h5py.Group):
            columns.update({f"{name}/{k}": v for k, v in _columns(group[name]).items()})
        else:
            columns[name] = group[name][()]
    return columns


def read_macro(path):
    """macro.h5 or macro_SCENE.h5: a list of curves."""
    with h5py.File(path, "r") as file:
        _require(file, path, "macro curves")
        curves = []
        for name in sorted(file["curves"]):
            group = file["curves"][name]
            curves.append(MacroCurve(text_attribute(group, "engine"), int(group.attrs["sample"]),
                                     text_attribute(group, "test"), bool(group.attrs["usable"]),
                                     _columns(group)))
        return curves


def read_summary(path):
    """summary.json of a run directory (or the file itself) as a dictionary."""
    path = Path(path)
    return json.loads((path / "summary.json" if path.is_dir() else path).read_text())


class Run:
    """A run directory. Files are read when they are asked for."""

    def __init__(self, directory):
        self.directory = Path(directory)
        if not self.directory.is_dir():
            raise FileNotFoundError(f"{directory}: no such run directory")

    @property
    def summary(self):
        return read_summary(self.directory)

    def law(self):
        return read_law(self.directory / "law.toml")

    def measurements(self):
        return read_measurements(self.directory / "measurements.h5")

    def macro(self, scene=None):
        """Curves; of a comparison those of a scene."""
        return read_macro(self.directory / ("macro.h5" if scene is None else f"macro_{scene}.h5"))

    def snapshots(self, last=False):
        """States (see snapshot.py); `last`: of every series the last alone."""
        return read_snapshots(self.directory, last)
