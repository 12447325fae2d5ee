// Tables and dumps as the script of LAMMPS writes them, and a test that has stages of every kind.
#pragma once

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <vector>

#include "macrosim/lammps_run/points_file.h"
#include "macrosim/macro_spec.h"

namespace softgrain::test {

/// Point `number` of a test that went well, in a box of 1 m.
inline lammps::PointRow point_row(double number, double strain) {
  using lammps::Point;
  lammps::PointRow row;
  const auto set = [&](Point p, double x) { row.values[static_cast<std::size_t>(p)] = x; };
  set(Point::number, number);
  set(Point::strain, strain);
  for (const Point p : {Point::lx, Point::ly, Point::lz}) set(p, 1.0);
  for (int k = 0; k < 6; ++k) row.values[static_cast<std::size_t>(Point::wall_xlo) + k] = 10.0 + k;
  set(Point::contacts, 4.0);
  set(Point::wall_contacts, 2.0);
  set(Point::force_sum, 40.0);
  set(Point::fabric, 0.25);
  set(Point::branch_zz, 15.0);
  set(Point::law_evaluations, 3.0);
  set(Point::law_largest, 0.5);
  set(Point::residual, 0.003);
  set(Point::passes, 100.0);
  set(Point::end, 1.0);
  set(Point::looked_at, 1234.0);
  set(Point::seconds, 0.5);
  set(Point::unrest, 0.003);
  set(Point::unrest_at, 1.0);
  set(Point::unrest_end, 1.0);
  return row;
}

inline lammps::PointRow with(lammps::PointRow row, lammps::Point p, double x) {
  row.values[static_cast<std::size_t>(p)] = x;
  return row;
}

inline std::string dump_text(const std::string& what, const std::vector<std::string>& rows) {
  std::string text = fmt::format(
      "ITEM: TIMESTEP\n7\nITEM: NUMBER OF {}\n{}\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n", what, rows.size());
  text += "ITEM: " + what + " some columns\n";
  for (const std::string& row : rows) text += row + "\n";
  return text;
}

/// Without waiting for the disk.
inline void overwrite(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Stages of every kind, in a periodic cell.
inline MacroSpec staged_spec() {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.test = MacroTest::stages;
  const auto add = [&](StageKind kind) -> MacroStage& {
    spec.stages.emplace_back();
    spec.stages.back().record = {to_string(kind), kind, kind};
    return spec.stages.back();
  };
  for (AxisDrive& axis : add(StageKind::consolidation).axis) axis = {true, 300.0, -1};
  MacroStage& triaxial = add(StageKind::triaxial);
  triaxial.axis[0] = triaxial.axis[1] = {true, 0.0, 1};
  triaxial.axis[2].value = 0.05;
  MacroStage& shear = add(StageKind::shear);
  shear.axis[0].value = -0.01;
  shear.axis[2].value = 0.01;
  shear.logarithmic = true;
  add(StageKind::hold);
  return spec;
}

}  // namespace softgrain::test
