#include "common/data/packing_io.h"

#include "common/data/fields.h"

namespace softgrain {

void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings) {
  const h5::Group group = root.create("packings");
  write_records(group, packings);
  write_column(group, "radius_count", "1", packings, [](const auto& p) { return p.radii.size(); });
  std::vector<double> radii;
  for (const PackingInfo& p : packings) radii.insert(radii.end(), p.radii.begin(), p.radii.end());
  group.write("radii", std::span<const double>(radii));
  group.attribute_of("radii", "unit", "m");
}

std::vector<PackingInfo> read_packings(const h5::Group& root) {
  const h5::Group group = root.open("packings");
  std::vector<PackingInfo> packings(column_length(group, "seed"));
  read_records(group, packings);
  const std::vector<double> radii =
      read_numbers(group, "radii", "m", {group.doubles("radii").size()}, Limits::not_negative());
  Slices slices(radii.size());
  read_integers(group, "radius_count", packings, [&](auto& p, auto v) { p.radii = take(radii, slices, v); });
  slices.finish();
  return packings;
}

}  // namespace softgrain
