#include "pipelines/commands/key_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/kinds/kinds.h"

namespace softgrain {

namespace {

constexpr double kUnlimited = 1e11;  // counts up to this have no upper end that means anything

/// An end of a range with six digits; what only allows for rounding is left out. A small end above zero is meant.
double shown_end(double end) {
  constexpr double kRounding = 1e-8;
  if (!std::isfinite(end)) return end;
  return end > -kRounding && end < 0.0 ? 0.0 : std::stod(rounded_text(end, {6}));
}

/// "m, above 0", "\"fast\", \"slow\"", "list, above 0". `quote` stands on both sides of a word.
std::string allowed_text(const AskedKey& k, const std::string& quote) {
  const std::string range = range_text(allowed(k));
  std::string unit = si_unit(k.unit);
  switch (k.form) {
    case KeyForm::choice:
      return join_text(k.words, ", ", [&](const std::string& w) { return quote + w + quote; });
    case KeyForm::flag:
      return "true, false";
    case KeyForm::flags:
      return "list of true, false";
    case KeyForm::text:
      return "text";
    case KeyForm::texts:
      return "list of texts";
    case KeyForm::count:
      return range.empty() ? "whole number" : "whole number, " + range;
    case KeyForm::vector:
      append_part(unit, "three numbers", ", ");
      return unit.starts_with(", ") ? unit.substr(2) : unit;
    case KeyForm::numbers: {
      std::string text = "list";
      if (!unit.empty()) append_part(text, unit, ", ");
      if (!range.empty()) append_part(text, range, ", ");
      return text;
    }
    case KeyForm::number:
      if (!range.empty()) append_part(unit, range, ", ");
      return unit.empty() ? "number" : unit;
    case KeyForm::any:
    case KeyForm::table:
    case KeyForm::tables:
      return "";
  }
  return "";
}

}  // namespace

const SceneKind& kind_named(const std::string& name, const std::string& command) {
  std::vector<std::string> names;
  for (const SceneKind& k : scene_kinds()) {
    if (name == k.name) return k;
    names.emplace_back(k.name);
  }
  throw InputError(fmt::format("{} {}: no such kind; {}", command, name,
                               nearest_text(name, names, "kinds are " + join_text(names))));
}

std::string written(const ExploredKey& key) {
  if (key.asked.form == KeyForm::table) return "[" + key.path() + "]";
  if (key.asked.form == KeyForm::tables) return "[[" + key.path() + "]]";
  return key.name;
}

Range allowed(const AskedKey& k) {
  Range range = k.range;
  range.low = shown_end(range.low);
  range.high = shown_end(range.high);
  if (k.form == KeyForm::count && range.high > kUnlimited) range.high = std::numeric_limits<double>::infinity();
  return range;
}

std::string allowed_forms(const ExploredKey& key, const std::string& quote) {
  std::string text = allowed_text(key.asked, quote);
  for (const AskedKey& other : key.also) append_part(text, allowed_text(other, quote), "; or ");
  return text;
}

std::string default_text(const ExploredKey& key) {
  if (!key.asked.usual.empty()) return key.asked.usual;
  if (key.required) return "-";
  if (key.defaults.empty()) return "none";
  return join_text(key.defaults, " or ", [](const std::string& d) { return d == "\"\"" ? "none" : d; });
}

std::vector<ExploredKey> in_table(const std::vector<ExploredKey>& all, const std::string& table) {
  std::vector<ExploredKey> some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const ExploredKey& k) { return k.table == table; });
  return some;
}

}  // namespace softgrain
