// Keys of scenes as earlier versions named them. They are still read.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <string>

namespace softgrain {

struct SceneDocument;

/// Gives keys of earlier versions their present names. Throws InputError where a scene has both.
void rename_old_keys(SceneDocument& document);

/// The present path of a key ("crowd.points": "multi_contact.points").
std::string current_key(const std::string& path);

}  // namespace softgrain
