"""A law and a packing, step by step.

    python3 example.py RUN [PICTURE.png]

RUN is a run directory of kind "pipeline" or "soft-particle". Works from the tree as it is. Needs h5py and numpy, and matplotlib for the
picture: without it the numbers are printed and that is said.
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

# %% What was measured: force over overlap, one curve per packing, dimensionless
measured = run.measurements()
scale = measured.spec["youngs_modulus"] * measured.spec["shell_radius"] ** 2
curves = measured.select("soft-solid")
for curve in curves:
    print(f"packing {curve.packing}, {curve.relaxation}: Fn/(E Rs^2) = {curve.force[-1] / scale:.4g} at Delta = "
          f"{curve.delta[-1]:.3g}")

# %% The law, when there is one
try:
    law = run.law().pair("soft-solid")
    print(f"law ({law.status}): F = {law.normal.a:.4g} Delta^{law.normal.b:.3g} {law.normal.c:+.3g} from Delta = "
          f"{law.normal.delta:.3g} on; fitted for {law.delta_min:.3g} to {law.delta_max:.3g}")
except (FileNotFoundError, KeyError):
    law = None
    print("no law in this run")

# %% A packing: its last state, the strongest contact
state = next(s for s in run.snapshots(last=True) if s.series.startswith("soft-solid"))
strongest = np.argmax(state.contacts.normal_force)
print(f"{state.label}: {len(state.radius)} grains, {len(state.contacts)} contacts, strongest "
      f"{state.contacts.normal_force[strongest]:.4g} N")

# %% Both as a picture
try:
    import matplotlib
except ImportError:
    sys.exit("no picture: matplotlib is not installed (Debian: python3-matplotlib, or pip install matplotlib)")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection, PatchCollection  # noqa: E402

figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5))
for curve in curves:
    left.plot(curve.delta, curve.force / scale, "o", markersize=3, alpha=0.6)
if law is not None:
    delta = np.linspace(0.0, max(c.delta[-1] for c in curves), 200)
    left.plot(delta, law.normal(delta), "k-", label="law")
    left.legend()
left.set_xlabel("Delta = hn/Rs")
left.set_ylabel("Fn/(E Rs²)")

# Seen along z; lines as thick as the force.
grains = [plt.Circle(x[:2], r) for x, r in zip(state.position, state.radius)]
right.add_collection(PatchCollection(grains, facecolor="0.8", edgecolor="0.5", alpha=0.3))
width = 8.0 * state.contacts.normal_force / state.contacts.normal_force[strongest]
ends = np.stack([state.contacts.start[:, :2], state.contacts.end[:, :2]], axis=1)
right.add_collection(LineCollection(ends, linewidths=width, colors="tab:red"))
right.set_aspect("equal")
right.autoscale_view()
right.set_xlabel("x [m]")
right.set_ylabel("y [m]")
right.set_title(state.label, fontsize=9)
picture = sys.argv[2] if len(sys.argv) > 2 else "softgrain_example.png"
figure.tight_layout()
figure.savefig(picture, dpi=120)
print(f"picture: {picture}")
