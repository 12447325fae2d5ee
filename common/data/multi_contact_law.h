// Laws of soft particles with several contacts, as fitted, over size ratio and solid fraction. Dimensionless inside
// [SP 1.6].
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/data/fields.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

/// nu = w v^m of one kind of neighbour at one size ratio.
struct PartnerRow {
  PartnerKind kind = PartnerKind::solid;  ///< plane: one without friction; those with that of the grains have w = m = 1
  double ratio = 1.0;                     ///< radius of the neighbour over that of the soft particle; 0 of planes
  Estimate weight;                        ///< w
  Estimate exponent;                      ///< m; the same for all ratios of soft neighbours
  double overlap_max = 0.0;               ///< h over the smaller radius, the end of what was measured
  double error = 0.0;                     ///< root mean square of (law - mean) over that of the mean
};

/// What a fit of forces does with a configuration.
enum class MultiContactUse {
  fitted,
  predicted,  ///< held out, with every other path that begins with the same loading
  repeated,   ///< repeats the loading of the same packings of a fitted or predicted configuration: gives nothing new
  apart       ///< has no weight in this form of law: a held shell, where other configurations have free shells
};

template <>
inline constexpr auto enum_names<MultiContactUse> =
    enum_name_list<MultiContactUse>({{MultiContactUse::fitted, "fitted"},
                                     {MultiContactUse::predicted, "predicted"},
                                     {MultiContactUse::repeated, "repeated"},
                                     {MultiContactUse::apart, "apart"}});

/// What somebody may ask for: a form, or (empty) the best of an entry.
using WantedForm = std::optional<LawForm>;

/// What would put a law right on one configuration: all forces times exp(force), its threshold delta higher by `onset`.
struct FormOffset {
  double force = 0.0;
  double onset = 0.0;
};

/// How well a law gives back one configuration.
struct ConfigurationError {
  std::string name;
  MultiContactUse use = MultiContactUse::fitted;
  double error = 0.0;         ///< root mean square of (law - mean) over that of the mean, all recorded states
  double end_ratio = 0.0;     ///< law over mean at the largest overlap, sums over the neighbours
  double noise = 0.0;         ///< root mean square standard error of the mean over that of the mean
  std::int64_t packings = 0;  ///< packings in its last loading state; 0: not recorded, as many as the entry has
  std::optional<FormOffset> offset{};  ///< correction on a configuration that the fit has not seen
  bool in_proportion = true;           ///< MultiContactConfiguration::in_proportion()
};

/// One form of law with its parameters.
struct MultiContactLaw {
  LawForm form = LawForm::pair;
  LawStatus status = LawStatus::good;
  std::string reason;
  Estimate a;  ///< pressure: F/(E Rs^2) of one plane is a (D^b - delta^b)
  Estimate b;
  Estimate delta;
  Estimate m0;  ///< coupling M(c) = m0 - m1 c - m2 c^2
  Estimate m1;
  Estimate m2;
  std::vector<PartnerRow> partners;  ///< solid, then soft, by ratio, then planes without friction
  std::vector<ConfigurationError> errors;
  double error_fitted = 0.0;                                         ///< mean over the configurations of the fit
  double error_held_out = std::numeric_limits<double>::quiet_NaN();  ///< mean over those left out of the fit; NaN: none
  /// Leave one loading out of those that may be fitted, mean over them; NaN: there is but one.
  double error_cross = std::numeric_limits<double>::quiet_NaN();
  double criterion = 0.0;  ///< corrected Akaike information criterion: smaller is better
  int parameters = 0;
  int replicates_failed = 0;  ///< refits that did not come to their minimum and count nowhere
  /// Refits to packings drawn with replacement, each as multi_contact_numbers() gives it; kept in the .h5 beside the
  /// table, read by read_replicates() alone.
  std::vector<std::vector<double>> replicates{};

  [[nodiscard]] std::vector<PartnerRow> rows(PartnerKind kind) const;
};

