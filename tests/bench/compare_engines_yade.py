# One packing in YADE: warm up, then a timed run; prints one line of JSON. Runs inside YADE (yade -x -n -j1 THIS), which
# provides O, sphere and the engines; compare_engines passes everything through the environment.
import gzip
import json
import os
import time
from math import atan

packing = os.environ["BENCH_PACKING"]
rate = float(os.environ["BENCH_RATE"])
steps = int(os.environ["BENCH_STEPS"])
warm_up = int(os.environ["BENCH_WARM_UP"])

with gzip.open(packing, "rt") as lines:
    head = next(lines).split()
    rows = [tuple(map(float, line.split())) for line in lines]
O.periodic = True
O.cell.setBox(*map(float, head[1:4]))
grain = O.materials.append(FrictMat(young=5e5, poisson=0.3, density=2500, frictionAngle=atan(0.3)))
O.bodies.append([sphere((x, y, z), r, material=grain) for x, y, z, r in rows])
O.engines = [
    ForceResetter(),
    # A negative distance is a fraction of the smallest radius.
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=-0.3),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()],
        [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.5, es=0.5)],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
    NewtonIntegrator(damping=0.0),
]
O.dt = float(os.environ["BENCH_STEP"])
O.cell.velGrad = Matrix3(0, rate, 0, 0, 0, 0, 0, 0, 0)
O.run(warm_up, True)
start, cpu_start = time.perf_counter(), time.process_time()
O.run(steps, True)
seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
stress = getStress()
print("BENCH " + json.dumps({
    "seconds": seconds,
    "cpu_seconds": cpu_seconds,
    "contacts": O.interactions.countReal(),
    "pressure": -(stress[0][0] + stress[1][1] + stress[2][2]) / 3,
}), flush=True)
os._exit(0)  # YADE's own way out can hang without a terminal
