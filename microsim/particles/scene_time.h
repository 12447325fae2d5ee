// The time step of a scene: what is stable, what resolves an impact, what the scene asks for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "common/system.h"

namespace softgrain {

struct SceneTime {
  double step = 0.0;  ///< [s]
  std::int64_t steps = 0;
  std::int64_t warm_up_steps = 0;  ///< the first steps, left out of the measured cost
  double end = 0.0;                ///< asked for, or steps * step; steps * step is not less [s]
  double natural_time = 0.0;       ///< smallest sqrt(m/k) [s]
  double stable_step = 0.0;        ///< largest step at which the contacts of the start are stable; infinite without [s]
  double contact_time = 0.0;       ///< shortest duration of an impact at the speeds of the scene; infinite at rest [s]
  double reach_time = 0.0;         ///< time to pass the shortest attraction at a distance; infinite without [s]
  bool is_given = false;           ///< the scene says the step in seconds
  std::string stiffest;            ///< sentence: which body and law set the natural time
  std::string limited_by;          ///< sentence: what the step comes from
  double slide_step = 0.0;  ///< largest stable step of tangential springs above normal ones; infinite without [s]
  std::string gripping;     ///< sentence: which body and law set the slide step
  std::string crowded;      ///< sentence: which body and contacts set the stable step; empty: one contact does
};

/// Table [time]: `step` "auto" or seconds, `end` or the number of `steps`, `step_fraction` of the natural time (0.05),
/// `warm_up_steps` (0). Automatic steps are also at most 1/200 of the shortest impact, 1/10 of the reach time and
/// kLargestStableShare of the slide step and of the stable step of the contacts that there are at the start, and divide
/// `end`. Throws InputError for steps above kLargestStepFraction of the natural time, of disks 0.2, or that share of
/// the slide step or of the stable step of the springs alone. `law_description`: per law, for messages. `valid`: the
/// system is that of the scene; else steps are not judged.
template <int D>
SceneTime read_time(const SceneTable& time, const System<D>& system, const std::vector<std::string>& law_description,
                    bool valid);

/// Duration of the shortest impact between a particle and an equal one at the largest relative speed in sight (present
/// velocities, free fall through the scene, images in a cell that is sheared, planes that a load drives through the
/// scene). Hertz [closed form]: h = (5 m12 v^2/(4 K))^(2/5), F = K h^(3/2),
/// T = 2 h/v int_0^1 dx/sqrt(1 - x^(5/2)) = (4/5) B(2/5, 1/2) h/v; linear spring: T = pi sqrt(m12/k). Cohesive disks
/// the same, without their adhesion. Infinite at rest.
/// `end` may be infinite. [s]
template <int D>
double shortest_impact(const System<D>& system, double end);

}  // namespace softgrain
