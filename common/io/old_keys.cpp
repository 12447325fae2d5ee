
#include <array>
#include <string_view>
#include <utility>

#include "common/core/error.h"
#include "common/io/scene_impl.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

struct OldKey {
  std::string_view table;  ///< table that the key is in; empty: the root
  std::string_view before;
  std::string_view now;

  [[nodiscard]] std::string path(std::string_view key) const {
    return (table.empty() ? "" : std::string(table) + ".") + std::string(key);
  }
};

constexpr std::array kOldKeys{OldKey{"", "crowd", "multi_contact"}, OldKey{"calibrate", "crowd", "multi_contact"}};
/// In the entries of law tables, at any depth.
constexpr std::array kOldMembers{OldKey{"", "retreat", "unloading"},
                                 OldKey{"", "retreat_measured", "unloading_measured"}};

void rename_key(toml::table& table, const OldKey& key, const std::string& name) {
  toml::node* old = table.get(key.before);
  if (old == nullptr) return;
  if (table.contains(key.now))
    throw InputError(name + ":" + std::to_string(old->source().begin.line) + ": " + std::string(key.before) +
                     " is an earlier name of " + std::string(key.now) + "; leave one of them out");
  old->visit([&](auto& node) { table.insert(key.now, std::move(node)); });  // moved: a copy forgets its line
  table.erase(key.before);
}

void rename_members(toml::node& node, const std::string& name) {
  if (toml::table* table = node.as_table()) {
    for (const OldKey& key : kOldMembers) rename_key(*table, key, name);
    for (auto&& [key, child] : *table) rename_members(child, name);
  } else if (toml::array* array = node.as_array()) {
    for (toml::node& child : *array) rename_members(child, name);
  }
}

}  // namespace

void rename_old_keys(SceneDocument& document) {
  toml::table& root = *document.content;
  for (const OldKey& key : kOldKeys) {
    toml::table* table = key.table.empty() ? &root : root.get_as<toml::table>(key.table);
    if (table != nullptr) rename_key(*table, key, document.name);
  }
  if (toml::node* entries = root.get("entry")) rename_members(*entries, document.name);
}

std::string current_key(const std::string& path) {
  for (const OldKey& key : kOldKeys)
    if (const std::string old = key.path(key.before); path == old || path.starts_with(old + "."))
      return key.path(key.now) + path.substr(old.size());
  return path;
}

}  // namespace softgrain
