"""States of a run: particles, walls and contacts with their forces, from run.h5 and states_*.h5.

powder.h5 and grain_box.h5 end in states whose contacts the program computes: `softgrain export RUN --to csv` makes tables of them.
"""
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from softgrain.figures import Drawn, new_figure
from softgrain.hdf5 import open_file, text_attribute
from softgrain.tables import Table, Tabular, counted

KINDS = ("particles", "soft-particle", "macro", "twin", "powder", "grain-box")
ROLES = ("solid", "soft", "inner")


@dataclass(repr=False)
class Contacts(Tabular):
    """pair (C, 2): indices i of a particle and j of a particle or, from len(radius) on, of a wall; force on i."""

    pair: np.ndarray
    start: np.ndarray  # (C, 3) centre of i
    end: np.ndarray  # (C, 3) centre of j in the image that i touches; of a wall the point of contact
    point: np.ndarray
    force: np.ndarray
    normal_force: np.ndarray

    def __len__(self):
        return len(self.pair)

    def table(self):
        """One contact a row: first, second (as in pair), normal_force [N], force_x.. on the first [N], point_x.. [m]."""
        vectors = {f"{name}_{'xyz'[k]}": values[:, k] for name, values in (("force", self.force), ("point", self.point)) for k in range(3)}
        units = {name: "N" if name.startswith("force") else "m" for name in vectors}
        return Table("contacts", {"first": self.pair[:, 0], "second": self.pair[:, 1], "normal_force": self.normal_force, **vectors},
                     {**units, "normal_force": "N"})

    def __repr__(self):
        return f"<{counted(len(self), 'contact')}>"


@dataclass(repr=False)
class Snapshot(Drawn, Tabular):
    kind: str
    series: str
    label: str
    frame: int
    time: float = np.nan  # [s]
    strain: float = np.nan
    overlap: float = np.nan  # Delta of a soft particle
    position: np.ndarray = None  # (N, 3)
    radius: np.ndarray = None
    role: np.ndarray = None  # indices into ROLES
    body: np.ndarray = None
    velocity: np.ndarray | None = None
    walls: dict = field(default_factory=dict)  # shape (0 plane, 1 inside of a sphere), point, normal, radius, body
    cell_edges: np.ndarray = None  # rows are edge vectors, meaningful where periodic
    periodic: np.ndarray = None
    contacts: Contacts | None = None  # None: not kept for this state

    def __repr__(self):
        contacts = "" if self.contacts is None else f", {counted(len(self.contacts), 'contact')}"
        return f"<{self.label}: {counted(len(self.radius), 'particle')}{contacts}>"

    def table(self):
        """One particle a row: x, y, z and radius [m], role ("solid", "soft", "inner"), body, velocity [m/s] where it was kept."""
        columns = {**{"xyz"[k]: self.position[:, k] for k in range(3)}, "radius": self.radius,
                   "role": np.array(ROLES)[np.asarray(self.role, dtype=int)], "body": self.body}
        units = dict.fromkeys(("x", "y", "z", "radius"), "m")
        for k in range(0 if self.velocity is None else 3):
            columns[f"velocity_{'xyz'[k]}"] = self.velocity[:, k]
            units[f"velocity_{'xyz'[k]}"] = "m/s"
        return Table(self.label, columns, units)

    def figure(self, along=2):
        """The state seen along an axis (0, 1, 2), lines between touching grains as thick as their force: a matplotlib figure."""
        from matplotlib.collections import LineCollection, PatchCollection
        from matplotlib.patches import Circle
        figure, axes = new_figure(height=5.0)
        seen = [k for k in range(3) if k != along]
        grains = [Circle(x[seen], r) for x, r in zip(self.position, self.radius)]
        axes.add_collection(PatchCollection(grains, facecolor="0.8", edgecolor="0.5", linewidth=0.4, alpha=0.35))
        if self.contacts is not None and len(self.contacts):
            strongest = max(float(np.abs(self.contacts.normal_force).max()), np.finfo(float).tiny)
            ends = np.stack([self.contacts.start[:, seen], self.contacts.end[:, seen]], axis=1)
            axes.add_collection(LineCollection(ends, linewidths=6.0 * np.abs(self.contacts.normal_force) / strongest, colors="C3"))
        axes.set_aspect("equal")
        axes.autoscale_view()
        for one, name in zip((axes.set_xlabel, axes.set_ylabel), seen):
            one(f"{'xyz'[name]} [m]")
        axes.set_title(self.label, fontsize=9)
        return figure