/// Fitted numbers of a law of planes and their names in files.
struct MultiContactParameterName {
  const char* key;
  Estimate MultiContactLaw::*estimate;
};
inline constexpr std::array<MultiContactParameterName, 6> kMultiContactParameters{{{"a", &MultiContactLaw::a},
                                                                                   {"b", &MultiContactLaw::b},
                                                                                   {"delta", &MultiContactLaw::delta},
                                                                                   {"m0", &MultiContactLaw::m0},
                                                                                   {"m1", &MultiContactLaw::m1},
                                                                                   {"m2", &MultiContactLaw::m2}}};

/// How one kind of neighbour slides on a soft particle: a spring up to the Coulomb limit.
struct SlideLaw {
  Estimate kt_ratio;     ///< kt/kn, kt the secant at a slide of pi Rs/180 (1 degree)
  Estimate friction;     ///< mu_soft: largest tangential over normal force of the measured slides
  bool measured = true;  ///< false: numbers that stand in, of another kind of neighbour or of the grains
  /// Rolling: moment over E R^2 R12 per angle, and largest moment over F R (see SoftMultiContact).
  Estimate rolling{};
  Estimate rolling_friction{};
  bool rolls = false;  ///< true: rolling was measured; false: the neighbour rolls freely
  /// Number s of the unloading branch of this kind of neighbour.
  Estimate unloading{};
  bool has_unloading = false;  ///< true: s was measured; false: that of planes is used, LawTableEntry::unloading
};

/// Where the numbers of a table come from.
enum class TableSource {
  measured,   ///< packings
  library,    ///< a library of law tables, for a material that was not measured
  combined,   ///< packings and a library together, LawTableEntry::prior
  press_test  ///< a library, by a press test: what is inside the soft particle is not known, LawTableEntry::spec lacks
              ///< it
};

template <>
inline constexpr auto enum_names<TableSource> = enum_name_list<TableSource>({{TableSource::measured, "measured"},
                                                                             {TableSource::library, "library"},
                                                                             {TableSource::combined,
                                                                              "packings and library"},
                                                                             {TableSource::press_test, "press test"}});

/// What own packings and a library say of one number of a law, and both together. NaN: not measured, or not known.
struct PriorNumber {
  std::string name;  ///< as in a library of law tables
  double own = std::numeric_limits<double>::quiet_NaN();
  double own_error = std::numeric_limits<double>::quiet_NaN();
  double library = std::numeric_limits<double>::quiet_NaN();
  double library_error = std::numeric_limits<double>::quiet_NaN();
  double value = 0.0;
  double error = 0.0;
  /// Share of the library's variance that own packings remove: for independent numbers their weight in the mean.
  double own_weight = 0.0;
};

void fields(auto&& visit, Of<PriorNumber> auto& n) {
  visit("name", n.name, Means{"name of the number"});
  visit("own", n.own, Means{"as the packings alone give it", "1"});
  visit("own_error", n.own_error, Limits::not_negative(), Means{"its standard error", "1"});
  visit("library", n.library, Means{"as the library predicts it", "1"});
  visit("library_error", n.library_error, Limits::not_negative(), Means{"its standard error", "1"});
  visit("value", n.value, Means{"both together", "1"});
  visit("error", n.error, Limits::not_negative(), Means{"its standard error", "1"});
  visit("own_weight", n.own_weight, Limits::flag(), Means{"share of the packings in it", "1"});
}

/// How the prediction of a library came into the law of an entry.
struct LawPrior {
  std::string library;      ///< file of the library
  double distance = 0.0;    ///< to the nearest measured material, LibraryAnswer::distance
  double own_factor = 1.0;  ///< by which errors of own packings are widened for what the form does not give back
  std::vector<PriorNumber> numbers;
};

void fields(auto&& visit, Of<LawPrior> auto& p) {
  visit("library", p.library, Means{"file of the library"});
  visit("distance", p.distance, Means{"distance to the nearest measured material", "1"});
  visit("own_factor", p.own_factor, Means{"factor on the errors of the packings", "1"});
  visit("numbers", p.numbers, Means{"each number of the law"});
}

