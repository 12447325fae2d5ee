#include "common/packing/grading_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/csv_file.h"

namespace softgrain {

namespace {

const Range kExponents = Range::closed(-20.0, 20.0);

const Key kFileKey{
    "file", "`\"sieve-curve\"` or `\"list\"`: CSV file of the curve or of the sizes, its path relative to the scene"};
const Key kExponentKey{"exponent",
                       "`\"power-law\"`: b of the number density P(r) ~ r^-b; `\"fuller\"`: q of the passing volume "
                       "(D^q - Dmin^q)/(Dmax^q - Dmin^q), above 0 to 3"};

/// Shares that differ by less are the same: sums of percents that a spreadsheet rounded.
constexpr double kRounding = 1e-9;

struct Ends {
  double low = 0.0;
  double high = 0.0;
};

/// `of`: what the radii are the ends of.
Ends read_ends(const SceneTable& t, const std::string& of) {
  const double low = t.number({"radius_min", "smallest radius of " + of}, Unit::length, Range::positive());
  const double high = t.number({"radius_max", "largest radius of " + of}, Unit::length, Range::positive());
  if (!t.has_errors() && !(high > low)) t.throw_error("radius_max", "must be above radius_min");
  return {low, high};
}

SizePiece read_class(const SceneTable& c, int dimension) {
  SizePiece p;
  if (c.has("radius")) {
    p.low = p.high = c.number({"radius", "radius of a class of equal grains"}, Unit::length, Range::positive());
    p.exponent = 1.0 + dimension;
  } else {
    const Ends ends = read_ends(c, "a class with a range of sizes, instead of `radius`");
    p.low = ends.low;
    p.high = ends.high;
    p.exponent = c.number({"exponent",
                           "b of the number density P(r) ~ r^-b in a class with a range of sizes; the default has the "
                           "same volume in every decade"},
                          Unit::none, kExponents, 1.0 + dimension);
  }
  p.volume = c.number({"volume_share", "volume share of the class; all shares add up to 1"}, Unit::none,
                      Range{0.0, 1.0, true, false});
  return p;
}

Grading read_classes(const SceneTable& t, int dimension) {
  std::vector<SizePiece> pieces;
  double sum = 0.0;
  for (const SceneTable& c : t.tables({"class", "`\"classes\"`: one class of sizes"})) {
    pieces.push_back(read_class(c, dimension));
    sum += pieces.back().volume;
  }
  if (pieces.empty()) t.throw_error("class", "needs at least one [[class]] with a size and volume_share");
  if (!t.has_errors() && std::abs(sum - 1.0) > 1e-6)
    t.throw_error("class", fmt::format("the shares add up to {:g}; they must add up to 1", sum));
  return Grading::classes(std::move(pieces), dimension);
}

/// The column with one of these names; -1: none.
int column_of(const CsvFile& csv, std::initializer_list<const char*> names) {
  for (std::size_t k = 0; k < csv.columns().size(); ++k)
    for (const char* name : names)
      if (csv.columns()[k].name == name) return static_cast<int>(k);
  return -1;
}

std::string head_of(const CsvFile& csv) { return csv.where(csv.header_line()) + ": "; }

bool in_inches(std::string unit) {
  for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return unit == "in" || unit == "in." || unit == "inch" || unit == "inches" || unit == "\"";
}

std::size_t length_column(const CsvFile& csv, std::initializer_list<const char*> names, const char* example) {
  const int k = column_of(csv, names);
  if (k < 0) throw InputError(fmt::format("{}needs a column \"{}\"", head_of(csv), example));
  const auto column = static_cast<std::size_t>(k);
  if (in_inches(csv.columns()[column].unit))
    throw InputError(
        fmt::format("{}sizes in inches are not read; give them in mm (1 in = 25.4 mm): \"{}\"", head_of(csv), example));
  csv.require_unit(column, Unit::length, example);
  return column;
}

double must(const std::optional<double>& value, const CsvFile& csv, const CsvRow& row, const char* what) {
  if (!value) throw InputError(fmt::format("{}: {} is missing", csv.where(row.line), what));
  return *value;
}

struct SieveRow {
  double opening = 0.0;  ///< [m]
  double passing = 0.0;  ///< 0 to 1
  std::string where{};   ///< "file:line"
};

const CsvNames kPassing{"passing",         "finer",         "cumulative passing", "percent passing",
                        "passing percent", "percent finer", "% passing",          "passing %",
                        "% finer",         "finer %",       "cumulative finer",   "passing by mass",
                        "mass passing"};
const CsvNames kOpening{"opening", "sieve", "size", "diameter", "sieve opening", "sieve size"};

bool is_retained(const CsvColumn& c) { return c.name.find("retained") != std::string::npos; }

/// Whether what passes is in percent, by the unit or the name of the column; else it is a share.
bool passes_in_percent(const CsvFile& csv, std::size_t column) {
  const CsvColumn& c = csv.columns()[column];
  if (is_percent(c.unit)) return true;
  if (!c.unit.empty() && c.unit != "1" && c.unit != "-")
    throw InputError(
        fmt::format("{}passing is in percent of mass or a share: \"passing [%]\", not [{}]", head_of(csv), c.unit));
  return c.name.find('%') != std::string::npos || c.name.find("percent") != std::string::npos;
}

std::size_t passing_column(const CsvFile& csv) {
  for (const std::string& name : kPassing)
    if (const int k = column_of(csv, {name.c_str()}); k >= 0) return static_cast<std::size_t>(k);
  const bool retained = std::any_of(csv.columns().begin(), csv.columns().end(), is_retained);
  throw InputError(fmt::format("{}needs a column \"passing [%]\", cumulative, of mass{}", head_of(csv),
                               retained ? "; passing is 100 % less what is retained in all" : ""));
}

/// What a column says that is none of those that count; masses and what is retained only say the same another way.
void require_sieve_columns(const CsvFile& csv) {
  CsvNames known{"opening", "passing"};
  for (const CsvNames* names : {&kPassing, &kOpening}) {
    const CsvColumn* first = nullptr;
    for (const CsvColumn& c : csv.columns()) {
      if (std::ranges::find(*names, c.name) == names->end()) continue;
      if (first != nullptr)
        throw InputError(fmt::format("{}columns \"{}\" and \"{}\" both say {}: remove one", head_of(csv), first->title,
                                     c.title, names == &kPassing ? "what passes" : "the opening"));
      first = &c;
      known.push_back(c.name);
    }
  }
  for (const CsvColumn& c : csv.columns())
    if (is_retained(c) || c.name.starts_with("mass") || c.name.starts_with("mesh")) known.push_back(c.name);
  csv.require_known_columns(known, "a sieve curve");
}

std::vector<SieveRow> sieve_rows(const CsvFile& csv) {
  csv.require_known_comments({}, "a sieve curve");
  const std::size_t opening =
      length_column(csv, {"opening", "sieve", "size", "diameter", "sieve opening", "sieve size"}, "opening [mm]");
  const std::size_t column = passing_column(csv);
  require_sieve_columns(csv);
  const bool percent = passes_in_percent(csv, column);
  const bool by_name = percent && !is_percent(csv.columns()[column].unit);
  std::vector<SieveRow> rows;
  for (const CsvRow& row : csv.rows()) {
    SieveRow s;
    s.where = csv.where(row.line);
    s.opening = must(csv.number(row, opening, Unit::length), csv, row, "the opening");
    s.passing = must(csv.number(row, column, Unit::none), csv, row, "what passes");
    if (by_name && row.cells[column].back() != '%') s.passing /= 100.0;
    if (!(s.opening > 0.0))
      throw InputError(s.where + ": an opening must be positive; for a pan give the size of the smallest grains");
    for (const double end : {0.0, 1.0})
      if (std::abs(s.passing - end) < kRounding) s.passing = end;
    if (s.passing < 0.0 || s.passing > 1.0)
      throw InputError(fmt::format("{}: {} passes; allowed: 0 to {}", s.where, row.cells[column],
                                   percent ? "100 %" : "1 (a share; write \"passing [%]\" for percent)"));
    rows.push_back(s);
  }
  return rows;
}

std::string percent(double share) { return percent_text(share, {6}); }

/// What passing that falls may be instead, from the smallest sieve to the largest.
std::string guess(const std::vector<SieveRow>& rows) {
  if (std::is_sorted(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.passing > b.passing; }))
    return ": this looks like what is retained in all; passing is 100 % less that";
  double sum = 0.0;
  for (const SieveRow& row : rows) sum += row.passing;
  if (std::abs(sum - 1.0) > 0.02) return "";
  return ": all add up to 100 %, which looks like what each sieve retains; passing is the sum of what finer sieves "
         "retain";
}

/// Grading of a sieve curve, from the smallest sieve to the largest.
Grading curve_of(std::vector<SieveRow> rows, int dimension) {
  if (rows.size() < 2) throw InputError("a sieve curve needs at least two sieves");
  std::stable_sort(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.opening < b.opening; });
  std::vector<double> radius{0.5 * rows[0].opening};
  std::vector<double> passing{rows[0].passing};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const SieveRow& before = rows[k - 1];
    const SieveRow& row = rows[k];
    if (row.opening == before.opening)
      throw InputError(
          fmt::format("{}: the sieve of {:g} mm is there twice ({})", row.where, 1e3 * row.opening, before.where));
    if (row.passing < before.passing - kRounding)
      throw InputError(fmt::format("{}: passing falls to {} on a wider sieve ({}: {}){}", row.where,
                                   percent(row.passing), before.where, percent(before.passing), guess(rows)));
    radius.push_back(0.5 * row.opening);
    passing.push_back(std::max(row.passing, before.passing));
  }
  for (const auto& [row, wanted] : {std::pair{rows.front(), 0.0}, std::pair{rows.back(), 1.0}})
    if (row.passing != wanted)
      throw InputError(fmt::format("{}: the curve goes from {} to {}; it must go from 0 to 100 %: add the {} grains",
                                   row.where, percent(rows.front().passing), percent(rows.back().passing),
                                   wanted == 0.0 ? "size that is below all" : "size that is above all"));
  return Grading::sieve_curve(radius, passing, dimension);
}

