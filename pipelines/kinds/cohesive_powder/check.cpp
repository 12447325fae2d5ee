// softgrain check of powders.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/cohesive_powder/variants.h"
#include "pipelines/run/findings.h"

namespace softgrain {

namespace {

using nlohmann::json;

std::string check_setup(const PowderSetup& setup, json& facts) {
  const double step = setup.time_step();
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
double expected_overlap(const PowderSetup& setup) {
  const double force = (setup.spec.cohesive ? 1.0 : 0.0) + setup.largest_stress();
  return force / setup.spec.stiffness;
}

/// Small, soft samples that are assembled the same way.
struct PowderTrial {
  double disks = 0.0;
  double pass_seconds = 0.0;   ///< core seconds per loop pass
  std::vector<double> time{};  ///< mean duration of each phase [T0]
};

/// Assembles a sample as far as a short time budget allows.
PowderState assemble_in_a_moment(const PowderSpec& spec, const std::vector<PowderPhase>& phases,
                                 const PowderSetup& setup, std::uint64_t sample) {
  constexpr double kBudget = 0.8;
  PowderState state = start_powder(spec, setup.seed, sample);
  PowderOptions options = setup.options;
  options.record_every = std::min(options.record_every, PowderOptions{}.record_every);  // when it is looked at
  const double start = thread_seconds();
  RunControl<PowderState> control;
  control.save = [&](const PowderState&) {
    if (thread_seconds() - start > kBudget) throw TrialOver{};
  };
  try {
    (void)run_powder(state, spec, phases, options, control);
  } catch (const TrialOver&) {
  } catch (const UnusableResult&) {  // the run will say so
  }
  return state;
}

/// What every phase took; of what did not get to its end the mean, on a scale of ratios, of what was seen and what it
/// may take.
std::vector<double> phase_times(const PowderState& state, std::size_t phases, double time_max) {
  std::vector<double> out(phases, 0.0);
  double before = 0.0;
  for (const PowderPoint& p : state.points) {
    out[static_cast<std::size_t>(p.phase)] += p.time - before;
    before = p.time;
  }
  for (auto k = static_cast<std::size_t>(state.phase); k < phases; ++k)
    out[k] = std::sqrt(std::max(out[k], 1.0) * time_max);
  return out;
}

/// Single samples of this size differ by a third.
PowderTrial try_assembly(const PowderSetup& setup) {
  constexpr std::int64_t kDisks = 100;
  constexpr double kSoft = 100.0;  // kappa
  constexpr std::uint64_t kSamples = 2;
  PowderSpec spec = setup.spec;
  spec.disks = std::min(spec.disks, kDisks);
  spec.stiffness = std::min(spec.stiffness, kSoft);
  // Rolling is as stiff as it will be: soft, it would swing for longer than anything else. Soft aggregates do.
  if (!(setup.protocol.aggregation_kappa > 0.0)) spec.rolling_stiffness *= setup.spec.stiffness / spec.stiffness;
  PowderProtocol protocol = setup.protocol;
  protocol.aggregation_kappa = 0.0;
  // The edges of a small cell have a shorter way: they go at the strain rate of the cell that is asked about.
  protocol.edge_speed_cap *= std::sqrt(static_cast<double>(spec.disks) / static_cast<double>(setup.spec.disks));
  const std::vector<PowderPhase> phases = powder_phases(spec, protocol);
  PowderTrial t{.disks = static_cast<double>(spec.disks)};
  t.time.assign(phases.size(), 0.0);
  double passes = 0.0;
  const double seconds = core_seconds_of([&] {
    for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
      const PowderState state = assemble_in_a_moment(spec, phases, setup, sample);
      const std::vector<double> times = phase_times(state, phases.size(), setup.options.time_max);
      for (std::size_t k = 0; k < phases.size(); ++k) t.time[k] += times[k] / static_cast<double>(kSamples);
      passes += static_cast<double>(state.system.cost.loop_passes);
    }
  });
  t.pass_seconds = seconds / std::max(passes, 1.0);
  return t;
}

/// Time until disks rest in a phase [T0]: that of the trial, longer in larger samples (1.2 to 1.4 times for four times
/// as many disks), once contacts have stiffened, which they do not in the trial.
double expected_time(const PowderSetup& setup, const PowderTrial& trial, const PowderPhase& phase, double of_trial) {
  const double larger = std::pow(static_cast<double>(setup.spec.disks) / trial.disks, 0.2);
  return std::min(phase.stiffening + of_trial * larger, setup.options.time_max);
}

/// Passes of a phase that begins with contacts of stiffness `before`.
double expected_passes(const PowderSetup& setup, const PowderPhase& phase, double before, double time) {
  const double per_time = 1.0 / (setup.options.step * setup.spec.diameter_min);  // at stiffness 1
  const double rise = std::log(phase.stiffness / before);
  const bool stiffens = phase.stiffening > 0.0 && rise != 0.0;
  const double stiffening = stiffens ? std::min(phase.stiffening, time) : 0.0;
  const double between = stiffens ? 2.0 * (std::sqrt(phase.stiffness) - std::sqrt(before)) / rise : 0.0;
  return per_time * (stiffening * between + (time - stiffening) * std::sqrt(phase.stiffness));
}

void spend_on_assembly(const PowderSetup& setup, Findings& out) {
  if (!setup.states.empty()) return;  // nothing is assembled
  const PowderTrial trial = try_assembly(setup);
  const std::vector<PowderPhase> phases = setup.phases();
  double passes = 0.0;
  double before = phases.front().stiffness;
  for (std::size_t k = 0; k < phases.size(); ++k) {
    passes += expected_passes(setup, phases[k], before, expected_time(setup, trial, phases[k], trial.time[k]));
    before = phases[k].stiffness;
  }
  out.spend("assembly", trial.pass_seconds * static_cast<double>(setup.spec.disks) / trial.disks * passes *
                            static_cast<double>(setup.samples));
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
  const double overlap = expected_overlap(setup);
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
  const double overlap = expected_overlap(setup);
  out.add("overlap", overlap, fmt::format("contacts overlap by about {:.2g} of the largest diameter at rest", overlap));
  add_sizes(out, drawn_sizes(setup, setup.seed));
  warn_of_setup(setup, "", out);
  spend_on_assembly(setup, out);
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
    if (!v.picked) continue;
    warn_of_setup(v.setup, v.name, out);
    spend_on_assembly(v.setup, out);
  }
}

}  // namespace softgrain
