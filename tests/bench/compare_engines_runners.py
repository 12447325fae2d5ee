"""The engines that compare_engines runs: each takes a scene and returns what it measured."""

import gzip
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKINGS = HERE.parent / "reference" / "bench"


class Scene:
    """One packing, held or sheared. Neighbour settings are the best found for LAMMPS on each packing."""

    PACKING = {  # step [s], shear rate [1/s], skin over smallest radius, search, upper diameters of the size classes [m]
        "A": (0.05, 2e-3, 0.25, "bin", ""),
        "B": (0.005, 1e-2, 0.8, "multi", "4 0.3 0.5 1.0 2.01"),
        "C": (0.001, 2e-2, 1.2, "multi", "5 0.09 0.2 0.42 0.92 2.01"),
    }

    def __init__(self, name, steps, warm_up):
        self.name, self.steps, self.warm_up = name, steps, warm_up
        packing, kind = name.split("_")
        self.step, rate, skin, self.search, self.classes = self.PACKING[packing]
        self.rate = rate if kind == "shear" else 0.0
        self.smallest = self.step / 0.05
        self.skin = skin * self.smallest
        self.packing = PACKINGS / f"{packing}.xyzr.gz"
        self.toml = HERE / "scenes" / f"{name}.toml"

    @classmethod
    def names(cls):
        return [f"{packing}_{kind}" for packing in cls.PACKING for kind in ("hold", "shear")]


class Failed(Exception):
    """An engine that is there but did not deliver."""


