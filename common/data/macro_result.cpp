// Layout of macro.h5: one group per curve ("curve_000000", ...) with attributes and one data set per recorded quantity.
#include "common/data/macro_result.h"

#include <fmt/format.h>

#include "common/core/error.h"
#include "common/data/spec_io.h"

namespace softgrain {

namespace {

constexpr const char* kFormat = "macro curves";

struct Column {
  const char* name;
  const char* unit;
  std::vector<double> MacroCurve::*values;
};

constexpr Column kColumns[] = {{"strain", "1", &MacroCurve::strain},
                               {"stress_axial", "Pa", &MacroCurve::stress_axial},
                               {"stress_lateral", "Pa", &MacroCurve::stress_lateral},
                               {"stress_axial_contacts", "Pa", &MacroCurve::stress_axial_contacts},
                               {"coordination", "1", &MacroCurve::coordination},
                               {"residual", "1", &MacroCurve::residual}};

struct Count {
  const char* name;
  std::int64_t MacroCurve::*value;
};

constexpr Count kCounts[] = {{"sample", &MacroCurve::sample},
                             {"bodies", &MacroCurve::bodies},
                             {"soft", &MacroCurve::soft},
                             {"grains", &MacroCurve::grains}};

void write_curve(const h5::Group& group, const MacroCurve& curve) {
  group.attribute("engine", curve.engine);
  group.attribute("test", curve.test);
  group.attribute("note", curve.note);
  group.attribute("usable", static_cast<std::int64_t>(curve.usable));
  for (const Count& c : kCounts) group.attribute(c.name, curve.*c.value);
  group.attribute("soft_volume_share", curve.soft_volume_share);
  group.attribute("solid_fraction", curve.solid_fraction);
  group.attribute("loop_passes", curve.cost.loop_passes);
  group.attribute("contact_evaluations", curve.cost.contact_evaluations);
  group.attribute("seconds", curve.cost.seconds);
  for (const Column& c : kColumns) {
    group.write(c.name, std::span<const double>(curve.*c.values));
    group.attribute_of(c.name, "unit", c.unit);
  }
}

MacroCurve read_curve(const h5::Group& group) {
  MacroCurve curve;
  curve.engine = group.text("engine");
  curve.test = group.text("test");
  curve.note = group.text("note");
  curve.usable = group.integer("usable") != 0;
  for (const Count& c : kCounts) curve.*c.value = group.integer(c.name);
  curve.soft_volume_share = group.number("soft_volume_share");
  curve.solid_fraction = group.number("solid_fraction");
  curve.cost = {group.integer("loop_passes"), group.integer("contact_evaluations"), group.number("seconds")};
  for (const Column& c : kColumns) curve.*c.values = group.doubles(c.name);
  return curve;
}

}  // namespace

void save_macro(const std::vector<MacroCurve>& curves, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kFormat);
  const h5::Group group = root.create("curves");
  for (std::size_t k = 0; k < curves.size(); ++k) write_curve(group.create(fmt::format("curve_{:06}", k)), curves[k]);
  write_provenance(root, provenance);
  file.commit();
}

std::vector<MacroCurve> load_macro(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kFormat, path);
  const h5::Group group = root.open("curves");
  std::vector<MacroCurve> curves;
  for (const std::string& name : group.children()) {
    curves.push_back(read_curve(group.open(name)));
    for (const Column& c : kColumns)
      if ((curves.back().*c.values).size() != curves.back().strain.size())
        throw FileTrouble(fmt::format("{}: {}/{}: another length than the strain", path, name, c.name));
  }
  return curves;
}

}  // namespace softgrain
