#include "common/io/key_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <set>
#include <sstream>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// Keys that were set one after another to reach a mode.
using Changes = std::vector<std::string>;

constexpr std::size_t kDeepest = 6;     // changes that lead to one mode
constexpr double kFewCounts = 4.0;      // counts of which each may be a mode
constexpr const char* kName = "probe";  // of the scenes that are read

bool is_number(const std::string& part) {
  return !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
}

/// "loading.0.stage.1.kind": table "loading.stage", name "kind".
ExploredKey placed(const std::string& path) {
  ExploredKey key;
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '.');) {
    if (is_number(part)) continue;
    if (!key.name.empty()) append_part(key.table, key.name, ".");
    key.name = part;
  }
  return key;
}

double allowed_number(const Range& r) {
  if (std::isfinite(r.low) && std::isfinite(r.high)) return 0.5 * (r.low + r.high);
  if (std::isfinite(r.low)) return r.low + 1.0;
  return std::isfinite(r.high) ? r.high - 1.0 : 1.0;
}

/// Values that may lead to other keys.
std::vector<std::string> values_to_try(const AskedKey& k) {
  std::vector<std::string> out;
  switch (k.form) {
    case KeyForm::any:
      return {"0.5", "\"x\"", "[0.5]", "true", "{}", "[{}]"};
    case KeyForm::choice:
      for (const std::string& w : k.words) out.push_back("\"" + w + "\"");
      return out;
    case KeyForm::flag:
      return {"true", "false"};
    case KeyForm::count:
      if (k.range.high - k.range.low > kFewCounts) return {rounded_text(k.range.low + 1.0, {15})};
      for (double x = k.range.low; x <= k.range.high; x += 1.0) out.push_back(rounded_text(x, {15}));
      return out;
    case KeyForm::number:
      return {rounded_text(allowed_number(k.range), {6}), fmt::format("\"{}\"", kFreeName)};
    case KeyForm::text:
      return {fmt::format("\"{}\"", kFreeName)};
    case KeyForm::texts:
      return {fmt::format("[\"{}\"]", kFreeName)};
    case KeyForm::numbers:
      return {"[" + rounded_text(allowed_number(k.range), {6}) + "]"};
    case KeyForm::vector:
      return {"[1.0, 1.0, 1.0]"};
    case KeyForm::flags:
      return {"[true, true, true]"};
    case KeyForm::table:
      return {"{}"};
    case KeyForm::tables:
      return {"[{}]"};
  }
  return out;
}

std::string list_text(const std::vector<std::string>& parts) { return "[" + join_text(parts) + "]"; }

/// What the reader got, as TOML.
std::string value_text(const AskedKey& k) {
  std::vector<std::string> parts;
  const bool flags = k.form == KeyForm::flag || k.form == KeyForm::flags;
  for (const double x : k.numbers) parts.push_back(flags ? (x != 0.0 ? "true" : "false") : rounded_text(x, {6}));
  for (const std::string& t : k.texts) parts.push_back("\"" + t + "\"");
  const bool list =
      k.form == KeyForm::vector || k.form == KeyForm::numbers || k.form == KeyForm::texts || k.form == KeyForm::flags;
  if (list) return list_text(parts);
  return parts.empty() ? "" : parts.front();
}

class Explorer {
 public:
  explicit Explorer(const std::function<void(const Scene&)>& read) : read_(read) {}

  /// Adds the keys of scenes that begin like this.
  void explore(const std::string& start) {
    start_ = start;
    tried_.clear();
    looked_for_.clear();
    for (waiting_.push_back({}); !waiting_.empty(); waiting_.pop_front()) look(waiting_.front());
  }

  std::vector<ExploredKey> all() {
    std::erase_if(keys_, [](const ExploredKey& k) { return k.asked.retired || k.asked.form == KeyForm::any; });
    // Tables in the order in which they were found, and in each the keys before the tables below.
    std::ranges::stable_sort(keys_, {},
                             [&](const ExploredKey& k) { return std::pair(place_of(k.table), k.is_table()); });
    return std::move(keys_);
  }

 private:
  /// Reads the scene with these changes, and notes what it was asked for.
  void look(const Changes& changes) {
    KeyRecord record;
    try {
      read_(Scene::parse(start_, kName, changes));
    } catch (const Error&) {  // refused, after it was asked for
    }
    std::size_t after = keys_.size();
    for (const std::string& path : record.order(kName)) after = note(placed(path), record.keys(kName).at(path), after);
    if (changes.size() >= kDeepest || leads_nowhere(changes)) return;
    for (const std::string& path : record.order(kName)) plan(path, record.keys(kName).at(path), changes);
    for (const std::string& path : record.free_tables(kName))
      if (!path.empty()) plan(path + "." + kFreeName, {.form = KeyForm::table}, changes);
  }

