// Fitted laws in words: numbers with their intervals, the form of a law, remarks.
#include "common/data/law_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "common/core/text.h"

namespace softgrain {

namespace {

int digits_for(double low, double high) { return digits_to_differ(low, high, 4, 12); }

}  // namespace

int digits_to_differ(double low, double high, int least, int most) {
  int digits = least;
  while (digits < most && rounded_text(low, {digits}) == rounded_text(high, {digits})) ++digits;
  return digits;
}

bool interval_known(double low, double high) { return std::isfinite(low) && std::isfinite(high) && low < high; }

std::string interval_text(double value, double low, double high) {
  if (!interval_known(low, high)) return fmt::format("{:.4g} (interval not determined)", value);
  const int digits = digits_for(low, high);
  return fmt::format("{:.{}g} ({:.{}g} to {:.{}g})", value, digits, low, digits, high, digits);
}

std::string bracket_text(const Estimate& e, double unit) {
  if (!interval_known(e.low, e.high)) return fmt::format("{:.4g} [not determined]", unit * e.value);
  const int digits = digits_for(unit * e.low, unit * e.high);
  return fmt::format("{:.{}g} [{:.{}g}, {:.{}g}]", unit * e.value, digits, unit * e.low, digits, unit * e.high, digits);
}

std::string ends_text(double low, double high, const EndsForm& form) {
  const bool known = form.may_be_equal ? std::isfinite(low) && std::isfinite(high) : interval_known(low, high);
  return known ? form.number(low, form.digits) + form.between + form.number(high, form.digits) : form.unknown;
}

std::string estimate_with_error(const Estimate& e, const EstimateForm& form) {
  const std::string value = form.number(e.value, 3);
  if (!std::isfinite(e.standard_error)) return value + form.unknown;
  return e.standard_error > 0.0 ? value + form.between + form.number(e.standard_error, 2) : value;
}

namespace {

/// Rank of a law as fit_multi_contact_laws() ranks forms, before it judges how accurate they are.
auto rank_of(const MultiContactLaw& law) {
  const bool determined = law.status == LawStatus::good || law.status == LawStatus::inaccurate;
  return std::tuple{!determined, std::isnan(law.error_cross) ? HUGE_VAL : law.error_cross, law.parameters};
}

}  // namespace

std::string form_label(const LawTableEntry& entry, const MultiContactLaw& law) {
  if (law.form != entry.best) return to_string(law.form);
  const bool better = std::any_of(entry.laws.begin(), entry.laws.end(),
                                  [&](const MultiContactLaw& other) { return rank_of(other) < rank_of(law); });
  return to_string(law.form) + (better ? " (chosen)" : " (best)");
}

std::string unseen_error_text(const LawTableEntry& entry, const MultiContactLaw& law) {
  if (std::isfinite(law.error_cross))
    return fmt::format("off by {:.1f} % leaving one loading of planes out", 100.0 * law.error_cross);
  if (entry.source != TableSource::measured && std::isfinite(law.error_held_out))
    return fmt::format("from a library of laws, which are off by {:.1f} % on loadings that their fits did not see",
                       100.0 * law.error_held_out);
  return "fitted to one loading of planes, so that nothing could be left out";
}

std::string slides_text(const LawTableEntry& entry) {
  std::string text;
  for (const auto& [name, slide] : {std::pair{"against planes", &entry.slide_plane},
                                    {"against solid spheres", &entry.slide_solid},
                                    {"among soft particles", &entry.slide_soft}}) {
    const std::string numbers = fmt::format("{:.2f}, {:.2f}", slide->friction.value, slide->kt_ratio.value);
    append_part(text, slide->measured ? numbers + " " + name
                                      : fmt::format("not measured {} ({} taken instead)", name, numbers));
  }
  text = "friction limit and kt/kn: " + text;
  if (!entry.rolls()) return text;
  std::string rolling;
  for (const auto& [name, slide] : {std::pair{"against planes", &entry.slide_plane},
                                    {"against solid spheres", &entry.slide_solid},
                                    {"among soft particles", &entry.slide_soft}})
    append_part(rolling, slide->rolls ? fmt::format("{:.3f} F R {}", slide->rolling_friction.value, name)
                                      : fmt::format("not measured {} (free)", name));
  return text + "; largest moment against rolling: " + rolling;
}

std::string kt_remark(const LawCard& card) {
  std::string text;
  if (has_frozen_kt(card))
    text =
        "kt of this card is from a frozen turn (version 0.2.0 or earlier): at 1 degree it is 0.3 to 0.5 of what a "
        "slow turn gives; measure again, or calibrate from new measurements";
  std::map<std::pair<double, bool>, std::string> kinds;  // by the ratio that they share, and whether Ft was measured
  for (const PairLaw& law : card.pairs) {
    if (has_tangential(law) || !has_numbers(law.status)) continue;
    const bool measured = law.reason.find(kNoStiffness) != std::string::npos;
    append_part(kinds[{assumed_kt_ratio(card, law), measured}], to_string(law.kind), " and ");
  }
  for (const auto& [of, names] : kinds)
    append_part(
        text, of.first > 0.0
                  ? fmt::format("tangential stiffness of {} contacts was {}: kt = {:.3g} dFn/dh is "
                                "assumed (kt_ratio of the card, Mindlin's unless it was changed), up to mu Fn",
                                names, of.second ? "measured, but not determined" : "not measured", of.first)
                  : fmt::format("{} contacts have no tangential force, whatever mu: kt_ratio of the card is 0", names));
  return text;
}

std::string unloading_text(const PairLaw& law) {
  if (!law.unloading) return "no unloading branch: the contact gives back the work that it took";
  const UnloadingLaw& u = *law.unloading;
  const ThresholdPowerLaw& n = law.normal;
  std::string text =
      fmt::format("unloading: residual {}, exponent {}", bracket_text(u.residual), bracket_text(u.exponent));
  const double end = law.delta_max;
  const double force = n.value(end);
  if (!(force > 0.0)) return text;
  const double threshold = n.delta.value;
  const double length = (1.0 - u.residual.value) * (end - threshold);
  const double power = n.b.value + 1.0;
  const double work =
      n.a.value * (std::pow(end, power) - std::pow(threshold, power)) / power + n.c.value * (end - threshold);
  return text + fmt::format(
                    "; from Delta = {:.3g} it begins {:.2f} times as steep as loading, and {:.0f} % of the work "
                    "comes back",
                    end, u.exponent.value * force / (length * n.derivative(end)),
                    100.0 * force * length / ((u.exponent.value + 1.0) * work));
}

std::string unloading_text(const LawTableEntry& entry) {
  if (!entry.unloading_measured) return "unloading was not measured";
  std::string text = fmt::format("unloading is {:.2f} times as steep as loading", entry.unloading.value);
  if (entry.slide_solid.has_unloading)
    text += fmt::format(", {:.2f} against solid spheres", entry.slide_solid.unloading.value);
  if (entry.slide_soft.has_unloading)
    text += fmt::format(", {:.2f} among soft particles", entry.slide_soft.unloading.value);
  return text;
}

std::string pair_law_remark() {
  return fmt::format(
      "the pair law was measured with one contact; with two to twelve neighbours around a soft particle forces were "
      "measured to be {:g} to {:g} times as large, among soft particles up to {:g} times",
      kPairLawMissesLeast, kPairLawMissesMost, kPairLawMissesAmongSoft);
}

bool use_pair_law(const std::vector<MacroCurve>& curves) {
  return std::ranges::any_of(curves, [](const MacroCurve& c) { return c.law.form == LawForm::pair; });
}

}  // namespace softgrain