/// All laws of one kind of packing.
struct LawTableEntry {
  SoftParticleSpec spec;
  double solid_fraction = 0.0;
  double solid_fraction_error = 0.0;  ///< standard error over packings
  double grains = 0.0;  ///< number of grains that one soft particle represents, those inside inner ones too; 0: unknown
  bool main = false;    ///< whether the table was made for this packing; true for at most one entry
  int packings = 0;
  std::string relaxation;
  TableSource source = TableSource::measured;
  double volume_max = 0.0;         ///< validity: largest equivalent volume S among the fitted states
  double overlap_max = 0.0;        ///< validity: largest overlap with a plane, h/Rs
  double grain_overlap_max = 0.0;  ///< largest overlap of grains over the smaller radius in that range
  Extrapolation beyond = Extrapolation::extrapolate;  ///< what the laws do above volume_max
  SlideLaw slide_plane;
  SlideLaw slide_solid;
  SlideLaw slide_soft;
  Estimate unloading;  ///< s of the unloading branch of planes
  bool unloading_measured = true;
  std::vector<MultiContactLaw> laws;
  std::optional<LawPrior> prior{};  ///< of source `combined`
  LawForm best = LawForm::pair;     ///< the form that was asked for, or that cross-validation prefers among good ones;
                                    ///< what is held out has no say

  [[nodiscard]] const MultiContactLaw* find(LawForm form) const;

  /// s of the unloading branch of one kind of neighbour.
  [[nodiscard]] const Estimate& unloading_of(const SlideLaw& slide) const {
    return slide.has_unloading ? slide.unloading : unloading;
  }

  /// Whether rolling was measured, of any kind of neighbour.
  [[nodiscard]] bool rolls() const { return slide_plane.rolls || slide_solid.rolls || slide_soft.rolls; }
};

/// Every number of one law that forces depend on, exactly, as text: the same text, the same forces.
std::string numbers_of(const LawTableEntry& entry, LawForm form);

struct LawTable {
  int schema = 1;
  std::vector<LawTableEntry> entries;  ///< entries in ascending order of solid fraction
  std::string table_id{};              ///< identifier of the .h5 that belongs to the table; may be empty
  std::vector<std::string> notes{};    ///< remarks from reading: parts of the .h5 that do not match an edited table
};

/// The card as TOML; save_law_table() of common/contact/make_laws.h writes it with the forces that it
/// stands for. `table_id`: names the .h5 that belongs to it; empty: none.
std::string law_table_text(const LawTable& table, const Provenance& provenance, const std::string& table_id);

/// Reads the card. Throws InputError with file:line for wrong content, IoError for files.
LawTable load_law_table(const std::string& toml_path);
LawTable load_law_table(const Scene& file);

/// The entry of the packing that the table was made for. Where no entry says so, the one that was measured
/// with most configurations, of those the one of most packings.
const LawTableEntry& main_entry(const LawTable& table);

/// How far beyond its ends a table serves: means over some packings never are that of those that were measured, and a
/// number that somebody gives is rounded.
inline constexpr double kReachOfPackings = 0.02;
inline constexpr double kReachOfNumbers = 0.0005;

/// The entry at a solid fraction: the entries themselves as they are, between them each parameter along a monotone
/// curve through them, so that it is a law of the same form, whose forces have an energy. Entries must agree in
/// material (nu, mu), in the law of sizes and in the neighbours. The ends serve `reach` beyond their own solid
/// fractions; outside that: InputError, or the nearest end with a remark. Remarks too: entries that prefer different
/// forms, or differ so much that the force on a plane leaves the room between theirs.
LawTableEntry entry_at(const LawTable& table, double solid_fraction, RangePolicy policy, std::string& remark,
                       double reach = kReachOfPackings);

}  // namespace softgrain
