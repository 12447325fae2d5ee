// Finished multi-contact runs that later runs need not measure again: one small file each, named by what determines it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/data/multi_contact_measurements.h"
#include "microsim/multi_contact_experiment.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

/// Raised whenever the same key would give another result: contact laws, relaxation, packing, what is recorded. The
/// test of cached results holds a run of this number.
inline constexpr int kMultiContactSchema = 3;

/// Everything that determines a run, as text. `contents` says what the bodies hold (seed and packing of the centre and
/// of its soft neighbours, and the tag of a level that adds inner soft particles). Neither names nor threads matter.
std::string multi_contact_run_key(const SoftParticleSpec& spec, const MultiContactConfiguration& configuration,
                                  const MultiContactPlan& plan, const MultiContactOptions& options,
                                  const std::string& contents);

/// The name of its file.
inline std::string multi_contact_run_name(const std::string& key) { return ResultCache::name("crowd", key); }

class MultiContactCache {
 public:
  /// `directory` empty: nothing is ever found or kept. `say` takes remarks.
  MultiContactCache(std::string directory, std::function<void(const std::string&)> say)
      : cache_(std::move(directory), "crowd-run", "crowd", "measured again", std::move(say)) {}

  /// A file that is damaged or belongs to another key is ignored, with a remark.
  [[nodiscard]] std::optional<MultiContactRun> find(const std::string& key) const;
  /// Throws IoError.
  void keep(const std::string& key, const MultiContactRun& run) const;

 private:
  ResultCache cache_;
};

}  // namespace softgrain
