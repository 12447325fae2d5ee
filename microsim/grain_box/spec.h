// A pack of grains between six planes: what it is made of, how it is generated, how it is loaded [QS 2.3].
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/core/vec.h"
#include "common/packing/grading.h"
#include "common/statics/least_work.h"

namespace softgrain {

/// Grains: radii uniform or of `sizes`, E and nu normal, cut at three deviations and to what elasticity allows.
struct GrainBoxMaterial {
  double radius_min = 0.07e-3;          ///< [m]
  double radius_max = 0.13e-3;          ///< [m]
  std::optional<Grading> sizes;         ///< radii of another law, whose ends stand in the two numbers above
  double youngs_modulus = 70e9;         ///< mean E [Pa]
  double youngs_modulus_scatter = 0.1;  ///< standard deviation over mean
  double poisson_ratio = 0.2;
  double poisson_ratio_scatter = 0.1;  ///< standard deviation over mean
  double density = 2420.0;             ///< [kg/m^3]; for the relaxation of the loose arrangement; statics need none
};

struct GrainBoxWalls {
  double youngs_modulus = 7e12;  ///< [Pa]
  double poisson_ratio = 0.495;
  double friction = 0.3;
};

/// Friction of a pack whose mu is infinite. Without any limit a contact that opens drops a force it still carries, and
/// then there need be no equilibrium at all; with this one |Q| goes to 0 with P. K is within 1 % of that with twice the
/// value, G within 2 %.
inline constexpr double kStickingFriction = 5.0;

/// An increment needs about 100 iterations; one that needs this many is halved instead.
inline constexpr std::int64_t kPatience = 3000;

/// Phases (a) and (b) of the generation [QS 2.3].
struct GrainBoxGeneration {
  double pressure = 4e6;  ///< sigma_c(mu = 0) at the end of (a) [Pa]
  /// Ascending, below `pressure` [Pa]: where (a) stops on the way. Packs of one arrangement that differ in `pressure`
  /// are the same pack pressed on without friction, as in the publication, when the lower ones of them stand here.
  std::vector<double> lower_pressures;
  double pressure_tolerance = 1e-3;  ///< relative tolerance of the pressure
  double growth = 0.01;              ///< relative growth of the radius per pass, of grains with fewer than 4 contacts
  std::int64_t growth_passes = 200;
  double increment = 1e-4;            ///< strain increment of (b)
  std::int64_t window = 10;           ///< increments over which the end of (b) averages G and the sliding share
  double saturation = 0.01;           ///< largest change of the mean sliding share between two windows
  std::int64_t max_increments = 400;  ///< largest number of increments of (b)
  int axis = 2;                       ///< axis of the uniaxial compression
  bool isotropic = false;             ///< (b): compressed alike from all sides instead; ends when sliding has saturated

  /// All stops of (a), `pressure` the last.
  [[nodiscard]] std::vector<double> pressures() const {
    std::vector<double> all = lower_pressures;
    all.push_back(pressure);
    return all;
  }
};

enum class AxisControl { strain, stress };

/// One loading programme. Strain rates are relative: the largest magnitude among the strained axes is one increment.
struct GrainBoxLoading {
  std::string test = "uniaxial";
  std::array<AxisControl, 3> control{};
  Vec3 strain_rate{{0.0, 0.0, 1.0}};  ///< strain rates of axes held by strain; compression positive
  Vec3 stress{};                      ///< stresses of axes held by stress [Pa]
  std::vector<double> increments{1e-4};
  std::vector<double> stage_strains;                            ///< strain covered by every stage but the last
  double end_stress = std::numeric_limits<double>::infinity();  ///< sigma_c at which the loading ends [Pa]
  double end_strain = std::numeric_limits<double>::infinity();  ///< largest axis strain since the start of loading
  std::int64_t probe_every = 20;                                ///< increments between elastic probes; 0: never
  double stress_tolerance = 1e-4;                               ///< relative tolerance of the servo
  int max_halvings = 5;  ///< largest number of halvings of an increment that does not converge
};

/// Ranges of sigma_c in which growth exponents are fitted [Pa].
struct GrainBoxFit {
  std::array<double, 2> low{4e6, 20e6};
  std::array<double, 2> high{40e6, 130e6};
};

/// Everything about one pack and its run.
struct GrainBoxSpec {
  std::string name = "pack";      ///< name of the variant
  std::string of = "pack";        ///< the name without the number of the arrangement
  std::uint64_t arrangement = 0;  ///< number of the arrangement: random numbers are keyed by seed and this
  std::int64_t grains = 2740;
  Vec3 aspect{{1.0, 1.0, 1.0}};  ///< box lengths, relative
  double solid_fraction = 0.3;   ///< solid fraction of the loose arrangement
  double friction = 0.3;         ///< friction coefficient between grains; infinity: kStickingFriction
  GrainBoxMaterial material;
  GrainBoxWalls walls;
  GrainBoxGeneration generation;
  GrainBoxLoading loading;
  GrainBoxFit fit;
  LeastWorkOptions solver{.max_iterations = kPatience};
};

}  // namespace softgrain
