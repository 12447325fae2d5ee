#include "microsim/particles/guards.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/core/vec.h"
#include "common/data/rows.h"
#include "common/dynamics/verlet.h"
#include "common/io/scene.h"

namespace softgrain {

namespace {

/// Grains up to which every 64th step is looked at, above it every 512th.
constexpr Slot kFewGrains = 1000;

/// Why the mechanical energy of a scene may grow; empty when it may not.
template <int D>
std::string driven_by(const System<D>& s) {
  for (int k = 0; k < D; ++k) {
    if (norm2(s.cell.velocity_gradient[k]) > 0.0) return "the cell is deformed";
    if (s.cell.periodic[at(k)] && s.gravity[k] != 0.0) return "gravity points along a periodic axis";
  }
  const auto& p = s.particles;
  for (Slot i = 0; i < p.size(); ++i)
    if ((p.inverse_mass[at(i)] == 0.0 && norm2(p.velocity[at(i)]) > 0.0) ||
        (p.inverse_inertia[at(i)] == 0.0 && norm2(p.spin[at(i)]) > 0.0))
      return "a body is moved at a given velocity";
  return "";
}

/// Potential energy of gravity and of the loads on planes [J].
template <int D>
double potential_energy(const System<D>& s) {
  const auto& p = s.particles;
  double sum = 0.0;
  for (Slot i = 0; i < p.first_plane(); ++i)
    if (p.inverse_mass[at(i)] > 0.0) sum -= dot(s.gravity, p.sphere[at(i)].x) / p.inverse_mass[at(i)];
  for (Slot w = p.first_plane(); w < p.size(); ++w)
    if (p.inverse_mass[at(w)] > 0.0)
      sum -= p.plane_load[at(w - p.first_plane())] * dot(p.normal_of(w), p.sphere[at(w)].x);
  return sum;
}

/// Twice the longest way of a wall moved by forces through all grains; infinite without such walls or grains.
template <int D>
double default_travel(const System<D>& s) {
  const auto& p = s.particles;
  double longest = 0.0;
  for (Slot w = p.first_plane(); w < p.size(); ++w) {
    if (!(p.inverse_mass[at(w)] > 0.0)) continue;
    for (Slot i = 0; i < p.grains; ++i)
      longest =
          std::max(longest, std::abs(dot(p.sphere[at(i)].x - p.sphere[at(w)].x, p.normal_of(w))) + p.sphere[at(i)].r);
  }
  return longest > 0.0 ? 2.0 * longest : kInfinity;
}

/// Whether some law was measured over a range that it can leave.
bool has_measured_law(const LawSet& laws) {
  for (std::int32_t k = 0; k < laws.size(); ++k)
    if (traits_of(laws.law(k)).is_fitted) return true;
  return false;
}

template <int D>
std::string body(const System<D>& s, Slot slot) {
  if (slot >= s.particles.grains) return "wall " + std::to_string(slot - s.particles.grains);
  const auto& id = s.particles.id;
  return "particle " + std::to_string(id.empty() ? slot : id[at(slot)]);
}

// What stands in a row of each data set of a checkpoint.

constexpr auto kRecord = [](auto&& visit, auto& r) {
  visit(r.worst);
  visit(r.count);
  visit(r.first_time);
};
constexpr auto kLookCounts = [](auto&& visit, auto& report) {
  visit(report.looks);
  visit(report.laws.evaluations);
  visit(report.laws.beyond);
  visit(report.laws.rejected);
  visit(report.laws.clamped);
};

/// The four records, by the names of their data sets.
void guard_records(auto&& visit, auto& report) {
  visit("overlap", report.overlap);
  visit("energy", report.energy);
  visit("escape", report.escape);
  visit("wall_travel", report.wall_travel);
}

}  // namespace

namespace {

const Key kActionKey{"action",
                     "`\"count\"`: a remark in the summary; `\"stop\"`: the run ends in its present state, "
                     "marked not usable, exit status 3"};

/// Reads as many components as the scene has dimensions; the others are zero and never looked at.
Vec3 read_corner(const SceneTable& t, const Key& key, int dimension) {
  return dimension == 3 ? t.vector3(key, Unit::length) : in_space<2>(read_vector<2>(t, key, Unit::length));
}

}  // namespace

namespace {

/// Limits of a guard that looks at nothing.
void refuse_idle(const SceneTable& t, const GuardRule& rule, std::initializer_list<const char*> keys) {
  if (rule.action != GuardAction::ignore) return;
  t.refuse(keys, "nothing is watched with action = \"ignore\"");
}

}  // namespace

GuardSpec read_guards(const SceneTable& t, int dimension) {
  GuardSpec out;
  const SceneTable overlap = t.table_or_empty({"overlap", "guard of deep overlaps"});
  out.overlap.limit = overlap.number({"limit", "largest overlap over the smaller radius"}, Unit::none,
                                     Range::positive(), out.overlap.limit);
  out.overlap.action = overlap.choice<GuardAction>(kActionKey, out.overlap.action);
  refuse_idle(overlap, out.overlap, {"limit"});
  const SceneTable energy = t.table_or_empty({"energy", "guard of the energy of scenes that nothing drives"});
  out.energy.limit = energy.number(
      {"limit",
       "scenes that nothing drives: kinetic, stored and potential energy above its smallest value so far, "
       "over the largest kinetic plus stored energy"},
      Unit::none, Range::positive(), out.energy.limit);
  out.energy.action = energy.choice<GuardAction>(kActionKey, out.energy.action);
  refuse_idle(energy, out.energy, {"limit"});
  const SceneTable escape = t.table_or_empty(
      {"escape", "guard of particles that leave: centres behind a plane, or outside the box from `low` to `high`"});
  if (escape.has("low"))
    out.low = read_corner(escape, {"low", "lower corner of the box that no centre may leave", "no box"}, dimension);
  if (escape.has("high"))
    out.high = read_corner(escape, {"high", "upper corner of the box that no centre may leave", "no box"}, dimension);
  for (int k = 0; out.low && out.high && k < dimension; ++k)
    if (!((*out.low)[k] < (*out.high)[k])) escape.add_error("high", "must be above low along every axis");
  out.escape.action = escape.choice<GuardAction>(kActionKey, out.escape.action);
  refuse_idle(escape, out.escape, {"low", "high"});
  const SceneTable wall = t.table_or_empty({"wall", "guard of planes with a load that run away"});
  out.wall_travel.limit = wall.number({"travel", "largest distance that a plane with a load may have moved",
                                       "twice the distance through all particles"},
                                      Unit::length, Range::positive(), 0.0);
  out.wall_travel.action = wall.choice<GuardAction>(kActionKey, out.wall_travel.action);
  refuse_idle(wall, out.wall_travel, {"travel"});
  return out;
}

template <int D>
Guards<D>::Guards(const GuardSpec& spec, const System<D>& start) : spec_(spec) {
  const auto& p = start.particles;
  report_.every = p.grains <= kFewGrains ? 64 : 512;
  report_.energy_unwatched = driven_by(start);
  if (spec_.energy.action == GuardAction::ignore) report_.energy_unwatched = "the scene asks for that";
  report_.wall_travel_limit = spec.wall_travel.limit > 0.0 ? spec.wall_travel.limit : default_travel(start);
  const auto active = [](const GuardRule& rule) { return rule.action != GuardAction::ignore; };
  watches_ = active(spec.overlap) || active(spec.energy) || active(spec.escape) || active(spec.wall_travel) ||
             has_measured_law(start.laws);
  for (Slot w = p.first_plane(); w < p.size(); ++w) wall_start_.push_back(p.sphere[at(w)].x);
  least_ = kInfinity;
}

template <int D>
void Guards<D>::note(const GuardRule& rule, double value, double time, GuardRecord& record, const std::string& what) {
  record.worst = larger_or_nan(record.worst, value);
  if (value <= rule.limit) return;
  if (record.count++ == 0) record.first_time = time;
  if (rule.action == GuardAction::stop) throw UnusableResult(what);
}

template <int D>
void Guards<D>::look_at_energy(const System<D>& s, const ContactWatch<D>& watch) {
  if (!report_.energy_unwatched.empty()) return;
  if (!watch.energy_known) {
    report_.energy_unwatched = "a contact law has no energy of its own";
    return;
  }
  const double kinetic = kinetic_energy(s.particles);
  const double energy = kinetic + watch.stored + potential_energy(s);
  scale_ = larger_or_nan(scale_, kinetic + std::abs(watch.stored));
  if (energy < least_) least_ = energy;
  if (scale_ == 0.0) return;
  const double growth = (energy - least_) / scale_;
  std::ostringstream what;
  if (std::isnan(growth))
    what << "the energy of the scene is not a number";
  else
    what << "energy grows although nothing drives the scene: by " << 100.0 * growth
         << " % of the most that moved or was stored (guards.energy.limit " << 100.0 * spec_.energy.limit
         << " %); take a shorter step, or tangential = \"rescaled\"";
  note(spec_.energy, growth, s.time, report_.energy, what.str());
}

template <int D>
void Guards<D>::look_at_grains(const System<D>& s, const ContactWatch<D>& watch) {
  const auto& p = s.particles;
  if (spec_.overlap.action != GuardAction::ignore && watch.i >= 0) {
    std::ostringstream what;
    what << body(s, watch.i) << " and " << body(s, watch.j) << " overlap by " << watch.overlap
         << " of the smaller radius (guards.overlap.limit " << spec_.overlap.limit << ")";
    note(spec_.overlap, watch.overlap, s.time, report_.overlap, what.str());
  }
  if (spec_.escape.action == GuardAction::ignore) return;
  const std::vector<Slot>& behind = watch.behind_planes;
  auto outside = std::ssize(behind);
  Slot first = behind.empty() ? -1 : behind.back();
  for (Slot i = 0; (spec_.low || spec_.high) && i < p.grains; ++i) {
    const Vec<D>& x = p.sphere[at(i)].x;
    bool in = true;
    for (int k = 0; k < D; ++k)
      in = in && !(spec_.low && x[k] < (*spec_.low)[k]) && !(spec_.high && x[k] > (*spec_.high)[k]);
    if (in) continue;
    if (!std::binary_search(behind.begin(), behind.end(), i)) ++outside;
    first = i;
  }
  note(spec_.escape, static_cast<double>(outside), s.time, report_.escape,
       first < 0 ? ""
                 : body(s, first) + " has escaped: " +
                       (std::binary_search(behind.begin(), behind.end(), first) ? "its centre is behind a wall"
                                                                                : "it is outside guards.escape"));
}

template <int D>
void Guards<D>::look_at_walls(const System<D>& s) {
  if (spec_.wall_travel.action == GuardAction::ignore) return;
  const auto& p = s.particles;
  for (Slot w = p.first_plane(); w < p.size(); ++w) {
    if (!(p.inverse_mass[at(w)] > 0.0)) continue;
    const double travel = norm(p.sphere[at(w)].x - wall_start_[at(w - p.first_plane())]);
    std::ostringstream what;
    what << body(s, w) << ", which its load moves, runs away: it has gone " << travel << " m (guards.wall.travel "
         << report_.wall_travel_limit << " m)";
    note({report_.wall_travel_limit, spec_.wall_travel.action}, travel, s.time, report_.wall_travel, what.str());
  }
}

template <int D>
void Guards<D>::look(const System<D>& s) {
  if (!watches_) return;
  const ContactWatch<D> watch = watch_contacts(s);
  ++report_.looks;
  report_.laws += watch.laws;
  look_at_grains(s, watch);
  look_at_walls(s);
  look_at_energy(s, watch);
  if (watch.laws.rejected > 0) throw UnusableResult("soft contacts: " + law_use_text(watch.laws));
}

template <int D>
struct Guards<D>::Numbers {
  void operator()(auto&& visit, auto& guards) const {
    visit(guards.least_);
    visit(guards.scale_);
    visit(guards.report_.laws.max_range_ratio);
  }
};

template <int D>
void Guards<D>::save(const h5::Group& g) const {
  guard_records([&](const char* name, const GuardRecord& record) { write_row(g, name, record, kRecord); }, report_);
  write_row(g, "laws", report_, kLookCounts);
  write_row(g, "numbers", *this, Numbers{});
  g.attribute("energy_unwatched", report_.energy_unwatched);
}

template <int D>
void Guards<D>::load(const h5::Group& g) {
  guard_records([&](const char* name, GuardRecord& record) { read_row(g, name, record, kRecord); }, report_);
  read_row(g, "laws", report_, kLookCounts);
  read_row(g, "numbers", *this, Numbers{});
  report_.energy_unwatched = g.text("energy_unwatched");
}

template class Guards<2>;
template class Guards<3>;

}  // namespace softgrain
