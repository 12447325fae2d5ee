#include "common/io/old_keys.h"

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

}  // namespace

void rename_old_keys(SceneDocument& document) {
  toml::table& root = *document.content;
  for (const OldKey& key : kOldKeys) {
    toml::table* table = key.table.empty() ? &root : root.get_as<toml::table>(key.table);
    toml::node* old = table == nullptr ? nullptr : table->get(key.before);
    if (old == nullptr) continue;
    if (table->contains(key.now))
      throw InputError(document.name + ":" + std::to_string(old->source().begin.line) + ": " + std::string(key.before) +
                       " is an earlier name of " + std::string(key.now) + "; leave one of them out");
    old->visit([&](auto& node) { table->insert(key.now, std::move(node)); });  // moved: a copy forgets its line
    table->erase(key.before);
  }
}

std::string current_key(const std::string& path) {
  for (const OldKey& key : kOldKeys)
    if (const std::string old = key.path(key.before); path == old || path.starts_with(old + "."))
      return key.path(key.now) + path.substr(old.size());
  return path;
}

}  // namespace softgrain
