// Strict reader of TOML scenes: every key is asked for by the code that uses it; a key nobody asked for is an error
// that names the file, the line and the nearest known key. Numbers are SI, or strings with a unit ("16 mm", "0.5 MPa").
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/error.h"
#include "common/core/material.h"
#include "common/core/vec.h"

namespace softgrain {

/// Physical dimension of a number in a scene; decides which units a string may carry.
enum class Unit {
  none,
  length,
  mass,
  time,
  frequency,
  pressure,
  density,
  velocity,
  angular_velocity,
  force,
  acceleration,
  stiffness,
  angle_degree
};

/// Allowed values, either end open or closed.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false;
  bool high_open = false;

  static Range any() { return {}; }
  static Range positive() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static Range not_negative() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }
  static Range closed(double low, double high) { return {low, high, false, false}; }
  static Range above(double low) { return {low, std::numeric_limits<double>::infinity(), true, false}; }
  /// Of coefficients of friction: with a thousand no contact slides that bears anything, and more is a wrong unit.
  static Range friction() { return closed(0.0, 1000.0); }

  [[nodiscard]] bool contains(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
};

/// "above 0", "from 0 to 0.5", "at least 0 and below 1"; empty when all numbers are allowed.
std::string range_text(const Range& range);

/// The SI unit of numbers of a dimension, "m"; angles are in degrees. Empty for none.
std::string si_unit(Unit unit);

/// The name of a key and what it means, said once: where the key is read (`softgrain schema`, tables of the guide).
struct Key {
  std::string name;
  std::string meaning{};  ///< without an end stop
  std::string usual{};    ///< what holds without the key, where the fallback does not say it
  bool retired = false;   ///< read only to be refused with a hint

  Key(const char* key) : name(key) {}             // NOLINT(google-explicit-constructor)
  Key(std::string key) : name(std::move(key)) {}  // NOLINT(google-explicit-constructor)
  /// A key of earlier versions, which is read to be refused with a hint.
  static Key of_before(const char* name) {
    Key key(name);
    key.retired = true;
    return key;
  }
  Key(std::string key, std::string means, std::string otherwise = "")
      : name(std::move(key)), meaning(std::move(means)), usual(std::move(otherwise)) {}
};

// Keys that scenes of several kinds have.
inline const Key kKindKey{"kind", "what the scene describes"};
inline const Key kTitleKey{"title", "title of summary and report"};
inline const Key kSeedKey{"seed", "seed of the random numbers; `--seed` replaces it"};

/// One error: "file:line: key = value: what is wrong, allowed range".
struct SceneError {
  std::size_t line = 0;  ///< 0: not of the file, but of the command line or of a file that the scene names
  std::string text{};
  std::string of{};  ///< what follows the text: " (in the variant ...)"
};

/// What is wrong with a scene: in the order of the file, one a line, the first twenty.
class BadScene : public InputError {
 public:
  BadScene(const std::string& file, std::vector<SceneError> errors);
  [[nodiscard]] const std::string& file() const { return file_; }
  /// None of a complaint that only follows from an error that was noted before (Scene::read).
  [[nodiscard]] const std::vector<SceneError>& errors() const { return errors_; }

 private:
  std::string file_;
  std::vector<SceneError> errors_;
};

