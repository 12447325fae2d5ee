// Layout of law.h5: "spec"; per pair kind a group with attributes, "table" (the measured curve) and, per law, a group
// of its parameters as rows (value, standard_error, low, high); "covariance" 7 x 7; "band" with the 95 % bands. All
// dimensionless.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/columns.h"
#include "common/data/law_card_format.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

namespace {

constexpr std::string_view kBandInterval = "95 %, ";  ///< before PairLaw::band_origin

void write_parameters(const h5::Group& group, const PairLaw& pair) {
  for (const LawPartName& part : kLawParts) {
    const h5::Group law = group.create(part.key);
    law.attribute("columns", "value, standard_error, low, high");
    law.attribute("unit", part.tangential ? "kt/(E Rs)" : "Fn/(E Rs^2)");
    for (const LawParameterName& p : kLawParameters) {
      const Estimate& e = pair.*part.law.*p.estimate;
      law.write(p.key, std::array<double, 4>{e.value, e.standard_error, e.low, e.high});
    }
  }
}

void write_curve(const h5::Group& group, const LawTableRows& rows) {
  const h5::Group table = group.create("table");
  table.attribute("units", "delta 1, force Fn/(E Rs^2), kt kt/(E Rs)");
  for (const LawTableColumn& column : kLawTableColumns)
    table.write(column.name, std::span<const double>(rows.*column.values));
}

void write_pair(const h5::Group& root, const PairLaw& pair) {
  const h5::Group group = root.create(to_string(pair.kind));
  group.attribute("status", to_string(pair.status));
  group.attribute("reason", pair.reason);
  group.attribute("initial_angle_deg", pair.initial_angle_deg);
  group.attribute("secant_angle_deg", pair.secant_angle_deg);
  group.attribute("has_tangential_initial", std::int64_t{pair.has_tangential_initial});
  group.attribute("has_tangential_secant", std::int64_t{pair.has_tangential_secant});
  group.attribute("delta_min", pair.delta_min);
  group.attribute("delta_max", pair.delta_max);
  group.attribute("max_overlap", pair.max_overlap);
  group.attribute("packings", std::int64_t{pair.packings});
  group.attribute("points", std::int64_t{pair.points});
  group.attribute("chi2_per_dof", pair.chi2_per_dof);
  group.attribute("quality", pair.quality);
  write_curve(group, pair.table);
  write_parameters(group, pair);
  constexpr std::size_t n = kLawParameterNames.size();
  if (pair.covariance.size() == n * n) group.write("covariance", std::span<const double>(pair.covariance), {n, n});
}

/// Group band/<pair kind>: delta, <law>_low, <law>_high; what the bands are as attribute.
void write_bands(const h5::Group& root, const LawCard& card) {
  const h5::Group bands = root.create("band");
  for (const PairLaw& pair : card.pairs) {
    if (pair.bands.empty()) continue;
    const h5::Group group = bands.create(to_string(pair.kind));
    group.attribute("interval", std::string(kBandInterval) + pair.band_origin);
    group.write("delta", std::span<const double>(pair.band_delta));
    for (const LawBandRows& band : pair.bands) {
      group.write(band.law + "_low", std::span<const double>(band.low));
      group.write(band.law + "_high", std::span<const double>(band.high));
    }
  }
}

/// Whether the bands belong to the numbers of the card, which people may have changed.
bool same_numbers(const h5::Group& law, const ThresholdPowerLaw& card) {
  return std::ranges::all_of(kLawParameters, [&](const LawParameterName& p) {
    if (!law.has(p.key)) return false;
    const std::vector<double> row = law.doubles(p.key);
    const double value = (card.*p.estimate).value;
    return !row.empty() && std::abs(row.front() - value) <= 1e-9 * std::abs(value);
  });
}

/// Numbers that place values on the axis of overlaps.
std::vector<double> ascending(const h5::Group& group, const std::string& name, const std::string& path) {
  std::vector<double> values = group.doubles(name);
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values[k]) || (k > 0 && !(values[k - 1] < values[k])))
      throw IoError(path + ": '" + name + "' does not ascend in row " + std::to_string(k));
  return values;
}

