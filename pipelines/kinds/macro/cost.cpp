#include "pipelines/kinds/macro/cost.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "macrosim/cell_test.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/run/trial_times.h"

namespace softgrain {

namespace {

/// Scenes with more bodies are tried in small.
constexpr std::int64_t kTrialBodies = 60;

/// Increments of all stages of a test.
double increments_of(const MacroSpec& spec) {
  double increments = 0.0;
  for (const MacroStage& stage : stages_of(spec))
    increments += static_cast<double>(stage.steps * stage.increments_per_step);
  return increments;
}

/// Stands for laws that are still to be measured: those of results/published.
NamedLaws like_published(const MacroSpec& spec) {
  SoftContact solid;
  solid.normal = {0.58, 2.8, -0.58 * std::pow(0.065, 2.8)};
  solid.delta = 0.065;
  solid.modulus = spec.youngs_modulus;
  solid.friction = spec.friction;
  SoftContact soft = solid;
  soft.partner_is_soft = true;
  soft.normal = {0.26, 5.5, -0.26 * std::pow(0.2, 5.5)};
  soft.delta = 0.2;
  NamedLaws out;
  out.laws = pair_soft_laws(solid, soft, spec.wall_friction);
  return out;
}

std::vector<NamedLaws> laws_of(const LawSources* laws, const MacroSpec& spec, double solid_fraction) {
  if (spec.cells) return {};
  if (laws == nullptr) return {like_published(spec)};
  LawSources any = *laws;
  any.range = RangePolicy::clamp;
  std::vector<NamedLaws> out;
  for (const WantedForm form : laws->forms) {
    any.forms = {form};
    out.push_back(scene_law(any, spec, solid_fraction, "law"));
  }
  return out;
}

/// Core seconds of a whole test, from as much of it as is done in a moment; 0 where nothing is. `test`: compress() or
/// its like.
template <class State, class Test>
double try_test(const MacroSpec& spec, State& state, const Test& test) {
  constexpr double kBudget = 0.4;
  double share = 0.0;
  RunControl<State> control{.seconds = kBudget};
  control.progress = [&](const State& s, double done) {
    share = done;
    if (s.curve.cost.seconds > kBudget) throw TrialOver{};
  };
  const double seconds = core_seconds_of([&] {
    try {
      test(state, spec, control);
    } catch (const TrialOver&) {
    } catch (const NotUsable&) {  // the run will say so
    }
  });
  return share > 0.0 ? seconds / share : 0.0;
}

double try_law(const MacroSpec& spec, const MacroPacking& packing, const NamedLaws& law, double solid_fraction) {
  CompressionState state;
  state.macro = make_law_system(spec, packing, law.laws, solid_fraction > 0.0 ? solid_fraction : 1.0);
  state.curve = begin_curve(spec, packing, state.macro, law.name, 0);
  return try_test(spec, state, [](auto&... all) { compress(all...); });
}

double try_cells(const MacroSpec& spec, const MacroPacking& packing) {
  CellTestState state = begin_cell_test(spec, packing, "law", 0);
  return try_test(spec, state, test_cells);
}

/// Loop passes of the relaxations of a twin over a whole test: 620 and 670 per increment of strain 0.005 (quickstart,
/// published), 820 to 1650 per one of 0.01 to 0.02 (macro_vs_resolved); grains without shells rearrange more.
double relaxing_passes(const MacroSpec& spec, Twin twin) {
  const double increments = increments_of(spec);
  const double strain = rough_strains(spec).way / increments;
  return (twin == Twin::free ? 1.5 : 1.0) * increments * 650.0 * std::pow(strain / 0.005, 0.3);
}

/// And of its motion. The smallest grain, which sets the step, is taken to be as in the published soft particle.
double moving_passes(const MacroSpec& spec) {
  constexpr double kPerNaturalTime = 19.6;  ///< R sqrt(rho/E) of the smallest soft particle, at step_factor 1
  const double smallest = spec.soft_radius_max / spec.soft_polydispersity;
  const double largest = std::max(spec.solid_radius_max, spec.soft_radius_max);
  const double straining = rough_strains(spec).way * 2.0 * largest / spec.twin.speed;
  const double settling = (increments_of(spec) + 1.0) * spec.twin.settle_time * spec.soft_radius_max;
  return kPerNaturalTime / spec.twin.step_factor * (straining + settling) / smallest;
}

double twin_passes(const MacroSpec& spec, Twin twin) {
  const bool moves = spec.twin.relaxation == TwinRelaxation::slow_dynamics;
  return moves ? moving_passes(spec) + 0.3 * relaxing_passes(spec, twin) : relaxing_passes(spec, twin);
}

/// Runs that the band of a law takes on a sample, at most: two along each of a few components and four for what its
/// form is off by, or one per draw (bands.cpp).
double band_runs(const MacroSetup& setup) {
  if (setup.bands == 0) return 0.0;
  constexpr double kMostAlongComponents = 12.0;
  return setup.band_estimator == BandEstimator::draws ? static_cast<double>(setup.bands + 4) : kMostAlongComponents;
}

}  // namespace

void spend_on_macro(const MacroSetup& setup, const MacroContent& content, const LawSources* laws, Findings& out) {
  MacroSpec spec = setup.spec;
  if (spec.preparation == Preparation::lammps) spec.preparation = Preparation::frictionless;
  spec.bodies = std::min(spec.bodies, kTrialBodies);
  const double larger = static_cast<double>(setup.spec.bodies) / static_cast<double>(spec.bodies);
  const auto samples = static_cast<double>(setup.samples);
  const auto runs = static_cast<double>(setup.samples + std::min(setup.samples, setup.noise_samples));
  MacroPacking packing;
  try {
    const double preparation = core_seconds_of([&] { packing = make_packing(spec, 1, 0); });
    // Passes of a preparation grow like N^0.33: 1,500, 2,600, 4,500, 6,000 of 60, 250, 1,000, 4,000 bodies.
    if (!setup.given && !content.prepared) out.spend("preparation", samples * std::pow(larger, 1.33) * preparation);
    if (spec.cells) out.spend("law runs", samples * larger * try_cells(spec, packing));
    for (const NamedLaws& law : laws_of(laws, spec, content.solid_fraction)) {
      const double run =
          larger * static_cast<double>(setup.law_increments) * try_law(spec, packing, law, content.solid_fraction);
      out.spend("law runs", runs * run);
      if (setup.bands > 0) out.spend("bands", samples * band_runs(setup) * run);
    }
  } catch (const Error&) {  // so few bodies need not jam or hold the share; the scene may
  }
  const double grains = content.bodies + content.soft * content.grains_per_soft;
  for (const Twin twin : setup.twins)
    out.spend("twins", runs * grains * content.grain_pass_seconds * twin_passes(setup.spec, twin));
}

}  // namespace softgrain