Grading read_curve(const SceneTable& t, int dimension) {
  if (t.has("file")) return read_sieve_curve(t.resolve(t.text(kFileKey)), dimension);
  const std::vector<double> openings =
      t.numbers({"openings", "`\"sieve-curve\"` without a file: openings of the sieves (diameters)"}, Unit::length,
                Range::positive());
  std::vector<double> passing = t.numbers({"passing",
                                           "`\"sieve-curve\"` without a file: shares of the volume that pass the "
                                           "`openings`; the smallest must be 0, the largest 1"},
                                          Unit::none, Range::closed(-kRounding, 1.0 + kRounding));
  for (double& share : passing)
    for (const double end : {0.0, 1.0})
      if (std::abs(share - end) < kRounding) share = end;
  if (openings.size() != passing.size())
    t.throw_error("passing",
                  fmt::format("has {} values; openings has {}: one for each", passing.size(), openings.size()));
  std::vector<SieveRow> rows;
  for (std::size_t k = 0; k < openings.size(); ++k) rows.push_back({openings[k], passing[k], t.where("passing")});
  return curve_of(std::move(rows), dimension);
}

Grading read_list(const SceneTable& t, int dimension) {
  if (t.has("file")) return read_radii(t.resolve(t.text(kFileKey)), dimension);
  std::vector<double> radii =
      t.numbers({"radii", "`\"list\"` without a file: the sizes"}, Unit::length, Range::positive());
  if (radii.empty()) t.throw_error("radii", "at least one radius is needed");
  std::vector<double> counts;
  if (t.has("counts")) {
    counts = t.numbers({"counts", "`\"list\"`: number of grains of each size (weights by number)", "one of each"},
                       Unit::none, Range::not_negative());
    if (counts.size() != radii.size())
      t.throw_error("counts", fmt::format("has {} values; radii has {}: one for each", counts.size(), radii.size()));
    if (std::ranges::none_of(counts, [](double n) { return n > 0.0; }))
      t.throw_error("counts", "at least one must be above 0");
  }
  return Grading::list(std::move(radii), dimension, std::move(counts));
}

}  // namespace

