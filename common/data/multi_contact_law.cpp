#include "common/data/multi_contact_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/core/monotone_curve.h"
#include "common/core/text.h"

namespace softgrain {

namespace {

/// A parameter of one law along the entries, as a curve over solid fraction.
class AlongEntries {
 public:
  AlongEntries(const LawTable& table, double x) : table_(table), x_(x) {
    for (const LawTableEntry& e : table.entries) fractions_.push_back(e.solid_fraction);
  }

  /// Value, error and interval, each along its own curve.
  template <class Get>
  [[nodiscard]] Estimate estimate(const Get& get) const {
    return {value([&](const auto& e) { return get(e).value; }),
            value([&](const auto& e) { return get(e).standard_error; }),
            value([&](const auto& e) { return get(e).low; }), value([&](const auto& e) { return get(e).high; })};
  }

  template <class Get>
  [[nodiscard]] double value(const Get& get) const {
    std::vector<double> y;
    for (const LawTableEntry& e : table_.entries) y.push_back(get(e));
    // What one entry does not know is not known between entries.
    const auto unknown = std::ranges::find_if(y, [](double v) { return !std::isfinite(v); });
    if (unknown != y.end()) return *unknown;
    return MonotoneCurve(fractions_, y).value(x_);
  }

 private:
  const LawTable& table_;
  double x_;
  std::vector<double> fractions_;
};

bool same_neighbours(const MultiContactLaw& a, const MultiContactLaw& b) {
  return a.form == b.form &&
         std::equal(a.partners.begin(), a.partners.end(), b.partners.begin(), b.partners.end(),
                    [](const PartnerRow& x, const PartnerRow& y) { return x.kind == y.kind && x.ratio == y.ratio; });
}

bool same_grains(const SoftParticleSpec& a, const SoftParticleSpec& b) {
  return a.poisson_ratio == b.poisson_ratio && a.friction == b.friction && same_sizes(a, b);
}

/// Only what was measured alike can be interpolated.
void require_alike(const LawTable& table) {
  const LawTableEntry& first = table.entries.front();
  const auto refuse = [&](const LawTableEntry& e, const char* what) {
    throw InputError(
        fmt::format("law table: the entries at solid fraction {:.3f} and {:.3f} were not measured with the same {} and "
                    "cannot be interpolated",
                    first.solid_fraction, e.solid_fraction, what));
  };
  for (const LawTableEntry& e : table.entries) {
    if (!same_grains(e.spec, first.spec)) refuse(e, "grains (nu, mu, law of sizes)");
    if (!std::equal(e.laws.begin(), e.laws.end(), first.laws.begin(), first.laws.end(), same_neighbours))
      refuse(e, "neighbours");
  }
}

/// A law between entries is as good as the worst of them.
void take_worst_status(const LawTable& table, std::size_t k, MultiContactLaw& law) {
  const auto bad = [&](LawStatus status) {
    const auto at =
        std::ranges::find_if(table.entries, [&](const LawTableEntry& e) { return e.laws[k].status == status; });
    if (at == table.entries.end()) return false;
    law.status = at->laws[k].status;
    law.reason = at->laws[k].reason;
    return true;
  };
  for (const LawStatus status : {LawStatus::no_threshold_crossing, LawStatus::underdetermined, LawStatus::inaccurate})
    if (bad(status)) return;
}

void interpolate_law(const AlongEntries& along, std::size_t k, MultiContactLaw& law) {
  for (const MultiContactParameterName& p : kMultiContactParameters)
    law.*p.estimate = along.estimate([&](const LawTableEntry& e) -> const Estimate& { return e.laws[k].*p.estimate; });
  for (std::size_t r = 0; r < law.partners.size(); ++r) {
    PartnerRow& row = law.partners[r];
    row.weight =
        along.estimate([&](const LawTableEntry& e) -> const Estimate& { return e.laws[k].partners[r].weight; });
    row.exponent =
        along.estimate([&](const LawTableEntry& e) -> const Estimate& { return e.laws[k].partners[r].exponent; });
    row.overlap_max = along.value([&](const LawTableEntry& e) { return e.laws[k].partners[r].overlap_max; });
    row.error = along.value([&](const LawTableEntry& e) { return e.laws[k].partners[r].error; });
  }
}

LawTableEntry interpolate(const LawTable& table, double x) {
  require_alike(table);
  const AlongEntries along(table, x);
  const auto nearest = std::min_element(table.entries.begin(), table.entries.end(), [x](const auto& a, const auto& b) {
    return std::abs(a.solid_fraction - x) < std::abs(b.solid_fraction - x);
  });
  LawTableEntry out = *nearest;
  out.solid_fraction = x;
  out.main = false;
  for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft}) {
    (out.*slide).kt_ratio =
        along.estimate([=](const LawTableEntry& e) -> const Estimate& { return (e.*slide).kt_ratio; });
    (out.*slide).friction =
        along.estimate([=](const LawTableEntry& e) -> const Estimate& { return (e.*slide).friction; });
    (out.*slide).rolling =
        along.estimate([=](const LawTableEntry& e) -> const Estimate& { return (e.*slide).rolling; });
    (out.*slide).rolling_friction =
        along.estimate([=](const LawTableEntry& e) -> const Estimate& { return (e.*slide).rolling_friction; });
    (out.*slide).unloading =
        along.estimate([=](const LawTableEntry& e) -> const Estimate& { return e.unloading_of(e.*slide); });
  }
  out.unloading = along.estimate([](const LawTableEntry& e) -> const Estimate& { return e.unloading; });
  for (const LawTableEntry& e : table.entries) {  // what one entry does not know is not known between them
    out.unloading_measured = out.unloading_measured && e.unloading_measured;
    for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft}) {
      (out.*slide).measured = (out.*slide).measured && (e.*slide).measured;
      (out.*slide).rolls = (out.*slide).rolls && (e.*slide).rolls;
      (out.*slide).has_unloading = (out.*slide).has_unloading || (e.*slide).has_unloading;
    }
  }
  out.volume_max = along.value([](const LawTableEntry& e) { return e.volume_max; });
  out.overlap_max = along.value([](const LawTableEntry& e) { return e.overlap_max; });
  out.grain_overlap_max = along.value([](const LawTableEntry& e) { return e.grain_overlap_max; });
  for (std::size_t k = 0; k < out.laws.size(); ++k) {
    interpolate_law(along, k, out.laws[k]);
    take_worst_status(table, k, out.laws[k]);
  }
  return out;
}

