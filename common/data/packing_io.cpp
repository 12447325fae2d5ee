#include "common/data/packing_io.h"

#include "common/data/columns.h"

namespace softgrain {

void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings) {
  const h5::Group group = root.create("packings");
  write_column(group, "seed", "1", packings, [](const auto& p) { return p.seed; });
  write_column(group, "grains", "1", packings, [](const auto& p) { return p.grains; });
  write_column(group, "solid_fraction", "1", packings, [](const auto& p) { return p.solid_fraction; });
  write_column(group, "contacts_per_grain", "1", packings, [](const auto& p) { return p.contacts_per_grain; });
  write_column(group, "exponent", "1", packings, [](const auto& p) { return p.exponent; });
  write_column(group, "exponent_error", "1", packings, [](const auto& p) { return p.exponent_error; });
  write_column(group, "radius_count", "1", packings, [](const auto& p) { return p.radii.size(); });
  std::vector<double> radii;
  for (const PackingInfo& p : packings) radii.insert(radii.end(), p.radii.begin(), p.radii.end());
  group.write("radii", std::span<const double>(radii));
  group.attribute_of("radii", "unit", "m");
}

std::vector<PackingInfo> read_packings(const h5::Group& root) {
  const h5::Group group = root.open("packings");
  std::vector<PackingInfo> packings(column_length(group, "seed"));
  read_integers(group, "seed", packings, [](auto& p, auto v) { p.seed = static_cast<std::uint64_t>(v); });
  read_integers(
      group, "grains", packings, [](auto& p, auto v) { p.grains = v; }, Limits::not_negative());
  read_finite(
      group, "solid_fraction", "1", packings, [](auto& p, double v) { p.solid_fraction = v; }, Limits::flag());
  read_finite(
      group, "contacts_per_grain", "1", packings, [](auto& p, double v) { p.contacts_per_grain = v; },
      Limits::not_negative());
  read_doubles(group, "exponent", "1", packings, [](auto& p, double v) { p.exponent = v; });
  read_doubles(group, "exponent_error", "1", packings, [](auto& p, double v) { p.exponent_error = v; });
  const std::vector<double> radii =
      read_numbers(group, "radii", "m", {group.doubles("radii").size()}, Limits::not_negative());
  Slices slices(radii.size());
  read_integers(group, "radius_count", packings, [&](auto& p, auto v) { p.radii = take(radii, slices, v); });
  slices.finish();
  return packings;
}

}  // namespace softgrain
