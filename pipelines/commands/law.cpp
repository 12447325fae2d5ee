// softgrain law: what a fitted law says, for people and for other programs. Writes no run directory.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/commands/law_options.h"
#include "pipelines/law/law_difference.h"
#include "pipelines/law/law_json.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/law/pair_table.h"
#include "pipelines/law/terminal_plot.h"
#include "pipelines/law/value_output.h"

namespace softgrain {

namespace {

using law::ValueTable;
using law::ValueUnits;
using nlohmann::json;

void print(const std::string& text) { write_standard_output(text); }
void print(const json& object) { print(object.dump(2, ' ', false, json::error_handler_t::replace) + "\n"); }

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

void refuse(const LawOptions& o, std::initializer_list<const char*> names, const std::string& why) {
  for (const char* name : names)
    if (has(o.given, name)) throw InputError("law " + to_string(*o.action) + ": " + name + " " + why);
}

/// What goes with cards does not go with tables, and the reverse.
void require_fitting_options(const LawOptions& o, const FittedLaw& file) {
  const bool pairs = o.format == LawFormat::lammps_table;
  if (file.card() != nullptr)
    refuse(o, {"--form", "--arrangement", "--partner", "--ratio", "--shallow", "--solid-fraction", "--range"},
           "goes with a law table; " + file.path + " is a law card, which knows pairs alone");
  else if (!pairs)
    refuse(o, {"--kind", "--deepest"},
           "goes with a law card; " + file.path + " is a law table: give --partner plane, solid or soft");
  if (pairs)
    refuse(o,
           {"--delta", "--from", "--to-delta", "--steps", "--deepest", "--arrangement", "--partner", "--ratio",
            "--shallow", "--kt"},
           "does not go with --to lammps-table, which has --kind, --ratios, --rows and --delta-max");
  else
    refuse(o, {"--ratios", "--rows", "--delta-max"}, "goes with --to lammps-table");
  if (o.arrangement != Arrangement::beside_five) refuse(o, {"--shallow"}, "goes with --arrangement beside-five");
  if (file.table() != nullptr && o.partner == PartnerKind::plane)
    refuse(o, {"--ratio"}, "goes with --partner solid or soft: a plane has no radius");
}

double positive(const LawOptions& o, const char* name, double value, double high) {
  if (std::isfinite(value) && value > 0.0 && value <= high) return value;
  throw InputError(
      fmt::format("law {}: {} {}: must be above 0 and at most {}", to_string(*o.action), name, value, high));
}

double overlap(const LawOptions& o, const char* name, double value) {
  if (std::isfinite(value) && value >= 0.0 && value < 2.0) return value;
  throw InputError(fmt::format("law {}: {} {}: must be at least 0 and below 2", to_string(*o.action), name, value));
}

std::size_t whole(const LawOptions& o, const char* name, std::int64_t value, std::int64_t low) {
  constexpr std::int64_t kMost = 1000000;
  if (value >= low && value <= kMost) return static_cast<std::size_t>(value);
  throw InputError(fmt::format("law {}: {} {}: must be a whole number from {} to {}", to_string(*o.action), name, value,
                               low, kMost));
}

/// Delta of every value: those given, or evenly spread up to the end of the measured range.
std::vector<double> overlaps(const LawOptions& o, double end, std::int64_t steps) {
  const char* last = o.action == LawAction::eval ? "--to" : "--to-delta";
  if (has(o.given, "--delta")) {
    refuse(o, {"--from", last, "--steps"}, "does not go with --delta");
    for (const double d : o.deltas) (void)overlap(o, "--delta", d);
    return o.deltas;
  }
  const double low = overlap(o, "--from", o.from);
  const double high = has(o.given, last) ? overlap(o, last, o.to_delta) : end;
  if (!(low < high))
    throw InputError(fmt::format("law {}: --from {} must be below {} {}", to_string(*o.action), low, last, high));
  return law::even(low, high, whole(o, "--steps", has(o.given, "--steps") ? o.steps : steps, 2));
}

std::optional<double> fraction_of(const LawOptions& o) {
  if (!has(o.given, "--solid-fraction")) return std::nullopt;
  return positive(o, "--solid-fraction", o.solid_fraction, 1.0);
}

/// Kinds of pairs that were named, in the order of the file.
std::vector<PairKind> kinds_of(const LawOptions& o) {
  std::vector<PairKind> kinds;
  for (const PairKind kind : kPairKinds)
    if (std::ranges::find(o.kinds, kind) != o.kinds.end()) kinds.push_back(kind);
  return kinds;
}

const SoftParticleSpec& spec_of(const FittedLaw& file) {
  return file.card() != nullptr ? file.card()->spec : main_entry(*file.table()).spec;
}

double quantity(const LawOptions& o, const char* name, const std::string& text, Unit unit) {
  try {
    const double value = parse_quantity(text, unit);
    if (std::isfinite(value) && value > 0.0) return value;
  } catch (const InputError& e) {
    throw InputError(fmt::format("law {}: {} \"{}\": {}", to_string(*o.action), name, text, e.what()));
  }
  throw InputError(fmt::format("law {}: {} \"{}\": must be above 0", to_string(*o.action), name, text));
}

ValueUnits units_of(const LawOptions& o, const FittedLaw& file) {
  ValueUnits units;
  units.si = !o.modulus.empty() || !o.radius.empty() || o.format == LawFormat::lammps_table;
  units.modulus = spec_of(file).youngs_modulus;
  units.radius = spec_of(file).shell_radius;
  if (!o.modulus.empty()) units.modulus = quantity(o, "--E", o.modulus, Unit::pressure);
  if (!o.radius.empty()) units.radius = quantity(o, "--radius", o.radius, Unit::length);
  return units;
}

std::vector<ValueTable> card_tables(const LawOptions& o, const FittedLaw& file, std::int64_t steps) {
  std::vector<ValueTable> out;
  const std::vector<PairKind> wanted = kinds_of(o);
  std::optional<double> deepest;
  if (has(o.given, "--deepest")) deepest = positive(o, "--deepest", o.deepest, kLargestDelta);
  for (const PairKind kind : kPairKinds) {
    const PairLaw* pair = file.card()->find(kind);
    const bool named = std::ranges::find(wanted, kind) != wanted.end();
    if (wanted.empty() ? pair == nullptr || !has_numbers(pair->status) : !named) continue;
    const auto values = [&](const std::vector<double>& at) {
      return complaining_of(file, [&] { return law::card_values(*file.card(), kind, at, o.beyond, deepest); });
    };
    if (pair == nullptr) (void)values({});  // says what is wrong
    ValueTable t;
    t.law = to_string(kind);
    t.status = pair->status;
    t.remark = pair->reason;
    if (deepest)
      append_part(t.remark, fmt::format("below Delta = {:g} the contact unloads, without intervals", *deepest));
    t.beyond = o.beyond.value_or(pair->beyond);
    t.use_secant = o.tangential == TangentialSlope::secant;
    t.points = values(overlaps(o, pair->delta_max, steps));
    out.push_back(std::move(t));
  }
  if (out.empty()) throw UnusableResult(file.path + ": the card has no usable law (softgrain law show says why)");
  return out;
}

std::string question_text(const law::MultiContactQuestion& q, const law::MultiContactAnswer& a) {
  const std::string size = q.partner == PartnerKind::plane ? "" : fmt::format(" of ratio {:g}", q.ratio);
  return fmt::format("{} {}{}, {} law at solid fraction {:.4f}", to_string(q.arrangement), to_string(q.partner), size,
                     to_string(a.form), a.entry.solid_fraction);
}

/// What a colleague would add to numbers of a table: how far off the law is, and where it was not measured.
std::string table_remark(const law::MultiContactAnswer& a) {
  const std::string text = unseen_error_text(a.entry, *a.entry.find(a.form));
  return a.remark.empty() ? text : text + "; " + a.remark;
}

/// Question to a table that says which of its laws is meant.
law::MultiContactQuestion fraction_question(const LawOptions& o) {
  law::MultiContactQuestion q;
  q.form = o.form;
  q.solid_fraction = fraction_of(o);
  q.range = o.range;
  q.beyond = o.beyond;
  return q;
}

law::MultiContactAnswer answer_of(const FittedLaw& file, const law::MultiContactQuestion& q,
                                  const std::vector<double>& deltas) {
  return complaining_of(file, [&] { return law::multi_contact_values(*file.table(), q, deltas); });
}

ValueTable table_values(const LawOptions& o, const FittedLaw& file, std::int64_t steps) {
  law::MultiContactQuestion q = fraction_question(o);
  q.arrangement = o.arrangement;
  q.partner = o.partner;
  q.ratio = positive(o, "--ratio", o.ratio, 1e6);
  q.shallow = positive(o, "--shallow", o.shallow, 1.0);
  const double end = answer_of(file, q, {}).overlap_max;
  const law::MultiContactAnswer answer = answer_of(file, q, overlaps(o, end, steps));
  ValueTable t;
  t.law = question_text(q, answer);
  t.status = answer.entry.find(answer.form)->status;
  t.remark = table_remark(answer);
  t.beyond = q.beyond.value_or(answer.entry.beyond);
  t.points = answer.points;
  return t;
}

std::vector<ValueTable> value_tables(const LawOptions& o, const FittedLaw& file, std::int64_t steps) {
  return file.card() != nullptr ? card_tables(o, file, steps) : std::vector<ValueTable>{table_values(o, file, steps)};
}

json head_json(const LawOptions& o, const FittedLaw& file) {
  return {{"command", "law " + to_string(*o.action)},
          {"status", "good"},
          {"file", file.path},
          {"kind", kind_text(file)},
          {"provenance",
           {{"version", file.origin.version},
            {"commit", file.origin.commit},
            {"seed", file.origin.seed},
            {"command", file.origin.command}}}};
}

json parameters_json(const FittedLaw& file) {
  return std::visit([](const auto& law) { return law_json(law); }, file.content);
}

/// Refused values are no result to go on with.
ExitStatus status_of(const std::vector<ValueTable>& tables) {
  for (const ValueTable& t : tables)
    for (const law::LawPoint& p : t.points)
      if (p.refused) return ExitStatus::not_usable;
  return ExitStatus::good;
}

const char* status_word(ExitStatus status) { return status == ExitStatus::good ? "good" : "not usable"; }

json values_json(const std::vector<ValueTable>& tables, const ValueUnits& units) {
  json out = json::array();
  for (const ValueTable& t : tables) out.push_back(law::values_json(t, units));
  return out;
}

json units_json(const ValueUnits& units) {
  return {{"force", law::force_unit(units)},
          {"stiffness", law::stiffness_unit(units)},
          {"E", units.modulus},
          {"R", units.radius}};
}

FittedLaw load_with_refits(const std::string& path) {
  FittedLaw file = load_or_fit_law(path);
  read_refits(file);
  return file;
}

/// Forces over overlaps, which the cell law has none of.
FittedLaw load_contact_law(const LawOptions& o, const std::string& path) {
  FittedLaw file = load_with_refits(path);
  if (file.cells() != nullptr)
    throw InputError(
        fmt::format("law {}: {} is a card of the cell law, a pressure over a volume: softgrain law show "
                    "has its numbers",
                    to_string(*o.action), path));
  return file;
}

ExitStatus eval(const LawOptions& o) {
  const FittedLaw file = load_contact_law(o, o.files.front());
  require_fitting_options(o, file);
  const ValueUnits units = units_of(o, file);
  const std::vector<ValueTable> tables = value_tables(o, file, o.steps);
  const ExitStatus status = status_of(tables);
  if (o.json) {
    json out = head_json(o, file);
    out["status"] = status_word(status);
    out["units"] = units_json(units);
    out["laws"] = values_json(tables, units);
    print(out);
    return status;
  }
  print(join_text(tables, "\n", [&](const ValueTable& t) { return law::values_text(t, units); }));
  return status;
}

law::PairTableChoice pair_choice(const LawOptions& o, const ValueUnits& units) {
  law::PairTableChoice c;
  c.kinds = kinds_of(o);
  c.ratios = o.ratios;
  for (const double ratio : c.ratios) (void)positive(o, "--ratios", ratio, 1e6);
  c.rows = whole(o, "--rows", o.rows, 2);
  c.modulus = units.modulus;
  c.radius = units.radius;
  if (has(o.given, "--delta-max")) {
    c.delta_max = overlap(o, "--delta-max", o.delta_max);
    (void)positive(o, "--delta-max", o.delta_max, 2.0);
  }
  c.beyond = o.beyond;
  c.form = o.form;
  c.solid_fraction = fraction_of(o);
  c.range = o.range;
  return c;
}

std::string lammps_file(const LawOptions& o, const FittedLaw& file, const ValueUnits& units) {
  const std::vector<law::PairTable> tables = law::pair_tables(file, pair_choice(o, units));
  std::vector<std::string> head{"soft particles of softgrain, from " + file.path,
                                fmt::format("E = {:.6g} Pa; normal forces without friction and damping; of two bodies "
                                            "alone:",
                                            units.modulus),
                                "a soft particle with several neighbours is stiffer than a pair potential can say"};
  if (file.table() != nullptr) {
    const law::MultiContactAnswer a = answer_of(file, fraction_question(o), {});
    head.push_back(fmt::format("the {} law at solid fraction {:.4f} of the table{}", to_string(a.form),
                               a.entry.solid_fraction, a.remark.empty() ? "" : " (" + a.remark + ")"));
  }
  const std::string origin = law::origin_text(file.origin);
  if (!origin.empty()) head.insert(head.begin() + 1, origin);
  head.push_back(
      fmt::format("use: pair_style table linear {}; pair_coeff I J FILE {}", o.rows, tables.front().keyword));
  return law::lammps_text(tables, head);
}

json full_json(const LawOptions& o, const FittedLaw& file, const std::vector<ValueTable>& tables,
               const ValueUnits& units) {
  json out = head_json(o, file);
  out["status"] = status_word(status_of(tables));
  out["parameters"] = parameters_json(file);
  out["units"] = units_json(units);
  out["laws"] = values_json(tables, units);
  return out;
}

/// What an export of this format has written may be written again: it begins alike. Other files are left alone.
void refuse_to_replace_other_files(const LawOptions& o, const std::string& text) {
  constexpr std::size_t kBeginning = 30;
  std::error_code ignored;
  if (o.out.empty() || !std::filesystem::exists(o.out, ignored)) return;
  if (read_text(o.out).starts_with(text.substr(0, kBeginning))) return;
  throw InputError(
      fmt::format("law export: --out {}: is there already, is no {} export, and would be overwritten; choose "
                  "another name",
                  o.out, to_string(*o.format)));
}

ExitStatus export_law(const LawOptions& o) {
  if (!o.format) throw InputError("law export: give --to lammps-table, csv or json");
  const FittedLaw file = load_contact_law(o, o.files.front());
  require_fitting_options(o, file);
  const ValueUnits units = units_of(o, file);
  constexpr std::int64_t kSteps = 101;
  ExitStatus status = ExitStatus::good;
  std::string text;
  if (o.format == LawFormat::lammps_table) {
    text = lammps_file(o, file, units);
  } else {
    const std::vector<ValueTable> tables = value_tables(o, file, kSteps);
    status = status_of(tables);
    text = o.format == LawFormat::csv
               ? law::values_csv(tables, units)
               : full_json(o, file, tables, units).dump(2, ' ', false, json::error_handler_t::replace) + "\n";
  }
  refuse_to_replace_other_files(o, text);
  if (!o.out.empty()) write_text_atomic(o.out, text);
  if (o.json) {
    json summary = head_json(o, file);
    summary["status"] = status_word(status);
    summary["format"] = to_string(*o.format);
    summary[o.out.empty() ? "text" : "written"] = o.out.empty() ? text : o.out;
    print(summary);
  } else {
    print(o.out.empty() ? text : "written: " + o.out + "\n");
  }
  return status;
}

json row_json(const law::DifferenceRow& r) {
  const auto interval = [](const law::Quantity& q) {
    return q.interval ? json{q.interval->low, q.interval->high} : json(nullptr);
  };
  return {{"delta", r.delta},
          {"a", r.a.value},
          {"a_interval", interval(r.a)},
          {"b", r.b.value},
          {"b_interval", interval(r.b)},
          {"relative", std::isfinite(r.relative) ? json(r.relative) : json(nullptr)},
          {"within", r.known ? json(r.within) : json(nullptr)}};
}

ExitStatus compare(const LawOptions& o, const FittedLaw& a, const FittedLaw& b) {
  const std::vector<law::LawDifference> differences = law::law_differences(a, b);
  if (!o.json) {
    print(law::differences_text(a, b, differences, law::terminal_is_utf8()));
    return ExitStatus::good;
  }
  json out{{"command", "law show"}, {"status", "good"}, {"files", {a.path, b.path}}, {"differences", json::array()}};
  for (const law::LawDifference& d : differences) {
    json one{{"pair", d.pair},
             {"quantity", d.quantity},
             {"delta_range", {d.low, d.high}},
             {"root_mean_square", d.root_mean_square},
             {"largest", d.largest},
             {"values", json::array()}};
    for (const law::DifferenceRow& r : d.rows) one["values"].push_back(row_json(r));
    out["differences"].push_back(std::move(one));
  }
  print(out);
  return ExitStatus::good;
}

ExitStatus show(const LawOptions& o) {
  if (o.files.size() == 2) return compare(o, load_contact_law(o, o.files.front()), load_contact_law(o, o.files.back()));
  const FittedLaw file = load_with_refits(o.files.front());
  if (!o.json) {
    print(law::law_text(file, law::terminal_is_utf8()));
    return ExitStatus::good;
  }
  json out = head_json(o, file);
  out["parameters"] = parameters_json(file);
  print(out);
  return ExitStatus::good;
}

void require_files(const LawOptions& o, std::size_t most) {
  if (!o.files.empty() && o.files.size() <= most) return;
  throw InputError(fmt::format("law {} needs {} LAW, {} given (see softgrain law {} --help)", to_string(*o.action),
                               most == 1 ? "1" : "1 or 2", o.files.size(), to_string(*o.action)));
}

}  // namespace

ExitStatus command_law(const LawOptions& options) {
  if (options.action == LawAction::none)
    throw InputError("law: give show, eval, export, plan, library or get (see softgrain law --help)");
  if (options.action == LawAction::get) return get_law(options);
  if (options.action == LawAction::library) return make_library(options);
  require_files(options, options.action == LawAction::show ? 2 : 1);
  if (options.action == LawAction::show) return show(options);
  if (options.action == LawAction::plan) return plan_next(options);
  return options.action == LawAction::eval ? eval(options) : export_law(options);
}

}  // namespace softgrain