std::size_t configurations(const LawTableEntry& e) {
  std::size_t most = 0;
  for (const MultiContactLaw& law : e.laws) most = std::max(most, law.errors.size());
  return most;
}

/// F/(E Rs^2) of one plane at the overlap D.
double force_on_plane(const MultiContactLaw& law, double d) {
  if (!(d > law.delta.value)) return 0.0;
  return law.a.value * (std::pow(d, law.b.value) - std::pow(law.delta.value, law.b.value));
}

/// a, b and delta are nearly degenerate: two fits with much the same forces may have numbers far apart, and numbers
/// between them other forces.
std::string off_the_entries(const LawTableEntry& at, const LawTableEntry& below, const LawTableEntry& above) {
  constexpr double kSlack = 0.05;  ///< tolerance over the larger force
  constexpr int kPoints = 40;
  for (std::size_t k = 0; k < at.laws.size(); ++k)
    for (int n = 1; n <= kPoints; ++n) {
      const double d = at.overlap_max * n / kPoints;
      const double force = force_on_plane(at.laws[k], d);
      const auto [low, high] = std::minmax({force_on_plane(below.laws[k], d), force_on_plane(above.laws[k], d)});
      if (force >= low - kSlack * high && force <= (1.0 + kSlack) * high) continue;
      return fmt::format(
          "the {} law at solid fraction {:.4f} is not between those of the entries at {:.4f} and {:.4f} (force on a "
          "plane at h/Rs = {:.3g}: {:.3g} E Rs^2, theirs {:.3g} and {:.3g}): take one of them",
          to_string(at.laws[k].form), at.solid_fraction, below.solid_fraction, above.solid_fraction, d, force,
          force_on_plane(below.laws[k], d), force_on_plane(above.laws[k], d));
    }
  return "";
}

