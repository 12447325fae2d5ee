// Inner side of scene.h: the parsed document and the record of keys asked for. For the sources of common/io only.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/core/error.h"
#include "common/io/key_record.h"
#include "common/io/scene.h"

// toml++ is included by sources only; this is how its version 3 declares the two types.
namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace softgrain {

/// The errors of a scene that is being read to its end.
struct SceneErrors {
  std::vector<SceneError> all;
  std::set<std::pair<std::size_t, std::string>> noted;  ///< line and text of them
  std::set<std::string> meant;  ///< unknown keys ("packing.raddius") that a message about a missing one names

  /// Once, wherever it is met again.
  void note(const SceneError& error);
};

/// A parsed file; every table of it holds the document.
struct SceneDocument {
  std::string name;                    ///< name of the file, as shown in messages
  std::string source;                  ///< the file as it was read
  std::vector<std::string> overrides;  ///< applied to it
  std::string variant;                 ///< "variant.0": the one that is laid over it
  std::shared_ptr<toml::table> content;
  std::set<const toml::node*> overridden;  ///< nodes that --set gave
  mutable SceneErrors* errors = nullptr;   ///< null: the first one is thrown
};

/// Parses the text and applies the overrides. Throws InputError.
std::shared_ptr<SceneDocument> read_document(const std::string& text, const std::string& name,
                                             const std::vector<std::string>& overrides);

std::string as_toml(const toml::table& table);

struct SceneTable::Impl {
  std::shared_ptr<const SceneDocument> document;
  const toml::table* content = nullptr;  ///< null: the table is absent, all fallbacks hold
  std::string name;                      ///< dotted, empty for the root
  std::string path;                      ///< dotted name with numbers of elements, as --set writes it
  bool element = false;                  ///< one of an [[array of tables]]
  std::string place;                     ///< "file:line" of the header
  std::size_t line = 0;                  ///< line of the header
  std::set<std::string> known;           ///< keys that were asked for
  bool missing = false;                  ///< it had to be there
  bool replaced = false;                 ///< a value was wrong: the reader has another one
  bool misread = false;                  ///< a word was wrong: other keys may have been asked for
  bool broken = false;                   ///< not read to its end
  std::set<std::string> blamed;          ///< keys of which one of several errors was noted
  bool wrong = false;                    ///< anything was noted
  std::map<std::string, std::vector<std::shared_ptr<Impl>>> children;

  /// Tells who takes keys down, if anybody does.
  void note_asked(const Key& key, AskedKey asked) const;
  /// The node under `key`, marked as known; null when absent.
  const toml::node* find(const std::string& key);
  /// The node under `key`, marked as known. Absence is an error that names the nearest key that is there.
  const toml::node& require(const std::string& key);

  [[nodiscard]] std::string dotted(const std::string& key) const { return name.empty() ? key : name + "." + key; }
  /// "in [packing]", "at the top level".
  [[nodiscard]] std::string location() const;
  /// "file:line", or "file (--set a.b)" for what came from the command line.
  [[nodiscard]] std::string where(const std::string& key, const toml::node& node) const;
  /// 0 for what came from the command line.
  [[nodiscard]] std::size_t line_of(const toml::node& node) const;
  /// "file:line: key = value: problem".
  [[nodiscard]] SceneError error_at(const std::string& key, const toml::node* node, const std::string& problem) const;
  /// Throws it as BadScene.
  [[noreturn]] void throw_error(const std::string& key, const toml::node& node, const std::string& problem) const;

  /// Notes what a BadScene of this file says, and what another error says at the header of this table.
  void note(const Error& error);
  /// What `read` returns; where errors are collected and it throws one, that is noted and `substitute` returned.
  /// `word`: the value decides which other keys are asked for.
  template <class Read, class T>
  T value(Read read, const T& substitute, bool word = false) {
    if (!document->errors) return read();
    try {
      return read();
    } catch (const BadScene& e) {
      note(e);
      replaced = true;
      misread = misread || word;
      return substitute;
    }
  }

  /// Whether `what` holds for this table or one below.
  [[nodiscard]] bool any(bool Impl::*what) const;

  std::shared_ptr<Impl> make_child(const std::string& key, const toml::table* table, bool is_element) const;
  [[nodiscard]] std::string setting_beside(const toml::node& node) const;
  /// Adds the places of a known key, in this table and those below: "'mu' in [material]", "'material.mu'" for --set.
  void find_key(const std::string& key, bool as_setting, std::set<std::string>& out) const;
  [[nodiscard]] std::string help_for_unknown(const std::string& key, const toml::node& node, const Impl& top) const;
  /// Adds keys that nobody asked for; `top` is the table of the scene in which they may belong elsewhere.
  void find_unknown(std::vector<SceneError>& out, const Impl& top) const;
};

/// A value as it is shown in messages, shortened when long.
std::string shown(const toml::node& node);

/// Gives keys of earlier versions, which are still read, their present names. Throws InputError where a scene has both.
void rename_old_keys(SceneDocument& document);

/// The present path of a key ("crowd.points": "multi_contact.points").
std::string current_key(const std::string& path);

}  // namespace softgrain
