"""The press test again, by GrainLearning: E and R of a law of softgrain as parameters of a Bayesian filter.

    python3 grainlearning_press_test.py [--out DIR] [--samples N] [--grainlearning]

With --grainlearning the search is GrainLearning's (pip install grainlearning). Without it the same callback and the same files serve
one round of weights on a grid, which needs nothing but numpy. Files of one sample, as GrainLearning's IODynamicSystem reads them:

    DIR/press_test.dat                                        # h Fn, the observation: a row per overlap
    DIR/sim_data/iter0/press_test_Iter0_Sample03_sim.txt      # h Fn
    DIR/sim_data/iter0/press_test_Iter0_Sample03_param.txt    # E R

The callback for whole simulations, in place of a law: pipelines/grainlearning_example.
"""
import argparse
import os
from pathlib import Path

import numpy as np

import fit_press_test as press
from fit_press_test import softgrain

NAME = "press_test"
LOW, HIGH = (0.3, 13.0), (0.8, 19.0)  # E [MPa], R [mm]


def write_columns(path, names, columns):
    """A header line "# name name ..." and one row per value."""
    np.savetxt(path, np.column_stack(columns), header=" ".join(names), fmt="%.17g")


def read_columns(path):
    """The named columns of such a file."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().lstrip("#").split()
    return dict(zip(names, np.loadtxt(path, ndmin=2).T))


def observation(folder):
    """Mean of the samples of the press test, as the file that a filter compares with."""
    overlap, force = press.read_press_test(press.TREE / "pipelines/press_test.csv")
    h = np.unique(overlap)
    mean = np.array([force[overlap == one].mean() for one in h])
    path = Path(folder) / f"{NAME}.dat"
    write_columns(path, ["h", "Fn"], [h, mean])
    return path, h


def make_callback(law, h, folder):
    """What GrainLearning calls: files for every row of system.param_data, named by iteration and sample."""

    def callback(calibration):
        system = getattr(calibration, "system", calibration)
        digits = len(str(len(system.param_data) - 1))
        for k, (megapascals, millimetres) in enumerate(system.param_data):
            prefix = Path(folder) / f"{NAME}_Iter{system.curr_iter}_Sample{k:0{digits}d}"
            force = law.force(1e3 * h / millimetres, radius=1e-3 * millimetres, modulus=1e6 * megapascals)
            write_columns(f"{prefix}_sim.txt", ["h", "Fn"], [h, force])
            write_columns(f"{prefix}_param.txt", ["E", "R"], [[megapascals], [millimetres]])
    return callback


class GridSystem:
    """The few members of GrainLearning's IODynamicSystem that the callback looks at."""
    curr_iter = 0
    param_names = ("E", "R")

    def __init__(self, samples):
        side = max(2, round(samples**0.5))
        grid = np.meshgrid(*(np.linspace(low, high, side) for low, high in zip(LOW, HIGH)), indexing="ij")
        self.param_data = np.stack([g.ravel() for g in grid], axis=1)


def weighted_mean(observed, folder):
    """E and R, each sample weighted by how well its file fits, as in a Bayesian filter with an error of 5 % of the largest force."""
    rows = []
    for path in sorted(Path(folder).glob(f"{NAME}_Iter0_Sample*_sim.txt")):
        simulated = read_columns(path)
        parameters = read_columns(str(path).replace("_sim.txt", "_param.txt"))
        misfit = np.sum(((simulated["Fn"] - observed["Fn"]) / (0.05 * observed["Fn"].max()))**2)
        rows.append((misfit, parameters["E"][0], parameters["R"][0]))
    misfit, megapascals, millimetres = np.array(rows).T
    weight = np.exp(-0.5 * (misfit - misfit.min()))
    return np.average(megapascals, weights=weight), np.average(millimetres, weights=weight)


def grainlearning_search(callback, observation_file, samples):
    """By GrainLearning's iterative Bayesian filter; written after its documentation of version 2."""
    from grainlearning import BayesianCalibration, IODynamicSystem  # pylint: disable=import-outside-toplevel
    calibration = BayesianCalibration.from_dict({
        "num_iter": 3,
        "callback": callback,
        "system": {
            "system_type": IODynamicSystem, "param_min": list(LOW), "param_max": list(HIGH), "param_names": ["E", "R"],
            "num_samples": samples, "obs_data_file": os.path.abspath(observation_file), "obs_names": ["Fn"], "ctrl_name": "h",
            "sim_name": NAME, "sim_data_dir": os.path.abspath("sim_data"), "sim_data_file_ext": ".txt",
        },
        "calibration": {"inference": {"ess_target": 0.3},
                        "sampling": {"max_num_components": 1, "n_init": 1, "covariance_type": "full"}},
        "save_fig": -1,
    })
    calibration.run()
    return calibration.get_most_prob_params()


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--law", default=str(press.TREE / "results/published/law.toml"))
    parser.add_argument("--out", default="grainlearning_press_test")
    parser.add_argument("--samples", type=int, default=400)
    parser.add_argument("--grainlearning", action="store_true", help="let GrainLearning search")
    options = parser.parse_args()
    law = softgrain.Law.load(options.law)
    os.makedirs(options.out, exist_ok=True)
    os.chdir(options.out)
    observed_file, h = observation(".")
    if options.grainlearning:  # moves the files from here into sim_data/iterN after each iteration
        megapascals, millimetres = grainlearning_search(make_callback(law, h, "."), observed_file, options.samples)
    else:
        folder = Path("sim_data") / "iter0"
        folder.mkdir(parents=True, exist_ok=True)
        make_callback(law, h, folder)(GridSystem(options.samples))
        megapascals, millimetres = weighted_mean(read_columns(observed_file), folder)
    print(f"E = {megapascals:.3f} MPa, R = {millimetres:.2f} mm")


if __name__ == "__main__":
    main()
