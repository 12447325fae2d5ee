#!/usr/bin/env python3
"""Stress tests of numerical stability: study.py PROGRAM [--quick] [--table cases.csv]. Standard library only.

Every case is a scene that is run by the program, and a closed form or a rule that its outcome is held against. A case ends
in one of four ways: "held" (good, and within the stated error), "refused" (exit status 2 before any work), "stopped" (exit
status 3: a guard or the residual said so, and the summary says why), or "WRONG" (good status and a wrong number, not a
number, a crash, a hang). The study fails when a case is WRONG or ends otherwise than the case says it should.
--quick leaves out what takes long; it is a test of the default suite. --table writes one row per case as CSV; README.md is
written by hand.
"""
import argparse
import csv
import gzip
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time

BETA = 2.943275109  # contact time of elastic spheres over overlap/speed: 2 times the integral of 1/sqrt(1 - x^2.5)


def run(program, scene, directory, command="microsim", more=(), limit=600, threads=1):
    """Exit status, summary (None when there is none) and what was said."""
    path = os.path.join(directory, "scene.toml")
    with open(path, "w") as f:
        f.write(scene)
    out = os.path.join(directory, "run")
    words = [program, command, path, "--out", out, "--quiet", "--threads", str(threads), *more]
    start = time.time()
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return None, None, f"no end after {limit} s", time.time() - start
    summary = None
    if os.path.exists(os.path.join(out, "summary.json")):
        with open(os.path.join(out, "summary.json")) as f:
            text = f.read()
        if "NaN" in text or "Infinity" in text:
            return -1, None, "not a number in the summary", time.time() - start
        summary = json.loads(text)
    return done.returncode, summary, (done.stderr + done.stdout).strip(), time.time() - start


class Outcome:
    def __init__(self, kind, text, error=None):
        self.kind, self.text, self.error = kind, text, error


def judge(status, summary, said, check, bound):
    """`check(summary)` gives the relative error of a good run."""
    if status == 2:
        return Outcome("refused", said.splitlines()[-1] if said else "")
    if status == 3 and summary is not None:
        reason = summary.get("reason") or "; ".join(summary.get("remarks", []))
        return Outcome("stopped" if reason else "WRONG", reason or "no reason given")
    if status != 0 or summary is None:
        return Outcome("WRONG", f"exit status {status}: {said[-300:]}")
    error = check(summary)
    if error is None or error != error or error > bound:
        return Outcome("WRONG", f"status good, error {error} above {bound}", error)
    remarks = "; ".join(summary.get("remarks", []))
    return Outcome("held", remarks, error)


# Scenes ------------------------------------------------------------------------------------------------------------------

def particle(r, x, v, material="a", spin=(0, 0, 0)):
    three = lambda t: "[" + ", ".join(repr(float(c)) for c in t) + "]"
    return (f"[[particle]]\nmaterial = \"{material}\"\nradius = {r!r}\nposition = {three(x)}\nvelocity = {three(v)}\n"
            f"spin = {three(spin)}\n")


def material(name, E, nu, density):
    return f"[material.{name}]\nE = {E!r}\nnu = {nu!r}\ndensity = {density!r}\n"


def contact(a, b, e, mu, more=""):
    return f"[[contact]]\npair = [\"{a}\", \"{b}\"]\nlaw = \"hertz-tsuji\"\nrestitution = {e!r}\nmu = {mu!r}\n{more}"