def _contacts(group, part=slice(None)):
    ends = group["ends"][()].reshape(-1, 2, 3)[part]
    return Contacts(group["pair"][()].reshape(-1, 2)[part], ends[:, 0], ends[:, 1], group["point"][()].reshape(-1, 3)[part],
                    group["force"][()].reshape(-1, 3)[part], group["normal_force"][()][part])


def _state(group):
    p = group["particles"]
    return Snapshot(
        KINDS[int(group.attrs["kind"])], text_attribute(group, "series"), text_attribute(group, "label"),
        int(group.attrs["frame"]), *(float(group.attrs.get(name, np.nan)) for name in ("time", "strain", "overlap")),
        position=p["position"][()], radius=p["radius"][()], role=p["role"][()], body=p["body"][()],
        velocity=p["velocity"][()] if "velocity" in p else None,
        walls={name: group["walls"][name][()] for name in ("shape", "point", "normal", "radius", "body")},
        cell_edges=group["cell_edges"][()], periodic=group["cell_periodic"][()] != 0,
        contacts=_contacts(group["contacts"]) if "contacts" in group else None)


def _states(path, last):
    with open_file(path) as file:
        groups = [file["states"][name] for name in sorted(file["states"])]
        if last:
            groups = list({text_attribute(g, "series"): g for g in groups}.values())
        return [_state(g) for g in groups]


def _particles(path, last):
    """run.h5: every recorded frame, with the contacts of those that kept them."""
    with open_file(path) as file:
        bodies, trajectory, final = file["bodies"], file["trajectory"], file["final"]
        radius = bodies["radius"][()]
        time = trajectory["time"][()]
        soft = bodies["material_is_soft"][()] if "material_is_soft" in bodies else np.zeros(1 << 16, dtype=int)
        dimension = int(file.attrs.get("dimension", 3))  # the state in full has as many coordinates, disks two
        spheres = final["bodies"]["sphere"][()].reshape(-1, dimension + 1)[len(radius):]
        planes = np.zeros((final["bodies"]["plane_normal"].size // dimension, 3))
        planes[:, :dimension] = final["bodies"]["plane_normal"][()].reshape(-1, dimension)
        periodic = np.zeros(3, dtype=bool)
        periodic[:dimension] = final["cell"]["periodic"][()] != 0
        shells = len(spheres) - len(planes)
        walls = {"shape": np.r_[np.ones(shells, int), np.zeros(len(planes), int)],
                 "normal": np.r_[np.zeros((shells, 3)), planes], "radius": spheres[:, dimension], "body": np.full(len(spheres), -1)}
        kept = {}
        if "frame_contacts" in file:
            ends = np.cumsum(file["frame_contacts"]["count"][()])
            kept = {int(f): slice(int(e - n), int(e)) for f, n, e in
                    zip(file["frame_contacts"]["frame"][()], file["frame_contacts"]["count"][()], ends)}
        out = []
        for k in range(len(time) - 1 if last and len(time) else 0, len(time)):
            matrix = trajectory["cell_edges"][k]
            out.append(Snapshot(
                "particles", "particles", f"particles at {time[k]:.4g} s", k, time=float(time[k]),
                position=trajectory["position"][k], radius=radius, role=soft[bodies["material"][()]],
                body=np.arange(len(radius)), velocity=trajectory["velocity"][k],
                walls={**walls, "point": trajectory["wall_position"][k]}, cell_edges=matrix.T,
                periodic=periodic,
                contacts=_contacts(file["frame_contacts"], kept[k]) if k in kept else None))
        return out


def read_snapshots(run, last=False):
    """States of a run directory, or of one of its files run.h5 and states_*.h5; an empty list when there are none."""
    path = Path(run)
    if not path.exists():
        raise FileNotFoundError(f"{run}: no such run directory or file")
    files = sorted(f for f in path.iterdir() if f.name == "run.h5" or (f.name.startswith("states") and f.suffix == ".h5")) \
        if path.is_dir() else [path]
    out = []
    for file in files:
        out += _particles(file, last) if file.name == "run.h5" else _states(file, last)
    return out
