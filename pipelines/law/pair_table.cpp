#include "pipelines/law/pair_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "pipelines/law/law_values.h"

namespace softgrain::law {

namespace {

struct Response {
  double energy = 0.0;
  double force = 0.0;
  double stiffness = 0.0;
};

/// One pair of bodies: what an overlap h [m] costs.
struct Pair {
  PairKind kind = PairKind::soft_solid;
  double ratio = 1.0;
  double deepest = 0.0;   ///< h [m]
  double measured = 0.0;  ///< h up to which the law was measured [m]
  std::string beyond;     ///< what the law does at larger overlaps
  std::function<Response(double)> at;
  bool loading_alone = false;  ///< the law has an unloading branch, which no table of r can hold
};

std::string keyword(const Pair& pair) {
  return fmt::format("{}_{:g}", pair.kind == PairKind::soft_solid ? "SOFT_SOLID" : "SOFT_SOFT", pair.ratio);
}

PairTable tabulate(const Pair& pair, const PairTableChoice& choice) {
  PairTable t;
  t.keyword = keyword(pair);
  t.soft_radius = choice.radius;
  t.other_radius = choice.radius * pair.ratio;
  t.meaning =
      fmt::format("soft particle of radius {:.6g} m with a {} of radius {:.6g} m, overlaps to {:.4g} m", t.soft_radius,
                  pair.kind == PairKind::soft_solid ? "solid sphere" : "soft particle", t.other_radius, pair.deepest);
  if (pair.deepest > pair.measured * (1.0 + 1e-12))
    t.meaning += fmt::format("; measured to {:.4g} m, {}: nothing says how far off rows with r below {:.6g} are",
                             pair.measured, pair.beyond, t.soft_radius + t.other_radius - pair.measured);
  if (pair.loading_alone)
    t.meaning += "; loading alone: the law unloads along a branch of its own, which a table has not";
  const double touch = t.soft_radius + t.other_radius;
  if (!(pair.deepest < std::min(t.soft_radius, t.other_radius) * 2.0) || !(pair.deepest < touch))
    throw InputError(
        fmt::format("law export: {}: an overlap of {:.4g} m passes through a body of radius {:.4g} m: give a "
                    "smaller --delta-max",
                    t.keyword, pair.deepest, std::min(t.soft_radius, t.other_radius)));
  t.r = even(touch - pair.deepest, touch, choice.rows);
  for (const double r : t.r) {
    const Response at = pair.at(std::max(touch - r, 0.0));
    t.energy.push_back(at.energy);
    t.force.push_back(at.force);
  }
  t.slope_low = -pair.at(touch - t.r.front()).stiffness;
  return t;
}

[[noreturn]] void refuse_depth(double wanted, double end, const char* what) {
  throw InputError(
      fmt::format("law export: --delta-max {} lies beyond the end of the measured range, {} = {:.4g}, and the "
                  "law allows nothing there (beyond = \"error\")",
                  wanted, what, end));
}

Pair card_pair(const FittedLaw& file, PairKind kind, double ratio, const PairTableChoice& choice) {
  const LawCard& card = *file.card();
  const SoftContact contact = complaining_of(
      file, [&] { return make_soft_contact(card, kind, choice.modulus, 0.0, 0.0, false, choice.beyond); });
  const PairLaw& law = *card.find(kind);
  const double wanted = choice.delta_max.value_or(law.delta_max);
  if (wanted > law.delta_max && contact.range.beyond == Extrapolation::error)
    refuse_depth(wanted, law.delta_max, "Delta");
  const PairConstants constants = contact.pair_constants({choice.radius, choice.radius * ratio, 0.0, 0.0});
  Pair out{kind,
           ratio,
           wanted * constants.a,
           law.delta_max * constants.a,
           contact.range.beyond == Extrapolation::clamp ? "clamped beyond" : "extrapolated beyond",
           [=](double overlap) {
             ContactState<3> s;
             s.overlap = overlap;
             s.normal[0] = 1.0;
             s.constants = constants;
             const ContactResponse<3> r = contact.evaluate(s);
             return Response{contact.stored_energy(overlap, constants), r.elastic_force,
                             contact.is_clamped(overlap, constants.a) ? 0.0 : r.normal_stiffness};
           }};
  out.loading_alone = law.unloading.has_value();
  return out;
}

std::vector<Pair> card_pairs(const FittedLaw& file, const PairTableChoice& choice) {
  const LawCard& card = *file.card();
  std::vector<Pair> out;
  for (const PairLaw& law : card.pairs) {
    const bool named = std::find(choice.kinds.begin(), choice.kinds.end(), law.kind) != choice.kinds.end();
    if (choice.kinds.empty() ? !has_numbers(law.status) : !named) continue;
    for (const double ratio : choice.ratios) out.push_back(card_pair(file, law.kind, ratio, choice));
  }
  for (const PairKind kind : choice.kinds)
    if (card.find(kind) == nullptr) (void)card_pair(file, kind, 1.0, choice);  // says what is wrong
  return out;
}

/// Energy over E R^3 of a soft particle that lost the equivalent volume s: the integral of p dS, which is that of the
/// force of one plane over the depth D of its cap; of a clamped law at constant pressure beyond the end.
double potential(const MultiContactPressure& p, double s) {
  const double taken = std::min(s, p.range.clamp_at());
  const double d = cap_depth(taken);
  if (!(d > p.delta)) return 0.0;
  const double threshold = std::pow(p.delta, p.b);
  const double own = p.a * ((std::pow(d, p.b + 1.0) - threshold * p.delta) / (p.b + 1.0) - threshold * (d - p.delta));
  return own + (s - taken) * p.at(taken).p;
}

/// The single contact of one soft particle: x the overlap over its radius.
struct Side {
  MultiContactPressure pressure;
  PairConstants constants;
  double curvature = 0.0;  ///< own radius over that of the other body

