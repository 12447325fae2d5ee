// Finished crowd runs that later runs need not measure again: one small file each, named by what determines it.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/data/crowd_measurements.h"
#include "microsim/crowd_experiment.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

/// Raised whenever the same key would give another result: contact laws, relaxation, packing, what is recorded. The
/// test of cached results holds a run of this number.
inline constexpr int kCrowdSchema = 3;

/// Everything that determines a run, as text. `contents` says what the bodies hold (seed and packing of the centre and
/// of its soft neighbours, and the tag of a level that adds inner soft particles). Neither names nor threads matter.
std::string crowd_run_key(const SoftParticleSpec& spec, const CrowdConfiguration& configuration, const CrowdPlan& plan,
                          const CrowdOptions& options, const std::string& contents);

/// The name of its file.
inline std::string crowd_run_name(const std::string& key) { return ResultCache::name("crowd", key); }

class CrowdCache {
 public:
  /// `directory` empty: nothing is ever found or kept. `say` takes remarks.
  CrowdCache(std::string directory, std::function<void(const std::string&)> say)
      : cache_(std::move(directory), "crowd-run", "crowd", "measured again", std::move(say)) {}

  /// A file that is damaged or belongs to another key is ignored, with a remark.
  [[nodiscard]] std::optional<CrowdRun> find(const std::string& key) const;
  /// Throws FileTrouble.
  void keep(const std::string& key, const CrowdRun& run) const;

 private:
  ResultCache cache_;
};

}  // namespace softgrain
