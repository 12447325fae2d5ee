#include "pipelines/kinds/law_table/crowd_cache.h"

#include <fmt/format.h>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// Raised whenever the same key would give another result: contact laws, relaxation, packing, what is recorded.
constexpr int kCacheSchema = 2;

std::string exact(double x) { return fmt::format(" {:.17g}", x); }

std::string text_of(const SoftParticleSpec& s) {
  std::string text = "spec";
  for (const double x : {s.shell_radius, s.youngs_modulus, s.poisson_ratio, s.friction, s.density, s.restitution,
                         s.exponent, s.polydispersity, s.rmax_over_shell, s.beta})
    text += exact(x);
  if (s.sizes) text += " " + s.sizes->text();
  return text + fmt::format(" {} {}\n", s.trials, to_string(s.placement));
}

std::string text_of(const CrowdConfiguration& c) {
  std::string text = fmt::format("centre {}{}\n", c.centre_free ? "free" : "held", c.turning ? ", turning" : "");
  for (const CrowdPartner& p : c.partners)
    text += (p.smooth ? "smooth " : "") + to_string(p.kind) + exact(p.ratio) + exact(p.direction[0]) +
            exact(p.direction[1]) + exact(p.direction[2]) + (p.on >= 0 ? fmt::format(" on {}", p.on) : "") + "\n";
  for (const CrowdStage& s : c.stages) {
    text += "stage" + exact(s.slide) + (s.roll != 0.0 ? " roll" + exact(s.roll) : "");
    for (const double h : s.overlap) text += exact(h);
    text += "\n";
  }
  return text;
}

std::string text_of(const CrowdPlan& plan) {
  std::string text;
  for (const std::vector<double>& shares : plan) {
    text += "record";
    for (const double s : shares) text += exact(s);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string crowd_run_key(const SoftParticleSpec& spec, const CrowdConfiguration& configuration, const CrowdPlan& plan,
                          const CrowdOptions& options, const std::string& contents) {
  return fmt::format("crowd run, schema {}\n", kCacheSchema) + text_of(spec) + text_of(configuration) + text_of(plan) +
         "relaxation " + to_string(options.relaxation) + exact(options.approach_speed) + exact(options.step_factor) +
         exact(options.settle_time) + exact(options.increment) + exact(options.tolerance) +
         exact(options.tolerance_between) + exact(options.least_stiffness) + fmt::format(" {}\n", options.max_passes) +
         contents + "\n";
}

std::optional<CrowdRun> CrowdCache::find(const std::string& key) const {
  std::optional<CrowdRun> found;
  cache_.find(key, [&](const h5::Group& root) {
    std::vector<CrowdRun> runs = read_crowd_runs(root);
    if (runs.size() != 1) throw FileTrouble(crowd_run_name(key) + ": damaged: holds no single run");
    found = std::move(runs.front());
  });
  return found;
}

void CrowdCache::keep(const std::string& key, const CrowdRun& run) const {
  cache_.keep(key, [&](const h5::Group& root) { write_crowd_runs(root, {run}); });
}

}  // namespace softgrain