class Impact:
    """Head-on impact of two elastic spheres; all numbers from Hertz."""

    def __init__(self, E=1e7, nu=0.25, density=(2500.0, 2500.0), radius=(0.01, 0.01), speed=0.1, offset=0.0, e=1.0, step="auto",
                 overlap=None, fraction=None, guards="", longer=1.2):
        self.speed = speed
        m = [4 / 3 * math.pi * r**3 * d for r, d in zip(radius, density)]
        self.m = m[0] * m[1] / (m[0] + m[1])
        self.R = radius[0] * radius[1] / (radius[0] + radius[1])
        self.Estar = E / (2 * (1 - nu * nu))
        self.k = 4 / 3 * self.Estar * math.sqrt(self.R)
        self.overlap_max = (1.25 * self.m * speed**2 / self.k) ** 0.4
        self.force = self.k * self.overlap_max**1.5
        self.duration = BETA * self.overlap_max / speed
        self.energy = 0.5 * self.m * speed**2
        gap = 0.02 * self.overlap_max if overlap is None else -overlap
        self.stored = 0.0 if overlap is None else 0.4 * self.k * overlap**2.5
        v = speed if overlap is None else 0.0
        # in the frame where the total momentum is zero
        v0, v1 = v * m[1] / (m[0] + m[1]), -v * m[0] / (m[0] + m[1])
        scale = self.duration if overlap is None else self.k and math.pi * math.sqrt(self.m / (1.5 * self.k * math.sqrt(overlap)))
        end = longer * self.duration + gap / speed if overlap is None else 3 * scale
        self.masses = m
        self.scene = ("kind = \"particles\"\n" + material("a", E, nu, density[0]) + material("b", E, nu, density[1]) +
                      contact("a", "b", e, 0.3) +
                      particle(radius[0], (offset, offset, offset), (v0, 0, 0), "a") +
                      particle(radius[1], (offset + radius[0] + radius[1] + gap, offset, offset), (v1, 0, 0), "b") +
                      f"[time]\nend = {end!r}\n" + (f"step = {step!r}\n" if step != "auto" else "step = \"auto\"\n") +
                      (f"step_fraction = {fraction!r}\n" if fraction else "") + guards)

    def relative_speed(self, s):
        a, b = s["particles"]
        return b["velocity"][0] - a["velocity"][0]

    def error(self, s):
        """Largest of: force, overlap, duration, speed after."""
        if not s["contacts"]:
            return math.inf
        c = s["contacts"][0]
        return max(abs(c["max_force"] / self.force - 1), abs(c["max_overlap"] / self.overlap_max - 1),
                   abs(c["duration"] / self.duration - 1), abs(self.relative_speed(s) / self.speed - 1))

    def restitution(self, s):
        return self.relative_speed(s) / self.speed

    def release_error(self, s):
        """What was stored in the overlap is motion at the end."""
        return abs(math.sqrt(0.5 * self.m * self.relative_speed(s) ** 2 / self.stored) - 1)


def sliding(mu, e=0.5):
    """A ball set sliding at u0 on a plane rolls after 2 u0/(7 mu g) at 5 u0/7."""
    R, E, nu, rho, g, u0 = 0.01, 1e7, 0.25, 2500.0, 9.81, 0.1
    mass = 4 / 3 * math.pi * R**3 * rho
    k = 4 / 3 * E / (2 * (1 - nu * nu)) * math.sqrt(R)
    rest = (mass * g / k) ** (2 / 3)
    stop = 2 * u0 / (7 * mu * g) if mu > 0 else 0.05
    end = max(1.5 * stop, 0.02)
    scene = ("kind = \"particles\"\ngravity = [0.0, 0.0, -9.81]\n" + material("a", E, nu, rho) + contact("a", "a", e, mu) +
             particle(R, (0, 0, R - rest), (u0, 0, 0)) +
             "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"a\"\n" +
             f"[time]\nend = {end!r}\nstep = \"auto\"\n")
    want = 5 * u0 / 7 if mu > 0 else u0

    def check(s):
        p = s["particles"][0]
        return max(abs(p["velocity"][0] / want - 1), abs(p["spin"][1] * R / want - 1) if mu > 0 else abs(p["spin"][1] * R / u0))
    return scene, check


def pushed(V, step="auto"):
    """A plane that moves at V hits a ball at rest: it leaves at 2 V."""
    R, E, nu, rho = 0.01, 1e7, 0.25, 2500.0
    mass = 4 / 3 * math.pi * R**3 * rho
    k = 4 / 3 * E / (2 * (1 - nu * nu)) * math.sqrt(R)
    h = (1.25 * mass * V * V / k) ** 0.4
    end = 1.2 * BETA * h / V + 0.05 * h / V
    scene = ("kind = \"particles\"\n" + material("a", E, nu, rho) + contact("a", "a", 1.0, 0.3) +
             particle(R, (0, 0, R + 0.02 * h), (0, 0, 0)) +
             "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"a\"\n"
             f"motion = \"velocity\"\nvelocity = [0.0, 0.0, {V!r}]\n[time]\nend = {end!r}\nstep = \"auto\"\n")
    return scene, lambda s: abs(s["particles"][0]["velocity"][2] / (2 * V) - 1)


