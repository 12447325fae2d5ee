#include "pipelines/macro_cost.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "pipelines/trial_times.h"

namespace softgrain {

namespace {

/// Scenes with more bodies are tried in small.
constexpr std::int64_t kTrialBodies = 60;

/// Strain increments of a test, those of its preload included.
double increments_of(const MacroSpec& spec) {
  return static_cast<double>((recorded_points(spec) - 1) * spec.increments_per_step);
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
  if (laws == nullptr) return {like_published(spec)};
  LawSources any = *laws;
  any.range = RangePolicy::clamp;
  std::vector<NamedLaws> out;
  for (const std::string& form : laws->forms) {
    any.forms = {form};
    out.push_back(scene_law(any, spec, solid_fraction, form));
  }
  return out;
}

struct TrialOver {};

/// A test by law, as far as it comes in a moment.
struct LawTrial {
  double seconds = 0.0;     ///< of a whole test
  double increments = 0.0;  ///< done
  double passes = 0.0;      ///< in them
};

LawTrial try_law(const MacroSpec& spec, const MacroPacking& packing, const NamedLaws& law, double solid_fraction) {
  constexpr double kBudget = 0.4;
  CompressionState state;
  state.macro = make_law_system(spec, packing, law.laws, solid_fraction > 0.0 ? solid_fraction : 1.0);
  state.curve = begin_curve(spec, packing, state.macro, law.name, 0);
  double share = 0.0;
  const double seconds = core_seconds_of([&] {
    try {
      compress(
          state, spec,
          [&](const CompressionState& s, double done) {
            share = done;
            if (s.curve.cost.seconds > kBudget) throw TrialOver{};
          },
          kBudget);
    } catch (const TrialOver&) {
    } catch (const NotUsable&) {  // the run will say so
    }
  });
  const auto passes = static_cast<double>(state.curve.cost.loop_passes);
  if (!(share > 0.0)) return {};
  return {seconds / share, increments_of(spec) * share, passes};
}

}  // namespace

void spend_on_macro(const MacroSetup& setup, const MacroContent& content, const LawSources* laws, Findings& out) {
  // Passes of a twin over those of a law run (quickstart 2.1 and 2.7, published 2.5).
  constexpr double kTwinPasses = 2.4;
  MacroSpec spec = setup.spec;
  spec.preparation = "softgrain";
  spec.bodies = std::min(spec.bodies, kTrialBodies);
  const double larger = static_cast<double>(setup.spec.bodies) / static_cast<double>(spec.bodies);
  const auto samples = static_cast<double>(setup.samples);
  MacroPacking packing;
  try {
    const double preparation = core_seconds_of([&] { packing = make_packing(spec, 1, 0); });
    out.spend("preparation", samples * larger * preparation);
    double passes = 0.0;
    const std::vector<NamedLaws> forms = laws_of(laws, spec, content.solid_fraction);
    for (const NamedLaws& law : forms) {
      const LawTrial trial = try_law(spec, packing, law, content.solid_fraction);
      out.spend("law runs", samples * larger * trial.seconds);
      if (trial.increments > 0.0) passes += trial.passes / trial.increments / static_cast<double>(forms.size());
    }
    const double grains = content.bodies + content.soft * content.grains_per_soft;
    out.spend("twins", samples * static_cast<double>(setup.twins.size()) * grains * content.grain_pass_seconds *
                           kTwinPasses * passes * increments_of(setup.spec));
  } catch (const Error&) {  // so few bodies need not jam or hold the share; the scene may
  }
}

}  // namespace softgrain
