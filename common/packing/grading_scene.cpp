#include "common/packing/grading_scene.h"

#include <fmt/format.h>

#include <algorithm>
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

std::size_t length_column(const CsvFile& csv, std::initializer_list<const char*> names, const char* example) {
  const int k = column_of(csv, names);
  if (k < 0) throw InputError(fmt::format("{}needs a column \"{}\"", head_of(csv), example));
  const auto column = static_cast<std::size_t>(k);
  csv.require_unit(column, Unit::length, example);
  return column;
}

double must(const std::optional<double>& value, const CsvFile& csv, const CsvRow& row, const char* what) {
  if (!value) throw InputError(fmt::format("{}: {} is missing", csv.where(row.line), what));
  return *value;
}

/// A file says the whole distribution: values beside it are those of another one. The usual way there is a --set that
/// gives the file to a scene with values, so the message has the setting that replaces both. Said once for all `keys`.
void refuse_beside_file(const SceneTable& t, std::initializer_list<const char*> keys, GradingForm form) {
  bool said = false;
  for (const char* key : keys) {
    if (!t.has(key) || said) continue;
    said = true;
    std::string text = "goes without file, which gives all sizes: leave out one of the two";
    if (!t.path().empty())
      text += fmt::format("; a whole table in its place: --set '{}={{form=\"{}\",file=\"{}\"}}'", t.path(),
                          to_string(form), t.text("file"));
    t.add_error(key, text);
  }
}

Grading read_curve(const SceneTable& t, int dimension) {
  if (t.has("file")) {
    refuse_beside_file(t, {"openings", "passing"}, GradingForm::sieve_curve);
    const SieveOptions options = read_sieve_options(t);  // asked for before the file is read
    return read_sieve_file(t.resolve(t.text(kFileKey)), options, dimension).grading;
  }
  const std::vector<double> openings =
      t.numbers({"openings", "`\"sieve-curve\"` without a file: openings of the sieves (diameters)"}, Unit::length,
                Range::positive());
  std::vector<double> passing = t.numbers({"passing",
                                           "`\"sieve-curve\"` without a file: shares of the volume that pass the "
                                           "`openings`; the smallest must be 0, the largest 1"},
                                          Unit::none, Range::closed(-kSieveRounding, 1.0 + kSieveRounding));
  for (double& share : passing)
    for (const double end : {0.0, 1.0})
      if (std::abs(share - end) < kSieveRounding) share = end;
  if (openings.size() != passing.size())
    t.throw_error("passing", fmt::format("has {}; openings has {}: one for each", counted(passing.size(), "value"),
                                         openings.size()));
  std::vector<SieveRow> rows;
  for (std::size_t k = 0; k < openings.size(); ++k) rows.push_back({openings[k], passing[k], t.where("passing")});
  return sieve_grading(std::move(rows), dimension);
}

Grading read_list(const SceneTable& t, int dimension) {
  if (t.has("file")) {
    refuse_beside_file(t, {"radii", "counts"}, GradingForm::list);
    return read_radii(t.resolve(t.text(kFileKey)), dimension);
  }
  std::vector<double> radii =
      t.numbers({"radii", "`\"list\"` without a file: the sizes"}, Unit::length, Range::positive());
  if (radii.empty()) t.throw_error("radii", "at least one radius is needed");
  std::vector<double> counts;
  if (t.has("counts")) {
    counts = t.numbers({"counts", "`\"list\"`: number of grains of each size (weights by number)", "one of each"},
                       Unit::none, Range::not_negative());
    if (counts.size() != radii.size())
      t.throw_error("counts",
                    fmt::format("has {}; radii has {}: one for each", counted(counts.size(), "value"), radii.size()));
    if (std::ranges::none_of(counts, [](double n) { return n > 0.0; }))
      t.throw_error("counts", "at least one must be above 0");
  }
  return Grading::list(std::move(radii), dimension, std::move(counts));
}

}  // namespace

SieveOptions read_sieve_options(const SceneTable& t) {
  SieveOptions options;
  options.column = t.text({"column",
                           "file of a sieve curve: which column counts and as what, `passing`, `retained` (on each "
                           "sieve), `cumulative retained`, the title of a column, or `TITLE as MEANING`",
                           "as the file says"},
                          "");
  if (t.has("unit"))
    options.unit = t.choice({"unit",
                             "file of a sieve curve: unit of sizes without one; `phi`: -log2 of mm, `astm`: numbers "
                             "of ASTM E11",
                             "as the file says"},
                            {"mm", "um", "cm", "m", "in", "phi", "astm"});
  const auto size = [&](const Key& key) -> std::optional<double> {
    if (!t.has(key.name)) return std::nullopt;
    return t.number(key, Unit::length, Range::positive());
  };
  options.smallest = size({"smallest",
                           "file of a sieve curve: diameter that is below all grains, where some pass the "
                           "finest sieve"});
  options.largest = size({"largest",
                          "file of a sieve curve: diameter that is above all grains, where the coarsest "
                          "sieve retains some"});
  return options;
}

Grading read_radii(const std::string& path, int dimension) {
  CsvFile csv = CsvFile::read(path);
  csv.take_units_behind_names([](const std::string& name) {
    const bool size = name == "radius" || name == "r" || name == "diameter" || name == "d";
    return size ? std::optional(Unit::length) : std::nullopt;
  });
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
