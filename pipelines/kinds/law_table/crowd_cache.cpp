#include "pipelines/kinds/law_table/crowd_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "common/core/error.h"
#include "common/data/spec_io.h"
#include "common/io/file_seal.h"
#include "common/io/text_file.h"
#include "pipelines/run/task_store.h"

namespace softgrain {

namespace {

constexpr const char* kFormat = "crowd-run";

/// Raised whenever the same key would give another result: contact laws, relaxation, packing, what is recorded.
constexpr int kCacheSchema = 1;

std::string exact(double x) { return fmt::format(" {:.17g}", x); }

std::string text_of(const SoftParticleSpec& s) {
  std::string text = "spec";
  for (const double x : {s.shell_radius, s.youngs_modulus, s.poisson_ratio, s.friction, s.density, s.exponent,
                         s.polydispersity, s.rmax_over_shell, s.beta})
    text += exact(x);
  if (s.sizes) text += " " + s.sizes->text();
  return text + fmt::format(" {} {}\n", s.trials, to_string(s.placement));
}

std::string text_of(const CrowdConfiguration& c) {
  std::string text = fmt::format("centre {}\n", c.centre_free ? "free" : "held");
  for (const CrowdPartner& p : c.partners)
    text += to_string(p.kind) + exact(p.ratio) + exact(p.direction[0]) + exact(p.direction[1]) + exact(p.direction[2]) +
            "\n";
  for (const CrowdStage& s : c.stages) {
    text += "stage" + exact(s.slide);
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
         "relaxation" + exact(options.increment) + exact(options.tolerance) + exact(options.tolerance_between) +
         exact(options.least_stiffness) + fmt::format(" {}\n", options.max_passes) + contents + "\n";
}

std::string crowd_run_name(const std::string& key) { return "crowd-" + short_hash(key); }

std::optional<CrowdRun> CrowdCache::find(const std::string& key) const {
  const std::string path = directory_.empty() ? "" : file(key);
  if (path.empty() || !std::filesystem::exists(path)) return std::nullopt;
  try {
    const std::lock_guard lock(h5::library_mutex());
    if (check_seal(path) != Seal::sound) throw FileTrouble(path + ": damaged, or written by an earlier version");
    const h5::Group root = h5::open_file(path);
    require_format(root, kFormat, path);
    if (root.text("key") != key) throw FileTrouble(path + ": belongs to another measurement");
    std::vector<CrowdRun> runs = read_crowd_runs(root);
    if (runs.size() != 1) throw FileTrouble(path + ": damaged: holds no single run");
    return std::move(runs.front());
  } catch (const FileTrouble& e) {
    say_(std::string(e.what()) + "; measured again");
    return std::nullopt;
  }
}

void CrowdCache::keep(const std::string& key, const CrowdRun& run) const {
  if (directory_.empty()) return;
  // Other processes may keep the same run: each writes a file of its own, the last one to finish stays.
  const std::string own = file(key) + "." + std::to_string(::getpid());
  {
    const std::lock_guard lock(h5::library_mutex());
    h5::AtomicFile out(own, false, true);
    write_format(out.root(), kFormat);
    out.root().attribute("key", key);
    write_crowd_runs(out.root(), {run});
    out.commit();
  }
  std::error_code error;
  std::filesystem::rename(own, file(key), error);
  if (error) throw FileTrouble(file(key) + ": cannot be written: " + error.message());
}

}  // namespace softgrain
