// A library of law tables: the isotropic law of many materials, measured, and that of a material in between.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/data/multi_contact_law.h"
#include "common/io/provenance.h"
#include "pipelines/law/fitted_law.h"

namespace softgrain {

/// What the law of a soft particle depends on, besides E/(1 - nu^2), which scales it.
struct LibraryPoint {
  double friction = 0.0;        ///< mu of the grains
  double exponent = 0.0;        ///< b of the size distribution P(r) ~ r^-b
  double polydispersity = 0.0;  ///< rmax/rmin
  double solid_fraction = 0.0;  ///< volume of grains over that of the shell
};

/// With what the laws change evenly: the variable, its logarithm, or mu/(mu + kHalfFriction), as friction matters most
/// where there is little.
enum class LibraryAxis { linear, logarithm, friction };
inline constexpr double kHalfFriction = 0.15;  ///< friction at which half of its effect is reached

/// Where friction lies on its axis.
constexpr double on_friction_axis(double mu) { return mu / (mu + kHalfFriction); }

struct LibraryVariable {
  const char* name;
  double LibraryPoint::*value;
  LibraryAxis axis = LibraryAxis::linear;
};
inline constexpr std::array<LibraryVariable, 4> kLibraryVariables{
    {{"mu", &LibraryPoint::friction, LibraryAxis::friction},
     {"exponent", &LibraryPoint::exponent},
     {"ratio", &LibraryPoint::polydispersity, LibraryAxis::logarithm},
     {"solid fraction", &LibraryPoint::solid_fraction}}};

/// What a press on one plane tells, the shell held: F/(E* Rs^2) with E* = E/(1 - nu^2). Forces, as a, b and delta of a
/// fitted curve are nearly degenerate.
struct PressNumbers {
  double ln_deep = 0.0;     ///< ln F/(E* Rs^2) at D = 0.3
  double ln_shallow = 0.0;  ///< at D = 0.2
};

/// One measured material. `numbers` as LawLibrary::names says; NaN: not measured.
struct LibraryMaterial {
  std::string source;  ///< table that it comes from
  LibraryPoint at;
  int packings = 0;
  std::vector<double> numbers;
  std::vector<double> errors;        ///< standard errors of the numbers
  std::vector<double> correlations;  ///< of the numbers of the law, that is the first ones, row-major
  double volume_max = 0.0;           ///< as LawTableEntry says
  double overlap_max = 0.0;
  double grain_overlap_max = 0.0;
  std::vector<double> partner_overlap_max;  ///< per row of neighbours, see PartnerRow
  std::optional<PressNumbers> press{};      ///< empty: not known, as in files of earlier versions
};

/// Kind and size of a row of neighbours of all laws of a library.
struct LibraryPartner {
  PartnerKind kind = PartnerKind::solid;
  double ratio = 1.0;
  bool operator==(const LibraryPartner&) const = default;
};

/// How well the other materials predict one number, each material left out in turn: by a Gaussian process that is
/// fitted to the others alone, and by their mean.
struct LibraryCheck {
  std::string name;
  std::size_t materials = 0;   ///< that have the number; 0: too few
  double error = 0.0;          ///< root mean square of process less measured
  double error_of_mean = 0.0;  ///< of mean less measured
  /// By how much deviations of answers are widened, at least 1: of the materials left out, the mean square of
  /// (predicted less measured) over (widened deviation, measured error) is then 1, at most (scale factor of Birge 1932,
  /// doi:10.1103/PhysRev.40.207).
  double factor = 1.0;
  double coverage = 0.0;  ///< share of materials within 1.96 widened deviations, the measured error included

  /// Whether answers are the mean and scatter of the materials: the process does not beat them.
  [[nodiscard]] bool by_mean() const { return materials > 0 && error >= error_of_mean; }
};

/// Numbers of a law, so chosen that they change smoothly and are hardly correlated: ln of the force of a plane at D =
/// 0.35, F/(E* Rs^2) with E* = E/(1 - nu^2), b, delta; for each kind of neighbour ln nu at v = 0.02 of every size, and
/// m; then kt/kn, friction limits, rolling, unloading, errors of the form, ln trials.
struct LawLibrary {
  double rmax_over_shell = 0.5;
  double beta = 3.0;
  std::vector<LibraryPartner> partners;
  std::vector<LibraryMaterial> materials;
  std::vector<LibraryCheck> checks{};  ///< of all names(), from check_library(); answers go by them
  /// The same from check_press_tests(), for answers to press tests; empty: a material has no press numbers.
  std::vector<LibraryCheck> press_checks{};
  std::string path{};
  std::string text{};

