// Stress-strain records of macro runs and of their resolved twins.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/core/law_range.h"
#include "common/core/material.h"
#include "common/data/columns.h"
#include "common/io/hdf5_file.h"
#include "common/io/provenance.h"

namespace softgrain {

/// The law that a curve was made with: two runs with the same hash had the same forces.
struct LawIdentity {
  std::optional<LawForm> form{};          ///< empty: with a hash the law of cells, else a twin, or not recorded
  double solid_fraction = 0.0;            ///< solid fraction at which a table was taken; 0: a law card
  double youngs_modulus = 0.0;            ///< [Pa]
  std::optional<double> poisson_ratio{};  ///< nu of the measured grains; empty: not known (experiments)
  std::optional<double> friction{};       ///< mu of the measured grains
  std::string hash;

  friend bool operator==(const LawIdentity&, const LawIdentity&) = default;
};

/// "directional law at solid fraction 0.7048, for grains of nu = 0.3, mu = 0.3, used with E = 5e+05 Pa; hash
/// 0123456789abcdef".
std::string identity_text(const LawIdentity& law);

/// Numbers of a law with their names as attributes of curves and in summaries. `fraction`: as solid_fraction.
void law_fields(auto&& visit, Of<LawIdentity> auto& law, auto& fraction) {
  visit("law_hash", "hash", law.hash, Means{"hash of every number that forces depend on"});
  visit("law_solid_fraction", "solid_fraction", fraction, Limits::not_negative(),
        Means{"solid fraction at which a table was taken; null: a law card", "1"});
  visit("law_youngs_modulus", "E", law.youngs_modulus, Limits::not_negative(),
        Means{"Young's modulus that scales the forces of the law", "Pa"});
  visit("law_poisson_ratio", "nu", law.poisson_ratio, Limits{},
        Means{"Poisson's ratio of the measured grains; null: not known", "1"});
  visit("law_friction", "mu", law.friction, Limits{}, Means{"friction of the measured grains; null: not known", "1"});
}

/// Material that a law is for, in the words of check, summaries and reports; empty for a twin.
inline constexpr const char* kMatterInShells =
    "laws of soft particles are for material with shells: fines that spread into the voids bear far less";
inline constexpr const char* kMatterWithoutShells = "for material without shells: fines fill all voids";
inline std::string picture_of(const LawIdentity& law) {
  if (law.form) return kMatterInShells;
  return law.hash.empty() ? "" : kMatterWithoutShells;
}

/// Resolved twins of a law, which are engines of curves too.
enum class Twin {
  shelled,  ///< contents in moving shells
  free      ///< grains of the shelled twin without shells
};

template <>
inline constexpr auto enum_names<Twin> = enum_name_list<Twin>({{Twin::shelled, "shelled"}, {Twin::free, "free"}});

enum class MacroTest {
  isotropic,
  oedometric,
  shear,         ///< z shortens, x lengthens, y stands, at constant volume
  stages,        ///< what its stages say
  undrained,     ///< z shortens, x and y lengthen alike, at constant volume
  simple_shear,  ///< planes of constant z slide along x, all lengths stand
  direct_shear   ///< as simple_shear, at constant stress along z
};

template <>
inline constexpr auto enum_names<MacroTest> = enum_name_list<MacroTest>({{MacroTest::oedometric, "oedometric"},
                                                                         {MacroTest::isotropic, "isotropic"},
                                                                         {MacroTest::shear, "shear"},
                                                                         {MacroTest::undrained, "undrained"},
                                                                         {MacroTest::simple_shear, "simple-shear"},
                                                                         {MacroTest::direct_shear, "direct-shear"},
                                                                         {MacroTest::stages, "stages"}});

/// Tests that change the shape after an isotropic strain, their preload.
inline bool is_shear(MacroTest test) {
  return test == MacroTest::shear || test == MacroTest::undrained || test == MacroTest::simple_shear ||
         test == MacroTest::direct_shear;
}

/// Tests whose strain is a shear strain: planes slide over each other.
inline bool slides(MacroTest test) { return test == MacroTest::simple_shear || test == MacroTest::direct_shear; }

/// Tests whose runs are compared stage by stage: not the strain of z drives them, or it goes forth and back.
inline bool by_stages(MacroTest test) { return test == MacroTest::stages || slides(test); }

/// Label of MacroCurve::strain in percent.
inline const char* strain_label(MacroTest test) { return slides(test) ? "shear strain [%]" : "axial strain [%]"; }

/// What the axes of a box or cell do in a part of a test; the load is along z.
enum class StageKind {
  oedometric,     ///< z is driven, x and y stand
  isotropic,      ///< all strain alike
  shear,          ///< z shortens, x lengthens by equal logarithmic strains, y stands: constant volume
  triaxial,       ///< z is driven, x and y are held by stress
  consolidation,  ///< every axis goes to its stress
  axes,           ///< every axis to a strain or a stress of its own
  unload,         ///< reverses the path of the last stage that was none of unload, reload and hold
  reload,         ///< repeats the path that an unloading reversed
  hold,           ///< nothing is driven
  undrained,      ///< z shortens, x and y lengthen by half of its logarithmic strain each: constant volume
  simple_shear,   ///< x displaced in proportion to z, all lengths stand: constant volume
  direct_shear    ///< x displaced in proportion to z, x and y stand, z is held by stress
};

template <>
inline constexpr auto enum_names<StageKind> = enum_name_list<StageKind>({{StageKind::oedometric, "oedometric"},
                                                                         {StageKind::isotropic, "isotropic"},
                                                                         {StageKind::shear, "shear"},
                                                                         {StageKind::undrained, "undrained"},
                                                                         {StageKind::simple_shear, "simple-shear"},
                                                                         {StageKind::direct_shear, "direct-shear"},
                                                                         {StageKind::triaxial, "triaxial"},
                                                                         {StageKind::consolidation, "consolidation"},
                                                                         {StageKind::axes, "axes"},
                                                                         {StageKind::unload, "unload"},
                                                                         {StageKind::reload, "reload"},
                                                                         {StageKind::hold, "hold"}});

/// Ways that hold the volume.
inline bool keeps_volume(StageKind way) {
  return way == StageKind::shear || way == StageKind::undrained || way == StageKind::simple_shear;
}

/// Ways that displace x in proportion to z.
inline bool slides(StageKind way) { return way == StageKind::simple_shear || way == StageKind::direct_shear; }

/// What is around the bodies.
enum class Boundary {
  walls,    ///< six planes
  periodic  ///< none: the cell repeats along all axes
};

template <>
inline constexpr auto enum_names<Boundary> = enum_name_list<Boundary>({{Boundary::walls, "walls"},
                                                                       {Boundary::periodic, "periodic"}});

/// A part of a test as a curve knows it.
struct StageRecord {
  std::string name;
  StageKind kind = StageKind::oedometric;
  StageKind way = StageKind::oedometric;  ///< stage that unload, reload or hold reverse, repeat or stay on
  /// Stresses [Pa], ascending, between which its modulus is taken; zeros: as stage_results.h says for its kind.
  std::array<double, 2> modulus_stress{};
  /// Axes that go by stress, x, y, z; empty: not recorded, as in files of earlier versions.
  std::optional<std::array<bool, 3>> by_stress{};

