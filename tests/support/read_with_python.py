"""What the Python package reads of a run directory, as JSON, for comparison with what the program reads.

    python3 read_with_python.py PACKAGE_FOLDER RUN
"""
import json
import sys
from pathlib import Path

sys.path.insert(0, sys.argv[1])
import softgrain  # noqa: E402

run = softgrain.Run(sys.argv[2])
out = {"status": run.summary["status"], "snapshots": []}
for s in run.snapshots():
    out["snapshots"].append({"series": s.series, "kind": s.kind, "frame": s.frame, "particles": len(s.radius),
                             "walls": len(s.walls["shape"]), "radii": float(s.radius.sum()),
                             "x": float(s.position[:, 0].sum()), "body": int(s.body.sum()), "role": int(s.role.sum()),
                             "contacts": None if s.contacts is None else len(s.contacts),
                             "normal_force": 0.0 if s.contacts is None else float(s.contacts.normal_force.sum()),
                             "force_x": 0.0 if s.contacts is None else float(s.contacts.force[:, 0].sum())})
out["last"] = [s.frame for s in run.snapshots(last=True)]
if Path(sys.argv[2], "measurements.h5").exists():
    out["measured"] = [{"kind": r.kind, "relaxation": r.relaxation, "force": r.force.tolist(),
                        "angles": r.tangential["angle"].tolist(),
                        "turned_converged": r.tangential["converged"].tolist()} for r in run.measurements().runs]
if Path(sys.argv[2], "macro.h5").exists():
    out["macro"] = [{"engine": c.engine, "stress": c["stress_axial"].tolist()} for c in run.macro()]
if Path(sys.argv[2], "law.toml").exists():
    try:
        law = run.law()
        out["law"] = {p.kind: [law.force(d, p.kind, radius=1, modulus=1, beyond="extrapolate") for d in (0.0, 0.5)] for p in law.pairs}
    except ImportError:  # built without the compiled laws
        pass
print("RESULT " + json.dumps(out))
