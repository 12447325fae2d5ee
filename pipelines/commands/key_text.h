// How commands describe the keys of scenes: schema and new.
#pragma once

#include <string>
#include <vector>

#include "common/io/key_record.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// The kind of this name, for `command`. Throws InputError, naming the nearest.
const SceneKind& kind_named(const std::string& name, const std::string& command);

/// "[packing]", "[[stage]]", "mu".
std::string written(const ExploredKey& key);

/// Allowed range as it is shown: ends with six digits, none where they mean nothing.
Range allowed(const AskedKey& key);

/// All forms that the key may have: "m, above 0", "\"fast\", \"slow\"". `quote` stands on both sides of a word.
std::string allowed_forms(const ExploredKey& key, const std::string& quote = "\"");

/// "-" for a key that must be there, "none" for one that need not.
std::string default_text(const ExploredKey& key);

/// Keys that stand in a table; tables that stand in it come as one row each.
std::vector<ExploredKey> in_table(const std::vector<ExploredKey>& all, const std::string& table);

}  // namespace softgrain
