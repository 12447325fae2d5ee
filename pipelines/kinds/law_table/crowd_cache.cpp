#include "pipelines/kinds/law_table/crowd_cache.h"

#include "common/core/error.h"
#include "pipelines/kinds/law_table/crowd_members.h"

namespace softgrain {

namespace {

/// Neither its name nor what it is used for changes what is measured.
CrowdConfiguration without_name(CrowdConfiguration configuration) {
  const CrowdConfiguration none;
  configuration.name = none.name;
  configuration.held_out = none.held_out;
  return configuration;
}

}  // namespace

std::string crowd_run_key(const SoftParticleSpec& spec, const CrowdConfiguration& configuration, const CrowdPlan& plan,
                          const CrowdOptions& options, const std::string& contents) {
  return KeyText("crowd run", kCrowdSchema, spec, without_name(configuration), plan, options, contents).text();
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
