// softgrain check of reverse searches.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/core/error.h"
#include "common/data/force_curves.h"
#include "pipelines/kinds/inverse/scene.h"
#include "pipelines/kinds/soft_particle/cost.h"

namespace softgrain {

namespace {

/// Core seconds of one run, the mean over points along the diagonal of the box; so few of them are enough, as cost
/// changes evenly from one corner to the other. Points where no grain finds a place cost nothing.
double seconds_per_run(const InverseSetup& setup) {
  constexpr std::array kPlaces{0.15, 0.5, 0.85};
  constexpr double kBudget = 0.1;
  double sum = 0.0;
  for (const double place : kPlaces) {
    try {
      const SoftParticleSpec spec = spec_at(setup, std::vector<double>(setup.search.size(), place));
      const MeasureTrial trial = try_soft_particle(spec, setup.measure.seed, kBudget);
      const double packings = setup.kind == PairKind::soft_soft ? 2.0 : 1.0;
      sum += packings * trial.packing_seconds +
             measuring_seconds(setup.measure, setup.relaxation, setup.plan, setup.kind, trial.pass_seconds);
    } catch (const InputError&) {
    }
  }
  return sum / static_cast<double>(kPlaces.size());
}

}  // namespace

void check_inverse(const InverseSetup& setup, Findings& out) {
  const std::int64_t runs = setup.budget * setup.packings + setup.confirm;
  out.facts["evaluations"] = setup.budget;
  out.facts["points_per_run"] = setup.target.delta.size();
  out.add("runs", runs,
          fmt::format("{} evaluations of {} packings and {} to confirm: {} runs of {} {} states", setup.budget,
                      setup.packings, setup.confirm, runs, setup.target.delta.size(), to_string(setup.kind)));
  for (const SearchParameter& p : setup.search)
    out.lines += fmt::format("  {} from {:.4g} to {:.4g}{}\n", p.name, p.low, p.high,
                             p.logarithmic ? ", evenly in its logarithm" : "");
  out.lines +=
      fmt::format("  target: Delta from {:.4g} to {:.4g}, force up to {:.4g} N\n", setup.target.delta.front(),
                  setup.target.delta.back(), *std::max_element(setup.target.force.begin(), setup.target.force.end()));
  const SoftParticleSpec& spec = setup.measure.spec;
  out.warn_of_metres("shell_radius", spec.shell_radius);
  for (const std::string& one :
       implausible_forces(setup.target.delta, setup.target.force, spec.shell_radius, spec.youngs_modulus))
    out.warn(one);
  for (const std::string& remark : setup.remarks) out.warn(remark);
  out.spend("runs", seconds_per_run(setup) * static_cast<double>(runs));
}

}  // namespace softgrain
