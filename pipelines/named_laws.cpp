#include "pipelines/named_laws.h"

#include <fmt/format.h>

#include "common/contact/soft_contact_from_card.h"
#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

std::int32_t law_of(const System3& s, const ContactRecord<3>& c) {
  const auto& material = s.particles.material;
  return s.laws.index(material[static_cast<std::size_t>(c.i)], material[static_cast<std::size_t>(c.j)]);
}

double reference_radius(const System3& s, const SoftContact& law, const ContactRecord<3>& c) {
  const double rj = c.j < s.particles.grains ? s.particles.sphere[static_cast<std::size_t>(c.j)].r : 0.0;
  return law.pair_constants({s.particles.sphere[static_cast<std::size_t>(c.i)].r, rj, 0.0, 0.0}).a;
}

/// Largest Delta among the soft contacts of a law run, against the range its laws were fitted in; empty when inside.
std::string extrapolation_note(const System3& s, const LawCard& card) {
  double beyond = 0.0;
  std::string note;
  for (const ContactRecord<3>& c : contact_records(s)) {
    const auto* soft = std::get_if<SoftContact>(&s.laws.law(law_of(s, c)));
    if (soft == nullptr) continue;
    const double delta = c.overlap / reference_radius(s, *soft, c);
    const PairLaw* law = card.find(soft->partner_is_soft ? PairKind::soft_soft : PairKind::soft_solid);
    if (law == nullptr || delta - law->delta_max <= beyond) continue;
    beyond = delta - law->delta_max;
    note = fmt::format(
        "soft contacts reach Delta = {:.2f} at the end, the {} law was fitted up to {:.2f} and is extrapolated", delta,
        to_string(law->kind), law->delta_max);
  }
  return note;
}

}  // namespace

NamedLaws pair_law_of(const LawCard& card, const MacroSpec& spec, const std::string& name) {
  const auto contact = [&](PairKind kind) {
    return make_soft_contact(card, kind, spec.youngs_modulus, spec.friction, 0.0, spec.kt_secant);
  };
  return {name, pair_soft_laws(contact(PairKind::soft_solid), contact(PairKind::soft_soft), spec.wall_friction),
          [card](const System3& s) { return extrapolation_note(s, card); }};
}

LawSources read_law_sources(const Scene& scene, const SceneTable& law) {
  return {load_card(scene.resolve(law.text("card")))};
}

std::vector<NamedLaws> laws_for(const LawSources& sources, const MacroSpec& spec) {
  return {pair_law_of(sources.card, spec, "pair")};
}

}  // namespace softgrain
