#!/usr/bin/env python3
"""Which friction gives a measured curve? softgrain as the model of a calibration tool.

  calibrate.py [--softgrain PROGRAM] [--samples N] [--out DIR] [--grainlearning]

With --grainlearning the search is GrainLearning's (pip install grainlearning). Without it the same callback and the same
files serve a plain loop over the parameter: the script then needs nothing but Python. The "measurement" is made up: our own
simulation with mu = 0.3 and another seed.

Files of one sample, in DIR/sim_data/iter0:  softgrain_Iter0_Sample3_sim.txt    # Delta Fn Fn_error, a row per overlap
                                             softgrain_Iter0_Sample3_param.txt  # mu, one row
"""
import argparse
import math
import os
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "soft_particle.toml")
NAME = "softgrain"


def run_softgrain(program, prefix, settings, seed=None):
    """One run; writes PREFIX_sim.txt and PREFIX_param.txt. Status 3 (some points did not converge) leaves files too."""
    command = [program, "microsim", SCENE, "--quiet", "--observables", prefix]
    for key, value in settings.items():
        command += ["--set", f"{key}={value!r}"]
    if seed is not None:
        command += ["--seed", str(seed)]
    status = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
    if status not in (0, 3):
        sys.exit(f"{' '.join(command)} ended with status {status}")


def read_columns(path):
    """The named columns of a file with a header line '# name name ...'."""
    with open(path, encoding="utf-8") as lines:
        names = lines.readline().lstrip("#").split()
        rows = [[float(word) for word in line.split()] for line in lines if line.strip()]
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}


def make_callback(program, folder):
    """What GrainLearning calls: a run for every row of system.param_data, files named by iteration and sample."""
    keys = {"mu": "material.mu", "beta": "packing.beta", "trials": "packing.trials"}

    def callback(calibration):
        system = getattr(calibration, "system", calibration)
        digits = math.floor(math.log10(len(system.param_data))) + 1
        for k, row in enumerate(system.param_data):
            prefix = os.path.join(folder, f"{NAME}_Iter{system.curr_iter}_Sample{k:0{digits}d}")
            run_softgrain(program, prefix, {keys[name]: float(value) for name, value in zip(system.param_names, row)})
    return callback


class PlainSystem:
    """The few members of GrainLearning's IODynamicSystem that the callback looks at."""
    curr_iter = 0
    param_names = ["mu"]

    def __init__(self, values):
        self.param_data = [[value] for value in values]


def misfit_of(simulated, observed):
    """Mean square of the distance over its error (10 % of the force, 1 % of the largest), over the overlaps where both are known;
    infinite where a run came to no force at all."""
    largest = max((f for f in observed if math.isfinite(f)), default=0.0)
    squares = [((a - b) / (0.1 * b + 0.01 * largest)) ** 2
               for a, b in zip(simulated, observed) if math.isfinite(a) and math.isfinite(b)]
    return sum(squares) / len(squares) if squares else math.inf


def plain_search(callback, observed, folder, samples, low, high):
    """The sample with the least misfit, and the weighted mean over all (weights as in a Bayesian filter)."""
    system = PlainSystem([low + (high - low) * k / (samples - 1) for k in range(samples)])
    callback(system)
    total = mean = 0.0
    best = (math.inf, None)
    digits = math.floor(math.log10(samples)) + 1
    for k in range(samples):
        prefix = os.path.join(folder, f"{NAME}_Iter0_Sample{k:0{digits}d}")
        simulated = read_columns(prefix + "_sim.txt")
        mu = read_columns(prefix + "_param.txt")["mu"][0]
        misfit = len(observed["Fn"]) * misfit_of(simulated["Fn"], observed["Fn"])  # chi^2, were every overlap known
        weight = math.exp(-0.5 * misfit)
        total += weight
        mean += weight * mu
        if misfit < best[0]:
            best = (misfit, mu)
        print(f"mu = {mu:.3f}: misfit {misfit:.1f}")
    if best[1] is None:
        sys.exit("not one sample came to a force at an overlap that was observed")
    print(f"best sample: mu = {best[1]:.3f}; weighted mean {mean / total if total > 0 else best[1]:.3f}; truth 0.3")
    return best[1]


def grainlearning_search(callback, observation, samples, low, high):
    """The same by GrainLearning's iterative Bayesian filter; written after its documentation of version 2."""
    from grainlearning import BayesianCalibration, IODynamicSystem  # pylint: disable=import-outside-toplevel
    calibration = BayesianCalibration.from_dict({
        "num_iter": 3,
        "callback": callback,
        "system": {
            "system_type": IODynamicSystem,
            "param_min": [low], "param_max": [high], "param_names": ["mu"], "num_samples": samples,
            "obs_data_file": os.path.abspath(observation), "obs_names": ["Fn"], "ctrl_name": "Delta",
            "sim_name": NAME, "sim_data_dir": os.path.abspath("sim_data"), "sim_data_file_ext": ".txt",
        },
        "calibration": {"inference": {"ess_target": 0.3},
                        "sampling": {"max_num_components": 1, "n_init": 1, "covariance_type": "full"}},
        "save_fig": -1,
    })
    calibration.run()
    print("most probable:", calibration.get_most_prob_params())


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--softgrain", default=os.path.join(HERE, "..", "..", "build", "release", "softgrain"))
    parser.add_argument("--samples", type=int, default=7)
    parser.add_argument("--out", default="grainlearning_example")
    parser.add_argument("--grainlearning", action="store_true", help="let GrainLearning search")
    options = parser.parse_args()
    program = os.path.abspath(options.softgrain)
    os.makedirs(options.out, exist_ok=True)
    os.chdir(options.out)
    run_softgrain(program, "observation", {"material.mu": 0.3}, seed=2)
    if options.grainlearning:
        # GrainLearning moves the files from here into sim_data/iterN after each iteration.
        grainlearning_search(make_callback(program, "."), "observation_sim.txt", options.samples, 0.05, 0.8)
        return
    folder = os.path.join("sim_data", "iter0")
    best = plain_search(make_callback(program, folder), read_columns("observation_sim.txt"), folder, options.samples, 0.05, 0.8)
    sys.exit(0 if 0.1 < best < 0.6 else 3)


if __name__ == "__main__":
    main()