/// A table of a scene. Copies share the record of which keys were used.
/// A wrong type, unit, NaN or range throws BadScene; within Scene::read it is noted, and the reader gets a value that
/// is allowed: the fallback, else the low end of the range (what asks for least beside it), and none for what goes with
/// a table that is missing.
class SceneTable {
 public:
  struct Impl;
  explicit SceneTable(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

  [[nodiscard]] bool has(const std::string& key) const;  ///< whether the key is present; also marks it as known
  [[nodiscard]] bool is_text(
      const std::string& key) const;  ///< present and in quotes (a word such as "auto", or a number with unit)
  [[nodiscard]] bool is_list(const std::string& key) const;  ///< present and in brackets

  [[nodiscard]] double number(const Key& key, Unit unit, const Range& range = Range::any()) const;
  [[nodiscard]] double number(const Key& key, Unit unit, const Range& range, double fallback) const;
  [[nodiscard]] std::int64_t count(const Key& key, std::int64_t low, std::int64_t high) const;
  [[nodiscard]] std::int64_t count(const Key& key, std::int64_t low, std::int64_t high, std::int64_t fallback) const;
  [[nodiscard]] bool flag(const Key& key, bool fallback) const;
  [[nodiscard]] std::string text(const Key& key) const;
  [[nodiscard]] std::string text(const Key& key, const std::string& fallback) const;
  /// A text that must hold more than spaces where it is given: the name of something, or of a file.
  [[nodiscard]] std::string filled_text(const Key& key) const;
  [[nodiscard]] std::string filled_text(const Key& key, const std::string& fallback) const;
  /// The same without control characters: a name that stands in messages, tables and files.
  [[nodiscard]] std::string line_text(const Key& key) const;
  [[nodiscard]] std::string line_text(const Key& key, const std::string& fallback) const;
  /// What line_text() asks of a name, where the name is that of a table.
  void require_line(const std::string& key, const std::string& name) const;
  /// Key `title`, one line like line_text(); empty where the scene has none.
  [[nodiscard]] std::string title() const;
  /// One of a list of words; the error names the nearest.
  [[nodiscard]] std::string choice(const Key& key, std::initializer_list<const char*> words) const;
  [[nodiscard]] std::string choice(const Key& key, const std::vector<const char*>& words) const;
  [[nodiscard]] std::string choice(const Key& key, std::initializer_list<const char*> words,
                                   const std::string& fallback) const;
  [[nodiscard]] std::string choice(const Key& key, const std::vector<const char*>& words,
                                   const std::string& fallback) const;
  /// The value behind one of the words of an enum, of some of its values, and with a value for an absent key.
  template <NamedEnum Enum>
  [[nodiscard]] Enum choice(const Key& key) const {
    return *parse_enum<Enum>(choice(key, all_enum_names<Enum>()));
  }
  template <NamedEnum Enum>
  [[nodiscard]] Enum choice(const Key& key, std::initializer_list<Enum> allowed) const {
    std::vector<const char*> some;
    for (const EnumName<Enum>& w : enum_names<Enum>)
      if (std::find(allowed.begin(), allowed.end(), w.value) != allowed.end()) some.push_back(w.text);
    return *parse_enum<Enum>(choice(key, some));
  }
  template <NamedEnum Enum>
  [[nodiscard]] Enum choice(const Key& key, std::type_identity_t<Enum> fallback) const {
    return *parse_enum<Enum>(choice(key, all_enum_names<Enum>(), to_string(fallback)));
  }
  [[nodiscard]] Vec3 vector3(const Key& key, Unit unit) const;
  [[nodiscard]] Vec3 vector3(const Key& key, Unit unit, const Vec3& fallback) const;
  [[nodiscard]] std::vector<double> numbers(const Key& key, Unit unit, const Range& range = Range::any()) const;
  [[nodiscard]] std::vector<double> numbers(const Key& key, Unit unit, const Range& range,
                                            const std::vector<double>& fallback) const;
  [[nodiscard]] std::vector<std::string> texts(const Key& key) const;
  [[nodiscard]] std::vector<bool> flags(const Key& key) const;

  [[nodiscard]] SceneTable table(const Key& key) const;  ///< required sub-table
  /// Sub-table, or an empty one (all fallbacks hold) when absent.
  [[nodiscard]] SceneTable table_or_empty(const Key& key) const;
  [[nodiscard]] std::vector<SceneTable> tables(const Key& key) const;  ///< [[array of tables]], empty when absent
  [[nodiscard]] std::vector<std::string> keys() const;  ///< names present, for tables with free names ([material.NAME])
  [[nodiscard]] SceneTable named(const Key& key) const;  ///< sub-table with a free name

  /// Name of the table as --set writes it, "grains.sizes", "contact.0"; empty for the root.
  [[nodiscard]] std::string path() const;
  /// "file:line" of a key (of the table itself when the key is absent), for messages of checks that span keys.
  [[nodiscard]] std::string where(const std::string& key) const;
  /// A path written in the scene, relative to the scene's own folder.
  [[nodiscard]] std::string resolve(const std::string& relative) const;
  /// Throws BadScene at `key` with this text in the standard form; one without errors where a value of this table, or
  /// of one below, is not that of the file, so that the complaint may come from that.
  [[noreturn]] void throw_error(const std::string& key, const std::string& problem) const;
  /// Adds an error as throw_error() does, where reading can go on: within Scene::read it is noted.
  void add_error(const std::string& key, const std::string& problem) const;
  /// Adds the error to each of these keys that is given: they do not go with what was read.
  template <class Keys>
  void refuse(const Keys& keys, const std::string& problem) const {
    for (const auto& key : keys)
      if (has(key)) add_error(key, problem);
  }
  void refuse(std::initializer_list<const char*> keys, const std::string& problem) const {
    refuse<std::initializer_list<const char*>>(keys, problem);
  }
  /// Whether anything was found wrong so far in this table or one below. Ask this before a check that takes values of
  /// several tables.
  [[nodiscard]] bool has_errors() const;
  /// Reads this table, or a part of it; within Scene::read an InputError that ends it is noted, and what follows is
  /// read.
  void section(const std::function<void()>& read) const;
  /// Runs a rule that reads no keys of this table; within Scene::read an InputError that ends it is noted, and what
  /// follows is read.
  void check(const std::function<void()>& rule) const;

  /// Throws BadScene for the keys of this table, or any table below, that nobody asked for.
  void finish() const;

 private:
  std::shared_ptr<Impl> impl_;
};

struct SceneDocument;

/// A scene file with its overrides applied.
class Scene {
 public:
  /// Reads `path`, then applies each "key.sub=value" (value in TOML, bare words taken as strings). Throws InputError,
  /// IoError.
  static Scene load(const std::string& path, const std::vector<std::string>& overrides = {});
  /// Reads a scene from a text (tests, embedded scenes); `name` stands for the file in messages.
  static Scene parse(const std::string& text, const std::string& name, const std::vector<std::string>& overrides = {});