  [[nodiscard]] Response at(double x) const {
    const LostVolume nu = lost_volume(lens(x, curvature), constants.a, constants.b);
    const MultiContactPressure::Value p = pressure.at(nu.nu);
    return {potential(pressure, nu.nu), p.p * nu.slope, p.slope * nu.slope * nu.slope + p.p * nu.curvature};
  }
};

Pair table_pair(const FittedLaw& file, PairKind kind, double ratio, const PairTableChoice& choice) {
  MultiContactQuestion q;
  q.form = choice.form;
  q.partner = kind == PairKind::soft_solid ? PartnerKind::solid : PartnerKind::soft;
  q.ratio = ratio;
  q.solid_fraction = choice.solid_fraction;
  q.range = choice.range;
  q.beyond = choice.beyond;
  const MultiContactAnswer answer = complaining_of(file, [&] { return multi_contact_values(*file.table(), q, {}); });
  const Extrapolation beyond = choice.beyond.value_or(answer.entry.beyond);
  const double end = answer.overlap_max;
  const double wanted = choice.delta_max.value_or(end);
  if (wanted > end * (1.0 + 1e-12) && beyond == Extrapolation::error) refuse_depth(wanted, end, "h/R");
  MultiContactModel model = multi_contact_model(*answer.entry.find(answer.form));
  if (answer.entry.volume_max > 0.0) model.form.pressure.range = {answer.entry.volume_max, beyond};
  const LostVolumeTable& partners = q.partner == PartnerKind::solid ? model.solid : model.soft;
  const Side own{model.form.pressure, partners.at(ratio), 1.0 / ratio};
  const Side other{model.form.pressure, partners.at(1.0 / ratio), ratio};
  const double e = choice.modulus;
  const double r1 = choice.radius;
  const double r2 = choice.radius * ratio;
  const auto scaled = [e](const Response& a, double r) {
    return Response{e * r * r * r * a.energy, e * r * r * a.force, e * r * a.stiffness};
  };
  std::string after =
      beyond == Extrapolation::clamp
          ? fmt::format("extrapolated beyond, clamped above a lost volume of {:.4g} R^3", answer.entry.volume_max)
          : "extrapolated beyond";
  return {kind, ratio, wanted * r1, end * r1, std::move(after), [=](double overlap) {
            Response sum = scaled(own.at(overlap / r1), r1);
            if (kind == PairKind::soft_solid) return sum;
            const Response second = scaled(other.at(overlap / r2), r2);
            return Response{sum.energy + second.energy, sum.force + second.force, sum.stiffness + second.stiffness};
          }};
}

std::vector<Pair> table_pairs(const FittedLaw& file, const PairTableChoice& choice) {
  std::vector<PairKind> kinds = choice.kinds;
  if (kinds.empty()) kinds = {PairKind::soft_solid, PairKind::soft_soft};
  std::vector<Pair> out;
  for (const PairKind kind : kinds)
    for (const double ratio : choice.ratios) out.push_back(table_pair(file, kind, ratio, choice));
  return out;
}

}  // namespace

std::vector<PairTable> pair_tables(const FittedLaw& file, const PairTableChoice& choice) {
  const std::vector<Pair> pairs = file.card() != nullptr ? card_pairs(file, choice) : table_pairs(file, choice);
  if (pairs.empty()) throw InputError(file.path + ": the card has no usable law");
  std::vector<PairTable> out;
  for (const Pair& pair : pairs) {
    const auto same = std::ranges::find(out, keyword(pair), &PairTable::keyword);
    if (same != out.end())
      throw InputError(
          fmt::format("law export: --ratios {} and {} would both be the section {}, of which LAMMPS reads the first: "
                      "give each ratio once, and ratios that differ in their first six digits",
                      same->other_radius / same->soft_radius, pair.ratio, same->keyword));
    out.push_back(tabulate(pair, choice));
  }
  return out;
}

std::string lammps_text(const std::vector<PairTable>& tables, const std::vector<std::string>& head) {
  std::string text = "# UNITS: si\n";  // LAMMPS looks for this word in the first line
  for (const std::string& line : head) text += "# " + line + "\n";
  for (const PairTable& t : tables) {
    text += fmt::format("\n# {}\n{}\n", t.meaning, t.keyword);
    text +=
        fmt::format("N {} R {:.17g} {:.17g} FPRIME {:.17g} 0\n\n", t.r.size(), t.r.front(), t.r.back(), t.slope_low);
    for (std::size_t k = 0; k < t.r.size(); ++k)
      text += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", k + 1, t.r[k], t.energy[k], t.force[k]);
  }
  return text;
}

}  // namespace softgrain::law
