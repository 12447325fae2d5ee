#include "macrosim/grain_record.h"

#include <fmt/format.h>

#include <array>

#include "common/core/particles.h"
#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

using Contacts = std::vector<ContactRecord<3>>;

double solid_fraction(const MacroSystem& macro) {
  const Vec3 size = box_high(macro.system, macro.box) - box_low(macro.system, macro.box);
  double volume = 0.0;
  for (std::size_t u = 0; u < at(macro.system.particles.grains); ++u)
    volume += kSphereVolume * cube(macro.system.particles.sphere[u].r);
  return volume / (size[0] * size[1] * size[2]);
}

/// Grains with too few contacts go, until all that are left hold each other.
double rattling_share(const MacroSystem& macro, const Contacts& contacts, int needed) {
  const auto& p = macro.system.particles;
  std::vector<int> count(at(p.size()), 0);
  std::vector<std::vector<Slot>> partners(at(p.grains));
  const auto add = [&](Slot a, Slot b) {
    if (a >= p.grains) return;
    ++count[at(a)];
    if (b < p.grains) partners[at(a)].push_back(b);
  };
  for (const auto& c : contacts) {
    add(c.i, c.j);
    add(c.j, c.i);
  }
  std::vector<Slot> loose;
  std::vector<bool> gone(at(p.grains), false);
  const auto look_at = [&](Slot i) {
    if (gone[at(i)] || count[at(i)] >= needed) return;
    gone[at(i)] = true;
    loose.push_back(i);
  };
  for (Slot i = 0; i < p.grains; ++i) look_at(i);
  for (std::size_t k = 0; k < loose.size(); ++k)
    for (const Slot j : partners[at(loose[k])]) {
      --count[at(j)];
      look_at(j);
    }
  return static_cast<double>(loose.size()) / static_cast<double>(p.grains);
}

/// Shares of the sum of force times branch over all contacts, in the order of Bearers.
std::array<double, 3> shares(const MacroSystem& macro, const Contacts& contacts, double coarse) {
  const auto& p = macro.system.particles;
  std::array<double, 3> sum{};
  double all = 0.0;
  for (const auto& c : contacts) {
    const double virial = dot(c.normal * c.normal_force + c.tangential_force, c.branch);
    all += virial;
    if (c.j >= p.grains) continue;
    const int fine = (p.sphere[at(c.i)].r < coarse ? 1 : 0) + (p.sphere[at(c.j)].r < coarse ? 1 : 0);
    sum[static_cast<std::size_t>(fine)] += virial;
  }
  for (double& s : sum) s = all > 0.0 ? s / all : 0.0;
  return sum;
}

}  // namespace

std::string share_name(Bearers bearers, double split) { return fmt::format("{} {:.4g}", to_string(bearers), split); }

void record_grains(const MacroSystem& macro, const MacroSpec& spec, MacroCurve& curve) {
  const Contacts contacts = contact_records(macro.system);
  curve.more[kSolidFraction].push_back(solid_fraction(macro));
  curve.more[kRattlers].push_back(rattling_share(macro, contacts, contacts_that_hold(spec)));
  for (const double split : spec.splits) {
    const auto share = shares(macro, contacts, split * macro.largest_radius);
    for (const Bearers b : {Bearers::coarse_coarse, Bearers::coarse_fine, Bearers::fine_fine})
      curve.more[share_name(b, split)].push_back(share[static_cast<std::size_t>(b)]);
  }
}

}  // namespace softgrain
