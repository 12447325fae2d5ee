"""softgrain in Python: runs scenes, evaluates laws, reads what runs leave behind.

    import softgrain
    run = softgrain.run("pipelines/quickstart.toml", set={"macro.count": 40})
    run.summary["status"], run.names(), run.array("macro/...")
    softgrain.check({"kind": "particles", ...}).warnings
    law = softgrain.Law.load("law.toml")
    law.force(delta), law.stiffness(delta), law.force_interval(delta)      # arrays
    state = run.snapshots(last=True)[0]
    state.position, state.contacts.normal_force
"""
from softgrain.errors import (BadInput, FileTrouble, InputError, Interrupted, IoError, Mistake, NotUsable, SoftgrainError,  # noqa: F401
                              UnusableResult)
from softgrain.law import CardLaw, Law, PairLaw, TableLaw, ThresholdPowerLaw
from softgrain.results import (MacroCurve, MeasuredRun, Quantity, Run, read_macro, read_measurements, read_summary)
from softgrain.running import Findings, check, run
from softgrain.snapshot import Contacts, Snapshot, read_snapshots

__all__ = ["CardLaw", "Contacts", "Findings", "InputError", "Interrupted", "IoError", "Law", "MacroCurve", "MeasuredRun", "Mistake",
           "PairLaw", "Quantity", "Run", "Snapshot", "SoftgrainError", "TableLaw", "ThresholdPowerLaw", "UnusableResult", "check",
           "read_macro", "read_measurements", "read_snapshots", "read_summary", "run"]
__version__ = "0.2.0"
