// Every member of what a multi-contact run is made of, for the keys of what is kept of it.
#pragma once

#include "microsim/multi_contact_experiment.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

SOFTGRAIN_EVERY_MEMBER(SoftParticleSpec, shell_radius, youngs_modulus, poisson_ratio, friction, density, restitution,
                       sizes, exponent, polydispersity, rmax_over_shell, beta, trials, placement)
SOFTGRAIN_EVERY_MEMBER(MultiContactPartner, kind, ratio, direction, smooth, on)
SOFTGRAIN_EVERY_MEMBER(MultiContactStage, move, overlap, slide, roll)
SOFTGRAIN_EVERY_MEMBER(MultiContactConfiguration, name, partners, stages, centre_free, held_out, turning)
SOFTGRAIN_EVERY_MEMBER(MultiContactOptions, relaxation, increment, tolerance, tolerance_between, max_passes,
                       least_stiffness, approach_speed, step_factor, settle_time)

}  // namespace softgrain
