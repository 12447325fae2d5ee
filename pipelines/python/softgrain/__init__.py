"""Reads what runs of softgrain leave behind.

    import softgrain
    run = softgrain.Run("results/quickstart")
    run.summary["status"]
    law = run.law().pair("soft-solid")
    law.normal(0.2)                          # Fn/(E Rs^2) at Delta = 0.2
    state = run.snapshots(last=True)[0]
    state.position, state.contacts.normal_force
"""
from softgrain.law import Law, PairLaw, ThresholdPowerLaw, read_law
from softgrain.run import MacroCurve, MeasuredRun, Run, read_macro, read_measurements, read_summary
from softgrain.snapshot import Contacts, Snapshot, read_snapshots

__all__ = ["Contacts", "Law", "MacroCurve", "MeasuredRun", "PairLaw", "Run", "Snapshot", "ThresholdPowerLaw", "read_law",
           "read_macro", "read_measurements", "read_snapshots", "read_summary"]
__version__ = "0.1.0"
