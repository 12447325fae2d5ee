// Starting states that are not prepared: kept by another run, or given as a file.
#include "pipelines/kinds/macro/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/csv_file.h"
#include "common/neighbours/hierarchical_grid.h"
#include "macrosim/preparation.h"
#include "pipelines/kinds/macro/twin_cache.h"

namespace softgrain {

enum class BodyKind { solid, soft };

template <>
inline constexpr auto enum_names<BodyKind> = enum_name_list<BodyKind>({{BodyKind::solid, "solid"},
                                                                       {BodyKind::soft, "soft"}});

namespace {

std::size_t column_of(const CsvFile& csv, const char* name, Unit unit, const char* example) {
  for (std::size_t k = 0; k < csv.columns().size(); ++k) {
    if (csv.columns()[k].name != name) continue;
    csv.require_unit(k, unit, example);
    return k;
  }
  std::string found;
  for (const CsvColumn& c : csv.columns()) append_part(found, c.title, ", ");
  throw InputError(fmt::format("{}: needs a column \"{}\"; a packing has x [m], y [m], z [m], r [m], kind; found: {}",
                               csv.where(csv.header_line()), example, found));
}

struct Columns {
  std::size_t x, y, z, r, kind;
};

double required(const CsvFile& csv, const CsvRow& row, std::size_t column) {
  const auto value = csv.number(row, column, Unit::length);
  if (!value)
    throw InputError(fmt::format("{}: column \"{}\": is missing", csv.where(row.line), csv.columns()[column].title));
  return *value;
}

MacroBody body_of(const CsvFile& csv, const CsvRow& row, const Columns& c) {
  MacroBody body;
  const std::array<std::size_t, 3> places{c.x, c.y, c.z};
  for (int a = 0; a < 3; ++a) body.x[a] = required(csv, row, places[static_cast<std::size_t>(a)]);
  body.r = required(csv, row, c.r);
  const auto complain = [&](std::size_t column, const std::string& problem) {
    throw InputError(fmt::format("{}: column \"{}\": {}: {}", csv.where(row.line), csv.columns()[column].title,
                                 row.cells[column], problem));
  };
  if (!(body.r > 0.0)) complain(c.r, "a radius must be above 0");
  const auto kind = parse_enum<BodyKind>(row.cells[c.kind]);
  if (!kind) complain(c.kind, "must be solid or soft");
  body.soft = kind == BodyKind::soft;
  return body;
}

const CsvNames kBoxNames{"box"};

/// Low and high corner from the comment, else around all bodies.
void read_box(const CsvFile& csv, const Columns& c, MacroPacking& packing) {
  const auto corners = csv.quantities(kBoxNames, Unit::length, 6);
  if (!corners) {
    packing.low = packing.high = packing.bodies.front().x;
    for (const MacroBody& b : packing.bodies)
      for (int a = 0; a < 3; ++a) {
        packing.low[a] = std::min(packing.low[a], b.x[a] - b.r);
        packing.high[a] = std::max(packing.high[a], b.x[a] + b.r);
      }
    return;
  }
  const CsvSetting said = *csv.setting(kBoxNames);
  const auto complain = [&](const std::string& problem) {
    throw InputError(fmt::format("{}: {} = {}: {}", csv.where(said.line), said.title, said.value, problem));
  };
  const bool unit = !said.unit.empty() || said.value.find('m') != std::string::npos;
  if (!unit && csv.columns()[c.x].unit != "m")
    complain(fmt::format("no unit, and the columns are in {0}: write \"box [{0}] = ...\"", csv.columns()[c.x].unit));
  packing.low = {{(*corners)[0], (*corners)[1], (*corners)[2]}};
  packing.high = {{(*corners)[3], (*corners)[4], (*corners)[5]}};
  for (int a = 0; a < 3; ++a)
    if (!(packing.low[a] < packing.high[a])) complain("the high corner must be above the low one");
}

/// Requires that all bodies are in the box. In a periodic cell only their centres must be.
void require_inside(const CsvFile& csv, const MacroPacking& packing, const Columns& c, Boundary boundary) {
  const std::array<std::size_t, 3> places{c.x, c.y, c.z};
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) {
    const MacroBody& b = packing.bodies[k];
    for (int a = 0; a < 3; ++a) {
      const double r = boundary == Boundary::periodic ? 0.0 : b.r;
      const double out = std::max(packing.low[a] - (b.x[a] - r), b.x[a] + r - packing.high[a]);
      if (out <= kGivenOverlap * b.r) continue;
      const std::size_t column = places[static_cast<std::size_t>(a)];
      throw InputError(
          fmt::format("{}: column \"{}\": {}: the body is outside the box by {:.3g} of its radius; allowed: up to {:g}",
                      csv.where(csv.rows()[k].line), csv.columns()[column].title, csv.rows()[k].cells[column],
                      out / b.r, kGivenOverlap));
    }
  }
}

/// Pairs that overlap by more than is allowed, across the faces of a periodic cell too.
void require_apart(const CsvFile& csv, const MacroPacking& packing, Boundary boundary) {
  Particles<3> particles;
  for (const MacroBody& b : packing.bodies) {
    NewBody<3> grain;
    grain.x = b.x - packing.low;
    grain.r = b.r;
    add_grain(particles, grain);
  }
  const bool periodic = boundary == Boundary::periodic;
  const Cell<3> cell = periodic ? box_cell<3>(packing.size(), {true, true, true}) : open_cell<3>();
  for (const CandidatePair& pair : candidate_pairs(particles, cell, std::vector<double>(packing.bodies.size(), 0.0))) {
    const Sphere<3>& a = particles.sphere[at(pair.i)];
    const Sphere<3>& b = particles.sphere[at(pair.j)];
    const double smaller = std::min(a.r, b.r);
    const double overlap = a.r + b.r - norm(a.x - b.x - cell.image_shift(pair.image));
    if (overlap <= kGivenOverlap * smaller) continue;
    const auto [first, second] = std::minmax(csv.rows()[at(pair.i)].line, csv.rows()[at(pair.j)].line);
    throw InputError(
        fmt::format("{}: columns x, y, z: overlaps the body of line {} by {:.3g} of the smaller radius; allowed: up "
                    "to {:g}",
                    csv.where(second), first, overlap / smaller, kGivenOverlap));
  }
}

/// A cell must be given, and be longer than two diameters of the largest body. All centres go home into it.
void make_periodic(const CsvFile& csv, MacroPacking& packing) {
  if (!csv.setting(kBoxNames))
    throw InputError(fmt::format(
        "{}: a periodic packing says its cell: \"# box [m] = 0 0 0 0.1 0.1 0.1\", the low corner and the high one",
        csv.where(csv.header_line())));
  const Vec3 size = packing.size();
  const double shortest = std::min({size[0], size[1], size[2]});
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) {
    MacroBody& b = packing.bodies[k];
    if (4.1 * b.r > shortest)
      throw InputError(
          fmt::format("{}: images of a body must be at least two diameters apart: the cell is {:.3g} m long",
                      csv.where(csv.rows()[k].line), shortest));
    for (int a = 0; a < 3; ++a) b.x[a] -= size[a] * std::floor((b.x[a] - packing.low[a]) / size[a]);
  }
}

