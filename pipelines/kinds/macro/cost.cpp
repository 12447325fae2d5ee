#include "pipelines/kinds/macro/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/error.h"
#include "macrosim/cell_specimen.h"
#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/test_protocol.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

/// Bodies that scenes with more are tried with: laws of soft particles cost more than contacts of grains.
std::int64_t trial_bodies(const MacroSpec& spec) {
  constexpr std::int64_t kSoft = 60;
  constexpr std::int64_t kGrains = 250;
  std::int64_t least = spec.soft_share > 0.0 || spec.cells ? kSoft : kGrains;
  if (spec.boundary == Boundary::periodic) least = std::max(least, least_bodies(spec));
  return std::min(spec.bodies, least);
}

/// Most grains of a periodic trial whose packing jams within the budget of a trial.
constexpr std::int64_t kMostTried = 2500;

/// The same grains down to a `span`-th of the largest alone.
MacroSpec narrowed(MacroSpec spec, double span) {
  spec.solid_sizes.reset();
  spec.solid_polydispersity = span;
  return spec;
}

/// What is tried in place of a scene: fewer bodies, and where a cell with room for the largest would need too many fine
/// ones (spans above about 12), of a smaller span. A packing of few grains and the whole span says little: after its
/// budget (3 s of 60 at span 30) it is far from jammed, and there is nothing to test.
MacroSpec trial_spec(MacroSpec spec) {
  const std::int64_t bodies = trial_bodies(spec);
  if (bodies > kMostTried && spec.boundary == Boundary::periodic && !(spec.soft_share > 0.0) && !spec.cells) {
    double low = 1.0;
    double high = spec.solid_polydispersity;
    for (int k = 0; k < 30; ++k) {
      const double middle = std::sqrt(low * high);
      (least_bodies(narrowed(spec, middle)) > kMostTried ? high : low) = middle;
    }
    spec = narrowed(spec, low);
    spec.bodies = std::min(spec.bodies, kMostTried);
    return spec;
  }
  spec.bodies = bodies;
  return spec;
}

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

/// How many times longer a scene takes than its trial. Counts are those of power laws r^-3.5.
class TrialScale {
 public:
  TrialScale(const MacroSpec& scene, const MacroSpec& trial)
      : tried_(static_cast<double>(trial.bodies)),
        larger_(static_cast<double>(scene.bodies) / tried_),
        wider_(scene.solid_polydispersity / trial.solid_polydispersity),
        own_load_(scene.balance == Balance::own_load) {}

  /// Whether the trial has a smaller span.
  [[nodiscard]] bool narrowed() const { return wider_ > 1.0; }

  /// Core seconds for the packing of the trial: the grains of a narrowed one are many.
  [[nodiscard]] double budget() const { return narrowed() ? 6.0 : 3.0; }

  /// By bodies alone.
  [[nodiscard]] double bodies() const { return larger_; }

  /// Passes of a preparation grow like N^0.33: 1,500, 2,600, 4,500, 6,000 of 60, 250, 1,000, 4,000 bodies. They grow
  /// with the span too: 3,900, 8,900, 19,200 of 8,000 bodies at 3, 12, 30, since fine grains wait for a share of a mean
  /// contact force that they never bear. With balance "own-load" they need not, and the number of bodies hardly counts:
  /// 2,000 of 60,000 at 3, 2,900 of 8,000 at 12, 3,600 of 20,000 at 30, 6,900 of 160,000 at 60.
  [[nodiscard]] double preparation() const {
    const double passes = own_load_ ? std::pow(wider_, 0.5) : std::pow(larger_, 0.33) * std::pow(wider_, 0.8);
    return larger_ * passes * memory();
  }

  /// Passes of an increment grow like N^0.33 too: 160, 190, 300 of 1,400, 2,400, 8,000 bodies in a triaxial test. Where
  /// there are more bodies because of a larger span there are not more passes for that. With balance "own-load" their
  /// number does not count either: about 44 min of one core for 32 increments of 450,000 bodies at span 100.
  [[nodiscard]] double test() const { return (own_load_ ? larger_ : std::pow(larger_, 1.33)) * memory(); }