  /// Whether the last value is one that nobody takes: of an unknown key, or a number where a table must stand.
  [[nodiscard]] bool leads_nowhere(const Changes& changes) const {
    if (changes.empty()) return false;
    const std::string path = path_of(changes.back());
    const std::string value = changes.back().substr(path.size() + 1);
    const auto at = find(placed(path));
    if (at == keys_.end()) return false;
    const KeyForm form = at->asked.form;
    return form == KeyForm::any || (form == KeyForm::table && value != "{}") ||
           (form == KeyForm::tables && value != "[{}]");
  }

  static std::string path_of(const std::string& change) { return change.substr(0, change.find('=')); }

  /// "stage.0." of "stage.0.kind"; nothing for keys at the top.
  static std::string table_of(const std::string& path) { return path.substr(0, path.rfind('.') + 1); }

  /// Whether the value of `key` may decide who reads `path`: a word, flag or count of its table or one above.
  [[nodiscard]] bool is_mode_of(const std::string& key, const std::string& path) const {
    const auto at = find(placed(key));
    if (at == keys_.end() || !path.starts_with(table_of(key))) return false;
    const KeyForm form = at->asked.form;
    return form == KeyForm::choice || form == KeyForm::flag || form == KeyForm::count || form == KeyForm::text ||
           at->is_table();
  }

  /// Whether no reader was found yet that takes the value of this key.
  [[nodiscard]] bool is_unknown(const std::string& path) const {
    const ExploredKey key = placed(path);
    const auto at = find(key);
    return at != keys_.end() && at->asked.form == KeyForm::any;
  }

  [[nodiscard]] std::vector<ExploredKey>::const_iterator find(const ExploredKey& key) const {
    return std::ranges::find_if(keys_,
                                [&](const ExploredKey& k) { return k.table == key.table && k.name == key.name; });
  }

  /// Returns the place of the key.
  std::size_t note(ExploredKey key, const AskedKey& asked, std::size_t after) {
    if (std::ranges::find(tables_, key.table) == tables_.end()) tables_.push_back(key.table);
    auto at = keys_.begin() + (find(key) - keys_.cbegin());
    if (at == keys_.end()) {
      key.asked = asked;
      key.required = asked.required;
      at = keys_.insert(after < keys_.size() ? keys_.begin() + static_cast<std::ptrdiff_t>(after) + 1 : keys_.end(),
                        std::move(key));
    }
    add(*at, asked);
    return static_cast<std::size_t>(at - keys_.begin());
  }

  static void add(ExploredKey& key, const AskedKey& asked) {
    AskedKey& known = key.asked;
    if (known.form == KeyForm::any) {
      const AskedKey before = std::exchange(known, asked);
      if (known.meaning.empty()) known.meaning = before.meaning;
    }
    const auto has_form = [&](const AskedKey& k) { return k.form == asked.form; };
    if (asked.form != KeyForm::any && !has_form(known) && std::ranges::none_of(key.also, has_form))
      key.also.push_back(asked);
    if (known.meaning.empty()) known.meaning = asked.meaning;
    if (known.usual.empty()) known.usual = asked.usual;
    for (const std::string& w : asked.words)
      if (std::ranges::find(known.words, w) == known.words.end()) known.words.push_back(w);
    if (asked.form == KeyForm::any) key.required = false;
    if (asked.given || asked.required) return;
    const std::string text = value_text(asked);
    if (!text.empty() && std::ranges::find(key.defaults, text) == key.defaults.end()) key.defaults.push_back(text);
  }

  void plan(const std::string& path, const AskedKey& asked, const Changes& changes) {
    if (std::ranges::any_of(changes, [&](const std::string& c) { return c.starts_with(path + "="); })) return;
    // What is only looked for is tried again in every mode that its table or one above has, until one reads it.
    const bool unknown = asked.form == KeyForm::any;
    if (unknown && !is_unknown(path)) return;
    std::string mode = unknown && !changes.empty() ? changes.back() : "";
    if (!mode.empty() && looked_for_.contains(path) && !is_mode_of(path_of(mode), path)) return;
    if (unknown) looked_for_.insert(path);
    for (const std::string& value : values_to_try(asked)) {
      if (!tried_.insert({path, value, mode}).second) continue;
      Changes next = changes;
      next.push_back(path + "=" + value);
      waiting_.push_back(std::move(next));
    }
  }

  [[nodiscard]] std::ptrdiff_t place_of(const std::string& table) const {
    return std::ranges::find(tables_, table) - tables_.begin();
  }

  std::string start_;
  const std::function<void(const Scene&)>& read_;
  std::deque<Changes> waiting_;
  std::set<std::string> looked_for_;            // keys of unknown form that were tried
  std::set<std::array<std::string, 3>> tried_;  // path, value, the mode
  std::vector<ExploredKey> keys_;
  std::vector<std::string> tables_;
};

}  // namespace

std::vector<ExploredKey> explore_keys(const std::vector<std::string>& starts,
                                      const std::function<void(const Scene&)>& read) {
  Explorer explorer(read);
  for (const std::string& start : starts) explorer.explore(start);
  return explorer.all();
}

}  // namespace softgrain