Grading read_sieve_curve(const std::string& path, int dimension) {
  try {
    return curve_of(sieve_rows(CsvFile::read(path)), dimension);
  } catch (const InputError& e) {
    const std::string what = e.what();
    throw InputError(what.starts_with(path) ? what : path + ": " + what);
  }
}

Grading read_radii(const std::string& path, int dimension) {
  const CsvFile csv = CsvFile::read(path);
  csv.require_known_comments({}, "a list of sizes");
  const bool diameters = column_of(csv, {"radius", "r"}) < 0 && column_of(csv, {"diameter", "d"}) >= 0;
  const std::size_t column = diameters ? length_column(csv, {"diameter", "d"}, "diameter [mm]")
                                       : length_column(csv, {"radius", "r"}, "radius [mm]");
  const int count = column_of(csv, {"count", "number", "frequency", "n"});
  csv.require_known_columns(
      {csv.columns()[column].name, count < 0 ? "count" : csv.columns()[static_cast<std::size_t>(count)].name},
      "a list of sizes");
  if (count >= 0) csv.require_unit(static_cast<std::size_t>(count), Unit::none, "count");
  std::vector<double> radii;
  std::vector<double> counts;
  for (const CsvRow& row : csv.rows()) {
    radii.push_back((diameters ? 0.5 : 1.0) * must(csv.number(row, column, Unit::length), csv, row, "the size"));
    if (!(radii.back() > 0.0)) throw InputError(fmt::format("{}: a size must be positive", csv.where(row.line)));
    if (count < 0) continue;
    counts.push_back(must(csv.number(row, static_cast<std::size_t>(count), Unit::none), csv, row, "the count"));
    if (!(counts.back() >= 0.0)) throw InputError(fmt::format("{}: a count must not be negative", csv.where(row.line)));
  }
  if (radii.empty()) throw InputError(path + ": no sizes");
  if (count >= 0 && std::ranges::none_of(counts, [](double n) { return n > 0.0; }))
    throw InputError(path + ": no size has a count above 0");
  return Grading::list(std::move(radii), dimension, std::move(counts));
}