 private:
  /// Time of a pass and body over that of a trial. Bodies and contacts of a trial stay in the cache, half a kilobyte a
  /// body; a contact of 80,000 bodies took two to four times as long beside other work, one of 20,000 hardly more.
  [[nodiscard]] double memory() const {
    constexpr double kCached = 2e4;
    return std::sqrt(std::max(larger_ * tried_, kCached) / std::max(tried_, kCached));
  }

  double tried_;
  double larger_;
  double wider_;
  bool own_load_;
};

/// Share of the work of a test that is done with this share of its points. An increment that shears takes 2.3 times the
/// passes of one that compresses: 350 and 150 of 8,000 grains of span 12 after an isotropic preload.
double work_share(const MacroSpec& spec, double share) {
  constexpr double kShearing = 2.3;
  const std::vector<MacroStage> stages = stages_of(spec);
  double left = 1.0;  // the start is a point, too
  for (const MacroStage& stage : stages) left += static_cast<double>(stage.steps);
  left *= share;
  double all = 0.0;
  double done = 0.0;
  const auto add = [&](double points, const MacroStage& stage) {
    const double weight =
        static_cast<double>(stage.increments_per_step) * (shears(stage.record.kind) ? kShearing : 1.0);
    const double some = std::clamp(left, 0.0, points);
    left -= some;
    done += some * weight;
    all += points * weight;
  };
  add(1.0, stages.front());
  for (const MacroStage& stage : stages) add(static_cast<double>(stage.steps), stage);
  return done / all;
}

/// Core seconds of a whole test, from as much of it as is done in a moment; 0 where nothing is. `test`: compress() or
/// its like.
template <class State, class Test>
double try_test(const MacroSpec& spec, State& state, const Test& test) {
  constexpr double kBudget = 0.8;
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
    } catch (const UnusableResult&) {  // the run will say so
    }
  });
  return share > 0.0 ? seconds / work_share(spec, share) : 0.0;
}

/// A preparation on trial: core seconds of the whole, and the packing where it came to its end.
struct PreparationTrial {
  double seconds = 0.0;
  std::optional<MacroPacking> packing{};
};

/// `budget`: core seconds after which it is left.
PreparationTrial try_preparation(const MacroSpec& spec, std::uint64_t seed, double budget) {
  constexpr double kPatience = 30.0;  // core seconds without any progress
  PreparationTrial out;
  double share = 0.0;
  const double start = thread_seconds();
  const double seconds = core_seconds_of([&] {
    try {
      const auto watch = [&](double done) {
        share = done;
        const double spent = thread_seconds() - start;
        if (spent > budget && done > 0.0) throw TrialOver{};
        if (spent > std::max(kPatience, budget)) throw UnusableResult(fmt::format("no progress in {:.0f} s", spent));
      };
      out.packing = make_packing(spec, seed, 0, {watch});
    } catch (const TrialOver&) {
    }
  });
  out.seconds = out.packing ? seconds : seconds / share;
  return out;
}