/// The test begins when a packing is prepared: its members, and those of laws and twins, are as without a scene. Every
/// other member is part of the key. (A test of the keys prepares packings with each of these changed.)
MacroSpec as_prepared(MacroSpec spec) {
  const MacroSpec none;
  spec.friction = none.friction;  // of the test; that of the preparation among bodies is in its protocol
  spec.wall_friction = preparation_wall_friction(spec);
  if (!(spec.protocol.friction > 0.0)) spec.rolling = none.rolling;
  spec.test = none.test;
  spec.splits = none.splits;
  spec.stages = none.stages;
  spec.modulus_stress = none.modulus_stress;
  spec.strain_end = none.strain_end;
  spec.preload = none.preload;
  spec.preload_steps = none.preload_steps;
  spec.steps = none.steps;
  spec.increments_per_step = none.increments_per_step;
  spec.tolerance = none.tolerance;
  spec.force_floor = none.force_floor;
  spec.max_passes = none.max_passes;
  spec.twin = none.twin;
  spec.kt_secant = none.kt_secant;
  return spec;
}

}  // namespace

MacroPacking read_packing_file(const std::string& path, Boundary boundary) {
  const CsvFile csv = CsvFile::read(path);
  csv.require_known_comments({kBoxNames}, "a packing");
  const Columns columns{column_of(csv, "x", Unit::length, "x [m]"), column_of(csv, "y", Unit::length, "y [m]"),
                        column_of(csv, "z", Unit::length, "z [m]"), column_of(csv, "r", Unit::length, "r [m]"),
                        column_of(csv, "kind", Unit::none, "kind")};
  csv.require_known_columns({"x", "y", "z", "r", "kind"}, "a packing");
  MacroPacking packing;
  for (const CsvRow& row : csv.rows()) packing.bodies.push_back(body_of(csv, row, columns));
  if (packing.bodies.empty()) throw InputError(csv.where(csv.header_line()) + ": no body");
  read_box(csv, columns, packing);
  require_inside(csv, packing, columns, boundary);
  if (boundary == Boundary::periodic) make_periodic(csv, packing);
  require_apart(csv, packing, boundary);
  return packing;
}

std::string packing_key(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample) {
  return KeyText("macro packing", kPackingSchema, as_prepared(spec), seed, sample).text();
}

}  // namespace softgrain