  /// Compares what the stages do. How the curve is evaluated does not count, nor does anything that one of them does
  /// not say.
  friend bool operator==(const StageRecord& a, const StageRecord& b) {
    return a.name == b.name && a.kind == b.kind && a.way == b.way &&
           (!a.by_stress || !b.by_stress || *a.by_stress == *b.by_stress);
  }
};

/// What a curve starts from; runs that are set side by side should agree in it. Zeros: not known.
struct MacroStart {
  double radius_min = 0.0;      ///< smallest radius of the bodies [m]
  double radius_max = 0.0;      ///< largest radius of the bodies [m]
  double youngs_modulus = 0.0;  ///< E of solid grains and of the content of soft particles [Pa]
  double poisson_ratio = 0.0;
  double friction = 0.0;
  double wall_friction = 0.0;
  double size_x = 0.0;  ///< length of the box along x [m]
  double size_y = 0.0;
  double size_z = 0.0;
  std::string bodies;  ///< hash of the box and of places, radii and kinds of all bodies
  RollingResistance rolling{};

  friend bool operator==(const MacroStart&, const MacroStart&) = default;
};

/// visit(name, member, ComparedAs{what}): two curves that differ in it cannot be compared; what it is called then.
struct ComparedAs {
  const char* what;
};

void fields(auto&& visit, Of<MacroStart> auto& s) {
  const Limits not_negative = Limits::not_negative();
  visit("start", s.bodies);
  visit("radius_min", s.radius_min, not_negative);
  visit("radius_max", s.radius_max, not_negative);
  visit("youngs_modulus", s.youngs_modulus, not_negative, ComparedAs{"E of the grains [Pa]"});
  visit("friction", s.friction, not_negative, ComparedAs{"mu of the grains"});
  visit("wall_friction", s.wall_friction, not_negative, ComparedAs{"mu of the walls"});
  visit("poisson_ratio", s.poisson_ratio, Limits{kPoissonLowest, kPoissonHighest}, ComparedAs{"nu of the grains"});
  visit("size_x", s.size_x, not_negative, kLater);
  visit("size_y", s.size_y, not_negative, kLater);
  visit("size_z", s.size_z, not_negative, kLater);
}

/// Rolling resistance of the grains, where they have one.
void rolling_fields(auto&& visit, Of<RollingResistance> auto& rolling) {
  visit("rolling_friction", rolling.friction, Limits::not_negative(), ComparedAs{"mu_r of the grains"});
  if (rolling.friction > 0.0)
    visit("rolling_stiffness_ratio", rolling.stiffness, Limits::not_negative(), ComparedAs{"kr_ratio of the grains"});
}

/// Components of a symmetric tensor in the order in which files and reports have them.
inline constexpr std::array<const char*, 6> kTensorComponents{"xx", "yy", "zz", "xy", "xz", "yz"};

/// A symmetric tensor per point, by component.
using TensorColumns = std::array<std::vector<double>, 6>;

/// How the preparation of a sample came to the solid fraction that was asked for: by its friction.
struct DensitySearch {
  double target = 0.0;     ///< solid fraction asked for
  double tolerance = 0.0;  ///< largest difference from it
  double friction = 0.0;   ///< friction between particles with which it was met
  std::int64_t tries = 0;  ///< preparations that the search took

