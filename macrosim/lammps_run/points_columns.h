// What is recorded at every point of a test in LAMMPS: one list for the script that writes rows and for their reader.
#pragma once

#include <array>
#include <cstddef>

namespace softgrain::lammps {

struct PointColumn {
  const char* name;        ///< name in the head of points.txt
  const char* expression;  ///< expression of the column in LAMMPS
};

/// Recorded quantities, in the order of kPointColumns.
enum class Point : std::size_t {
  number,
  strain,
  lx,
  ly,
  lz,
  wall_xlo,
  wall_xhi,
  wall_ylo,
  wall_yhi,
  wall_zlo,
  wall_zhi,
  contacts,
  wall_contacts,
  force_sum,
  fabric,
  branch_xx,
  branch_yy,
  branch_zz,
  branch_xy,
  branch_xz,
  branch_yz,
  overlap,
  law_evaluations,
  law_beyond,
  law_largest,
  law_refused,
  law_clamped,
  behind_walls,
  residual,
  passes,
  end,
  mean_force,
  looked_at,
  seconds,
  stress_x,
  stress_y,
  stress_z,
  asked_x,
  asked_y,
  asked_z,
  over,
  unrest,
  unrest_at,
  unrest_end,
  count
};

/// Columns of tables that earlier versions began ("points 2"): those before `unrest`.
inline constexpr std::size_t kEarlierColumns = static_cast<std::size_t>(Point::unrest);

/// Forces of bodies on walls [N], pushing positive; branch: force times branch [N m]; end: 1 converged, 2 capped,
/// 3 diverged; looked_at: near pairs in all passes; stress: on the box [Pa], asked: of axes that go by stress; over: 1
/// where that was not reached; unrest: residual of the increment since the point before that ended farthest from rest,
/// which one of them it is, and how it ended. Columns of walls are 0 in a periodic cell.
inline constexpr std::array<PointColumn, static_cast<std::size_t>(Point::count)> kPointColumns{{
    {"point", "v_point"},
    {"strain", "v_strain"},
    {"lx", "lx"},
    {"ly", "ly"},
    {"lz", "lz"},
    {"wall_xlo", "f_walls[1]"},
    {"wall_xhi", "f_walls[2]"},
    {"wall_ylo", "f_walls[3]"},
    {"wall_yhi", "f_walls[4]"},
    {"wall_zlo", "f_walls[5]"},
    {"wall_zhi", "f_walls[6]"},
    {"contacts", "c_contacts[1]"},
    {"wall_contacts", "c_contacts[2]"},
    {"force_sum", "c_contacts[3]"},
    {"fabric", "c_contacts[4]"},
    {"branch_xx", "c_contacts[5]"},
    {"branch_yy", "c_contacts[6]"},
    {"branch_zz", "c_contacts[7]"},
    {"branch_xy", "c_contacts[8]"},
    {"branch_xz", "c_contacts[9]"},
    {"branch_yz", "c_contacts[10]"},
    {"overlap", "c_contacts[11]"},
    {"law_asked", "c_contacts[12]"},
    {"law_beyond", "c_contacts[13]"},
    {"law_largest", "c_contacts[14]"},
    {"law_refused", "c_contacts[15]"},
    {"law_clamped", "c_contacts[16]"},
    {"behind_walls", "c_contacts[17]"},
    {"residual", "v_residual"},
    {"passes", "v_passes"},
    {"end", "v_end"},
    {"mean_force", "v_mean_force"},
    {"looked_at", "v_looked_at"},
    {"seconds", "v_seconds"},
    {"stress_x", "f_relax[7]"},
    {"stress_y", "f_relax[8]"},
    {"stress_z", "f_relax[9]"},
    {"asked_x", "v_wantx"},
    {"asked_y", "v_wanty"},
    {"asked_z", "v_wantz"},
    {"over", "v_over"},
    {"unrest", "v_unrest"},
    {"unrest_at", "v_unrest_at"},
    {"unrest_end", "v_unrest_end"},
}};

/// First words of points.txt; the name of the scene follows (scene_key).
inline constexpr const char* kPointsHead = "# softgrain points 3";
inline constexpr const char* kEarlierPointsHead = "# softgrain points 2";

}  // namespace softgrain::lammps
