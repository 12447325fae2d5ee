// Values of a law card.
#include <algorithm>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "pipelines/law/law_values.h"

namespace softgrain::law {

namespace {

/// Unit radius and modulus: what the loop computes is dimensionless.
ContactResponse<3> ask(const CardLaw& contact, double delta, double deepest) {
  ContactState<3> state;
  state.overlap = delta;
  state.memory = deepest;
  state.normal[0] = 1.0;
  state.constants.a = 1.0;
  return std::visit([&](const auto& law) { return law.evaluate(state); }, contact);
}

Where place(const PairLaw& law, double delta) {
  if (delta < law.normal.delta.value) return Where::no_contact;
  constexpr double kRounding = 1e-12;  // 3 * 0.1 is not beyond 0.3
  if (law.delta_max > 0.0 && delta > law.delta_max * (1.0 + kRounding)) return Where::beyond;
  return delta < law.delta_min * (1.0 - kRounding) ? Where::below : Where::inside;
}

}  // namespace

std::vector<LawPoint> card_values(const LawCard& card, PairKind kind, const std::vector<double>& deltas,
                                  std::optional<Extrapolation> beyond, std::optional<double> deepest) {
  const auto contact = [&](bool secant) {
    return make_card_law(card, kind, 1.0, 0.0, 0.0, secant, beyond, deepest.has_value());
  };
  const CardLaw initial = contact(false);
  const CardLaw secant = contact(true);
  const PairLaw& law = *card.find(kind);
  if (deepest && !law.unloading) throw InputError("law card: no unloading branch of the " + to_string(kind) + " law");
  const Extrapolation policy = beyond.value_or(law.beyond);
  std::vector<LawPoint> out;
  for (const double delta : deltas) {
    LawPoint p;
    p.delta = delta;
    p.where = place(law, delta);
    p.refused = p.where == Where::beyond && policy == Extrapolation::error;
    p.clamped = p.where == Where::beyond && policy == Extrapolation::clamp;
    const ContactResponse<3> r = ask(initial, delta, deepest.value_or(0.0));
    const bool measured = p.where != Where::beyond && !(deepest && delta < *deepest);
    const auto quantity = [&](double value, const auto& interval, LawPart part) {
      return measured ? Quantity{value, interval(law, part, delta)} : Quantity{value, std::nullopt};
    };
    p.force = quantity(r.elastic_force, value_interval, LawPart::normal);
    p.stiffness = quantity(p.clamped ? 0.0 : r.normal_stiffness, slope_interval, LawPart::normal);
    if (has_part(law, LawPart::tangential_initial))
      p.tangential_initial = quantity(r.tangential_stiffness, value_interval, LawPart::tangential_initial);
    if (has_part(law, LawPart::tangential_secant))
      p.tangential_secant = quantity(ask(secant, delta, deepest.value_or(0.0)).tangential_stiffness, value_interval,
                                     LawPart::tangential_secant);
    out.push_back(std::move(p));
  }
  return out;
}

std::string where_text(const LawPoint& point) {
  switch (point.where) {
    case Where::no_contact:
      return "no contact";
    case Where::below:
      return "below range";
    case Where::inside:
      return "";
    default:
      if (point.refused) return "beyond range: refused";
      return point.clamped ? "beyond range: clamped" : "beyond range: extrapolated";
  }
}

std::vector<double> even(double low, double high, std::size_t n) {
  std::vector<double> values;
  for (std::size_t k = 0; k < n; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(n - 1);
    values.push_back(k + 1 == n ? high : low + (high - low) * share);
  }
  return values;
}

}  // namespace softgrain::law
