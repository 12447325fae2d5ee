#include "pipelines/commands/commands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/core/text.h"
#include "common/io/key_record.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/kinds.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr const char* kRoot = ".";
constexpr double kUnlimited = 1e11;  // counts up to this have no upper end that means anything

const SceneKind& kind_named(const std::string& name) {
  std::vector<std::string> names;
  for (const SceneKind& k : scene_kinds()) {
    if (name == k.name) return k;
    names.emplace_back(k.name);
  }
  const std::string near = nearest_word(name, names);
  throw InputError(fmt::format("schema {}: no such kind; {}", name,
                               near.empty() ? "kinds are " + join_text(names) : "nearest is '" + near + "'"));
}

/// "[packing]", "[[stage]]", "mu".
std::string written(const ExploredKey& key) {
  if (key.asked.form == KeyForm::table) return "[" + key.path() + "]";
  if (key.asked.form == KeyForm::tables) return "[[" + key.path() + "]]";
  return key.name;
}

/// An end of a range with six digits; what only allows for rounding is left out.
double shown_end(double end) {
  constexpr double kRounding = 1e-8;
  if (!std::isfinite(end)) return end;
  return std::abs(end) < kRounding ? 0.0 : std::stod(rounded_text(end, {6}));
}

Range allowed(const AskedKey& k) {
  Range range = k.range;
  range.low = shown_end(range.low);
  range.high = shown_end(range.high);
  if (k.form == KeyForm::count && range.high > kUnlimited) range.high = std::numeric_limits<double>::infinity();
  return range;
}

/// "m, above 0", "\"fast\", \"slow\"", "list, above 0". `quote` stands on both sides of a word.
std::string allowed_text(const AskedKey& k, const std::string& quote = "\"") {
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

/// All forms that the key may have.
std::string allowed_forms(const ExploredKey& key, const std::string& quote = "\"") {
  std::string text = allowed_text(key.asked, quote);
  for (const AskedKey& other : key.also) append_part(text, allowed_text(other, quote), "; or ");
  return text;
}

/// "-" for a key that must be there, "none" for one that need not.
std::string default_text(const ExploredKey& key) {
  if (!key.asked.usual.empty()) return key.asked.usual;
  if (key.required) return "-";
  if (key.defaults.empty()) return "none";
  return join_text(key.defaults, " or ", [](const std::string& d) { return d == "\"\"" ? "none" : d; });
}

/// Keys that stand in a table; tables that stand in it come as one row each.
std::vector<ExploredKey> in_table(const std::vector<ExploredKey>& all, const std::string& table) {
  std::vector<ExploredKey> some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const ExploredKey& k) { return k.table == table; });
  return some;
}

/// Throws InputError for a table that the kind does not have.
void require_table(const std::vector<ExploredKey>& all, const SchemaOptions& o) {
  std::vector<std::string> tables;
  for (const ExploredKey& k : all)
    if (k.is_table()) tables.push_back(k.path());
  if (o.table.empty() || o.table == kRoot || std::ranges::find(tables, o.table) != tables.end()) return;
  const std::string near = nearest_word(o.table, tables);
  throw InputError(fmt::format("schema {} {}: no such table; {}", o.kind, o.table,
                               near.empty() ? "tables are " + join_text(tables) : "nearest is '" + near + "'"));
}

std::string table_name(const SchemaOptions& o) { return o.table == kRoot ? "" : o.table; }

std::string as_text(const std::vector<ExploredKey>& keys) {
  std::size_t width = 0;
  for (const ExploredKey& k : keys) width = std::max(width, written(k).size());
  std::string text;
  for (const ExploredKey& k : keys) {
    text += fmt::format("{:<{}}  {}\n", written(k), width, k.asked.meaning);
    if (k.is_table()) continue;
    const std::string otherwise = default_text(k) == "-" ? "must be given" : "default " + default_text(k);
    text += fmt::format("{:<{}}  ({}; {})\n", "", width, allowed_forms(k), otherwise);
  }
  return text;
}

/// A cell of a table: a bar would end it.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, "\\");
  return text;
}

std::string as_markdown(const std::vector<ExploredKey>& keys) {
  std::string text = "| key | meaning | allowed | default |\n|---|---|---|---|\n";
  for (const ExploredKey& k : keys)
    text += fmt::format("| `{}` | {} | {} | {} |\n", written(k), cell(k.asked.meaning), cell(allowed_forms(k, "`")),
                        k.is_table() ? "" : cell(default_text(k)));
  return text;
}

/// Each table under a heading of its own.
std::string all_markdown(const std::vector<ExploredKey>& all) {
  std::vector<std::string> tables{""};
  for (const ExploredKey& k : all)
    if (k.is_table() && std::ranges::find(tables, k.path()) == tables.end()) tables.push_back(k.path());
  return join_text(tables, "\n", [&](const std::string& table) {
    return fmt::format("## `{}`\n\n{}", table.empty() ? kRoot : "[" + table + "]", as_markdown(in_table(all, table)));
  });
}

