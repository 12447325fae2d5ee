"""Which Young's modulus explains a press test? scipy fits a law of softgrain to the readings.

    python3 fit_press_test.py [LAW.toml [PRESS_TEST.csv [PICTURE.png]]]

Needs numpy and scipy; matplotlib for the picture. The law gives the shape Fn/(E R^2) over h/R, as fitted to simulated soft particles;
E and the zero of the overlap are what the fit looks for. Law and derivatives come from the compiled laws of the simulation.
"""
import csv
import sys
from pathlib import Path

import numpy as np

TREE = Path(__file__).resolve().parents[2]
try:
    import softgrain
except ImportError:  # not installed: from the tree
    sys.path.insert(0, str(Path(__file__).resolve().parent))
    import softgrain


def read_press_test(path):
    """Overlaps [m] and forces [N] of a file like pipelines/press_test.csv."""
    with open(path, encoding="utf-8-sig") as file:
        rows = csv.reader((line for line in file if not line.startswith("#")), delimiter=";")
        next(rows)
        data = np.array([[float(h), float(f)] for _, h, f in rows])
    return 1e-3 * data[:, 0], 1e-3 * data[:, 1]


def fit(law, overlap, force, radius, kind="soft-solid"):
    """E [MPa] and where the plate first touched [mm], with their standard errors: the roots of curve_fit's covariance. Of a test
    bench the first is wanted and the second never quite known: the plate was there `shift` before the zero of its reading."""

    from scipy.optimize import curve_fit  # here: the GrainLearning example shares the rest and needs numpy alone

    def model(h, megapascals, shift):
        return law.force((h + 1e-3 * shift) / radius, kind, radius=radius, modulus=1e6 * megapascals)

    def derivatives(h, megapascals, shift):
        delta = (h + 1e-3 * shift) / radius
        by_shift = 1e-3 * law.stiffness(delta, kind, radius=radius, modulus=1e6 * megapascals)
        return np.stack([model(h, megapascals, shift) / megapascals, by_shift], axis=1)

    best, covariance = curve_fit(model, overlap, force, p0=(1e-6 * law.youngs_modulus, 0.0), jac=derivatives)
    return best, np.sqrt(np.diag(covariance))


def main():
    """Command line."""
    law = softgrain.Law.load(sys.argv[1] if len(sys.argv) > 1 else TREE / "results/published/law.toml")
    overlap, force = read_press_test(sys.argv[2] if len(sys.argv) > 2 else TREE / "pipelines/press_test.csv")
    radius = law.shell_radius
    (megapascals, shift), (megapascals_error, shift_error) = fit(law, overlap, force, radius)
    print(f"E = {megapascals:.3f} +- {megapascals_error:.3f} MPa, plate {shift:.3f} +- {shift_error:.3f} mm before zero")

    def fitted(h):
        return law.force((h + 1e-3 * shift) / radius, radius=radius, modulus=1e6 * megapascals)

    print(f"readings off by {1e3 * np.sqrt(np.mean((force - fitted(overlap))**2)):.1f} mN (root mean square) of {1e3 * force.max():.0f}")
    if len(sys.argv) > 3:
        from softgrain.figures import new_figure
        figure, axes = new_figure()
        h = np.linspace(0.0, overlap.max(), 200)
        axes.plot(1e3 * overlap, force, "o", markersize=3, alpha=0.6, label="press test")
        axes.plot(1e3 * h, fitted(h), label=f"law, E = {megapascals:.3f} MPa")
        axes.set_xlabel("overlap [mm]")
        axes.set_ylabel("force [N]")
        axes.legend(frameon=False)
        figure.savefig(sys.argv[3], dpi=120)
        print(f"picture: {sys.argv[3]}")


if __name__ == "__main__":
    main()