/// What to say about an interpolated entry.
std::string interpolation_remark(const LawTable& table, const LawTableEntry& at) {
  const auto above =
      std::ranges::find_if(table.entries, [&](const LawTableEntry& e) { return e.solid_fraction > at.solid_fraction; });
  const auto below = above - 1;
  std::string text = off_the_entries(at, *below, *above);
  if (below->best != above->best)
    append_part(
        text,
        fmt::format("the entries at solid fraction {:.4f} and {:.4f} prefer different forms ({} and {}); best is that "
                    "of the nearest",
                    below->solid_fraction, above->solid_fraction, to_string(below->best), to_string(above->best)));
  return text;
}

}  // namespace

const LawTableEntry& main_entry(const LawTable& table) {
  if (table.entries.empty()) throw InputError("law table: it has no entries");
  const auto marked = std::ranges::find_if(table.entries, [](const auto& e) { return e.main; });
  if (marked != table.entries.end()) return *marked;
  return *std::max_element(table.entries.begin(), table.entries.end(), [](const auto& a, const auto& b) {
    return std::pair{configurations(a), a.packings} < std::pair{configurations(b), b.packings};
  });
}

std::vector<PartnerRow> MultiContactLaw::rows(PartnerKind kind) const {
  std::vector<PartnerRow> out;
  std::copy_if(partners.begin(), partners.end(), std::back_inserter(out),
               [kind](const PartnerRow& r) { return r.kind == kind; });
  return out;
}

const MultiContactLaw* LawTableEntry::find(LawForm form) const {
  const auto at = std::ranges::find_if(laws, [&](const MultiContactLaw& l) { return l.form == form; });
  return at == laws.end() ? nullptr : &*at;
}

std::string numbers_of(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw& law = *entry.find(form);
  std::string text(earlier_name(to_string(form)));  // the number of a law outlives the name of its form
  for (const auto& parameter : kMultiContactParameters) text += fmt::format(" {:a}", (law.*parameter.estimate).value);
  for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft})
    text += fmt::format(" {:a} {:a}", (entry.*slide).kt_ratio.value, (entry.*slide).friction.value);
  if (entry.rolls())
    for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft})
      text += fmt::format(" {:a} {:a}", (entry.*slide).rolling.value, (entry.*slide).rolling_friction.value);
  text += fmt::format(" {:a}", entry.unloading.value);
  for (const auto slide : {&LawTableEntry::slide_plane, &LawTableEntry::slide_solid, &LawTableEntry::slide_soft})
    if ((entry.*slide).has_unloading) text += fmt::format(" {:a}", (entry.*slide).unloading.value);
  for (const PartnerRow& row : law.partners)
    text += fmt::format(" {:a} {:a} {:a}", row.ratio, row.weight.value, row.exponent.value);
  return text;
}

LawTableEntry entry_at(const LawTable& table, double solid_fraction, RangePolicy policy, std::string& remark,
                       double reach) {
  if (table.entries.empty()) throw InputError("law table: it has no entries");
  const double first = table.entries.front().solid_fraction;
  const double last = table.entries.back().solid_fraction;
  const double low = first - reach;
  const double high = last + reach;
  if (!(solid_fraction >= low && solid_fraction <= high)) {
    const std::string problem =
        fmt::format("solid fraction {:.3f} of the soft particles is outside the law table ({:.3f} to {:.3f})",
                    solid_fraction, reach > kReachOfNumbers ? low : first, reach > kReachOfNumbers ? high : last);
    if (policy == RangePolicy::reject)
      throw InputError("law table: " + problem + ": measure it, or allow the nearest entry with range = \"clamp\"");
    remark = problem + "; the nearest entry was used";
  }
  const double x = std::clamp(solid_fraction, first, last);
  for (const LawTableEntry& e : table.entries)
    if (e.solid_fraction == x) return e;
  LawTableEntry out = interpolate(table, x);
  const std::string more = interpolation_remark(table, out);
  if (!more.empty()) append_part(remark, more);
  return out;
}

}  // namespace softgrain