// JSON Schema, draft 4: what editors take.

json number_schema(const AskedKey& k) {
  const Range r = allowed(k);
  json number{{"type", k.form == KeyForm::count ? "integer" : "number"}};
  if (std::isfinite(r.low)) number["minimum"] = r.low;
  if (std::isfinite(r.high)) number["maximum"] = r.high;
  if (std::isfinite(r.low) && r.low_open) number["exclusiveMinimum"] = true;
  if (std::isfinite(r.high) && r.high_open) number["exclusiveMaximum"] = true;
  if (k.form == KeyForm::count || k.unit == Unit::none) return number;
  return {{"anyOf", {number, {{"type", "string"}}}}};  // "16 mm"
}

json value_schema(const AskedKey& k) {
  switch (k.form) {
    case KeyForm::number:
    case KeyForm::count:
      return number_schema(k);
    case KeyForm::flag:
      return {{"type", "boolean"}};
    case KeyForm::text:
      return {{"type", "string"}};
    case KeyForm::choice:
      return {{"enum", k.words}};
    case KeyForm::vector:
    case KeyForm::numbers:
      return {{"type", "array"}, {"items", number_schema(k)}};
    case KeyForm::texts:
      return {{"type", "array"}, {"items", {{"type", "string"}}}};
    case KeyForm::flags:
      return {{"type", "array"}, {"items", {{"type", "boolean"}}}};
    case KeyForm::any:
    case KeyForm::table:
    case KeyForm::tables:
      return json::object();
  }
  return json::object();
}

json table_schema(const std::vector<ExploredKey>& all, const std::string& table) {
  json out{{"type", "object"}, {"properties", json::object()}};
  for (const ExploredKey& k : in_table(all, table)) {
    json& at = k.name == kFreeName ? out["additionalProperties"] : out["properties"][k.name];
    at = k.is_table() ? table_schema(all, k.path()) : value_schema(k.asked);
    if (!k.also.empty()) {
      at = {{"anyOf", {at}}};
      for (const AskedKey& other : k.also) at["anyOf"].push_back(value_schema(other));
    }
    if (k.asked.form == KeyForm::tables) at = {{"type", "array"}, {"items", at}};
    if (!k.asked.meaning.empty()) at["description"] = k.asked.meaning;
    if (!k.is_table()) at["x-default"] = default_text(k);
  }
  return out;
}

std::string as_json(const std::vector<ExploredKey>& all, const SchemaOptions& o) {
  json schema = table_schema(all, table_name(o));
  schema["$schema"] = "http://json-schema.org/draft-04/schema#";
  schema["title"] = "softgrain scene of kind " + o.kind;
  return schema.dump(2) + "\n";
}

std::string list_of_kinds() {
  std::string text = "softgrain schema KIND: the keys of a kind of scenes. Kinds:\n";
  for (const SceneKind& k : scene_kinds()) text += fmt::format("  {:<18} softgrain {}\n", k.name, k.command);
  return text;
}

std::string tables_below(const std::vector<ExploredKey>& all) {
  std::string text;
  for (const ExploredKey& k : all)
    if (k.is_table() && !k.table.empty()) append_part(text, k.path(), ", ");
  return text.empty() ? "" : fmt::format("Tables within: {}\n", text);
}

}  // namespace

void add_schema_command(CLI::App& app, SchemaOptions& o) {
  CLI::App* sub = app.add_subcommand("schema", "Which keys a kind of scenes has: meaning, unit, range, default");
  sub->add_option("KIND", o.kind, "kind of scenes; without one: all kinds")->option_text(" ");
  sub->add_option("TABLE", o.table,
                  "table of it, such as macro; . for the keys at the top; default these and all tables")
      ->option_text(" ");
  sub->add_option_function<std::string>(
         "--to", [&o](const std::string& word) { o.form = *parse_enum<SchemaForm>(word); },
         "Form: text (default), markdown, or json for editors (JSON Schema)")
      ->option_text("text|markdown|json")
      ->check(CLI::IsMember(all_enum_names<SchemaForm>()).description(""));
  sub->add_flag_callback(
      "--json", [&o] { o.form = SchemaForm::json; }, "As --to json");
  sub->callback([&o] { o.chosen = true; });
}

ExitStatus command_schema(const SchemaOptions& o) {
  if (o.kind.empty()) {
    write_standard_output(list_of_kinds());
    return ExitStatus::good;
  }
  const std::vector<ExploredKey> all = keys_of(kind_named(o.kind));
  require_table(all, o);
  const std::vector<ExploredKey> shown = in_table(all, table_name(o));
  if (o.form == SchemaForm::json)
    write_standard_output(as_json(all, o));
  else if (o.form == SchemaForm::markdown)
    write_standard_output(o.table.empty() ? all_markdown(all) : as_markdown(shown));
  else
    write_standard_output(as_text(shown) + (o.table.empty() ? tables_below(all) : ""));
  return ExitStatus::good;
}

}  // namespace softgrain
