// All keys that a reader of scenes asks for in any of its modes, found by reading: every word of a choice, every flag
// and every table that may stand there is tried in turn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/io/key_record.h"
#include "common/io/scene.h"

namespace softgrain {

/// Stands for names that a scene chooses: "material.NAME.density".
inline constexpr const char* kFreeName = "NAME";

/// A key of a kind of scenes, as all modes of its reader together show it.
struct ExploredKey {
  std::string table;  ///< tables that it stands in, from the root: "macro", "loading.stage"; empty: the root
  std::string name;
  bool required = false;         ///< nothing holds without it
  AskedKey asked{};              ///< form, unit, range, words, meaning; lists of words of several modes are joined
  std::vector<AskedKey> also{};  ///< other forms that it may have: a number, or a word
  std::vector<std::string> defaults{};  ///< what holds without it, as TOML; several where it depends on other keys

  [[nodiscard]] bool is_table() const { return asked.form == KeyForm::table || asked.form == KeyForm::tables; }
  [[nodiscard]] std::string path() const { return table.empty() ? name : table + "." + name; }
};

/// Keys in the order in which they are asked for, those of a table together; none that are only refused. `read` gets
/// scenes of which most are not complete, and may throw InputError; `starts`: scenes to begin with, as TOML, each for
/// modes that one changed key after another does not reach from the others.
std::vector<ExploredKey> explore_keys(const std::vector<std::string>& starts,
                                      const std::function<void(const Scene&)>& read);

}  // namespace softgrain
