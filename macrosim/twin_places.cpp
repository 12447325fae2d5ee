#include "macrosim/twin_places.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/contact_tensors.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/slow_dynamics.h"
#include "common/dynamics/verlet.h"
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

/// Rates of a strain in motion [1/s].
struct StrainRates {
  Vec3 shrink{};       ///< of the edges
  double slide = 0.0;  ///< of displacement against x over the height
};

/// The motion of a box whose edges shrink and that slides at these rates: of its walls or cell, and of all bodies with
/// it. What is taken off at the end is that of the places where bodies are then.
Drive straining(const MacroSystem& macro, const StrainRates& rates) {
  return [&macro, rate = rates.shrink, slide = rates.slide](System3& s, double share) {
    const Vec3 centre = box_centre(s, macro.box);
    auto& p = s.particles;
    for (std::size_t u = 0; u < at(p.size()); ++u) {
      const Vec3 place = carried_place(s, u);
      for (int k = 0; k < 3; ++k) p.velocity[u][k] -= share * rate[k] * (place[k] - centre[k]);
      if (slide != 0.0) p.velocity[u][0] -= share * slide * place[2];
    }
    if (!macro.box.periodic) return;
    for (int k = 0; k < 3; ++k) s.cell.velocity_gradient[k][k] = share > 0.0 ? -rate[k] : 0.0;
    s.cell.velocity_gradient[0][2] = share > 0.0 ? -slide : 0.0;
  };
}

/// Planes go straight to where they have to be; the cell's edges, whose rate is one of what they are, as a logarithm.
Vec3 rates_of(const Vec3& strain, double duration, bool periodic) {
  Vec3 rate{};
  for (int k = 0; k < 3; ++k) rate[k] = (periodic ? -std::log1p(-strain[k]) : strain[k]) / duration;
  return rate;
}

/// How long an increment takes: neighbours of the largest radius come towards each other at the speed of the twin [s].
double straining_time(const MacroSystem& macro, const MacroSpec& spec, const Vec3& strain, double shear) {
  const double wave_speed = std::sqrt(spec.youngs_modulus / spec.density);
  const double largest = std::max({std::abs(strain[0]), std::abs(strain[1]), std::abs(strain[2]), std::abs(shear)});
  return largest * 2.0 * macro.largest_radius / (spec.twin.speed * wave_speed);
}

/// Planes are driven and nothing else moves them: no velocity of theirs is left behind by rounding.
void stop_walls(System3& s) {
  for (Slot i = s.particles.first_plane(); i < s.particles.size(); ++i) s.particles.velocity[at(i)] = {};
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

void strain_in_motion(MacroSystem& macro, const MacroSpec& spec, const Vec3& strain, double shear) {
  const double wave_speed = std::sqrt(spec.youngs_modulus / spec.density);
  if (const double duration = straining_time(macro, spec, strain, shear); duration > 0.0) {
    const StrainRates rates{rates_of(strain, duration, macro.box.periodic), shear / duration};
    run_slow(macro, straining(macro, rates), duration, spec.twin.step_factor);
    stop_walls(macro.system);
  }
  const double settle = spec.twin.settle_time * spec.soft_radius_max / wave_speed;
  if (settle > 0.0) run_slow(macro, {}, settle, spec.twin.step_factor);
  stop_motion(macro.system.particles);
}

double straining_rate(const MacroSystem& macro, const MacroSpec& spec, const Vec3& strain, double shear) {
  const double duration = straining_time(macro, spec, strain, shear);
  if (!(duration > 0.0)) return 0.0;
  const Vec3 rate = rates_of(strain, duration, macro.box.periodic);
  Matrix<3> gradient;
  for (int k = 0; k < 3; ++k) gradient[k][k] = -rate[k];
  gradient[0][2] = shear / duration;
  return shear_rate(gradient);
}

}  // namespace softgrain
