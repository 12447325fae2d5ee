// Inner side of scene.h: the parsed document and the record of keys asked for. For the sources of common/io only.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/io/scene.h"

// toml++ is included by sources only; this is how its version 3 declares the two types.
namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace softgrain {

/// A parsed file; every table of it holds the document.
struct SceneDocument {
  std::string name;                    ///< of the file, as shown in messages
  std::string source;                  ///< the file as it was read
  std::vector<std::string> overrides;  ///< applied to it
  std::shared_ptr<toml::table> content;
  std::set<const toml::node*> overridden;  ///< nodes that --set gave
};

/// Parses the text and applies the overrides. Throws BadInput.
std::shared_ptr<SceneDocument> read_document(const std::string& text, const std::string& name,
                                             const std::vector<std::string>& overrides);

std::string as_toml(const toml::table& table);

struct SceneTable::Impl {
  std::shared_ptr<const SceneDocument> document;
  const toml::table* content = nullptr;  ///< null: the table is absent, all fallbacks hold
  std::string name;                      ///< dotted, empty for the root
  bool element = false;                  ///< one of an [[array of tables]]
  std::string place;                     ///< "file:line" of the header
  std::set<std::string> known;           ///< keys that were asked for
  std::map<std::string, std::vector<std::shared_ptr<Impl>>> children;

  /// The node under `key`, marked as known; null when absent.
  const toml::node* find(const std::string& key);
  /// The same, but absence is an error that names the nearest key that is there.
  const toml::node& require(const std::string& key);

  [[nodiscard]] std::string dotted(const std::string& key) const { return name.empty() ? key : name + "." + key; }
  /// "in [packing]", "at the top level".
  [[nodiscard]] std::string location() const;
  /// "file:line", or "file (--set a.b)" for what came from the command line.
  [[nodiscard]] std::string where(const std::string& key, const toml::node& node) const;
  /// Throws BadInput "file:line: key = value: problem".
  [[noreturn]] void reject(const std::string& key, const toml::node& node, const std::string& problem) const;

  std::shared_ptr<Impl> make_child(const std::string& key, const toml::table* table, bool is_element) const;
  void finish() const;
};

/// A value as it is shown in messages, shortened when long.
std::string shown(const toml::node& node);

}  // namespace softgrain
