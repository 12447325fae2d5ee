// Every member of what a crowd run is made of, for the keys of what is kept of it.
#pragma once

#include "microsim/crowd_experiment.h"
#include "pipelines/run/key_text.h"

namespace softgrain {

SOFTGRAIN_EVERY_MEMBER(SoftParticleSpec, shell_radius, youngs_modulus, poisson_ratio, friction, density, restitution,
                       sizes, exponent, polydispersity, rmax_over_shell, beta, trials, placement)
SOFTGRAIN_EVERY_MEMBER(CrowdPartner, kind, ratio, direction, smooth, on)
SOFTGRAIN_EVERY_MEMBER(CrowdStage, move, overlap, slide, roll)
SOFTGRAIN_EVERY_MEMBER(CrowdConfiguration, name, partners, stages, centre_free, held_out, turning)
SOFTGRAIN_EVERY_MEMBER(CrowdOptions, relaxation, increment, tolerance, tolerance_between, max_passes, least_stiffness,
                       approach_speed, step_factor, settle_time)

}  // namespace softgrain