/// Bands of the laws whose numbers are those of the card; the others are named in `edited`.
void read_bands(const h5::Group& root, PairLaw& pair, const std::string& path, std::vector<std::string>& edited) {
  const std::string name = to_string(pair.kind);
  if (!root.has("band") || !root.open("band").has(name)) return;
  const h5::Group group = root.open("band").open(name);
  pair.band_delta = ascending(group, "delta", path);
  const std::string said = group.has_attribute("interval") ? group.text("interval") : "";
  if (said.starts_with(kBandInterval)) pair.band_origin = said.substr(kBandInterval.size());
  for (const LawPartName& part : kLawParts) {
    const std::string key = part.key;
    if (!group.has(key + "_low") || !group.has(key + "_high")) continue;
    LawBandRows rows{key, group.doubles(key + "_low"), group.doubles(key + "_high")};
    if (rows.low.size() != pair.band_delta.size() || rows.high.size() != pair.band_delta.size())
      throw IoError(path + ": the band of '" + key + "' has a wrong length");
    const h5::Group fitted = root.open(name);
    if (fitted.has(key) && same_numbers(fitted.open(key), pair.*part.law))
      pair.bands.push_back(std::move(rows));
    else
      edited.push_back(name + " " + key);
  }
}

LawTableRows read_curve(const h5::Group& table, const std::string& path) {
  LawTableRows rows;
  for (const LawTableColumn& column : kLawTableColumns) {
    std::vector<double>& values = rows.*column.values;
    values = column.values == &LawTableRows::delta ? ascending(table, column.name, path) : table.doubles(column.name);
    // A quantity that was not measured has an empty column.
    if (!values.empty() && values.size() != rows.delta.size())
      throw IoError(path + ": column '" + column.name + "' of the table has a wrong length");
  }
  return rows;
}

}  // namespace

void require_own_table(const h5::Group& root, const std::string& table_id, const std::string& path) {
  const std::string said = root.has_attribute(kTableId) ? root.text(kTableId) : "";
  // People may take the words about the origin out of a card: then its numbers tell.
  if (table_id.empty() || said == table_id) return;
  throw InputError(path + ": this file belongs to another law (" +
                   (said.empty() ? "it names none" : "it names " + said) + ", the .toml of this name wants " +
                   table_id +
                   "): put the one back that was written with the .toml, or "
                   "remove it");
}

void write_table(const LawCard& card, const std::string& path, const Provenance& provenance,
                 const std::string& table_id) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kLawFormat);
  if (!table_id.empty()) root.attribute(kTableId, table_id);
  root.attribute("relaxation", card.relaxation);
  if (!card.from_experiment()) root.attribute("turn", to_string(card.turn));
  write_spec(root, card.spec);
  for (const PairLaw& pair : card.pairs) write_pair(root, pair);
  write_bands(root, card);
  write_provenance(root, provenance);
  file.commit();
}

void read_table(LawCard& card, const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kLawFormat, path);
  require_own_table(root, card.table_id, path);
  std::vector<std::string> edited;
  for (PairLaw& pair : card.pairs) {
    const std::string name = to_string(pair.kind);
    if (!root.has(name)) continue;
    pair.table = read_curve(root.open(name).open("table"), path);
    read_bands(root, pair, path, edited);
  }
  if (!edited.empty())
    card.notes.push_back("the numbers of the card are not those that " + path + " was written with (" +
                         join_text(edited) + "): its 95 % bands are not used");
}

namespace {

/// `known`: the fit is good, so that its numbers are finite; errors and intervals may be infinite all the same.
void check_parameters(const h5::Group& law, bool known) {
  constexpr std::size_t kColumns = 4;
  for (const LawParameterName& p : kLawParameters) {
    const std::vector<double> row = law.doubles(p.key);
    if (row.size() != kColumns || (known && !std::isfinite(row.front())))
      law.refuse(p.key, "must hold a finite number, its standard error and the ends of its interval");
  }
}

}  // namespace

void check_table(const std::string& path) {
  h5::naming_file(path, [&] {
    const h5::Group root = h5::open_file(path);
    require_format(root, kLawFormat, path);
    for (const PairKind kind : kPairKinds) {
      PairLaw pair;
      pair.kind = kind;
      const std::string name = to_string(kind);
      if (!root.has(name)) continue;
      const h5::Group group = root.open(name);
      const h5::Group table = group.open("table");
      const bool known = group.text("status") == to_string(LawStatus::good);
      (void)read_curve(table, path);
      if (known) (void)finite_numbers(table, "force_mean");  // stiffnesses that were not measured are NaN
      for (const LawPartName& part : kLawParts) check_parameters(group.open(part.key), known);
      std::vector<std::string> of_other_numbers;
      read_bands(root, pair, path, of_other_numbers);
    }
  });
}

}  // namespace softgrain
