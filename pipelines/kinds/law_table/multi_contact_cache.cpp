#include "pipelines/kinds/law_table/multi_contact_cache.h"

#include "common/core/error.h"
#include "pipelines/kinds/law_table/multi_contact_members.h"

namespace softgrain {

namespace {

/// Neither its name nor what it is used for changes what is measured.
MultiContactConfiguration without_name(MultiContactConfiguration configuration) {
  const MultiContactConfiguration none;
  configuration.name = none.name;
  configuration.held_out = none.held_out;
  return configuration;
}

}  // namespace

std::string multi_contact_run_key(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                  const MultiContactPlan& plan, const MultiContactOptions& options,
                                  const std::string& contents) {
  return KeyText("crowd run", kMultiContactSchema, spec, without_name(configuration), plan, options, contents).text();
}

std::optional<MultiContactRun> MultiContactCache::find(const std::string& key) const {
  std::optional<MultiContactRun> found;
  cache_.find(key, [&](const h5::Group& root) {
    std::vector<MultiContactRun> runs = read_multi_contact_runs(root);
    if (runs.size() != 1) throw IoError(multi_contact_run_name(key) + ": damaged: holds no single run");
    found = std::move(runs.front());
  });
  return found;
}

void MultiContactCache::keep(const std::string& key, const MultiContactRun& run) const {
  cache_.keep(key, [&](const h5::Group& root) { write_multi_contact_runs(root, {run}); });
}

}  // namespace softgrain