Grading read_grading(const SceneTable& t, int dimension) {
  const auto form = t.choice<GradingForm>({"form", "form of the size distribution"});
  if (form == GradingForm::classes) return read_classes(t, dimension);
  if (form == GradingForm::sieve_curve) return read_curve(t, dimension);
  if (form == GradingForm::list) return read_list(t, dimension);
  const Ends ends = read_ends(t, "`\"power-law\"`, `\"fuller\"` and `\"log-normal\"`");
  if (form == GradingForm::log_normal)
    return Grading::log_normal(
        t.number({"radius_median", "`\"log-normal\"`: half of the volume is in smaller grains"}, Unit::length,
                 Range::positive()),
        t.number({"geometric_deviation", "`\"log-normal\"`: exp of the standard deviation of ln r"}, Unit::none,
                 Range{1.0, 20.0, true, false}),
        ends.low, ends.high, dimension);
  if (form == GradingForm::fuller)
    return Grading::fuller(t.number(kExponentKey, Unit::none, Range{0.0, 3.0, true, false}), ends.low, ends.high,
                           dimension);
  return Grading::power_law(t.number(kExponentKey, Unit::none, kExponents), ends.low, ends.high, dimension);
}

Grading stored_grading(const std::string& text, int dimension) {
  try {
    return read_grading(Scene::parse(text, "sizes").root(), dimension);
  } catch (const InputError& e) {
    throw IoError(std::string("attribute 'sizes': ") + e.what());
  }
}

std::optional<Grading> read_sizes(const SceneTable& t, const Key& key, std::initializer_list<const char*> instead,
                                  int dimension) {
  if (!t.has(key.name)) return std::nullopt;
  t.refuse(instead, "goes without " + key.name + ", which says all sizes");
  const SceneTable sizes = t.table(key);
  std::optional<Grading> out;
  sizes.section([&] { out = read_grading(sizes, dimension); });
  return out;
}

}  // namespace softgrain
