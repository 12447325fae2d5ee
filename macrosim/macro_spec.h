// What a macro scene asks for.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/core/material.h"
#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"

namespace softgrain {

enum class Construction {
  mixed,  ///< solid grains and soft particles are drawn, placed and compacted together
  voids   ///< solid grains first, then soft particles fill the voids between them, largest hole first
};

template <>
inline constexpr auto enum_names<Construction> = enum_name_list<Construction>({{Construction::mixed, "mixed"},
                                                                               {Construction::voids, "voids"}});

/// Who runs a test.
enum class MacroEngine { softgrain, lammps };

template <>
inline constexpr auto enum_names<MacroEngine> = enum_name_list<MacroEngine>({{MacroEngine::softgrain, "softgrain"},
                                                                             {MacroEngine::lammps, "lammps"}});

/// How bodies come into touch; protocol_of() says what each does.
enum class Preparation {
  frictionless,  ///< relaxed without friction under a pressure that falls to the one asked for
  fast,          ///< shrunk at a high rate with the friction of the test, then relaxed: loose
  slow,          ///< shrunk at a low rate with the friction of the test, then relaxed
  dense,         ///< fines grow in the voids of a jammed pack of the coarse bodies, then all are freed
  lammps,        ///< we place bodies loosely, and LAMMPS compacts them
  poured,        ///< as fast: loose bulk density
  rodded,        ///< as fast with a tenth of friction at most: between poured and vibrated
  vibrated       ///< as frictionless: the densest that bodies reach without order
};

template <>
inline constexpr auto enum_names<Preparation> = enum_name_list<Preparation>({{Preparation::frictionless,
                                                                              "frictionless"},
                                                                             {Preparation::fast, "fast"},
                                                                             {Preparation::slow, "slow"},
                                                                             {Preparation::dense, "dense"},
                                                                             {Preparation::lammps, "lammps"},
                                                                             {Preparation::poured, "poured"},
                                                                             {Preparation::rodded, "rodded"},
                                                                             {Preparation::vibrated, "vibrated"},
                                                                             {Preparation::frictionless, "softgrain"}});

/// All that defines a preparation beside the bodies and the pressure at its end.
struct PreparationProtocol {
  double start_fraction = 0.30;      ///< share of the box that bodies fill at random places; lower where they find none
  double inertial_number = 0.0;      ///< strain rate of the sides times d sqrt(density/pressure); 0: no motion
  double friction = 0.0;             ///< mu of all contacts
  double restitution = 0.3;          ///< coefficient of restitution during the motion
  double coarse_share = 1.0;         ///< volume share of the largest bodies, which jam first; fines grow between them
  double first_pressure = 128.0;     ///< first pressure of the relaxation over its last one, to which it falls
  double tolerance = 3e-2;           ///< largest net force over mean contact force at the end; a third for stress
  std::int64_t max_passes = 200000;  ///< largest number of passes of a relaxation
};

/// What net forces are compared with, in preparations and tests.
enum class Balance {
  mean_force,  ///< the mean contact force
  own_load     ///< or what a grain bears under the mean stress, where that is more; see ForceScale
};

template <>
inline constexpr auto enum_names<Balance> = enum_name_list<Balance>({{Balance::mean_force, "mean-force"},
                                                                     {Balance::own_load, "own-load"}});

/// What an axis does in a stage.
struct AxisDrive {
  bool by_stress = false;
  double value = 0.0;  ///< nominal strain from the start of the stage (shear: logarithmic), or stress at its end [Pa]
  std::int64_t as_at{-1};  ///< stress as it was when this stage began, in place of the value; -1: none

  /// Whether it goes to a stress that is given.
  [[nodiscard]] bool to_stress() const { return by_stress && as_at < 0; }
};

/// A part of a test: equal increments of strain, or of stress, from what it is when the stage begins.
struct MacroStage {
  StageRecord record;
  std::array<AxisDrive, 3> axis{};
  double shear = 0.0;        ///< shear strain at the end: x displaced over the height z (slides())
  bool logarithmic = false;  ///< whether strains are logarithmic
  bool isotropic = false;    ///< whether all axes strain alike; by stress: by the mean of their stresses
  std::int64_t steps = 30;   ///< recorded points
  std::int64_t increments_per_step = 2;
  double tolerance = 1e-2;  ///< largest net force over mean contact force; a third for stress, of the largest asked

