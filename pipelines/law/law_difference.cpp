#include "pipelines/law/law_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "common/core/error.h"

namespace softgrain::law {

namespace {

/// The law of one kind of pair of a file, as a function of Delta over its range.
struct Source {
  double low = 0.0;
  double high = 0.0;
  std::function<std::vector<LawPoint>(const std::vector<double>&)> values;
  std::string secant{};  ///< what its secant of the tangential force is of
};

bool comparable(const PairLaw& law) {
  return has_numbers(law.status) && has_part(law, LawPart::normal) && law.delta_max > 0.0;
}

std::optional<Source> card_source(const LawCard& card, PairKind kind) {
  const PairLaw* law = card.find(kind);
  if (law == nullptr || !comparable(*law)) return std::nullopt;
  return Source{law->delta_min, law->delta_max,
                [&card, kind](const std::vector<double>& deltas) {
                  return card_values(card, kind, deltas, Extrapolation::extrapolate);
                },
                fmt::format("at {:g} degree{}", law->secant_angle_deg, law->secant_angle_deg > 1.0 ? "s" : "")};
}

std::optional<Source> table_source(const LawTable& table, PairKind kind, double solid_fraction) {
  MultiContactQuestion q;
  q.solid_fraction = solid_fraction;
  q.partner = kind == PairKind::soft_solid ? PartnerKind::plane : PartnerKind::soft;
  q.beyond = Extrapolation::extrapolate;
  const auto ask = [&table, q](const std::vector<double>& deltas) { return multi_contact_values(table, q, deltas); };
  try {
    return Source{0.0, ask({}).overlap_max, [ask](const std::vector<double>& deltas) { return ask(deltas).points; },
                  "of slides"};
  } catch (const InputError&) {  // no comparable law, or none for soft neighbours
    return std::nullopt;
  }
}

std::optional<Source> source(const FittedLaw& file, PairKind kind, const FittedLaw& other) {
  if (const LawCard* card = file.card()) return card_source(*card, kind);
  return table_source(*file.table(), kind, compared_fraction(file, other));
}

using Get = std::function<std::optional<Quantity>(const LawPoint&)>;
struct ComparedQuantity {
  const char* name;
  Get get;
};
const std::array<ComparedQuantity, 3>& compared_quantities() {
  static const std::array<ComparedQuantity, 3> all{
      {{"F/(E Rs^2)", [](const LawPoint& p) { return std::optional<Quantity>(p.force); }},
       {"kt/(E Rs) initial", [](const LawPoint& p) { return p.tangential_initial; }},
       {"kt/(E Rs) secant", [](const LawPoint& p) { return p.tangential_secant; }}}};
  return all;
}

double half_width(const Quantity& q) { return q.interval ? 0.5 * (q.interval->high - q.interval->low) : 0.0; }

DifferenceRow row_of(double delta, const Quantity& a, const Quantity& b) {
  DifferenceRow row{delta, a, b, std::numeric_limits<double>::quiet_NaN(), half_width(a) + half_width(b) > 0.0, false};
  if (a.value > 0.0) row.relative = b.value / a.value - 1.0;
  row.within = std::abs(b.value - a.value) <= std::hypot(half_width(a), half_width(b));
  return row;
}

void judge(LawDifference& d) {
  double square = 0.0;
  double all = 0.0;
  double largest = 0.0;
  double most = 0.0;
  for (const DifferenceRow& r : d.rows) {
    const double off = r.b.value - r.a.value;
    square += off * off;
    all += r.a.value * r.a.value;
    largest = std::max(largest, std::abs(off));
    most = std::max(most, r.a.value);
  }
  // Against a law that is zero everywhere nothing is relative.
  constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  d.root_mean_square = all > 0.0 ? std::sqrt(square / all) : kUndefined;
  d.largest = most > 0.0 ? largest / most : kUndefined;
}

void add(std::vector<LawDifference>& out, PairKind kind, const Source& a, const Source& b, std::size_t points) {
  const double low = std::max(a.low, b.low);
  const double high = std::min(a.high, b.high);
  if (!(low < high)) return;
  const std::vector<double> deltas = even(low, high, points);
  const std::vector<LawPoint> of_a = a.values(deltas);
  const std::vector<LawPoint> of_b = b.values(deltas);
  for (const ComparedQuantity& w : compared_quantities()) {
    LawDifference d{to_string(kind), w.name, low, high, {}, 0.0, 0.0};
    if (a.secant != b.secant && d.quantity.ends_with("secant"))
      d.quantity += fmt::format(" (A {}, B {}: not the same)", a.secant, b.secant);
    for (std::size_t k = 0; k < deltas.size(); ++k) {
      const auto x = w.get(of_a[k]);
      const auto y = w.get(of_b[k]);
      if (x && y && (x->value > 0.0 || y->value > 0.0)) d.rows.push_back(row_of(deltas[k], *x, *y));
    }
    if (d.rows.empty()) continue;
    judge(d);
    out.push_back(std::move(d));
  }
}

}  // namespace

double compared_fraction(const FittedLaw& file, const FittedLaw& other) {
  if (file.card() != nullptr) return 0.0;
  const LawCard* card = other.card();
  const std::vector<LawTableEntry>& entries = file.table()->entries;
  const auto drawn_alike = [&](const LawTableEntry& e) {
    return card != nullptr && e.spec.beta == card->spec.beta && e.spec.trials == card->spec.trials;
  };
  const auto alike = std::find_if(entries.begin(), entries.end(), drawn_alike);
  if (alike != entries.end()) return alike->solid_fraction;
  if (card != nullptr) return main_entry(*file.table()).solid_fraction;
  const double compared_quantities = main_entry(*other.table()).solid_fraction;
  return std::min_element(entries.begin(), entries.end(),
                          [compared_quantities](const auto& x, const auto& y) {
                            return std::abs(x.solid_fraction - compared_quantities) <
                                   std::abs(y.solid_fraction - compared_quantities);
                          })
      ->solid_fraction;
}

std::vector<LawDifference> law_differences(const FittedLaw& a, const FittedLaw& b, std::size_t points) {
  std::vector<LawDifference> out;
  for (const PairKind kind : kPairKinds) {
    const auto of_a = source(a, kind, b);
    const auto of_b = source(b, kind, a);
    if (of_a && of_b) add(out, kind, *of_a, *of_b, points);
  }
  return out;
}

}  // namespace softgrain::law