def settled(count, ratio, seed=1, mu=0.5):
    """Grains of two sizes fall onto a plane inside four walls; see at_rest()."""
    R, E, nu, rho, g = 0.01, 1e6, 0.25, 2500.0, 9.81
    r = R / ratio
    side = 4.4 * R
    text = ("kind = \"particles\"\ngravity = [0.0, 0.0, -9.81]\n" + material("a", E, nu, rho) + contact("a", "a", 0.3, mu))
    walls = [((0, 0, 0), (0, 0, 1)), ((-side / 2, 0, 0), (1, 0, 0)), ((side / 2, 0, 0), (-1, 0, 0)),
             ((0, -side / 2, 0), (0, 1, 0)), ((0, side / 2, 0), (0, -1, 0))]
    for point, normal in walls:
        text += (f"[[wall]]\nshape = \"plane\"\npoint = {list(map(float, point))}\nnormal = {list(map(float, normal))}\n"
                 "material = \"a\"\n")
    import random
    rng = random.Random(seed)
    for k in range(4):
        text += particle(R, ((k % 2 - 0.5) * 2.1 * R, (k // 2 - 0.5) * 2.1 * R, 1.02 * R), (0, 0, 0))
    placed = 0
    layer = 2.2 * R + r
    while placed < count:
        per = max(1, int(side / (2.4 * r)))
        for a in range(per):
            for b in range(per):
                if placed == count:
                    break
                x = -side / 2 + 1.2 * r + a * 2.4 * r + 0.1 * r * rng.random()
                y = -side / 2 + 1.2 * r + b * 2.4 * r + 0.1 * r * rng.random()
                text += particle(r, (x, y, layer), (0, 0, 0))
                placed += 1
        layer += 2.4 * r
    return text


SETTLED = "kinetic energy over weight times radius of the large grains (4 of them); escapes and growing energy stop a run"


def at_rest(count, ratio):
    """Kinetic energy of settled() at the end over its weight times the large radius."""
    R, rho, g = 0.01, 2500.0, 9.81
    weight = rho * g * 4 / 3 * math.pi * R**3 * (4 + count / ratio**3)

    def check(s):
        return s["kinetic_energy"] / (weight * R) if s["guards"]["energy"]["watched"] else math.inf
    return check


def lattice(overlap, step):
    """108 grains on a face-centred lattice, compressed by `overlap` radii, one of them moving: energy is kept."""
    R, E = 0.01, 1e6
    a = (2 - overlap) * R * math.sqrt(2)
    text = ("kind = \"particles\"\n" + material("a", E, 0.2, 2500.0) + contact("a", "a", 1.0, 0.3, "tangential = \"rescaled\"\n") +
            f"[cell]\nsize = [{3 * a!r}, {3 * a!r}, {3 * a!r}]\nperiodic = [true, true, true]\n[time]\nsteps = 3000\nstep = {step!r}\n"
            "[output]\nrecord = false\n")
    for n in range(27):
        for b in ((0, 0, 0), (.5, .5, 0), (.5, 0, .5), (0, .5, .5)):
            x = [a * (c + d) for c, d in zip((n % 3, n // 3 % 3, n // 9), b)]
            text += particle(R, x, (0.01, 0.02, 0.03) if n == 0 and b == (0, 0, 0) else (0, 0, 0))
    return text, lambda s: s["guards"]["energy"]["worst"]


# Cases -------------------------------------------------------------------------------------------------------------------

class Case:
    """`allowed`: how it may end. `bound`: of the relative error when it holds."""

    def __init__(self, axis, value, scene, check, bound, allowed=("held",), command="microsim", quick=True, more=(), limit=600,
                 quantity=""):
        self.axis, self.value, self.scene, self.check, self.bound = axis, value, scene, check, bound
        self.allowed, self.command, self.quick, self.more, self.limit = allowed, command, quick, more, limit
        self.quantity = quantity
        self.outcome, self.seconds = None, 0.0


HERTZ = "largest of the errors of force, overlap, duration and speed of a Hertz impact"


def cases():
    out = []
    base = Impact()

    # Step: the natural time that limits are given in is said by the program; fractions of it.
    # "auto" never takes fewer than 200 steps per impact; a step in seconds may, up to 0.6 sqrt(m/k) at a stiffness of
    # five percent of overlap.
    for f in (0.005, 0.05, 0.6):
        i = Impact(fraction=f)
        out.append(Case("step_fraction of step = \"auto\"", f, i.scene, i.error, 1e-4, quantity=HERTZ))
    for f in (0.61, 100.0):
        i = Impact(fraction=f)
        out.append(Case("step_fraction of step = \"auto\"", f, i.scene, i.error, 0.0, ("refused",), quantity=HERTZ))
    for steps in (1000, 200, 50, 20, 10, 7, 6, 3, 1):
        i = Impact(step=base.duration / steps)
        out.append(Case("steps per impact, slow: limit at 7", steps, i.scene, i.error, 0.05, ("held",) if steps >= 7 else ("refused",),
                        quantity=HERTZ))
    fast = Impact(speed=5.0)  # overlaps of a fifth of the radius: stiffer than what the limit of the step is taken at
    for steps in (200, 50, 20, 10, 8, 6, 5, 4, 3):
        i = Impact(speed=5.0, step=fast.duration / steps)
        out.append(Case("steps per impact, fast (overlap 0.2 R)", steps, i.scene, lambda s, i=i: abs(i.restitution(s) - 1), 0.05,
                        ("held",) if steps >= 10 else ("held", "stopped", "refused"), quantity="error of the speed after an elastic impact"))

    for step in (1.5e-4, 3e-4, 6e-4, 9e-4, 1.1e-3, 1.3e-3, 1.48e-3):
        scene, check = lattice(0.4, step)
        out.append(Case("step [s] of a lattice compressed by 0.4 R (limit for one contact 1.5e-3)", step, scene, check, 0.05,
                        ("held",) if step <= 3e-4 else ("refused",), quantity="growth of energy over what is stored"))

    for power in range(3, 21):
        E = 10.0**power
        # the same overlap over radius everywhere: the speed grows with sqrt(E)
        i = Impact(E=E, speed=0.1 * math.sqrt(E / 1e7))
        out.append(Case("E [Pa], same overlap", f"1e{power}", i.scene, i.error, 2e-4, quick=power % 4 == 0 or power == 3,
                        quantity=HERTZ))
    for power in (3, 6, 10, 14, 20):
        i = Impact(E=10.0**power, speed=0.01)
        out.append(Case("E [Pa], same speed 0.01 m/s", f"1e{power}", i.scene, i.error, 2e-4, quantity=HERTZ))

    for ratio in (1, 10, 100, 1000, 1e4):
        i = Impact(radius=(0.01, 0.01 / ratio))
        out.append(Case("size ratio of an impact", ratio, i.scene, i.error, 3e-4, quantity=HERTZ))
    for ratio in (1e-6, 1e-3, 1.0, 1e3, 1e6):
        i = Impact(density=(2500.0, 2500.0 * ratio))
        out.append(Case("density ratio", ratio, i.scene, i.error, 3e-4, quantity=HERTZ))

    for mu in (0.0, 0.001, 0.1, 1.0, 3.0, 10.0):
        scene, check = sliding(mu)
        out.append(Case("mu of a ball that slides and then rolls", mu, scene, check, 2e-3, quick=mu != 0.001,
                        quantity="error of speed and spin in the end (5/7 of the start)"))

    for e in (0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0):
        i = Impact(e=e, longer=1.2 if e > 0.3 else 5.0 if e > 0.0 else 200.0)
        out.append(Case("restitution", e, i.scene, lambda s, i=i, e=e: abs(i.restitution(s) - e), 2e-3,
                        quantity="restitution that comes out minus the one asked for"))

    for h in (1e-6, 1e-3, 0.1, 0.5, 1.0, 1.9):
        i = Impact(radius=(0.01, 0.002), overlap=h * 0.002)
        out.append(Case("overlap at the start, over the smaller radius (5 times smaller)", h, i.scene, i.release_error, 2e-3,
                        quantity="error of the speed at which the spheres part (what was stored becomes motion)"))

    for offset in (0.0, 1.0, 1e3, 1e6, 1e9, 1e12):
        i = Impact(offset=offset)
        allowed = ("held",) if offset < 1e5 else ("held", "refused") if offset < 1e8 else ("refused",)
        out.append(Case("distance from the origin [m], radius 0.01 m", offset, i.scene, i.error, 1e-3, allowed, quantity=HERTZ))

    for V in (1e-6, 1e-3, 1.0, 10.0, 100.0, 1e4):
        scene, check = pushed(V)
        allowed = ("held",) if V <= 10.0 else ("held", "stopped", "refused")
        out.append(Case("speed of a wall that hits a ball [m/s]", V, scene, check, 1e-3, allowed,
                        quantity="error of the speed of the ball (twice the wall's)"))

    # Nobody, one alone.
    none = "kind = \"particles\"\n" + material("a", 1e7, 0.25, 2500.0) + contact("a", "a", 0.5, 0.3) + "[time]\nend = 1.0\nstep = 1e-4\n"
    out.append(Case("number of grains", 0, none, lambda s: float(s["particle_count"]), 0.0, ("held", "refused"), quantity="-"))
    one = none + particle(0.01, (0, 0, 0), (1.0, 0, 0))
    out.append(Case("number of grains", 1, one, lambda s: abs(s["particles"][0]["position"][0] - 1.0), 1e-9,
                    quantity="position after free flight"))

    for ratio, count in ((2, 60), (10, 300), (50, 300)):
        text = settled(count, ratio) + "[time]\nend = 0.4\nstep = \"auto\"\n[output]\nrecord = false\n"
        out.append(Case("size ratio of grains that settle in a box", ratio, text, at_rest(count, ratio), 0.02, quick=ratio == 2,
                        limit=900, quantity=SETTLED))

    for mu in (0.0, 0.5, 10.0):
        text = settled(60, 2, mu=mu) + "[time]\nend = 0.4\nstep = \"auto\"\n[output]\nrecord = false\n"
        out.append(Case("mu of grains that settle in a box", mu, text, at_rest(60, 2), 0.02, quick=False, quantity=SETTLED))
    return out


def soft_cases():
    """Soft particles: overlaps to half the shell, shells almost full and almost empty."""
    def scene(deltas, beta=3.0, trials=1000, rmax=0.5, polydispersity=3.0):
        return ("kind = \"soft-particle\"\nseed = 3\n[packing]\nshell_radius = \"16 mm\"\nexponent = 3.5\n"
                f"polydispersity = {polydispersity!r}\nrmax_over_shell = {rmax!r}\nbeta = {beta!r}\ntrials = {trials}\ncount = 2\n"
                f"[measure.soft_solid]\ndeltas = {deltas}\n")
    def grows(s):
        forces = [p["force"] for p in s["forces"]["soft-solid"]]
        return 0.0 if all(a <= b for a, b in zip(forces, forces[1:])) else 1.0
    out = [Case("Delta of a soft particle on a plane", d, scene([0.05, 0.15, d]), grows, 0.5, ("held", "stopped"), quantity="every point converges, the force grows with Delta",
                quick=d == 0.3) for d in (0.3, 0.4, 0.5)]
    for beta, trials in ((0.5, 100), (1.01, 1), (1.1, 10), (1.1, 1000), (3.0, 10000), (6.0, 100000)):
        out.append(Case("grains drawn for a shell (beta, trials)", f"{beta} and {trials}", scene([0.05, 0.15, 0.25], beta, trials), grows, 0.5,
                        ("held", "stopped", "refused"), quick=False, quantity="every point converges, the force grows with Delta"))
    out.append(Case("one grain in its shell (rmax over shell)", 0.95, scene([0.05, 0.15], 1.1, 100, 0.95, 1.05), grows, 0.5,
                    ("held", "stopped", "refused"), quantity="every point converges, the force grows with Delta"))
    return out


def million(program, directory):
    """1e6 grains of a loose lattice with random speeds: memory, and that they run."""
    path = os.path.join(directory, "million.xyzr.gz")
    import random
    rng = random.Random(5)
    with gzip.open(path, "wt", compresslevel=1) as f:
        f.write("1000000 2.1 2.1 2.1\n")
        for a in range(100):
            for b in range(100):
                f.writelines(f"{0.021 * a + 1e-3 * rng.random():.7f} {0.021 * b:.7f} {0.021 * c + 1e-3 * rng.random():.7f} 0.01\n"
                             for c in range(100))
    scene = ("kind = \"particles\"\ngravity = [0.0, 0.0, -9.81]\n" + material("a", 1e7, 0.25, 2500.0) + contact("a", "a", 0.5, 0.3) +
             f"[particles]\nfile = \"{path}\"\nmaterial = \"a\"\n"
             "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, -0.01]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"a\"\n"
             "[time]\nsteps = 100\nstep = \"auto\"\n[output]\nrecord = false\n")
    case = Case("number of grains", 1000000, scene, lambda s: 0.0 if s["particle_count"] == 1000000 else 1.0, 0.5, limit=1200,
                quantity="-")
    return case


def oversubscribed(program, directory):
    """More threads than cores: the same bits."""
    text = settled(60, 2) + "[time]\nend = 0.05\nstep = \"auto\"\n[output]\nrecord = false\n"
    states, seconds = [], []
    for threads in (1, 2, 16, 64):
        status, summary, said, used = run(program, text, directory, threads=threads)
        if status != 0:
            return Outcome("WRONG", f"{threads} threads: exit status {status}: {said[-200:]}")
        states.append(summary["particles"])
        seconds.append(used)
    same = all(s == states[0] for s in states)
    return Outcome("held" if same else "WRONG", "1, 2, 16, 64 threads: " + ("the same bits" if same else "other bits") +
                   ", " + ", ".join(f"{t:.1f}" for t in seconds) + " s", 0.0)


# Table -------------------------------------------------------------------------------------------------------------------

def row(case):
    o = case.outcome
    message = re.sub(r"[^\s(]*/scene\.toml", "scene.toml", o.text).replace("softgrain: ", "").replace("\n", " ")
    message = message if len(message) < 220 else message[:217] + "..."
    return (case.axis, plain(case.value), o.kind, "" if o.error is None else f"{o.error:.1e}",
            "" if case.quantity == "-" else case.quantity, message)


def plain(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def write_table(done, path):
    with open(path, "w", newline="") as f:
        head = ("varied", "value", "outcome", "error [-]", "what the error is of", "message")
        csv.writer(f, lineterminator="\n").writerows([head, *map(row, done)])


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("--quick", action="store_true")
    arguments.add_argument("--table")
    arguments.add_argument("--only", default="")
    o = arguments.parse_args()
    program = os.path.abspath(o.program)
    done, failed = [], 0
    with tempfile.TemporaryDirectory() as directory:
        everything = cases() + soft_cases()
        if not o.quick:
            everything.append(million(program, directory))
        for n, case in enumerate(everything):
            if (o.quick and not case.quick) or o.only not in case.axis:
                continue
            place = os.path.join(directory, str(n))
            os.mkdir(place)
            status, summary, said, case.seconds = run(program, case.scene, place, case.command, case.more, case.limit)
            case.outcome = judge(status, summary, said, case.check, case.bound)
            wrong = case.outcome.kind not in case.allowed
            failed += wrong
            done.append(case)
            print(f"{'WRONG ' if wrong else ''}{case.axis} = {case.value}: {case.outcome.kind}"
                  f"{'' if case.outcome.error is None else f' ({case.outcome.error:.2e})'}, {case.seconds:.1f} s  {case.outcome.text[:160]}",
                  flush=True)
        if o.only in "threads":
            threads = Case("threads on two cores", "1, 2, 16, 64", "", None, 0.0, quantity="the same bits")
            threads.outcome = oversubscribed(program, directory)
            failed += threads.outcome.kind != "held"
            done.append(threads)
            print("threads:", threads.outcome.kind, threads.outcome.text)
    if o.table:
        write_table(done, o.table)
    print(f"{len(done)} cases, {failed} not as they should be")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
