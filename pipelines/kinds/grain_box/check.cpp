#include "pipelines/kinds/grain_box/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "microsim/grain_box/analysis.h"
#include "microsim/grain_box/grain_box_run.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

/// What a small pack of the same kind takes [s of one core].
struct PackTrial {
  double grains = 0.0;
  double generation = 0.0;
  double increment = 0.0;  ///< core seconds of an increment of the loading
};

PackTrial try_pack(const GrainBoxSpec& spec, std::uint64_t seed) {
  constexpr std::int64_t kGrains = 100;
  constexpr double kIncrements = 20.0;
  GrainBoxSpec small = spec;
  small.grains = std::min(spec.grains, kGrains);
  small.loading.end_strain = std::min(spec.loading.end_strain, kIncrements * spec.loading.increments.front());
  PackTrial t{.grains = static_cast<double>(small.grains)};
  constexpr double kBudget = 2.0;
  const double start = thread_seconds();
  double loading = 0.0;  // when it begins
  double done = 0.0;
  RunControl<GrainBoxState> control;
  control.progress = [&](const GrainBoxState& state, double) {
    if (state.phase == BoxPhase::loading && loading == 0.0)
      loading = thread_seconds();
    else if (state.phase == BoxPhase::loading)
      done += 1.0;
    if (thread_seconds() - start > kBudget) throw TrialOver{};
  };
  const double whole = core_seconds_of([&] {
    try {
      (void)run_grain_box(small, seed, {}, control);
    } catch (const TrialOver&) {
    }
  });
  t.generation = loading > 0.0 ? loading - start : whole;
  t.increment = done > 0.0 ? (whole - t.generation) / done : 0.0;
  return t;
}

/// One trial serves all packs that are solved alike.
class PackTrials {
 public:
  explicit PackTrials(std::uint64_t seed) : seed_(seed) {}

  double expected_seconds(const GrainBoxSpec& spec, double increments) {
    // From 800 to 2740 grains an increment took 5.6 times as long; without friction a pack rearranges over and over,
    // and iterations per increment grew from 38 to 128 from 800 to 5036 grains (results/glass_beads).
    const double exponent = spec.friction > 0.0 ? 1.4 : 1.7;
    const auto known = trials_.try_emplace({spec.friction > 0.0, spec.solver.method});
    PackTrial& t = known.first->second;
    if (known.second) t = try_pack(spec, seed_);
    return (t.generation + t.increment * increments) * std::pow(static_cast<double>(spec.grains) / t.grains, exponent);
  }

 private:
  std::uint64_t seed_;
  std::map<std::pair<bool, LeastWorkMethod>, PackTrial> trials_;  ///< key: whether there is friction, solver method
};

void warn_of_pack(const GrainBoxSpec& spec, const GrainBoxForecast& f, Findings& out) {
  out.warn_of_metres("radius_max", spec.material.radius_max);
  constexpr std::int64_t kFew = 300;
  if (spec.grains < kFew)
    out.warn(fmt::format("{}: {} grains are few: the walls hold most of them, and moduli differ between packs",
                         spec.name, spec.grains));
  constexpr double kLarge = 0.05;
  if (f.overlap_ratio > kLarge)
    out.warn(
        fmt::format("{}: grains overlap by about {:.0f} % of the radius at the end of the loading: Hertz' law is one "
                    "of small overlaps; a lower end_stress, or a stiffer E",
                    spec.name, 100.0 * f.overlap_ratio));
  constexpr double kMany = 5000.0;
  if (f.increments > kMany)
    out.warn(
        fmt::format("{}: about {:.0f} increments; several sizes of increment (increments, stage_strains) take fewer",
                    spec.name, std::ceil(f.increments)));
}

}  // namespace

void check_grain_box(const GrainBoxSetup& setup, Findings& out) {
  nlohmann::json& facts = out.facts;
  std::string& lines = out.lines;
  PackTrials trials(setup.seed);
  add_sizes(out, drawn_sizes(setup, setup.seed));
  facts["packs"] = nlohmann::json::array();
  for (const GrainBoxSpec& spec : setup.packs) {
    const GrainBoxForecast f = forecast(spec);
    const double seconds = trials.expected_seconds(spec, f.increments);
    out.spend("packs", seconds);
    facts["packs"].push_back({{"name", spec.name},
                              {"grains", spec.grains},
                              {"solid_fraction", spec.solid_fraction},
                              {"box_length", f.box_length},
                              {"increments", std::ceil(f.increments)},
                              {"overlap_ratio", f.overlap_ratio},
                              {"contacts", f.contacts},
                              {"bytes", f.bytes},
                              {"core_seconds", seconds}});
    warn_of_pack(spec, f, out);
    lines += fmt::format(
        "  {}: {} grains, solid fraction {:.2f} when loose, box of about {:.3g} m; {} loading from {:.3g} MPa{}, about "
        "{:.0f} increments; overlap about {:.1f} % of the radius at the end; about {:.0f} contacts, {:.0f} MB, {:.0f} "
        "s\n",
        spec.name, spec.grains, spec.solid_fraction, f.box_length, spec.loading.test, spec.generation.pressure * 1e-6,
        spec.generation.lower_pressures.empty()
            ? ""
            : fmt::format(" (pressed on from {:.3g} MPa)", spec.generation.lower_pressures.front() * 1e-6),
        std::ceil(f.increments), 100.0 * f.overlap_ratio, f.contacts, f.bytes * 1e-6, seconds);
  }
}

}  // namespace softgrain
