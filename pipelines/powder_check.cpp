// softgrain check of powders.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipelines/powder_command.h"
#include "pipelines/powder_variants.h"

namespace softgrain {

namespace {

using nlohmann::json;

double time_step(const PowderSetup& setup) {
  return setup.options.step * std::sqrt(setup.spec.diameter_min * setup.spec.diameter_min / setup.spec.stiffness);
}

std::string check_setup(const PowderSetup& setup, json& facts) {
  const double step = time_step(setup);
  const auto phases = static_cast<double>(setup.phases().size());
  facts["samples"] = setup.samples;
  facts["disks"] = setup.spec.disks;
  facts["time_step"] = step;
  facts["steps_max"] = phases * setup.options.time_max / step;
  return fmt::format(
      "{} samples of {} disks, {:.0f} phases; time step {:.3g} T0 or a little more, at most {:.3g} steps each\n",
      setup.samples, setup.spec.disks, phases, step, phases * setup.options.time_max / step);
}

/// Overlap of a contact at rest: adhesion presses by F0, the load by about P a, over K_N.
double expected_overlap(const PowderSpec& spec) {
  const double force = (spec.cohesive ? 1.0 : 0.0) + spec.stress();
  return force / spec.stiffness;
}

/// Wall time of a step of the first phase, from a sample of at most 1400 disks.
double seconds_per_step(const PowderSetup& setup) {
  constexpr std::int64_t kDisks = 1400;
  constexpr std::int64_t kSteps = 200;
  PowderSpec spec = setup.spec;
  spec.disks = std::min(spec.disks, kDisks);
  PowderState state = start_powder(spec, setup.seed, 0);
  std::vector<PowderPhase> phases = powder_phases(spec, setup.protocol);
  phases.resize(1);
  PowderOptions options = setup.options;
  const double step = time_step(setup);
  options.time_max = static_cast<double>(kSteps) * step;
  const double seconds = seconds_of([&] { (void)run_powder(state, spec, phases, options, [](const PowderState&) {}); });
  return seconds / static_cast<double>(kSteps) * static_cast<double>(setup.spec.disks) /
         static_cast<double>(spec.disks);
}

void warn_of_setup(const PowderSetup& setup, const std::string& name, Findings& out) {
  const std::string of = name.empty() ? "" : name + ": ";
  constexpr double kChatter = 0.147;
  if (setup.options.step > kChatter)
    out.warn(of +
             fmt::format("step = {}: above {} the dashpots of the smallest disks are unstable, contacts chatter and a "
                         "sample never rests",
                         setup.options.step, kChatter));
  constexpr double kSoft = 0.01;
  const double overlap = expected_overlap(setup.spec);
  if (overlap > kSoft)
    out.warn(of + fmt::format("contacts overlap by about {:.2g} a at rest: kappa = {:.3g} is soft for this pressure",
                              overlap, setup.spec.stiffness));
  if (setup.spec.cohesive && overlap > 0.0 && setup.spec.range < 1.0 / setup.spec.stiffness)
    out.warn(of +
             fmt::format("the range of attraction ({:.3g} a) is shorter than the overlap that adhesion makes ({:.3g} "
                         "a)",
                         setup.spec.range, 1.0 / setup.spec.stiffness));
  if (setup.samples < 3)
    out.warn(of + fmt::format("{} sample{}: no scatter to judge differences by; the published means are over four",
                              setup.samples, setup.samples == 1 ? "" : "s"));
  constexpr std::int64_t kFew = 300;
  if (setup.spec.disks < kFew)
    out.warn(of + fmt::format("{} disks are few: chains of force span so small a cell", setup.spec.disks));
}

void check_one(const PowderSetup& setup, Findings& out) {
  out.lines += "  " + check_setup(setup, out.facts);
  const double overlap = expected_overlap(setup.spec);
  out.add("overlap", overlap, fmt::format("contacts overlap by about {:.2g} of the largest diameter at rest", overlap));
  warn_of_setup(setup, "", out);
  if (!setup.states.empty()) return;  // nothing is assembled
  // Samples rest long before the limit: the published cells took 0.7e6 to 1.2e6 of 1.6e7 steps.
  constexpr double kShare = 0.07;
  const double steps = out.facts["steps_max"].get<double>() * kShare * static_cast<double>(setup.samples);
  out.add_time("core_seconds", seconds_per_step(setup) * steps,
               fmt::format("assembly, if samples rest after {:.0f} % of the limit", 100.0 * kShare));
}

}  // namespace

void check_powder(const Scene& scene, Findings& out) {
  if (!has_powder_variants(scene)) {
    check_one(read_powder(scene), out);
    return;
  }
  for (const PowderVariant& v : read_powder_variants(scene)) {
    json one{{"name", v.name}, {"picked", v.picked}};
    out.lines += fmt::format("  {}{}: {}", v.name, v.picked ? "" : " (left out)", check_setup(v.setup, one));
    out.facts["variants"].push_back(one);
    if (v.picked) warn_of_setup(v.setup, v.name, out);
  }
}

}  // namespace softgrain
