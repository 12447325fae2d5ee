// Values of laws at given overlaps, from the laws that the contact loop uses, with intervals and with what they are
// worth there. Dimensionless: F/(E R^2), stiffness/(E R), R the radius that Delta refers to [SP 1.5, 1.6].
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/data/law_band.h"
#include "common/data/multi_contact_law.h"
#include "microsim/multi_contact_arrangements.h"

namespace softgrain::law {

/// Where an overlap lies in what was measured.
enum class Where {
  no_contact,  ///< below the threshold: no force
  below,       ///< above the threshold, below the first overlap that was fitted
  inside,
  beyond  ///< above the last one: `beyond` of the law says what happens
};

/// A number with its 95 % interval, where that is known: not beyond what was measured, where the scatter of what was
/// says nothing of how the law goes on.
struct Quantity {
  double value = 0.0;
  std::optional<LawInterval> interval{};
};

struct LawPoint {
  double delta = 0.0;
  Where where = Where::inside;
  bool refused = false;                          ///< beyond the range of a law that allows nothing there: no values
  Quantity force;                                ///< F/(E R^2)
  Quantity stiffness;                            ///< dF/dDelta = kn/(E R)
  std::optional<Quantity> tangential_initial{};  ///< kt/(E R), initial slope; empty: not fitted
  std::optional<Quantity> tangential_secant{};   ///< kt/(E R), secant; empty: not fitted
  std::vector<double> forces{};                  ///< multi-contact laws: on every neighbour
  double volume = 0.0;                           ///< multi-contact laws: equivalent volume S
  double friction_limit = 0.0;                   ///< multi-contact laws: mu F, over E R^2
  bool clamped = false;                          ///< the law stays at the force of the end of its range
};

/// The law of a card at overlaps Delta. `beyond` instead of what the card says; `deepest`: the contact was pressed in
/// so far before, and overlaps below lie on its unloading branch, without intervals. Throws InputError when the card
/// has no usable law of this kind, or no branch where one is asked for.
std::vector<LawPoint> card_values(const LawCard& card, PairKind kind, const std::vector<double>& deltas,
                                  std::optional<Extrapolation> beyond = std::nullopt,
                                  std::optional<double> deepest = std::nullopt);

/// What a law of a table is asked: neighbours of one kind around a soft particle, all pressed in by Delta = h/Rs.
struct MultiContactQuestion {
  WantedForm form{};
  Arrangement arrangement = Arrangement::one;
  PartnerKind partner = PartnerKind::plane;
  double ratio = 1.0;                      ///< radius of the neighbours over Rs; not of planes
  double shallow = 0.5;                    ///< beside-five: share of the overlap that the first neighbour gets
  std::optional<double> solid_fraction{};  ///< empty: that of the main entry
  RangePolicy range = RangePolicy::reject;
  std::optional<Extrapolation> beyond{};
};

struct MultiContactAnswer {
  LawForm form = LawForm::pair;
  LawTableEntry entry;             ///< entry of the table at the solid fraction
  std::string remark;              ///< clamped solid fraction, ratio that no row has; empty: none
  double overlap_max = 0.0;        ///< h/Rs up to which single contacts of this kind were measured
  std::size_t replicates = 0;      ///< number of replicates behind the intervals; 0: there are none
  std::vector<LawPoint> points{};  ///< force, stiffness and tangential (secant) of the first neighbour
};

/// Forces and stiffnesses of a law of a table. Throws InputError for a solid fraction that was
/// not measured (policy reject), no usable law of the form.
MultiContactAnswer multi_contact_values(const LawTable& table, const MultiContactQuestion& question,
                                        const std::vector<double>& deltas);

/// "no contact", "below range", "beyond range: extrapolated"...; empty inside.
std::string where_text(const LawPoint& point);

/// n >= 2 values evenly spread over [low, high], the ends exact.
std::vector<double> even(double low, double high, std::size_t n);

}  // namespace softgrain::law
