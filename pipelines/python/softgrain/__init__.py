"""softgrain in Python: runs scenes, evaluates laws, reads what runs leave behind.

    import softgrain
    run = softgrain.run("pipelines/quickstart.toml", set={"macro.count": 40})
    run.summary["status"], run.names(), run.array("macro/..."), run.macro().dataframe()
    softgrain.check({"kind": "particles", ...}).warnings
    softgrain.calibrate(run), softgrain.sweep(scene, {"material.mu": [0.1, 0.3]}), softgrain.compare(run, other)
    softgrain.export(run, "vtp"), softgrain.report(run)
    law = softgrain.Law.load("law.toml")
    law.force(delta), law.stiffness(delta), law.force_interval(delta)      # arrays
    state = run.snapshots(last=True)[0]
    state.position, state.contacts.normal_force
"""
from softgrain.commands import (Calibration, Comparison, Export, Sweep, calibrate, compare, example, examples, export, report,
                                sweep)
from softgrain.errors import (BadInput, FileTrouble, InputError, Interrupted, IoError, Mistake, NotUsable, SoftgrainError,  # noqa: F401
                              UnusableResult)
from softgrain.figures import Picture
from softgrain.law import CardLaw, Law, PairLaw, TableLaw, ThresholdPowerLaw
from softgrain.results import (MacroCurve, MacroCurves, MeasuredRun, Quantity, Run, read_macro, read_measurements, read_summary)
from softgrain.running import Findings, check, run
from softgrain.snapshot import Contacts, Snapshot, read_snapshots
from softgrain.tables import Table

__all__ = ["Calibration", "CardLaw", "Comparison", "Contacts", "Export", "Findings", "InputError", "Interrupted", "IoError", "Law",
           "MacroCurve", "MacroCurves", "MeasuredRun", "Mistake", "PairLaw", "Picture", "Quantity", "Run", "Snapshot",
           "SoftgrainError", "Sweep", "Table", "TableLaw", "ThresholdPowerLaw", "UnusableResult", "calibrate", "check",
           "compare", "example", "examples", "export", "read_macro", "read_measurements", "read_snapshots", "read_summary", "report", "run", "sweep"]
__version__ = "0.2.0"
