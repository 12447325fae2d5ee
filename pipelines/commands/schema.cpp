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
#include "pipelines/commands/key_text.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/results/set_summary.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr const char* kRoot = ".";
/// Throws InputError for a table that the kind does not have.
void require_table(const std::vector<ExploredKey>& all, const SchemaOptions& o) {
  std::vector<std::string> tables;
  for (const ExploredKey& k : all)
    if (k.is_table()) tables.push_back(k.path());
  if (o.table.empty() || o.table == kRoot || std::ranges::find(tables, o.table) != tables.end()) return;
  throw InputError(fmt::format("schema {} {}: no such table; {}", o.kind, o.table,
                               nearest_text(o.table, tables, "tables are " + join_text(tables))));
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

// Members of summaries.

std::string as_text(const std::vector<RecordMember>& members) {
  std::size_t width = 0;
  for (const RecordMember& m : members) width = std::max(width, m.path.size());
  std::string text;
  for (const RecordMember& m : members)
    text += fmt::format("{:<{}}  {}{}\n", m.path, width, m.meaning,
                        m.unit.empty() || m.unit == "1" ? "" : fmt::format(" [{}]", m.unit));
  return text;
}

std::string as_markdown(const std::vector<RecordMember>& members) {
  std::string text = "| member | meaning | unit |\n|---|---|---|\n";
  for (const RecordMember& m : members)
    text += fmt::format("| `{}` | {} | {} |\n", m.path, cell(m.meaning), cell(m.unit));
  return text;
}

std::string as_json(const std::vector<RecordMember>& members) {
  json out = json::object();
  for (const RecordMember& m : members) out[m.path] = {{"meaning", m.meaning}, {"unit", m.unit}};
  return out.dump(2) + "\n";
}

/// Throws InputError for a table: a summary has none.
std::string summary_text(const SchemaOptions& o) {
  if (!o.table.empty())
    throw InputError(
        fmt::format("schema {} {} --summary: a summary has no tables of keys; leave {} out", o.kind, o.table, o.table));
  const std::vector<RecordMember> members =
      o.kind.empty() ? members_of<SetSummary>() : summary_members(kind_named(o.kind, "schema"));
  if (o.form == SchemaForm::json) return as_json(members);
  return o.form == SchemaForm::markdown ? as_markdown(members) : as_text(members);
}

std::string list_of_kinds() {
  std::string text = "softgrain schema KIND: the keys of a kind of scenes. Kinds:\n";
  for (const SceneKind& k : scene_kinds())
    text += fmt::format("  {:<18} softgrain {}\n", k.name, commands_of(k, ", softgrain "));
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
  sub->add_flag("--summary", o.summary,
                "Members of the kind's summary.json instead, without KIND of that of several runs: meaning and unit");
  sub->callback([&o] { o.chosen = true; });
}

ExitStatus command_schema(const SchemaOptions& o) {
  if (o.summary) {
    write_standard_output(summary_text(o));
    return ExitStatus::good;
  }
  if (o.kind.empty()) {
    write_standard_output(list_of_kinds());
    return ExitStatus::good;
  }
  const std::vector<ExploredKey> all = keys_of(kind_named(o.kind, "schema"));
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
