// Resolved twins that later runs need not run again: they know nothing of the law that they are compared with.
#pragma once

#include <functional>
#include <string>

#include "pipelines/kinds/macro/stage.h"

namespace softgrain {

/// Raised whenever the same key would give another curve: when contact laws, relaxations, twins or what is recorded
/// change. The test of cached results holds a curve of this number.
inline constexpr int kTwinSchema = 2;

/// The text of all that determines the curve of a twin and the states that are kept of it: where every grain and shell
/// is at the start (`macro`), its springs (`packing`), material, test and motion (`spec`), and what of it is recorded
/// (`setup`). Cost is as it was when it ran.
std::string twin_key(const MacroSpec& spec, const MacroSetup& setup, const MacroPacking& packing,
                     const MacroSystem& macro, const std::string& engine, std::int64_t sample, const std::string& runs);

/// The text of all that determines how a sample, a packing of grains without soft particles, answers its test.
std::string test_key(const MacroSetup& setup, const MacroPacking& packing, std::int64_t sample);

/// Taken from --twin-cache, or run now and kept there; one that is not usable is not kept.
RunOutcome kept_twin(const std::string& key, const Run& run, const std::function<RunOutcome()>& go);

}  // namespace softgrain
