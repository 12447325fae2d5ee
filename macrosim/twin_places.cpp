#include "macrosim/twin_places.h"

#include "common/core/error.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/verlet_list.h"
#include "macrosim/body_contacts.h"

namespace softgrain {

namespace {

void add_forces(const SoftForces& f, const std::string& engine, MacroCurve& curve) {
  const std::array values{f.solid, f.wall, f.soft};
  for (std::size_t k = 0; k < values.size(); ++k)
    curve.more[places_column(engine, kPlacesPartners[k])].push_back(values[k]);
}

/// Row of MacroCurve::places for a packing.
std::vector<double> row_of(const MacroPacking& p) {
  std::vector<double> row;
  const auto add = [&](const Vec3& x) {
    for (int a = 0; a < 3; ++a) row.push_back(x[a]);
  };
  add(p.low);
  add(p.high);
  for (const MacroBody& b : p.bodies) add(b.x);
  return row;
}

MacroPacking packing_at(const std::vector<double>& row, const MacroPacking& packing) {
  MacroPacking out = packing;
  auto next = row.begin();
  const auto take = [&](Vec3& x) {
    for (int a = 0; a < 3; ++a) x[a] = *next++;
  };
  take(out.low);
  take(out.high);
  for (MacroBody& b : out.bodies) take(b.x);
  out.springs.clear();
  return out;
}

}  // namespace

SoftForces soft_forces(const MacroSystem& macro, const MacroPacking& packing) {
  SoftForces sum;
  for (const BodyContact& c : body_contacts(macro, contact_records(macro.system))) {
    const bool a_soft = packing.bodies[at(c.a)].soft;
    if (c.b >= macro.bodies) {
      if (a_soft) sum.wall += c.normal_force;
      continue;
    }
    const bool b_soft = packing.bodies[at(c.b)].soft;
    if (a_soft && b_soft)
      sum.soft += c.normal_force;
    else if (a_soft || b_soft)
      sum.solid += c.normal_force;
  }
  return sum;
}

MacroPacking packing_of_twin(const MacroSystem& twin, const MacroPacking& packing) {
  const auto& p = twin.system.particles;
  MacroPacking out = packing;
  out.low = box_low(twin.system, twin.box);
  out.high = box_high(twin.system, twin.box);
  out.springs.clear();
  for (Slot u = 0; u < p.first_plane(); ++u) {
    MacroBody& body = out.bodies[at(twin.body[at(u)])];
    if (!body.soft || u >= p.grains) body.x = p.sphere[at(u)].x;
  }
  return out;
}

void record_places(const MacroSystem& twin, const MacroPacking& packing, MacroCurve& curve) {
  add_forces(soft_forces(twin, packing), curve.engine, curve);
  curve.places.push_back(row_of(packing_of_twin(twin, packing)));
}

void place_laws(const MacroSpec& spec, const MacroPacking& packing, double inner_solid_fraction,
                const std::vector<PlacedLaw>& laws, MacroCurve& curve) {
  for (const std::vector<double>& row : curve.places) {
    const MacroPacking places = packing_at(row, packing);
    for (const PlacedLaw& law : laws) {
      MacroSystem macro = make_law_system(spec, places, law.laws, inner_solid_fraction);
      rebuild_neighbours(macro.system);
      add_forces(soft_forces(macro, places), law.name, curve);
    }
  }
}

std::string places_column(const std::string& engine, const char* partner) { return "places_" + engine + "_" + partner; }

}  // namespace softgrain
