// Values of a law table: one soft particle of radius 1 and modulus 1 with its neighbours, through the loop's own law.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/law/law_values.h"
#include "pipelines/law/multi_contact_middle.h"

namespace softgrain::law {

namespace {

constexpr double kRangeRounding = 1e-9;

struct Neighbours {
  std::vector<MultiContactNeighbour> around;
  std::vector<double> share;  ///< overlap of each neighbour over Delta
};

struct Raw {
  std::vector<double> force;
  double stiffness = 0.0;   ///< normal stiffness at the first neighbour
  double tangential = 0.0;  ///< tangential stiffness at the first neighbour
  double friction = 0.0;    ///< mu of this kind of pair
  double volume = 0.0;
};

Raw ask(const MultiContactLaws& laws, const Neighbours& neighbours, double delta) {
  Raw out;
  with_multi_contact_contacts(laws, [&]<class Law>(const MultiContactContacts<Law>& contacts) {
    std::vector<double> overlap;
    for (const double share : neighbours.share) overlap.push_back(delta * share);
    const MultiContactMiddle<Law> middle(contacts, neighbours.around, overlap);
    for (std::size_t k = 0; k < overlap.size(); ++k) out.force.push_back(middle.response(k).elastic_force);
    const Law& law = contacts.with(neighbours.around.front().kind);
    const ContactResponse<3> first = middle.response(0);
    out.stiffness = first.normal_stiffness;
    out.tangential = law.kt_ratio * first.normal_stiffness;
    out.friction = law.friction;
    out.volume = middle.volume();
  });
  return out;
}

Neighbours neighbours_of(const MultiContactQuestion& q) {
  Neighbours out;
  for (const Vec3& direction : directions_of(q.arrangement)) out.around.push_back({q.partner, q.ratio, direction});
  out.share = depth_shares(q.arrangement, q.shallow);
  return out;
}

MultiContactLaws laws_of(const LawTableEntry& entry, const MultiContactQuestion& q, LawForm form) {
  MultiContactChoices choices;
  choices.form = form;
  choices.modulus = 1.0;
  choices.beyond = q.beyond;
  return make_multi_contact_laws(entry, choices);
}

const SlideLaw& slide_for(const LawTableEntry& entry, PartnerKind kind) {
  if (kind == PartnerKind::plane) return entry.slide_plane;
  return kind == PartnerKind::solid ? entry.slide_solid : entry.slide_soft;
}

/// The entry that is asked: of the main packing unless somebody names a number.
LawTableEntry entry_of(const LawTable& table, const MultiContactQuestion& q, std::string& remark) {
  return entry_at(table, q.solid_fraction.value_or(main_entry(table).solid_fraction), q.range, remark, kReachOfNumbers);
}

/// Largest overlap over Rs that was measured with this neighbour, from the row of the nearest ratio.
double overlap_max(const MultiContactAnswer& answer, const MultiContactQuestion& q, std::string& remark) {
  if (q.partner == PartnerKind::plane) return answer.entry.overlap_max;
  const std::vector<PartnerRow> rows = answer.entry.find(answer.form)->rows(q.partner);
  const double ratio = q.partner == PartnerKind::soft ? std::max(q.ratio, 1.0 / q.ratio) : q.ratio;
  if (ratio < rows.front().ratio || ratio > rows.back().ratio)
    append_part(remark, fmt::format("ratio {:.4g} was not measured with {} neighbours ({:.4g} to {:.4g})", q.ratio,
                                    to_string(q.partner), rows.front().ratio, rows.back().ratio));
  return measured_overlap(answer.entry, answer.form, q.partner, q.ratio);
}

/// kt = (kt/kn) kn: both are uncertain, each on its own; on either side their distances add in quadrature. Both
/// intervals are widened for few packings in the logarithm, so the distances are ratios.
std::optional<LawInterval> tangential_interval(double kt, const Quantity& kn, const Estimate& ratio) {
  if (!kn.interval || !(kn.value > 0.0) || !(ratio.value > 0.0) || !interval_known(ratio.low, ratio.high))
    return std::nullopt;
  const auto distance = [](double value, double end) { return end > 0.0 ? std::log(end / value) : -kInfinity; };
  const double below = std::hypot(distance(kn.value, kn.interval->low), distance(ratio.value, ratio.low));
  const double above = std::hypot(distance(kn.value, kn.interval->high), distance(ratio.value, ratio.high));
  return LawInterval{kt * std::exp(-below), kt * std::exp(above), kFromPackings};
}

/// Where the law is clamped or extrapolated: it knows the lost volume alone.
bool squeezed(const LawTableEntry& entry, const LawPoint& p) {
  return entry.volume_max > 0.0 && p.volume > entry.volume_max * (1.0 + kRangeRounding);
}

Where place(const MultiContactAnswer& answer, const LawPoint& p) {
  if (!(p.force.value > 0.0)) return Where::no_contact;
  const bool deep = p.delta > answer.overlap_max * (1.0 + kRangeRounding);
  return deep || squeezed(answer.entry, p) ? Where::beyond : Where::inside;
}

/// One law for every replicate, at the solid fraction that was asked for.
std::vector<MultiContactLaws> replicate_laws(const LawTable& table, const MultiContactQuestion& q, LawForm form) {
  std::vector<MultiContactLaws> out;
  std::string ignored;
  const std::size_t n = replicate_count(table, form);
  for (std::size_t r = 0; r < n; ++r)
    out.push_back(laws_of(entry_of(replicate_of(table, form, r), q, ignored), q, form));
  return out;
}

LawPoint point_of(const Raw& raw, double delta, const std::vector<Raw>& drawn, int packings, const Estimate& kt_ratio) {
  LawPoint p;
  p.delta = delta;
  p.forces = raw.force;
  p.volume = raw.volume;
  std::vector<double> force;
  std::vector<double> stiffness;
  for (const Raw& r : drawn) {
    force.push_back(r.force.front());
    stiffness.push_back(r.stiffness);
  }
  p.force = {raw.force.front(), refit_interval(raw.force.front(), force, packings)};
  p.stiffness = {raw.stiffness, refit_interval(raw.stiffness, stiffness, packings)};
  p.tangential_secant = Quantity{raw.tangential, tangential_interval(raw.tangential, p.stiffness, kt_ratio)};
  p.friction_limit = raw.friction * raw.force.front();
  return p;
}

void forget_intervals(LawPoint& p) {
  p.force.interval.reset();
  p.stiffness.interval.reset();
  if (p.tangential_secant) p.tangential_secant->interval.reset();
}

}  // namespace

MultiContactAnswer multi_contact_values(const LawTable& table, const MultiContactQuestion& q,
                                        const std::vector<double>& deltas) {
  if (q.arrangement == Arrangement::scattered)
    throw InputError(
        "--arrangement scattered: neighbours that are drawn are for measurements; ask for another arrangement");
  MultiContactAnswer out;
  out.entry = entry_of(table, q, out.remark);
  out.form = q.form.value_or(out.entry.best);
  const MultiContactLaws laws = laws_of(out.entry, q, out.form);
  out.overlap_max = overlap_max(out, q, out.remark);
  const Neighbours around = neighbours_of(q);
  const std::vector<MultiContactLaws> drawn = replicate_laws(table, q, out.form);
  out.replicates = drawn.size() < kEnoughReplicates ? 0 : drawn.size();
  const Extrapolation beyond = q.beyond.value_or(out.entry.beyond);
  for (const double delta : deltas) {
    std::vector<Raw> raws;
    for (const MultiContactLaws& draw : drawn) raws.push_back(ask(draw, around, delta));
    LawPoint p =
        point_of(ask(laws, around, delta), delta, raws, out.entry.packings, slide_for(out.entry, q.partner).kt_ratio);
    p.where = place(out, p);
    p.refused = p.where == Where::beyond && beyond == Extrapolation::error;
    p.clamped = beyond == Extrapolation::clamp && squeezed(out.entry, p);
    if (p.where == Where::beyond) forget_intervals(p);
    out.points.push_back(std::move(p));
  }
  return out;
}

}  // namespace softgrain::law
