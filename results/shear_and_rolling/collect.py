#!/usr/bin/env python3
"""Tables of this folder (needs h5py): python3 results/shear_and_rolling/collect.py RUN writes paths.csv of a run of study.toml,
collect.py --depths RUN writes depths.csv of a run of pipelines/law_table.toml. The pages are written by hand."""
import csv
import pathlib
import sys

import h5py
import numpy as np

HERE = pathlib.Path(__file__).parent


def slide_direction(n):
    """As the program has it: the coordinate axis least aligned with n, made perpendicular to it."""
    axis = 0
    for k in range(1, 3):
        if abs(n[k]) < abs(n[axis]):
            axis = k
    along = np.zeros(3)
    along[axis] = 1.0
    along -= n * n.dot(along)
    return along / np.linalg.norm(along)


def turned(n, along, kind, ratio, state):
    """Direction of the first neighbour and of its drag, once it has gone round."""
    angle = state["roll"] / (1.0 - 0.5 * state["overlap"])
    if kind != 0:
        angle += state["slide"] / (1.0 + ratio - state["overlap"])
    return along * np.cos(angle) - n * np.sin(angle)


def load(file):
    """By configuration: list of states, each with overlap, slide, roll, and per packing normal force, drag, moment against rolling."""
    with h5py.File(file) as f:
        count = len(f["configurations/held_out"])
        names = [f["configurations"].attrs[f"name_{k}"].decode() for k in range(count)]
        first = np.concatenate([[0], np.cumsum(f["configurations/partner_count"][:])[:-1]]).astype(int)
        partners = f["configurations/partners"]
        direction = np.stack([partners[f"direction_{c}"][:] for c in "xyz"], 1)
        runs = f["runs"]
        rows = {q: runs[f"neighbours/{q}"][:] for q in ("normal", "overlap")}
        drag = np.stack([runs[f"neighbours/tangential_{c}"][:] for c in "xyz"], 1)
        moment = np.stack([runs[f"moments/moment_{c}"][:] for c in "xyz"], 1)
        points = {q: runs[f"points/{q}"][:] for q in ("slide", "roll", "stage", "neighbours")}
        out = {name: [] for name in names}
        point = row = 0
        for run, length in enumerate(runs["point_count"][:]):
            c = runs["configuration"][run]
            n = direction[first[c]]
            along = slide_direction(n)
            kind, ratio = partners["kind"][first[c]], partners["ratio"][first[c]]
            states = out[names[c]]
            for k in range(length):
                if k == len(states):
                    states.append({"stage": points["stage"][point], "slide": points["slide"][point], "roll": points["roll"][point],
                                   "overlap": rows["overlap"][row], "N": [], "T": [], "M": []})
                s = states[k]
                s["N"].append(rows["normal"][row])
                s["T"].append(-drag[row].dot(turned(n, along, kind, ratio, s)))
                s["M"].append(-moment[row].dot(np.cross(n, along)))
                point, row = point + 1, row + points["neighbours"][point]
        return out


def share(values, normal):
    """Ratio of means with its jackknife error."""
    v, n = np.array(values), np.array(normal)
    count = len(v)
    left = np.array([(v.sum() - a) / (n.sum() - b) for a, b in zip(v, n)])
    return v.sum() / n.sum(), np.sqrt((count - 1) / count * ((left - left.mean()) ** 2).sum())


def line(name, s, before):
    n = np.array(s["N"])
    t, te = share(np.array(s["T"]) - (np.array(before["T"]) if before else 0.0), n)
    m, me = share(np.array(s["M"]) - (np.array(before["M"]) if before else 0.0), n)
    return [name, f"{s['overlap']:.2f}", f"{s['slide']:.3f}", f"{s['roll']:.3f}", f"{n.mean():.5f}", f"{n.std(ddof=1) / len(n) ** 0.5:.5f}",
            f"{t:+.3f}", f"{te:.3f}", f"{m:+.3f}", f"{me:.3f}"]


def write_csv(name, head, rows):
    with open(HERE / name, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([head] + rows)


def paired(state, before):
    """Normal forces, and drags net of what was there before, of the packings that have both."""
    count = min(len(state["T"]), len(before["T"]))
    return np.array(state["N"][:count]), np.array(state["T"][:count]) - np.array(before["T"][:count])


def drag_at(moves, before, slide):
    """T/N, linear between recorded slides."""
    last = (0.0, 0.0, 0.0)
    for s in moves:
        normal, drag = paired(s, before)
        now = (s["slide"], *share(drag, normal))
        if now[0] >= slide:
            part = (slide - last[0]) / (now[0] - last[0])
            return [a + part * (b - a) for a, b in zip(last[1:], now[1:])]
        last = now
    return last[1:]


SLIDES = (np.pi / 180.0, 0.04, 0.08, 0.16, 0.3, 0.6)


def depths(run):
    """Drag of a slide over how deep the neighbour is pressed in."""
    head = ["neighbour", "overlap h [Rs]", "packings", "N [E Rs^2]"]
    for slide in SLIDES:
        head += [f"T/N at a slide of {slide:.3g} Rs", f"T/N at {slide:.3g} Rs: error"]
    head += ["kt h/N", "kt h/N: error", "kt sqrt(h Rs)/N", "kt sqrt(h Rs)/N: error", "N at the end over N"]
    rows = []
    for name, states in load(run / "multi_contact.h5").items():
        moves = [s for s in states if s["slide"]]
        if not moves or not name.endswith("slide"):
            continue
        before = next(s for s in reversed(states) if not s["slide"])
        h = before["overlap"]
        along = [drag_at(moves, before, s) for s in SLIDES]
        stiffness = [x / SLIDES[0] for x in along[0]]
        rows.append([name.rsplit("-", 2)[0], f"{h:.2f}", len(before["N"]), f"{np.mean(before['N']):.5f}"]
                    + [f"{x:.3f}" for drag in along for x in drag] + [f"{x * w:.2f}" for w in (h, h**0.5) for x in stiffness]
                    + [f"{np.mean(moves[-1]['N']) / np.mean(before['N']):.2f}"])
    write_csv("depths.csv", head, rows)


def paths(run):
    rows = []
    for name, states in load(run / "multi_contact.h5").items():
        moves = [s for s in states if s["slide"] or s["roll"]]
        before = next((s for s in reversed(states) if not s["slide"] and not s["roll"]), None)
        if "oblique" in name or not moves:
            rows.append(line(name, states[-1], None))
            continue
        rows.append(line(name, before, None))
        ends = [k for k in range(len(moves)) if k + 1 == len(moves) or moves[k + 1]["stage"] != moves[k]["stage"]]
        middle = [k for k in range(0, len(moves), 2)] if len(ends) == 1 else []
        rows += [line(name, moves[k], before) for k in sorted(set(middle + ends))]
    write_csv("paths.csv", ["path", "overlap h [Rs]", "slide [Rs]", "roll [Rs]", "N [E Rs^2]", "N: error [E Rs^2]", "T/N", "T/N: error", "M/(N Rs)",
                            "M/(N Rs): error"], rows)


def main():
    if sys.argv[1] == "--depths":
        depths(pathlib.Path(sys.argv[2]))
    else:
        paths(pathlib.Path(sys.argv[1]))


if __name__ == "__main__":
    main()