  [[nodiscard]] bool by_stress() const { return axis[0].by_stress || axis[1].by_stress || axis[2].by_stress; }
  /// Whether all axes go to stresses that are given, as in isotropic stages: their mean is what the stage goes to.
  [[nodiscard]] bool goes_to_mean() const { return axis[0].to_stress() && axis[1].to_stress() && axis[2].to_stress(); }
  /// The given stress to which a stage goes: mean stress, or else that along z; none where z does not go to one.
  [[nodiscard]] std::optional<double> target_stress() const {
    if (!axis[2].to_stress()) return std::nullopt;
    return goes_to_mean() ? (axis[0].value + axis[1].value + axis[2].value) / 3.0 : axis[2].value;
  }
};

/// Fines that are not bodies: they fill the radical cells of the bodies and resist by the law of a card, in place of
/// all contacts. Soft particles then are cells of fines alone.
struct CellMatter {
  CellCard card;
  double share = 0.0;           ///< share of the fines in the solid volume of bodies and fines together
  double solid_fraction = 0.0;  ///< solid fraction at the start; 0: at the start pressure by the mixture of the card
  bool at_density = false;      ///< pressure at the start follows from the density; else excess pores from the pressure
  std::string preparation{};    ///< preparation of the material, see void_ratio_factor(); empty: that of the card
};

/// How a resolved twin comes to rest after an increment of strain.
enum class TwinRelaxation {
  slow_dynamics,  ///< strained in motion, and left to move, with its grains' inertia: as laws are measured
  damped          ///< strained in one stroke and relaxed without inertia: cheaper, and stiff near the threshold
};

template <>
inline constexpr auto enum_names<TwinRelaxation> = enum_name_list<TwinRelaxation>(
    {{TwinRelaxation::slow_dynamics, "slow-dynamics"}, {TwinRelaxation::damped, "damped"}});

/// The motion of twins. Lengths and times in those of the soft particles, as in their measurement.
struct TwinMotion {
  TwinRelaxation relaxation = TwinRelaxation::slow_dynamics;
  double speed = 1.4142e-4;    ///< speed of neighbours of the largest radius towards each other, over sqrt(E/rho)
  double step_factor = 4.0;    ///< time step over that of the published protocol
  double settle_time = 240.0;  ///< time to settle after each increment, over R sqrt(rho/E), R = soft_radius_max: the
                               ///< limit of the scene, whatever the largest soft particle that was drawn
  double restitution = 0.5;    ///< coefficient of restitution of the grains
};

/// Solid grains and soft particles of any sizes in a box of six planes or a periodic cell, compressed [SP 1.9]. SI
/// units.
struct MacroSpec {
  Boundary boundary = Boundary::walls;
  Construction construction = Construction::mixed;
  std::int64_t bodies = 200;  ///< mixed: solid grains + soft particles; voids: solid grains
  Preparation preparation = Preparation::frictionless;
  PreparationProtocol protocol;  ///< details of the preparation, see protocol_of()
  Balance balance = Balance::mean_force;
  double soft_share = 0.45;            ///< share of soft particles, by their shell, in the volume of all bodies
  double exponent = 3.5;               ///< power-law exponent b of the radii of both kinds
  double solid_radius_max = 0.016;     ///< largest radius of the solid grains [m]
  double solid_polydispersity = 2.0;   ///< rmax/rmin of the solid grains
  double soft_radius_max = 0.016;      ///< largest radius of the soft particles [m]
  double soft_polydispersity = 1.5;    ///< rmax/rmin of the shells; voids: smaller holes stay empty
  std::optional<Grading> solid_sizes;  ///< radii of another law, whose ends stand in the two numbers above
  std::optional<Grading> soft_sizes;
  std::optional<CellMatter> cells;  ///< fines in cells between the bodies, in place of contacts
  std::string packing_text;  ///< text of a file that says where all bodies are; empty: they are drawn and prepared
  double solid_fill = 0.0;   ///< voids: share of the box that solid grains fill before soft ones come; 0: by soft_share
  double youngs_modulus = 5.0e5;  ///< E of solid grains, walls and of what is inside the soft particles [Pa]
  double poisson_ratio = 0.3;
  double friction = 0.3;  ///< mu of solid contacts; stands in for mu_soft
  double wall_friction = 0.0;
  RollingResistance rolling{};  ///< of solid contacts with friction, in a preparation with friction too
  double density = 2500.0;
  double start_pressure = 1.0e-5;  ///< pressure at the end of the preparation, over E
  MacroTest test = MacroTest::oedometric;
  std::vector<double> splits;  ///< radii that split grains into coarse and fine, over the largest radius: shares of the
                               ///< load are recorded
  std::vector<MacroStage> stages;  ///< stages of the test "stages"; the numbers below are those of the other tests
  std::array<double, 2> modulus_stress{};  ///< stresses between which the modulus of a stage is taken that does not
                                           ///< name its own, see StageRecord [Pa]
  double strain_end = 0.15;                ///< nominal strain at the end; shear, undrained: logarithmic
  double preload = 0.0;                    ///< is_shear(): isotropic nominal strain before the shear
  std::int64_t preload_steps = 4;          ///< number of recorded points of the preload
  std::int64_t steps = 30;                 ///< recorded points
  std::int64_t increments_per_step = 2;    ///< relaxed strain increments per recorded point
  double tolerance = 1e-2;                 ///< largest net force over mean contact force at recorded points
  double force_floor = 1.0e-4;  ///< the mean contact force never counts for less than this, over E R^2 (R the largest
                                ///< radius): else loose states before the first stress would be relaxed for ever
  std::int64_t max_passes = 20000;  ///< largest number of passes per relaxation
  TwinMotion twin;
  bool kt_secant = true;  ///< tangential law: the secant of the card, as published, instead of the initial slope
  /// Materials of solid grains that differ, by MacroBody::material; empty: all have E, nu, mu and density
  /// above. With it these stand for all: 1/E, nu and density are means over the solid volume (E is the unit of
  /// stresses), mu is that of the roughest. Walls have them too.
  GrainMaterials grain_materials{};
};

}  // namespace softgrain
