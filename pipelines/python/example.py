"""A run, step by step: what was measured, the law, stress over strain, a packing.

    python3 example.py RUN [PICTURE.png]

RUN is a run directory of kind "pipeline", "soft-particle" or "macro"; parts that it does not hold are left out. Works from the tree as it is.
Needs h5py and numpy, and matplotlib for the picture: without it the numbers are printed and that is said.
"""
# %% Where the package is, when it has not been installed
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import numpy as np  # noqa: E402

import softgrain  # noqa: E402

# %% A run and what it says of itself
run = softgrain.Run(sys.argv[1])
print(f"{run.directory}: {run.summary['status']}, softgrain {run.summary['version']} ({run.summary['commit']})")


def holds(file):
    return (run.directory / file).exists()


# %% What was measured: force over overlap, one curve per packing, dimensionless
curves = []
if holds("measurements.h5"):
    measured = run.measurements()
    scale = measured.spec["youngs_modulus"] * measured.spec["shell_radius"] ** 2
    curves = measured.select("soft-solid")
for curve in curves:
    print(f"packing {curve.packing}, {curve.relaxation}: Fn/(E Rs^2) = {curve.force[-1] / scale:.4g} at Delta = "
          f"{curve.delta[-1]:.3g}")

# %% The law, when there is one; evaluated by the compiled laws of the simulation, dimensionless with radius and modulus 1
try:
    law = softgrain.CardLaw(run.directory / "law.toml")
    pair = law.pair("soft-solid")
    numbers = pair.normal
    print(f"law ({pair.status}): F = {numbers.a:.4g} Delta^{numbers.b:.3g} {numbers.c:+.3g} from Delta = "
          f"{numbers.delta:.3g} on; fitted for {pair.delta_min:.3g} to {pair.delta_max:.3g}")
except (softgrain.IoError, KeyError):
    law = None
    print("no law in this run")
except ImportError as e:
    law = None
    print(e)

# %% Stress over strain of macro runs, by law and of resolved twins
macro = run.macro() if holds("macro.h5") else []
for curve in macro:
    print(f"{curve.engine}, sample {curve.sample}: axial stress {curve['stress_axial'][-1]:.4g} Pa at strain "
          f"{curve['strain'][-1]:.3g}, lateral {curve['stress_lateral'][-1]:.4g} Pa{'' if curve.usable else ', not usable'}")

# %% A packing: its last state, the strongest contact
states = list(run.snapshots(last=True))
state = next((s for s in states if s.series.startswith("soft-solid")), states[0] if states else None)
strongest = None
if state is None:
    print("no states were kept in this run")
elif len(state.contacts) == 0:
    print(f"{state.label}: {len(state.radius)} particles, no contact that carries force")
else:
    strongest = np.argmax(state.contacts.normal_force)
    print(f"{state.label}: {len(state.radius)} grains, {len(state.contacts)} contacts, strongest "
          f"{state.contacts.normal_force[strongest]:.4g} N")

# %% All of it as a picture
try:
    import matplotlib
except ImportError:
    sys.exit("no picture: matplotlib is not installed (Debian: python3-matplotlib, or pip install matplotlib)")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PatchCollection  # noqa: E402


def draw_forces(axes):
    for curve in curves:
        axes.plot(curve.delta, curve.force / scale, "o", markersize=3, alpha=0.6)
    if law is not None:
        delta = np.linspace(0.0, max(c.delta[-1] for c in curves), 200)
        axes.plot(delta, law.force(delta, radius=1, modulus=1), "k-", label="law")
        axes.legend()
    axes.set_xlabel("Delta = hn/Rs")
    axes.set_ylabel("Fn/(E Rs²)")


def draw_stresses(axes):
    engines = list(dict.fromkeys(curve.engine for curve in macro))
    for curve in macro:
        axes.plot(100 * curve["strain"], curve["stress_axial"], color=f"C{engines.index(curve.engine)}",
                  label=curve.engine if curve.sample == 0 else None)
    axes.legend()
    axes.set_xlabel("strain [%]")
    axes.set_ylabel("axial stress [Pa]")


def draw_packing(axes):
    """Seen along z; lines as thick as the force."""
    grains = [plt.Circle(x[:2], r) for x, r in zip(state.position, state.radius)]
    axes.add_collection(PatchCollection(grains, facecolor="0.8", edgecolor="0.5", alpha=0.3))
    if strongest is not None:
        width = 8.0 * state.contacts.normal_force / state.contacts.normal_force[strongest]
        ends = np.stack([state.contacts.start[:, :2], state.contacts.end[:, :2]], axis=1)
        axes.add_collection(LineCollection(ends, linewidths=width, colors="tab:red"))
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_title(state.label, fontsize=9)


there = [draw for draw, data in ((draw_forces, curves), (draw_stresses, macro), (draw_packing, state)) if data]
if not there:
    sys.exit("no picture: the run holds neither measurements, nor macro curves, nor states")
picture = sys.argv[2] if len(sys.argv) > 2 else "softgrain_example.png"
figure, places = plt.subplots(1, len(there), figsize=(5.5 * len(there), 5), squeeze=False)
for draw, axes in zip(there, places[0]):
    draw(axes)
figure.tight_layout()
figure.savefig(picture, dpi=120)
print(f"picture: {picture}")
