// Layout of macro.h5: one group per curve ("curve_000000", ...) with attributes and one data set per recorded quantity.
#include "common/data/macro_result.h"

#include <fmt/format.h>

#include <cmath>

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

/// Later additions: absent in files of before.
constexpr Column kOptionalColumns[] = {{"stress_x", "Pa", &MacroCurve::stress_x},
                                       {"stress_y", "Pa", &MacroCurve::stress_y},
                                       {"stress_deviator", "Pa", &MacroCurve::stress_deviator},
                                       {"fabric", "1", &MacroCurve::fabric},
                                       {"fabric_bodies", "1", &MacroCurve::fabric_bodies},
                                       {"coordination_bodies", "1", &MacroCurve::coordination_bodies},
                                       {"law_asked", "1", &MacroCurve::law_asked},
                                       {"law_beyond", "1", &MacroCurve::law_beyond},
                                       {"law_largest", "1", &MacroCurve::law_largest}};
constexpr Column kBodyForces{"body_forces", "N", &MacroCurve::body_forces};

void write_column(const h5::Group& group, const MacroCurve& curve, const Column& c) {
  group.write(c.name, std::span<const double>(curve.*c.values));
  group.attribute_of(c.name, "unit", c.unit);
}

void write_if_any(const h5::Group& group, const MacroCurve& curve, const Column& c) {
  if (!(curve.*c.values).empty()) write_column(group, curve, c);
}

void read_if_there(const h5::Group& group, MacroCurve& curve, const Column& c) {
  if (group.has(c.name)) curve.*c.values = group.doubles(c.name);
}

struct Count {
  const char* name;
  std::int64_t MacroCurve::*value;
};

constexpr Count kCounts[] = {{"sample", &MacroCurve::sample},
                             {"bodies", &MacroCurve::bodies},
                             {"soft", &MacroCurve::soft},
                             {"grains", &MacroCurve::grains}};

}  // namespace

void write_macro_curve(const h5::Group& group, const MacroCurve& curve) {
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
  group.attribute("preload", curve.preload);
  for (const Column& c : kColumns) write_column(group, curve, c);
  for (const Column& c : kOptionalColumns) write_if_any(group, curve, c);
  write_if_any(group, curve, kBodyForces);
}

MacroCurve read_macro_curve(const h5::Group& group) {
  MacroCurve curve;
  curve.engine = group.text("engine");
  curve.test = group.text("test");
  curve.note = group.text("note");
  curve.usable = group.integer("usable") != 0;
  for (const Count& c : kCounts) curve.*c.value = group.integer(c.name);
  curve.soft_volume_share = group.number("soft_volume_share");
  curve.solid_fraction = group.number("solid_fraction");
  curve.cost = {group.integer("loop_passes"), group.integer("contact_evaluations"), group.number("seconds")};
  if (group.has_attribute("preload")) curve.preload = group.number("preload");
  for (const Column& c : kColumns) curve.*c.values = group.doubles(c.name);
  for (const Column& c : kOptionalColumns) read_if_there(group, curve, c);
  read_if_there(group, curve, kBodyForces);
  return curve;
}

void save_macro(const std::vector<MacroCurve>& curves, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kFormat);
  const h5::Group group = root.create("curves");
  for (std::size_t k = 0; k < curves.size(); ++k)
    write_macro_curve(group.create(fmt::format("curve_{:06}", k)), curves[k]);
  write_provenance(root, provenance);
  file.commit();
}

namespace {

void require_finite(const MacroCurve& curve, const Column& c, const std::string& where) {
  for (const double x : curve.*c.values)
    if (!std::isfinite(x)) throw FileTrouble(fmt::format("{}/{}: holds a number that is not finite", where, c.name));
}

void require_length(const MacroCurve& curve, const Column& c, bool optional, const std::string& where) {
  const std::size_t n = (curve.*c.values).size();
  if (n == curve.strain.size() || (optional && n == 0)) return;
  throw FileTrouble(fmt::format("{}/{}: another length than the strain", where, c.name));
}

}  // namespace

std::vector<MacroCurve> load_macro(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kFormat, path);
  const h5::Group group = root.open("curves");
  std::vector<MacroCurve> curves;
  for (const std::string& name : group.children()) {
    curves.push_back(read_macro_curve(group.open(name)));
    for (const Column& c : kColumns) require_length(curves.back(), c, false, path + ": " + name);
    for (const Column& c : {kColumns[0], kColumns[1], kColumns[2]})
      require_finite(curves.back(), c, path + ": " + name);
    for (const Column& c : kOptionalColumns) require_length(curves.back(), c, true, path + ": " + name);
  }
  return curves;
}

}  // namespace softgrain