  friend bool operator==(const DensitySearch&, const DensitySearch&) = default;
};

/// As attributes of a group; nothing where there was no search.
void write_density_search(const h5::Group& group, const std::optional<DensitySearch>& search);
/// Throws IoError.
std::optional<DensitySearch> read_density_search(const h5::Group& group);

/// One macro run of one sample. Stresses are compressive positive [Pa], on walls or, in a periodic cell, from the sum
/// over contacts; strain is nominal, from the start of the test, of tests in stages that of z.
struct MacroCurve {
  /// "law" (soft particles with the pair law of a card), "pair" (the same), or another law's name; or that of a twin
  std::string engine;
  MacroTest test = MacroTest::oedometric;
  Boundary boundary = Boundary::walls;
  std::int64_t sample = 0;
  std::int64_t bodies = 0;  ///< solid grains + soft particles
  std::int64_t soft = 0;
  std::int64_t grains = 0;  ///< grains resolved inside soft particles (0 for laws)
  double soft_volume_share = 0.0;
  double solid_fraction = 0.0;  ///< solid fraction of the bodies in the box at the start
  MacroStart start;
  LawIdentity law;
  double preload = 0.0;             ///< shear: isotropic strain before; recorded at strains from -preload to 0
  std::vector<StageRecord> stages;  ///< stages of the test; empty: not recorded
  std::vector<double> strain;
  std::vector<double> stress_axial;
  std::vector<double> stress_lateral;         ///< mean of both directions
  std::vector<double> stress_axial_contacts;  ///< axial stress from the contact sum, a check on the walls
  std::vector<double> coordination;           ///< contacts per body (engine "law": force-carrying)
  std::vector<double> residual;               ///< largest net force over mean contact force
  // The rest may be empty: not recorded.
  std::vector<double> residual_largest;  ///< largest residual of all increments since the previous point
  std::vector<double> stress_x;
  std::vector<double> stress_y;
  std::vector<double> stress_deviator;      ///< axial (z) minus x
  std::vector<double> fabric;               ///< zz - xx of the fabric tensor of contacts between grains
  std::vector<double> fabric_bodies;        ///< zz - xx of the fabric between bodies, a soft particle being one
  std::vector<double> coordination_bodies;  ///< bodies and walls that a body touches, mean
  std::vector<double> body_forces;          ///< normal forces between bodies, walls included, at the end [N]
  std::vector<double>
      law_evaluations;              ///< soft contacts (pair laws) and soft particles (multi-contact laws) in contact
  std::vector<double> law_beyond;   ///< number of law_evaluations beyond the range that their law was measured in
  std::vector<double> law_largest;  ///< largest Delta or lost volume over the end of that range
  std::vector<double> stage;        ///< stage that ends at the point or leads to it, counted from 0; 0 at the start
  std::vector<double> strain_x;     ///< 1 - L/L0, L0 the length at the start
  std::vector<double> strain_y;
  std::vector<double> strain_z;
  /// Displacements against x (strains are positive in compression) over the height at which they happened, summed up;
  /// empty where no stage slides.
  std::vector<double> shear_strain;
  /// Shear stresses from the contacts, symmetric part; with stress_x, stress_y and stress_axial the whole tensor [Pa].
  std::vector<double> stress_xy;
  std::vector<double> stress_xz;
  std::vector<double> stress_yz;
  std::vector<double> stress_asymmetry;  ///< norm of the antisymmetric part of the contact stress over that of all
  TensorColumns fabric_tensor;           ///< mean of n n over contacts between bodies; trace 1, without contacts 0
  TensorColumns fabric_strong;           ///< the same of those with more than the mean normal force
  std::vector<double> inertial_number;   ///< of the strain that led to the point; empty: quasi-static, no rate
  std::map<std::string, std::vector<double>> more;  ///< per point, by name: what one kind of scene alone records
  std::vector<std::vector<double>> drawn_axial;  ///< per draw of the law, then per point: stress_axial with that draw
  /// Places in shelled twins, per point: low and high corner of the box, then x, y, z of every body in turn [m].
  std::vector<std::vector<double>> places;
  bool usable = true;
  std::string note;
  std::string warning;  ///< what may make it wrong for its purpose; empty: nothing
  Cost cost;
  Cost preparation;  ///< cost of the state that the curve starts from, which other engines may share
  std::optional<DensitySearch> density{};  ///< how that state came to a density that was asked for

