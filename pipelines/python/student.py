"""From the published experiment to a macro run beside its resolved twin: the code of student.ipynb, some minutes on two cores."""
import softgrain

material = {"E": "0.5 MPa", "nu": 0.3, "mu": 0.3, "density": 2500.0, "restitution": 0.5}
packing = {"shell_radius": "16 mm", "exponent": 3.5, "polydispersity": 10.0, "rmax_over_shell": 0.5, "beta": 3.0,
           "trials": 10000, "placement": "voids", "count": 7}
solid, soft = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3], [0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4]  # overlap h/R
macro = {"bodies": 40, "soft_share": 0.45, "test": "oedometric", "strain": 0.16, "steps": 8, "resolved": ["shelled"]}

experiment = softgrain.run({"kind": "soft-particle", "seed": 1, "material": material, "packing": packing, "measure": {
    "relaxation": "slow-dynamics", "soft_solid": {"deltas": solid}, "soft_soft": {"deltas": soft}}}, out="results/experiment")
forces = experiment.measurements().table()                    # .dataframe() where pandas is installed
print(experiment, forces, sep="\n")

fit = softgrain.calibrate(experiment, out="results/fit")
law = fit.law()
for kind, name, value, low, high, unit in zip(*(fit.table()[k] for k in ("kind", "parameter", "value", "low", "high", "unit"))):
    print(f"{kind}: {name} = {value:.4g} [{low:.4g}, {high:.4g}] {unit}")
print(law, f"F(0.25) = {law.force(0.25):.3g} N")

run = softgrain.run({"kind": "macro", "seed": 1, "macro": macro}, law=fit, out="results/macro")
with_law, twin = run.macro()
print(f"axial stress at strain {twin['strain'][-1]:.2g}: {with_law['stress_axial'][-1]:.3g} Pa, twin {twin['stress_axial'][-1]:.3g} Pa")

comparison = softgrain.compare(run)
for number, mean in zip(comparison.table()["number"], comparison.table()["mean"]):
    print(f"{number}: {mean:.3g}")
figure = run.picture("axial-stress-oedometric")
figure.save("results/stress.svg")
figure
