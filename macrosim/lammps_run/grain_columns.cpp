#include "macrosim/lammps_run/grain_columns.h"

#include <fmt/format.h>

#include <algorithm>

#include "macrosim/grain_record.h"

namespace softgrain::lammps {

namespace {

/// The first of compute softgrain/contacts that grains are told of.
constexpr int kFirstValue = 18;

constexpr Bearers kBearers[] = {Bearers::coarse_coarse, Bearers::coarse_fine, Bearers::fine_fine};

}  // namespace

std::string grain_words(const MacroSpec& spec, const MacroPacking& packing) {
  if (spec.splits.empty()) return "";
  double largest = 0.0;
  for (const MacroBody& b : packing.bodies) largest = std::max(largest, b.r);
  std::string text = fmt::format(" grains {}", contacts_that_hold(spec));
  for (const double split : spec.splits) text += fmt::format(" {}", split * largest);
  return text;
}

std::vector<GrainColumn> grain_columns(const MacroSpec& spec) {
  std::vector<GrainColumn> columns;
  const auto add = [&](const std::string& name) {
    columns.push_back({name, fmt::format("c_contacts[{}]", kFirstValue + static_cast<int>(columns.size()))});
  };
  if (!spec.splits.empty()) add(kRattlers);
  for (const double split : spec.splits)
    for (const Bearers b : kBearers) add(fmt::format("{}_{:.4g}", to_string(b), split));
  return columns;
}

std::vector<std::string> grain_names(const MacroSpec& spec) {
  std::vector<std::string> names;
  for (const GrainColumn& c : grain_columns(spec)) names.push_back(c.name);
  return names;
}

void add_grains(const PointRow& row, const MacroSpec& spec, const MacroPacking& packing, MacroCurve& curve) {
  if (spec.splits.empty()) return;
  const double volume = row[Point::lx] * row[Point::ly] * row[Point::lz];
  const double virial = row[Point::branch_xx] + row[Point::branch_yy] + row[Point::branch_zz];
  curve.more[kSolidFraction].push_back(packing.body_volume() / volume);
  curve.more[kRattlers].push_back(row.more[0] / static_cast<double>(packing.bodies.size()));
  std::size_t k = 1;
  for (const double split : spec.splits)
    for (const Bearers b : kBearers) {
      const double of_these = row.more[k++];
      curve.more[share_name(b, split)].push_back(virial > 0.0 ? of_these / virial : 0.0);
    }
}

}  // namespace softgrain::lammps
