# A soft particle that bounces on a fixed grain in YADE, with the law of a softgrain card as the contact law.
#
#   yade -n -x pipelines/python/yade_soft_particle.py     SOFTGRAIN_LAW=law.toml names another card
#
# Before forces are computed the normal stiffness of every contact is set to F(h)/h, so that YADE's linear law kn h is exactly F(h).
# What one step costs is one array of overlaps. New contacts begin with next to no stiffness (young, below), and no contact of a soft
# particle has a force at first touch.
import json
import os
import sys

import numpy as np

sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # where the package is in the tree, unless it is installed
import softgrain

law = softgrain.Law.load(os.environ.get("SOFTGRAIN_LAW", "results/published/law.toml"))
MODULUS = law.youngs_modulus  # of the grains inside the soft particle [Pa]
SOFT_RADIUS = law.shell_radius  # [m]
soft_bodies = set()


def soft_law():
    """kn = F(h)/h of every contact with a soft particle; of two the smaller radius counts."""
    contacts = [i for i in O.interactions if i.isReal and (i.id1 in soft_bodies or i.id2 in soft_bodies)]
    if not contacts:
        return
    bodies = [(O.bodies[i.id1], O.bodies[i.id2]) for i in contacts]
    radii = np.array([[a.shape.radius, b.shape.radius] for a, b in bodies])
    distance = np.array([(a.state.pos - b.state.pos).norm() for a, b in bodies])
    soft = np.array([[i.id1 in soft_bodies, i.id2 in soft_bodies] for i in contacts])
    overlap = np.maximum(radii.sum(axis=1) - distance, 0.0)
    radius = np.where(soft, radii, np.inf).min(axis=1)
    force = np.zeros(len(contacts))
    for kind, chosen in (("soft-soft", soft.all(axis=1)), ("soft-solid", ~soft.all(axis=1))):
        delta = overlap[chosen] / radius[chosen]
        force[chosen] = MODULUS * radius[chosen]**2 * law.force(delta, kind, radius=1.0, modulus=1.0)
    stiffness = np.divide(force, overlap, out=np.zeros_like(force), where=overlap > 0.0)
    for contact, kn in zip(contacts, stiffness):
        contact.phys.kn = float(kn)
        contact.phys.ks = 0.0


def put(position, radius, fixed, soft):
    """A sphere; a soft one feels the law."""
    number = O.bodies.append(sphere(position, radius, material=0, fixed=fixed))
    if soft:
        soft_bodies.add(number)
    return number


O.materials.append(FrictMat(young=1e-6, poisson=0.3, density=1775.0, frictionAngle=0.0))
put((0, 0, 0), 0.01, True, False)
moving = put((0, 0, 0.01 + SOFT_RADIUS), SOFT_RADIUS, False, True)
O.bodies[moving].state.vel = (0, 0, -0.4)
record = []


def note():
    """Overlap over the radius, force as YADE sees it, speed."""
    for i in O.interactions:
        if i.isReal:
            record.append((i.geom.penetrationDepth / SOFT_RADIUS, i.phys.normalForce.norm(), O.bodies[moving].state.vel[2]))


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    PyRunner(command="soft_law()", iterPeriod=1),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()], [Law2_ScGeom_FrictPhys_CundallStrack()]),
    PyRunner(command="note()", iterPeriod=1),
    NewtonIntegrator(damping=0.0),
]
O.dt = 2e-5
O.run(int(0.04 / O.dt), True)
delta, force, speed = np.array(record).T
expected = law.force(delta, "soft-solid")
print("YADE " + json.dumps({
    "contacts": len(record),
    "largest_delta": float(delta.max()),
    "largest_force": float(force.max()),
    "largest_difference": float(np.abs(force - expected).max()),
    "speed_after": float(O.bodies[moving].state.vel[2]),
}), flush=True)
os._exit(0)  # YADE's own way out can hang without a terminal
