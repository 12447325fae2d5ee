// Which keys readers ask scenes for, and what they would take: for tests and tools that go over all keys of a kind.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/io/scene.h"

namespace softgrain {

/// How a key was asked for; `any`: only whether it is there, and what it is.
enum class KeyForm { any, number, count, flag, text, choice, vector, numbers, texts, flags, table, tables };

/// A key that was asked for.
struct AskedKey {
  KeyForm form = KeyForm::any;
  bool given = false;     ///< the scene has it
  bool required = false;  ///< there is no fallback
  Unit unit = Unit::none;
  Range range{};                     ///< allowed range of numbers and counts
  std::vector<double> numbers{};     ///< what the reader got: numbers, counts, flags
  std::vector<std::string> texts{};  ///< texts and words that the reader got
  std::vector<std::string> words{};  ///< words that a choice allows
  std::string meaning{};             ///< as in Key
  std::string usual{};
  bool retired = false;
};

/// Takes down, while it lives, the keys that this thread asks scenes for. One at a time.
class KeyRecord {
 public:
  KeyRecord();
  ~KeyRecord();
  KeyRecord(const KeyRecord&) = delete;
  KeyRecord& operator=(const KeyRecord&) = delete;

  /// Keys of the scene of this name, by path as --set writes it ("material.E", "variant.0.mu"). What a variant that is
  /// laid over a scene (Scene::variant) is asked for counts for both places.
  [[nodiscard]] const std::map<std::string, AskedKey>& keys(const std::string& scene) { return keys_[scene]; }

  /// Their paths, in the order in which they were first asked for.
  [[nodiscard]] const std::vector<std::string>& order(const std::string& scene) { return orders_[scene]; }

  /// Paths of tables whose names were asked for: what stands in them has names that the scene chooses.
  [[nodiscard]] const std::vector<std::string>& free_tables(const std::string& scene) { return free_[scene]; }

  /// Adds what is known of a key to what was known before. For the sources of common/io.
  void note(const std::string& scene, const std::string& path, const AskedKey& asked);
  void note_free(const std::string& scene, const std::string& path) { free_[scene].push_back(path); }
  /// Null: nobody takes keys down.
  static KeyRecord* current();

 private:
  std::map<std::string, std::map<std::string, AskedKey>> keys_;
  std::map<std::string, std::vector<std::string>> orders_;
  std::map<std::string, std::vector<std::string>> free_;
};

// All keys that a reader of scenes asks for in any of its modes, found by reading: every word of a choice, every flag
// and every table that may stand there is tried in turn.

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
