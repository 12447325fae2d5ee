#include "pipelines/grain_box_check.h"

#include <fmt/format.h>

#include <cmath>

#include "microsim/grain_box/analysis.h"

namespace softgrain {

namespace {

/// Seconds of one core per grain and increment of the fast method: 0.1 to 0.2 s were seen for 2740 grains with
/// friction. The published method was not measured on these packs and is taken to need twenty times as long.
constexpr double kSecondsPerIncrement = 5e-5;
constexpr double kPublishedFactor = 20.0;
/// Without friction a pack rearranges over and over: 0.85 s for 5036 grains.
constexpr double kFrictionlessFactor = 3.0;
/// Equilibria of the generation: pressure, growth, compression with friction.
constexpr double kGenerationIncrements = 150.0;
/// Seconds per grain of the dynamics that brings the loose arrangement together; 30 s were seen for 2740 grains.
constexpr double kSecondsLoose = 1e-2;

double expected_seconds(const GrainBoxSpec& spec, double increments) {
  double per_increment = kSecondsPerIncrement;
  if (spec.solver.method != LeastWorkMethod::fast) per_increment *= kPublishedFactor;
  if (!(spec.friction > 0.0)) per_increment *= kFrictionlessFactor;
  const double per_grain = (increments + kGenerationIncrements) * per_increment + kSecondsLoose;
  return per_grain * static_cast<double>(spec.grains);
}

void warn_of_pack(const GrainBoxSpec& spec, const GrainBoxForecast& f, Findings& out) {
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
  double total = 0.0;
  facts["packs"] = nlohmann::json::array();
  for (const GrainBoxSpec& spec : setup.packs) {
    const GrainBoxForecast f = forecast(spec);
    const double seconds = expected_seconds(spec, f.increments);
    total += seconds;
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
        "  {}: {} grains, solid fraction {:.2f} when loose, box of about {:.3g} m; {} loading from {:.3g} MPa, about "
        "{:.0f} increments; overlap about {:.1f} % of the radius at the end; about {:.0f} contacts, {:.0f} MB, {:.0f} "
        "s\n",
        spec.name, spec.grains, spec.solid_fraction, f.box_length, spec.loading.test, spec.generation.pressure * 1e-6,
        std::ceil(f.increments), 100.0 * f.overlap_ratio, f.contacts, f.bytes * 1e-6, seconds);
  }
  out.add_time("core_seconds", total, fmt::format("{} packs, one core", setup.packs.size()));
}

}  // namespace softgrain