/// Core seconds of the preparations of a search for a density, and whether the bodies of the trial reach it.
double spend_on_density(const MacroSetup& setup, MacroSpec spec, std::uint64_t seed, const PreparationTrial& loose,
                        const TrialScale& scale, Findings& out) {
  constexpr double kMargin = 0.01;  // of samples with a few hundred bodies
  const DensityTarget& target = *setup.density;
  spec.protocol.friction = 0.0;
  const PreparationTrial dense = try_preparation(spec, seed, scale.budget());
  if (loose.packing && dense.packing && !scale.narrowed()) {  // grains of another span have other densities
    const double fraction = target.solid_fraction(spec.density);
    const double low = loose.packing->solid_fraction();
    const double high = dense.packing->solid_fraction();
    out.facts["target_density_reach"] = {low, high};
    const std::string reach = fmt::format("{} bodies reach {:.4f} to {:.4f}", spec.bodies, low, high);
    out.lines += fmt::format("  {}\n", reach);
    if (fraction < low - kMargin || fraction > high + kMargin)
      out.warn(fmt::format("{} may be out of reach: {}", target.text(spec.density), reach));
  }
  return 0.5 * kUsualDensityTries * (loose.seconds + dense.seconds);
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

/// Loop passes of the motion of a twin over a whole test. The smallest grain sets the time step.
double moving_passes(const MacroSpec& spec, const MacroContent& content) {
  constexpr double kPerNaturalTime = 0.98;  ///< R sqrt(rho/E) of the smallest grain, at step_factor 1
  constexpr double kPublished = 0.05;       // smallest grain of the published soft particle over its radius
  const double inside = content.smallest_grain > 0.0 ? content.smallest_grain : kPublished;
  const double smallest = inside * spec.soft_radius_max / spec.soft_polydispersity;
  const double largest = std::max(spec.solid_radius_max, spec.soft_radius_max);
  const double straining = rough_strains(spec).way * 2.0 * largest / spec.twin.speed;
  const double settling = (increments_of(spec) + 1.0) * spec.twin.settle_time * spec.soft_radius_max;
  return kPerNaturalTime / spec.twin.step_factor * (straining + settling) / smallest;
}

double twin_passes(const MacroSpec& spec, const MacroContent& content, Twin twin) {
  const bool moves = spec.twin.relaxation == TwinRelaxation::slow_dynamics;
  return moves ? moving_passes(spec, content) + 0.3 * relaxing_passes(spec, twin) : relaxing_passes(spec, twin);
}

/// Runs that the band of a law takes on a sample, at most: two along each of a few components and four for what its
/// form is off by, or one per draw (bands.cpp).
double band_runs(const MacroSetup& setup) {
  if (setup.bands == 0) return 0.0;
  constexpr double kMostAlongComponents = 12.0;
  return setup.band_estimator == BandEstimator::draws ? static_cast<double>(setup.bands + 4) : kMostAlongComponents;
}

void spend_on_twins(const MacroSetup& setup, const MacroContent& content, Findings& out) {
  const auto runs = static_cast<double>(setup.samples + std::min(setup.samples, setup.noise_samples));
  const double grains = content.bodies + content.soft * content.grains_per_soft;
  for (const Twin twin : setup.twins)
    out.spend("twins", runs * grains * content.grain_pass_seconds * twin_passes(setup.spec, content, twin));
}

}  // namespace

void spend_on_macro(const MacroSetup& setup, const MacroContent& content, const LawSources* laws, std::uint64_t seed,
                    Findings& out) {
  if (content.untimed) return;
  MacroSpec spec = setup.spec;
  const char* const tests = laws == nullptr && !(spec.soft_share > 0.0) ? "tests" : "law runs";
  if (spec.preparation == Preparation::lammps) spec.preparation = Preparation::frictionless;
  const auto samples = static_cast<double>(setup.samples);
  const auto runs = static_cast<double>(setup.samples + std::min(setup.samples, setup.noise_samples));
  try {
    PreparationTrial trial;
    if (!setup.given) spec = trial_spec(spec);
    const TrialScale scale(setup.spec, spec);
    if (setup.given)
      trial.packing = setup.given;
    else
      trial = try_preparation(spec, seed, scale.budget());
    const bool counted = !setup.given && !content.prepared;
    const double preparing =
        counted && setup.density ? spend_on_density(setup, spec, seed, trial, scale, out) : trial.seconds;
    if (counted) out.spend("preparation", samples * scale.preparation() * preparing);
    // A test takes about as long as its preparation where that was too long for a trial.
    if (!trial.packing) out.spend(tests, runs * scale.preparation() * trial.seconds);
    if (!trial.packing) return spend_on_twins(setup, content, out);
    if (spec.cells) {
      const double run = scale.bodies() * try_cells(spec, *trial.packing);
      out.spend(tests, samples * run);
      if (setup.bands > 0) out.spend("bands", samples * band_runs(setup) * run);
    }
    for (const NamedLaws& law : laws_of(laws, spec, content.solid_fraction)) {
      const double run = scale.test() * static_cast<double>(setup.law_increments) *
                         try_law(spec, *trial.packing, law, content.solid_fraction);
      out.spend(tests, runs * run);
      if (setup.bands > 0) out.spend("bands", samples * band_runs(setup) * run);
    }
  } catch (const Error& e) {  // so few bodies need not jam or hold the share; the scene may
    out.lines +=
        fmt::format("  the time is not known: a trial with {} bodies came to no end ({})\n", spec.bodies, e.what());
  }
  spend_on_twins(setup, content, out);
}

}  // namespace softgrain
