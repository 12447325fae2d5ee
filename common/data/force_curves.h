// Force-displacement measurements of an experiment, read from text: what a fit needs instead of simulated packings.
// And whether measured forces can be those of a soft particle: wrong units and signs show.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/data/measurements.h"

namespace softgrain {

class CsvFile;

/// One state of increasing normal overlap.
struct ForcePoint {
  double delta = 0.0;                                       ///< Delta = hn/Rs
  double force = 0.0;                                       ///< Fn [N], compression positive
  double error = std::numeric_limits<double>::quiet_NaN();  ///< standard error of the force [N]; NaN: not given
};

/// One unloading from the largest overlap so far, and the way back to it.
struct UnloadedCurve {
  double deepest = 0.0;            ///< Delta where it begins
  double force = 0.0;              ///< Fn there [N]
  std::vector<ForcePoint> points;  ///< in the order of the file; Delta at most `deepest`
};

/// One specimen (or one test of it).
struct ForceCurve {
  std::string name;
  std::vector<ForcePoint> normal;           ///< Delta rising
  std::vector<TangentialPoint> tangential;  ///< angle_deg = 180 ht / (pi Rs); all count as converged
  std::vector<double> before_touch{};       ///< forces read at negative overlaps [N], which no law is fitted to
  std::vector<UnloadedCurve> unloaded{};    ///< with Unloading::fit
};

/// All tests of one pair kind.
struct ForceCurves {
  PairKind kind = PairKind::soft_solid;
  SoftParticleSpec spec;  ///< Rs and E make the law dimensionless; nu, mu, density as given, all else is not known
  std::vector<ForceCurve> samples;
  bool has_errors = false;
  std::vector<std::string> remarks;  ///< columns that were not used, points that were left out
};

/// What to do with points behind the largest overlap so far.
enum class Unloading {
  refuse,
  drop,
  fit  ///< they are the unloading branch; single readings that fell back are left out, with a remark
};

template <>
inline constexpr auto enum_names<Unloading> =
    enum_name_list<Unloading>({{Unloading::refuse, "refuse"}, {Unloading::drop, "drop"}, {Unloading::fit, "fit"}});

/// What is said beside the file, for what the file does not say; both must not contradict each other.
struct ForceCurveOptions {
  std::optional<PairKind> kind;
  std::optional<double> shell_radius;    ///< Rs [m]
  std::optional<double> youngs_modulus;  ///< E [Pa]
  const char* kind_from = "--kind";      ///< who says each, for messages
  const char* radius_from = "--radius";
  const char* modulus_from = "--modulus";
  bool by_options = true;  ///< whether messages name the options --kind, --radius and --modulus
  Unloading unloading = Unloading::refuse;
  double initial_angle_deg = 0.05;         ///< a column kt is taken as the slope over +- this angle
  double secant_angle_deg = kSecantAngle;  ///< Ft is interpolated at this angle
};

/// Rows of ht and Ft belong to the reading of Fn before them where their overlaps agree to 1e-3, else to each other.
/// Readings within 1e-3 of secant_angle_deg count as at 0 or +-secant_angle_deg.
/// Reads one CSV file. Columns (any order, name [unit]): hn or overlap (with a unit of length) or Delta; Fn or force;
/// optional sample, a standard error of Fn (se, error), and for the tangential law ht with Ft (Ft at ht = 0 is the
/// prestrain), or kt; `branch` (loading, unloading, reloading), which else is told by the overlap. Repeats in columns:
/// numbered Fn 1, Fn 2, ... with a common overlap or hn 1, hn 2, ..., each a sample, in the order of their numbers,
/// whose cells may be empty. Other columns are named in a remark. Comments may say "# kind = soft-solid", "# Rs = 16
/// mm",
/// "# E [MPa] = 0.5", "# nu = ...", "# mu = ...", "# density [kg/m^3] = ...", "# sample = ..."; and of the machine "#
/// touch = 0.31 mm" (displacement at first touch),
/// "# force offset = 12 mN" (force read without contact) and "# machine stiffness = 80 N/mm" (in series with the
/// specimen): hn = read displacement - touch - (Fn - force offset)/stiffness; other comments that
/// name a value are refused. Throws InputError with file and line: unknown unit, missing value, number that is not
/// finite, overlap that falls, too few points (5), kind, Rs or E not given or said twice in different ways.
ForceCurves read_force_curves(const std::string& path, const ForceCurveOptions& options);

/// Whether the comments of a table say what ForceCurveOptions may say beside it.
struct SaidByFile {
  bool kind = false, shell_radius = false, youngs_modulus = false;
};
SaidByFile said_by_comments(const CsvFile& table);

/// See below; of all samples together.
std::vector<std::string> implausible_forces(const ForceCurves& curves);

/// Files of one experiment, joined by pair kind (soft-solid first). A sample is named by its file when there are
/// several. Throws InputError when files disagree about Rs, E, nu, mu or density.
std::vector<ForceCurves> read_force_curve_files(const std::vector<std::string>& paths,
                                                const ForceCurveOptions& options);

/// What is not as it should be of forces Fn [N] at overlaps Delta = hn/Rs of a soft particle of radius Rs [m] and
/// grains of Young's modulus E [Pa]; empty: nothing. One sentence each:
/// - tension: most of the force is negative, while compression counts positive;
/// - too stiff: the largest force is above that of a solid sphere of the same radius and modulus on a rigid plane,
///   4/3 E Rs^2 Delta^1.5 (Hertz, nu = 0);
/// - too soft: at Delta above 0.1 it is less than 2e-4 of it; published soft particles have 0.01 to 0.1.
/// Both hint at the unit of force, E or Rs.
std::vector<std::string> implausible_forces(const std::vector<double>& delta, const std::vector<double>& force,
                                            double shell_radius, double youngs_modulus);

}  // namespace softgrain