  /// Names of all numbers; those of the law come first.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] std::size_t law_numbers() const;
};

/// An empty library with the shell of an entry and the neighbours of its isotropic law, which it must have.
LawLibrary library_like(const LawTableEntry& entry);

/// A row of the library from an entry of a table with its refits; empty, and why, when its isotropic law does not
/// serve. Throws InputError for a table of other neighbours or shells.
std::optional<LibraryMaterial> library_row(const LawLibrary& library, const LawTableEntry& entry,
                                           const std::string& source, std::string& why);

/// Writes and reads a library. load_library() checks one whose file has no checks, which takes some seconds. Throw
/// InputError with file and line, IoError.
std::string library_text(const LawLibrary& library, const Provenance& provenance);
LawLibrary read_library(const Scene& file);
LawLibrary load_library(const std::string& path);
/// Whether a file is a library: it has [library].
bool is_library(const Scene& file);

/// The library that comes with the program: results/law_library of the source tree that it was built in, or
/// share/softgrain/results/law_library of the prefix where it is installed. Throws InputError when neither is there.
std::string shipped_library();

/// A number of the law of a material that was not measured, or of one as all others predict it.
struct LibraryNumber {
  std::string name;
  double value = 0.0;
  double deviation = 0.0;  ///< of interpolation and measured errors, widened by LibraryCheck::factor
};

/// What a law was measured on, and how far: of an answer that of the nearest material, and of own packings.
struct LibraryRange {
  int packings = 0;
  double volume_max = 0.0;  ///< this and the others as in LibraryMaterial
  double overlap_max = 0.0;
  double grain_overlap_max = 0.0;
  std::vector<double> partner_overlap_max{};
};

struct LibraryAnswer {
  LibraryPoint at;  ///< NaN where a press test does not tell
  std::vector<LibraryNumber> numbers;
  std::vector<std::string> by_mean;   ///< numbers that are mean and scatter of the materials, LibraryCheck::by_mean()
  std::vector<double> correlations;   ///< of the numbers of the law, row-major: the mean of those of the refits
  std::size_t nearest = 0;            ///< measured material that is nearest
  double distance = 0.0;              ///< to it: root of the sum of squares over the variables, each over its range
  double solid_fraction_error = 0.0;  ///< standard error of at.solid_fraction, which a press test leaves open
  LibraryRange range{};
};

/// By Gaussian processes, one for each number, or mean and scatter, as LawLibrary::checks decide. Throws InputError
/// outside the measured materials, with their ranges, and for a library that is not checked.
LibraryAnswer ask_library(const LawLibrary& library, const LibraryPoint& at);

/// The checks of all numbers: a fit for each number and material, some seconds in all. Throws InputError for fewer than
/// eight materials.
std::vector<LibraryCheck> check_library(const LawLibrary& library);

/// A material that is worth measuring.
struct NextMaterial {
  LibraryPoint at;
  double trials = 0.0;     ///< positions tried per grain that give its solid fraction or a little more; NaN: unknown
  double deviation = 0.0;  ///< of ln force of one plane there, of an answer, before it is measured
  double left = 0.0;       ///< root mean square of these deviations over all materials that are served, afterwards
};

struct NextMaterials {
  double deviation = 0.0;  ///< root mean square over all materials that are served, now
  std::vector<NextMaterial> materials;
};

/// Which materials would narrow the answers most, one after the other: each makes the mean square of the deviation of
/// the force least, over materials spread evenly over all that the library serves (active learning of Cohn, Ghahramani
/// and Jordan 1996, doi:10.1613/jair.295). Deviations of a Gaussian process do not depend on what will be measured,
/// only on where, and on the errors, for which the median of those of the library is taken. None is named whose onset
/// would lie deeper than any that was measured: its law could not be determined. Throws InputError for a
/// library that answers the force by the mean of its materials.
NextMaterials next_materials(const LawLibrary& library, int count);

/// Whether the answer is to a press test, so that the grains inside are not known.
inline bool of_press_test(const LibraryAnswer& answer) { return std::isnan(answer.at.exponent); }

/// What else describes the soft particle of an answer.
struct LibraryMatter {
  double youngs_modulus = 5.0e5;
  double poisson_ratio = 0.3;
  double density = 2500.0;
  double restitution = 0.5;
  double shell_radius = 0.016;
};

/// The answer as a law table of one entry whose refits are `draws` normal draws, for error bars of macro runs.
LawTable table_of(const LawLibrary& library, const LibraryAnswer& answer, const LibraryMatter& matter, int draws = 64);

/// In what a soft particle differs from those of a library in ways that no material of it covers: sizes of another law,
/// another shell; empty: in nothing.
std::string other_shell_text(const LawLibrary& library, const SoftParticleSpec& spec);

/// Why an entry is no measurement of its own; empty: it is one.
std::string not_measured_text(const LawTableEntry& entry);

/// The entry of a measured table whose solid fraction is nearest to that of a material of the library. Throws
/// InputError where the entry was not measured, so that a library would count twice, and, with all differences, where
/// it is of another material or shell, or its solid fraction is more than kReachOfPackings away; `source` names the
/// table.
const LawTableEntry& own_entry(const LawLibrary& library, const LibraryPoint& at, const LawTable& own,
                               const std::string& source);

/// What own packings and a library say together.
struct CorrectedAnswer {
  LawLibrary library;    ///< the same with the neighbours that own packings alone have; answers are not asked of it
  LibraryAnswer answer;  ///< of `library`
  LawPrior prior;        ///< both answers and the weights, number by number
  std::vector<std::string> contradicted;  ///< numbers that differ by more than three deviations, and by how many
  std::string remark;                     ///< which packings they are
};

/// The answer corrected by own packings, see own_entry(): mean and covariance of the product of two normal
/// distributions. The covariance of own numbers is that of their refits times own_error_factor() squared, that of the
/// library its widened deviations with the mean correlations. A neighbour that the library does not have keeps what was
/// measured, but for errors that it shares with other numbers. The error of the form is that of the own table, where it
/// has configurations that its fit did not see. Throws InputError for a table without refits.
CorrectedAnswer corrected(const LawLibrary& library, const LibraryAnswer& prior, const LawTableEntry& own);

/// By how much refits to other packings understate the errors of a law for what its form does not give back: what it is
/// off by when a configuration is left out, over the noise of the means; at least 1 (scale factor of Birge 1932).
double own_error_factor(const MultiContactLaw& law);

/// As above, with what own packings say in LawTableEntry::prior.
LawTable table_of(const CorrectedAnswer& corrected, const LibraryMatter& matter, int draws = 64);

/// Contradictions as one sentence without an end stop; empty: none.
std::string contradictions_text(const CorrectedAnswer& answer);

/// The own entry with its isotropic law replaced by the corrected one, which becomes its best, with `draws` normal
/// draws as refits. Friction, rolling and unloading are the corrected ones. Other forms stay as they were fitted.
LawTableEntry combined_entry(const CorrectedAnswer& corrected, const LawTableEntry& own, int draws = 64);

/// "mu = 0.5, exponent = 3, ratio = 6, solid fraction = 0.68".
std::string point_text(const LibraryPoint& at);
/// Which numbers are means, as one sentence without an end stop; empty: none.
std::string means_text(const LibraryAnswer& answer);
/// Which measured material is nearest, and how far, as one sentence without an end stop.
std::string nearest_text(const LawLibrary& library, const LibraryAnswer& answer);

// A library from the law tables below directories.

/// A table, or an entry of one, that is not in a library.
struct LeftOutTable {
  std::string path;
  std::string why;
  bool damaged = false;  ///< it cannot be read, or has another shell or other neighbours; else its law does not serve
};

struct LibraryCollection {
  LawLibrary library;
  std::vector<LeftOutTable> left_out;
};

/// The entries of all law_table.toml below directories at any depth, in the order of their names, as rows of a library
/// with its checks, after those of a `known` library. Shell and neighbours are its own, or those that most entries
/// have. Tables that do not go with these, are known already or cannot be read, are left out. Throws InputError where a
/// directory has no table, or too few entries are left.
LibraryCollection collect_library(const std::vector<std::string>& directories, const LawLibrary& known = {});

/// "left out: PATH: why", a line each.
std::string left_out_text(const std::vector<LeftOutTable>& left_out);

}  // namespace softgrain
