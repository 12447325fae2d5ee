// Histories of contacts across rebuilds of the list: each stays with its pair, none is lost, doubled or swapped.
#include <gtest/gtest.h>

#include <map>

#include "common/contact/hertz_mindlin.h"
#include "common/neighbours/verlet_list.h"
#include "tests/property/random_cloud.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

using Bodies = std::pair<Slot, Slot>;

/// Two materials with laws of their own (one remembers more than the other), a shell around half of the grains, a
/// plane.
System3 mixed_system(const CloudShape& shape) {
  System3 s;
  s.materials = {{"glass", 2500.0, 1e7, 0.25, false}, {"steel", 7800.0, 2e8, 0.3, false}};
  s.laws = LawSet(2);
  for (std::int32_t a = 0; a < 2; ++a)
    for (std::int32_t b = a; b < 2; ++b) {
      const auto k = HertzCoefficients::of(s.materials[static_cast<std::size_t>(a)],
                                           s.materials[static_cast<std::size_t>(b)], 0.1 + 0.2 * a + 0.1 * b, 0.9);
      s.laws.set(a, b, hertz_law(k, a == b));
    }
  s.cell = cell_of<3>(shape);
  add_cloud(shape, s.cell, s.particles);
  RandomStream random(shape.seed, RandomPurpose::test, 2);
  Particles<3>& p = s.particles;
  for (std::int32_t& m : p.material) m = random.uniform() < 0.5 ? 0 : 1;
  if (s.cell.any_periodic()) return s;  // walls have no images
  NewBody<3> shell;
  shell.x = s.cell.edges * Vec3{{0.5, 0.5, 0.5}};
  shell.r = norm(s.cell.edges * Vec3{{1.0, 1.0, 1.0}});
  const Slot slot = add_shell(p, shell);
  for (Slot i = 0; i < p.grains; i += 2) p.shell[static_cast<std::size_t>(i)] = slot;
  NewBody<3> plane;
  plane.x = {{0.3, 0.0, 0.0}};
  (void)add_plane(p, plane, Vec3{{1.0, 0.0, 0.0}});
  return s;
}

/// A number that no other pair, or rebuild, has.
double mark_of(const Bodies& pair, int round) { return 1.0 + pair.first + 1e4 * pair.second + 1e8 * round; }

/// Gives every second listed pair a history of its own; the others are new.
std::map<Bodies, double> mark(System3& s, int round) {
  std::map<Bodies, double> marks;
  for (std::size_t c = 0; c < s.contacts.i.size(); c += 2) {
    const Bodies pair{s.contacts.i[c], s.contacts.j[c]};
    marks[pair] = mark_of(pair, round);
    s.contacts.spring[c] = Vec3{{marks[pair], -2.0 * marks[pair], 0.5 * marks[pair]}};
    s.contacts.memory[c] = 3.0 * marks[pair];
  }
  for (std::size_t c = 1; c < s.contacts.i.size(); c += 2) {
    s.contacts.spring[c] = Vec3{};
    s.contacts.memory[c] = 0.0;
  }
  return marks;
}

void require_marks(const System3& s, const std::map<Bodies, double>& marks) {
  std::map<Bodies, int> seen;
  for (std::size_t c = 0; c < s.contacts.i.size(); ++c) {
    const Bodies pair{s.contacts.i[c], s.contacts.j[c]};
    RC_ASSERT(++seen[pair] == 1);
    const auto found = marks.find(pair);
    const double expected = found == marks.end() ? 0.0 : found->second;
    const Vec3 spring = s.contacts.spring[c];
    RC_ASSERT((spring == Vec3{{expected, -2.0 * expected, 0.5 * expected}}));
    RC_ASSERT(s.contacts.memory[c] == 3.0 * expected);
  }
}

RC_GTEST_PROP(HistoryProperty, HistoriesStayWithTheirPairs, ()) {
  CloudShape shape = any_cloud(80);
  shape.decades *= 0.4;
  if (*rc::gen::arbitrary<bool>()) shape.periodic = 0;
  System3 s = mixed_system(shape);
  RandomStream random(shape.seed, RandomPurpose::test, 3);
  const double step = 3.0 * share();
  rebuild_neighbours(s);
  RC_ASSERT(s.contacts.has_spring && s.contacts.has_memory);
  for (int round = 0; round < 6; ++round) {
    const auto marks = mark(s, round);
    shake(s, step, random);
    rebuild_neighbours(s);
    require_marks(s, marks);
  }
}

/// A pair that leaves the list comes back without its history.
RC_GTEST_PROP(HistoryProperty, WhatPartedHasForgotten, ()) {
  CloudShape shape = any_cloud(40);
  shape.decades = 0.0;
  shape.periodic = 0;
  System3 s = mixed_system(shape);
  rebuild_neighbours(s);
  const auto marks = mark(s, 0);
  const auto places = s.particles.sphere;
  for (Slot i = 0; i < s.particles.grains; ++i)
    s.particles.sphere[static_cast<std::size_t>(i)].x = Vec3{{4.0, 0.0, 0.0}} + Vec3{{0.0, 1.0, 0.0}} * (0.01 * i);
  for (Slot i = 0; i < s.particles.grains; ++i) s.particles.shell[static_cast<std::size_t>(i)] = -1;
  for (Slot i = 0; i < s.particles.grains; ++i) s.particles.sphere[static_cast<std::size_t>(i)].x[2] = 100.0 * i;
  rebuild_neighbours(s);
  RC_ASSERT(s.contacts.size() == 0);
  s.particles.sphere = places;
  rebuild_neighbours(s);
  require_marks(s, {});
}

}  // namespace