  [[nodiscard]] SceneTable root() const;
  /// What `reader` makes of the root, once all is read to the last key (SceneTable::finish). Throws BadScene with all
  /// errors that were found on the way.
  template <class Reader>
  auto read(Reader&& reader) const {
    std::optional<std::invoke_result_t<Reader, SceneTable>> out;
    collect([&] { out.emplace(reader(root())); });
    return std::move(*out);
  }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The scene as it is used, overrides included, as TOML: goes into every output as provenance.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// A path written in the scene, relative to the scene's own folder.
  [[nodiscard]] std::string resolve(const std::string& relative) const;
  /// The scene with its [[variant]] of this number laid over it: tables key by key, everything else replaced. The
  /// variants themselves and the keys in `apart` belong to neither. Messages name the lines where keys stand.
  [[nodiscard]] Scene variant(std::size_t number, const std::vector<std::string>& apart) const;

 private:
  Scene(const std::string& name, std::string text, std::shared_ptr<SceneDocument> document);
  void collect(const std::function<void()>& reader) const;

  std::shared_ptr<const SceneDocument> document_;
  std::string path_;
  std::string text_;
  std::shared_ptr<SceneTable::Impl> root_;
};

/// Parses "16 mm" or "0.016" into SI. Throws InputError with the units that are known for this dimension.
double parse_quantity(const std::string& text, Unit unit);

/// Known word nearest to `word` by edit distance, empty when none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

/// "softgrain has no fluids: see README, 'What it is not for'" for a key that asks for what softgrain does not model
/// ("fluid", "fluid_viscosity"); empty for others.
std::string out_of_scope_text(const std::string& key);

/// "nearest is 'NAME'" for a message about an unknown word; `otherwise` when none is near.
std::string nearest_text(const std::string& word, const std::vector<std::string>& known,
                         const std::string& otherwise = "");

/// The range of Poisson's ratio as readers of keys take it.
inline constexpr Range kPoissonRange{kPoissonAbove, kPoissonHighest, true, false};

/// SI value of a number with any unit that scenes know ("50 GPa": 5e10; angles in degrees), or without one; none for
/// what is no such number. No unit stands for two quantities with different factors.
std::optional<double> quantity_of_any_unit(const std::string& text);

/// Every key of a TOML text with its value as text: "macro.bodies" -> "40", elements of arrays of tables by their
/// numbers as --set counts them, "contact.0.mu" -> "0.3". Numbers that are equal have equal texts (0.3, 0.30); texts
/// come without quotes, lists in brackets. Throws InputError for what is no TOML; `name`: of the text in the message.
std::map<std::string, std::string> flat_scene(const std::string& text, const std::string& name);

// Vectors of a scene with as many components as it has dimensions.

/// Throws InputError.
template <int D>
Vec<D> read_vector(const SceneTable& t, const Key& key, Unit unit) {
  if constexpr (D == 3) {
    return t.vector3(key, unit);
  } else {
    const std::vector<double> values = t.numbers(key, unit);
    if (values.size() == 2) return {{values[0], values[1]}};
    t.add_error(key.name, "must have two components, as the scene has dimension = 2");
    return {};
  }
}
template <int D>
Vec<D> read_vector(const SceneTable& t, const Key& key, Unit unit, const Vec<D>& fallback) {
  return t.has(key.name) ? read_vector<D>(t, key, unit) : fallback;
}

}  // namespace softgrain