  [[nodiscard]] std::optional<Twin> twin() const { return parse_enum<Twin>(engine); }  ///< empty: made by a law
};

/// A quantity of a curve, one value per point, as files have it.
struct MacroColumn {
  const char* name;
  const char* unit;
  std::vector<double> MacroCurve::*values;
  Limits limits{};

  /// "stress_xy [Pa]"; the name alone of a plain number.
  [[nodiscard]] std::string header() const;
};

/// That of a member of MacroCurve. Throws std::out_of_range for one that files do not have as a column.
const MacroColumn& macro_column(std::vector<double> MacroCurve::*values);

/// A tensor of a curve: its name, which "_xx", "_yy" and so on follow.
struct MacroTensor {
  const char* name;
  TensorColumns MacroCurve::*values;

  [[nodiscard]] std::string of(std::size_t component) const;
};

inline constexpr std::array<MacroTensor, 2> kMacroTensors{
    {{"fabric_tensor", &MacroCurve::fabric_tensor}, {"fabric_strong", &MacroCurve::fabric_strong}}};

/// Numbers of a row of `places`.
constexpr std::size_t place_numbers(std::int64_t bodies) { return 6 + 3 * static_cast<std::size_t>(bodies); }

/// Columns of `more`: the stresses of the same test run a second time, with strains that differ in the twelfth digit.
inline constexpr const char* kAgainAxial = "again_stress_axial";
inline constexpr const char* kAgainLateral = "again_stress_lateral";

/// One curve as a group of a file, for checkpoints.
void write_macro_curve(const h5::Group& group, const MacroCurve& curve);
/// Throws IoError.
MacroCurve read_macro_curve(const h5::Group& group);

/// Writes all curves to an HDF5 file, atomically.
void save_macro(const std::vector<MacroCurve>& curves, const std::string& path,
                const Provenance& provenance = build_provenance());
std::vector<MacroCurve> load_macro(const std::string& path);

}  // namespace softgrain
