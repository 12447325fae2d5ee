#include "pipelines/python/binding/law_bindings.h"

#include <algorithm>
#include <sstream>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/data/law_band.h"
#include "common/io/scene.h"
#include "pipelines/python/binding/binding_tools.h"
#include "pipelines/python/binding/wide.h"

namespace softgrain::python {

namespace {

SoftContact contact_of(const LawCard& card, PairKind kind, double scale, bool secant,
                       std::optional<Extrapolation> beyond) {
  return make_soft_contact(card, kind, scale, 0.0, 0.0, secant, beyond);
}

/// Throws InputError for overlaps beyond what was measured, when the law does not allow them.
void require_allowed(const LawRange& range, std::span<const double> delta) {
  if (range.beyond != Extrapolation::error) return;
  constexpr double kRounding = 1e-12;
  for (const double d : delta)
    if (d > range.end * (1.0 + kRounding)) {
      std::ostringstream text;
      text << "delta = " << d << ": must be at most " << range.end
           << ", the end of what was measured (beyond = \"error\"; \"clamp\" and \"extrapolate\" go on)";
      throw InputError(text.str());
    }
}

LawPart part_for(LawOutput what, bool secant) {
  if (what != LawOutput::tangential) return LawPart::normal;
  return secant ? LawPart::tangential_secant : LawPart::tangential_initial;
}

}  // namespace

Array CardBinding::values(const std::string& kind, const std::string& what, const Array& delta, double scale,
                          bool secant, const std::optional<std::string>& beyond) const {
  const LawOutput output = parse_choice<LawOutput>("what", what);
  const PairKind pair = parse_choice<PairKind>("kind", kind);
  const SoftContact contact = contact_of(card_, pair, scale, secant, beyond_of(beyond));
  if (output == LawOutput::tangential && !has_part(*card_.find(pair), part_for(output, secant)))
    throw InputError("slope = \"" + std::string(secant ? "secant" : "initial") +
                     "\": the card has no such stiffness of " + kind + " contacts");
  Array out = like(delta);
  const std::span<const double> in = view(delta);
  const std::span<double> to = view(out);
  const pybind11::gil_scoped_release others_may_run;
  require_allowed(contact.range, in);
  card_array(contact, output, in, to);
  return out;
}

std::optional<std::pair<Array, Array>> CardBinding::interval(const std::string& kind, const std::string& what,
                                                             const Array& delta, double scale, bool secant,
                                                             const std::optional<std::string>& beyond) const {
  const LawOutput output = parse_choice<LawOutput>("what", what);
  const PairKind pair = parse_choice<PairKind>("kind", kind);
  const SoftContact contact = contact_of(card_, pair, scale, secant, beyond_of(beyond));
  const PairLaw& law = *card_.find(pair);
  const LawPart part = part_for(output, secant);
  const auto at = [&](double d) {
    return output == LawOutput::stiffness ? slope_interval(law, part, d) : value_interval(law, part, d);
  };
  if (!has_part(law, part) || !at(law.delta_max > 0.0 ? law.delta_max : 0.5)) return std::nullopt;
  Array low = like(delta);
  Array high = like(delta);
  const std::span<const double> in = view(delta);
  const std::span<double> to_low = view(low);
  const std::span<double> to_high = view(high);
  const pybind11::gil_scoped_release others_may_run;
  require_allowed(contact.range, in);
  in_stretches(in.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const bool unmeasured = law.delta_max > 0.0 && in[k] > law.delta_max * (1.0 + 1e-12);
      const auto one = unmeasured ? std::nullopt : at(in[k]);
      to_low[k] = one ? scale * one->low : kNaN;
      to_high[k] = one ? scale * one->high : kNaN;
    }
  });
  return std::pair{std::move(low), std::move(high)};
}

}  // namespace softgrain::python