def run(command, cores, environment=None, directory=None):
    """Runs on the given cores; returns standard output and the peak memory of the process [bytes]."""
    if shutil.which("taskset"):
        command = ["taskset", "-c", cores] + command
    process = subprocess.Popen(
        command, env={**os.environ, **(environment or {})}, cwd=directory, text=True,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise Failed(f"{' '.join(map(str, command))}: status {process.returncode}\n{output[-2000:]}")
    return output, 1024 * usage.ru_maxrss


class BusyCore:
    """A program that keeps a core busy while others are measured."""

    def __init__(self, core):
        command = [sys.executable, "-c", "while True: pass"]
        self.process = subprocess.Popen((["taskset", "-c", str(core)] if shutil.which("taskset") else []) + command)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()


class Softgrain:
    law = "tsuji"  # Hertz with the damping of Tsuji et al.

    def __init__(self, program, threads=1):
        self.name = "softgrain" if threads == 1 else f"softgrain, {threads} threads"
        self.program, self.threads = str(program), threads

    def missing(self):
        return "" if Path(self.program).is_file() else f"{self.program} is not built"

    def command(self, scene, directory):
        return [self.program, "microsim", str(scene.toml), "--json", "--quiet", "--threads", str(self.threads),
                "--out", str(directory / "run"), "--set", f"time.steps={scene.warm_up + scene.steps}",
                "--set", f"time.warm_up_steps={scene.warm_up}"]

    def measure(self, scene, directory, cores):
        output, memory = run(self.command(scene, directory), cores)
        summary = json.loads(output)
        cost, state = summary["cost"], summary["contact_state"]
        return {"grains": summary["particle_count"], "seconds": cost["measured"]["seconds"],
                "cpu_seconds": cost["measured"]["cpu_seconds"],
                "contacts": state["contacts"], "pressure": state["pressure"],
                "coordination_number": state["coordination_number"], "peak_memory": memory,
                "rebuilds": cost["measured"]["rebuilds"], "listed_pairs": cost["listed_pairs"],
                "contact_evaluations": cost["measured"]["contact_evaluations"]}


class Lammps:
    """On ranks, each of so many threads of its OPENMP package (0: without the package)."""

    def __init__(self, style, ranks=1, omp=0):
        self.ranks, self.omp = ranks, omp
        self.style, self.threads = style, ranks * max(omp, 1)
        parts = ([f"{ranks} ranks"] if ranks > 1 else []) + ([f"{omp} OpenMP threads"] if omp > 0 else [])
        self.name = ", ".join([f"LAMMPS {style}", *parts])
        self.law = "tsuji" if style == "granular" else "classic"  # the classic law damps otherwise

    def missing(self):
        if not shutil.which("lmp"):
            return "LAMMPS is not installed (package lammps)"
        if self.omp > 0 and not self.has_openmp():
            return "this LAMMPS was built without its OPENMP package"
        return "" if self.ranks == 1 or shutil.which("mpirun") else "mpirun is not installed (package openmpi-bin)"

    @staticmethod
    def has_openmp():
        listed = subprocess.run(["lmp", "-h"], capture_output=True, text=True, stdin=subprocess.DEVNULL).stdout
        return bool(re.search(r"\b(OPENMP|USER-OMP)\b", listed))

    def launcher(self):
        """Ranks share the cores that the whole command is given."""
        if self.ranks == 1:
            return []
        return ["mpirun", "-np", str(self.ranks), "--bind-to", "none", "--oversubscribe"]

    def environment(self):
        return {"OMP_NUM_THREADS": str(max(self.omp, 1)), "OMPI_ALLOW_RUN_AS_ROOT": "1",
                "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}

    @staticmethod
    def write_data(scene, path):
        """The packing as LAMMPS reads it; a sheared cell is triclinic from the start."""
        with gzip.open(scene.packing, "rt") as lines, open(path, "w") as out:
            count, *box = next(lines).split()
            out.write(f"packing\n\n{count} atoms\n1 atom types\n\n")
            out.writelines(f"0 {length} {axis}lo {axis}hi\n" for length, axis in zip(box, "xyz"))
            out.write(("0 0 0 xy xz yz\n" if scene.rate else "") + "\nAtoms # sphere\n\n")
            for number, line in enumerate(lines, 1):
                x, y, z, r = line.split()
                out.write(f"{number} 1 {2 * float(r):.12g} 2500 {x} {y} {z}\n")

    def measure(self, scene, directory, cores):
        data = directory / f"{scene.name}.data"
        if not data.exists():
            self.write_data(scene, data)
        values = {"data": data, "law": self.style, "rate": scene.rate, "step": scene.step, "warm_up": scene.warm_up,
                  "steps": scene.steps, "skin": scene.skin, "search": scene.search, "classes": scene.classes or "0"}
        command = self.launcher() + ["lmp", "-in", str(HERE / "compare_engines_lammps.in"), "-log", "none"]
        if self.omp > 0:
            command += ["-sf", "omp", "-pk", "omp", str(self.omp)]
        for key, value in values.items():
            command += ["-var", key, str(value)]
        output, memory = run(command, cores, self.environment(), directory)
        return {**self.read(output), "peak_memory": memory * self.ranks}  # of the largest rank, times ranks

    @staticmethod
    def read(output):
        loop = re.findall(r"Loop time of (\S+) on \d+ procs for \d+ steps with (\d+) atoms", output)
        pair = re.findall(r"^Pair\s+\|\s*\S+\s*\|\s*(\S+)", output, re.M)
        rows = re.findall(r"^\s*\d+\s+(\S+)\s+(\S+)\s*$", output, re.M)
        use = re.findall(r"^(\S+)% CPU use", output, re.M)
        rebuilds = re.findall(r"Neighbor list builds = (\d+)", output)
        if not (loop and pair and rows and use):
            raise Failed("no timing in the output of LAMMPS:\n" + output[-2000:])
        seconds, grains = float(loop[-1][0]), int(loop[-1][1])
        pressure, coordination = map(float, rows[-1])
        return {"grains": grains, "seconds": seconds, "cpu_seconds": 0.01 * float(use[-1]) * seconds,
                "force_share": float(pair[-1]) / seconds, "pressure": pressure, "coordination_number": coordination, "contacts": round(coordination * grains / 2), "rebuilds": int(rebuilds[-1]) if rebuilds else None}


class Yade:
    name = "YADE"
    law = "tsuji"

    def missing(self):
        return "" if shutil.which("yade") else "YADE is not installed (package yade)"

    def measure(self, scene, directory, cores):
        environment = {"BENCH_PACKING": str(scene.packing), "BENCH_RATE": str(scene.rate), "BENCH_STEP": str(scene.step),
                       "BENCH_STEPS": str(scene.steps), "BENCH_WARM_UP": str(scene.warm_up), "OMP_NUM_THREADS": "1"}
        script = str(HERE / "compare_engines_yade.py")
        output, memory = run(["yade", "-x", "-n", "-j1", script], cores, environment, directory)
        found = re.search(r"^BENCH (\{.*\})", output, re.M)
        if not found:
            raise Failed("no result in the output of YADE:\n" + output[-2000:])
        with gzip.open(scene.packing, "rt") as lines:
            grains = int(next(lines).split()[0])
        result = json.loads(found.group(1))
        return {**result, "grains": grains, "coordination_number": 2 * result["contacts"] / grains,
                "peak_memory": memory}
