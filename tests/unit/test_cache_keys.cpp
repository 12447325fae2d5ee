// Keys of results that are kept for later runs: each member of all that determines a result, changed by itself, changes
// the key, and members that are no part of it change no result. Schemas are held to the results that they stand for.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "macrosim/compression.h"
#include "macrosim/constructed_packing.h"
#include "macrosim/preparation.h"
#include "microsim/shell_packing.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/twin_cache.h"
#include "tests/support/multi_contact.h"

namespace softgrain {
namespace {

/// Goes over all leaves of a record, those of its members and of what these hold, and changes the one with a number.
class OneChange {
 public:
  explicit OneChange(std::size_t leaf) : leaf_(leaf) {}

  template <class T>
  void go(T& value) {
    if constexpr (std::is_same_v<T, bool>)
      change([&] { value = !value; }, &value);
    else if constexpr (std::is_floating_point_v<T>)
      change([&] { value = std::isfinite(value) ? std::nextafter(value, 1e300) : 1.0; }, &value);
    else if constexpr (std::is_integral_v<T>)
      change([&] { value = value > 1000 ? value - 1 : value + 1; }, &value);
    else if constexpr (std::is_enum_v<T>)
      change([&] { value = static_cast<T>(static_cast<std::int64_t>(value) == 0 ? 1 : 0); }, &value);
    else if constexpr (std::is_same_v<T, std::string>)
      change([&] { value += "x"; }, &value);
    else if constexpr (std::is_same_v<T, Grading>)
      change([&] { value = Grading::power_law(2.125, 1e-3, 2e-3); }, &value);
    else
      into(value);
  }

  [[nodiscard]] std::size_t leaves() const { return seen_; }
  [[nodiscard]] const void* changed() const { return changed_; }

 private:
  void change(const auto& how, const void* where) {
    if (seen_++ != leaf_) return;
    how();
    changed_ = where;
  }
  template <class T>
  void into(std::optional<T>& value) {
    if (value) go(*value);
    change([&] { value.reset(); }, &value);
  }
  template <class T>
  void into(std::vector<T>& values) {
    for (T& value : values) go(value);
    change([&] { values.push_back(values.back()); }, &values);
  }
  template <class T, std::size_t kCount>
  void into(std::array<T, kCount>& values) {
    for (T& value : values) go(value);
  }
  template <int D>
  void into(Vec<D>& value) {
    into(value.v);
  }
  template <HasEveryMember T>
  void into(T& record) {
    std::apply([this](auto&... members) { (go(members), ...); }, every_member(record));
  }

  std::size_t leaf_;
  std::size_t seen_ = 0;
  const void* changed_ = nullptr;
};

template <class T>
std::size_t count_leaves(T record) {
  OneChange none(static_cast<std::size_t>(-1));
  none.go(record);
  return none.leaves();
}

/// Whether a place is within a member.
template <class M>
bool within(const M& member, const void* place) {
  const auto* begin = reinterpret_cast<const char*>(&member);
  const auto* at = static_cast<const char*>(place);
  return at >= begin && at < begin + sizeof member;
}

/// Each leaf once: the key changes, unless it is of a member that `outside` names, whose leaves change nothing.
template <class T>
void expect_in_key(const T& record, const std::function<std::string(const T&)>& key,
                   const std::function<bool(const T&, const void*)>& outside) {
  const std::string before = key(record);
  std::set<std::string> keys{before};
  std::size_t within_key = 0;
  for (std::size_t leaf = 0; leaf < count_leaves(record); ++leaf) {
    T other = record;
    OneChange change(leaf);
    change.go(other);
    ASSERT_NE(change.changed(), nullptr);
    if (outside(other, change.changed())) {
      EXPECT_EQ(key(other), before) << "leaf " << leaf;
      continue;
    }
    ++within_key;
    EXPECT_TRUE(keys.insert(key(other)).second)
        << "leaf " << leaf << ", at byte "
        << static_cast<const char*>(change.changed()) - reinterpret_cast<const char*>(&other)
        << " of the record, is no part of the key";
  }
  EXPECT_GT(within_key, 0U);
}

/// With something in every list and option.
MacroSpec full_spec() {
  MacroSpec spec;
  spec.solid_sizes = Grading::power_law(3.0, 1e-3, 3e-3);
  spec.soft_sizes = Grading::power_law(2.5, 1e-3, 3e-3);
  spec.cells = CellMatter{};
  spec.cells->card.memory = CellMemory{};
  spec.cells->card.correlation = {{"K"}, {1.0}};
  spec.cells->card.preparations = {{"slow", {0.97, 0.01, 0.95, 0.99}}};
  spec.packing_text = "x,y,z";
  spec.splits = {0.25};
  spec.test = MacroTest::stages;
  MacroStage stage;
  stage.record.name = "press";
  stage.record.by_stress = std::array{false, false, true};
  stage.axis[2] = {false, 0.1, -1};
  spec.stages = {stage};
  spec.grain_materials.each = {{"stone", 5e9, 0.2, 0.4, 2600.0}};
  return spec;
}

/// Members of no effect on a packing: those of the test that follows it; walls have its friction, and contacts its
/// rolling resistance, where a preparation has friction.
bool of_the_test(const MacroSpec& s, const void* place) {
  const bool rough_walls = s.protocol.friction > 0.0 && s.boundary == Boundary::walls;
  return within(s.friction, place) || (!rough_walls && within(s.wall_friction, place)) ||
         (!(s.protocol.friction > 0.0) && within(s.rolling, place)) || within(s.test, place) ||
         within(s.modulus_stress, place) || within(s.strain_end, place) || within(s.preload, place) ||
         within(s.preload_steps, place) || within(s.steps, place) || within(s.increments_per_step, place) ||
         within(s.tolerance, place) || within(s.force_floor, place) || within(s.max_passes, place) ||
         within(s.twin, place) || within(s.kt_secant, place) || within(s.splits, place) || within(s.stages, place) ||
         (!s.splits.empty() && within(s.splits.front(), place)) ||
         (!s.stages.empty() && (within(s.stages.front(), place)));
}

TEST(CacheKeys, EveryMemberOfASpecIsInTheKeyOfItsPacking) {
  MacroSpec rough = full_spec();
  rough.protocol.friction = 0.3;
  for (const MacroSpec& full : {full_spec(), rough})
    expect_in_key<MacroSpec>(
        full, [](const MacroSpec& s) { return packing_key(s, 1, 0); }, of_the_test);
  const MacroSpec spec;
  EXPECT_NE(packing_key(spec, 1, 0), packing_key(spec, 2, 0));
  EXPECT_NE(packing_key(spec, 1, 0), packing_key(spec, 1, 1));
  EXPECT_NE(packing_key(spec, 11, 0), packing_key(spec, 1, 10));
}

MacroSpec small_spec(Preparation preparation, Boundary boundary = Boundary::walls) {
  MacroSpec spec;
  spec.bodies = boundary == Boundary::periodic ? 40 : 10;
  spec.soft_share = 0.3;
  spec.boundary = boundary;
  spec.preparation = preparation;
  spec.protocol = protocol_of(preparation, spec.friction);
  spec.grain_materials.each = {{"stone", spec.youngs_modulus, spec.poisson_ratio, spec.friction, spec.density}};
  return spec;
}

void expect_same_packing(const MacroPacking& a, const MacroPacking& b) {
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_EQ(a.bodies[k].x, b.bodies[k].x);
    EXPECT_EQ(a.bodies[k].r, b.bodies[k].r);
    EXPECT_EQ(a.bodies[k].soft, b.bodies[k].soft);
  }
  EXPECT_EQ(a.high, b.high);
  EXPECT_EQ(a.springs.size(), b.springs.size());
}

TEST(CacheKeys, WhatIsNoPartOfTheKeyOfAPackingChangesNoPacking) {
  for (const Preparation preparation :
       {Preparation::frictionless, Preparation::fast, Preparation::dense, Preparation::lammps}) {
    const MacroSpec spec = small_spec(preparation);
    MacroSpec other = spec;
    other.splits = {0.5};
    other.stages = full_spec().stages;
    for (std::size_t leaf = 0; leaf < count_leaves(other); ++leaf) {
      MacroSpec changed = other;
      OneChange change(leaf);
      change.go(changed);
      const void* place = change.changed();  // lists keep their length, so that each leaf keeps its number
      if (of_the_test(changed, place) && !within(changed.splits, place) && !within(changed.stages, place))
        other = changed;
    }
    EXPECT_NE(other.friction, spec.friction);
    EXPECT_NE(other.twin.speed, spec.twin.speed);
    other.friction = 0.9;  // and by more than a digit
    if (of_the_test(other, &other.wall_friction)) other.wall_friction = 0.4;
    other.strain_end = 0.3;
    other.tolerance = 0.2;
    other.force_floor = 1e-3;
    other.max_passes = 7;
    other.steps = 3;
    EXPECT_EQ(packing_key(spec, 1, 0), packing_key(other, 1, 0));
    expect_same_packing(make_packing(spec, 1, 0), make_packing(other, 1, 0));
  }
}

TEST(CacheKeys, WallsOfARoughPreparationHaveTheFrictionOfTheTest) {
  const MacroSpec smooth = small_spec(Preparation::fast);
  MacroSpec rough = smooth;
  rough.wall_friction = 0.4;
  EXPECT_NE(packing_key(smooth, 1, 0), packing_key(rough, 1, 0));
  EXPECT_NE(make_packing(smooth, 1, 0).high, make_packing(rough, 1, 0).high);
  MacroSpec periodic = smooth;
  periodic.boundary = Boundary::periodic;
  MacroSpec unused = periodic;
  unused.wall_friction = 0.4;
  EXPECT_EQ(packing_key(periodic, 1, 0), packing_key(unused, 1, 0));
}

struct SmallTwin {
  MacroSetup setup;
  MacroPacking packing;
  MacroSystem macro;
};

SmallTwin small_twin() {
  SmallTwin out;
  out.setup.spec = full_spec();
  out.packing.high = {{0.1, 0.1, 0.1}};
  out.packing.bodies = {{{{0.02, 0.02, 0.02}}, 0.016, false}, {{{0.05, 0.05, 0.05}}, 0.016, true}};
  out.packing.springs = {{0, 1, {{1e-6, 2e-6, 3e-6}}}};
  SoftParticleSpec inside;
  inside.trials = 100;
  inside.polydispersity = 3.0;
  MacroSpec spec = out.setup.spec;
  spec.cells.reset();
  spec.grain_materials.each.clear();
  out.macro = make_shelled_system(spec, out.packing, {generate_shell_packing(inside, 1, 0)}, 1, 0);
  return out;
}

TEST(CacheKeys, EveryMemberOfASpecIsInTheKeyOfItsTwin) {
  const SmallTwin twin = small_twin();
  const auto key = [&](const MacroSpec& s) {
    return twin_key(s, twin.setup, twin.packing, twin.macro, "shelled", 0, "macro");
  };
  expect_in_key<MacroSpec>(full_spec(), key, [](const MacroSpec& s, const void* place) {
    return within(s.kt_secant, place) || within(s.packing_text, place);
  });
  // The one that was missing: it sets how long a twin is left to settle.
  MacroSpec other = full_spec();
  other.soft_radius_max *= 1.5;
  EXPECT_NE(key(other), key(full_spec()));
}

TEST(CacheKeys, EveryMemberOfASpecIsInTheKeyOfATestOfAMaterial) {
  const SmallTwin twin = small_twin();
  expect_in_key<MacroSpec>(
      full_spec(),
      [&](const MacroSpec& s) {
        MacroSetup setup = twin.setup;
        setup.spec = s;
        return test_key(setup, twin.packing, 0);
      },
      [](const MacroSpec& s, const void* place) {
        return within(s.kt_secant, place) || within(s.packing_text, place);
      });
}

TEST(CacheKeys, SetupPackingAndSampleAreInTheKeys) {
  const SmallTwin twin = small_twin();
  std::set<std::string> twins;
  std::set<std::string> tests;
  std::size_t changes = 0;
  const auto add = [&](const MacroSetup& setup, const MacroPacking& packing, const MacroSystem& macro,
                       std::int64_t sample = 0, const std::string& engine = "shelled",
                       const std::string& runs = "macro") {
    ++changes;
    EXPECT_TRUE(twins.insert(twin_key(setup.spec, setup, packing, macro, engine, sample, runs)).second) << changes;
  };
  const auto add_test = [&](const MacroSetup& setup, const MacroPacking& packing, std::int64_t sample = 0) {
    ++changes;
    EXPECT_TRUE(tests.insert(test_key(setup, packing, sample)).second) << changes;
  };
  add(twin.setup, twin.packing, twin.macro);
  add(twin.setup, twin.packing, twin.macro, 1);
  add(twin.setup, twin.packing, twin.macro, 0, "free");
  add(twin.setup, twin.packing, twin.macro, 0, "shelled", "other");
  add_test(twin.setup, twin.packing);
  for (const auto member : {&MacroSetup::kept_states, &MacroSetup::noise_samples}) {
    MacroSetup setup = twin.setup;
    setup.*member += 1;
    add(setup, twin.packing, twin.macro);
    add_test(setup, twin.packing);
  }
  MacroSetup finer = twin.setup;
  finer.law_increments = 2;  // of runs with laws, and of materials
  add_test(finer, twin.packing);
  const auto with_packing = [&](const auto& change) {
    MacroPacking packing = twin.packing;
    change(packing);
    add_test(twin.setup, packing);
  };
  with_packing([](MacroPacking& p) { p.low[0] -= 1e-9; });
  with_packing([](MacroPacking& p) { p.high[2] += 1e-9; });
  with_packing([](MacroPacking& p) { p.bodies[0].x[1] += 1e-9; });
  with_packing([](MacroPacking& p) { p.bodies[1].r *= 1.001; });
  with_packing([](MacroPacking& p) { p.bodies[1].soft = false; });
  with_packing([](MacroPacking& p) { p.bodies[0].material = 1; });
  with_packing([](MacroPacking& p) { p.springs[0].spring[2] = 0.0; });
  with_packing([](MacroPacking& p) { p.springs.clear(); });
  MacroPacking wider = twin.packing;
  wider.high[0] += 1e-9;
  add(twin.setup, wider, twin.macro);
  wider = twin.packing;
  wider.springs[0].spring[0] = 0.0;
  add(twin.setup, wider, twin.macro);
  MacroSystem moved = twin.macro;
  moved.system.particles.sphere.front().x[0] += 1e-9;
  add(twin.setup, twin.packing, moved);
  moved = twin.macro;
  moved.system.particles.sphere.front().r *= 1.001;
  add(twin.setup, twin.packing, moved);
  moved = twin.macro;
  moved.body.front() += 1;
  add(twin.setup, twin.packing, moved);
}

TEST(CacheKeys, EveryMemberOfAMultiContactRunIsInItsKey) {
  const MultiContactConfiguration configuration = [] {
    MultiContactConfiguration c = test::multi_contact_of(PartnerKind::solid, 0.5, {Vec3{{1.0, 0.0, 0.0}}}, 0.3);
    c.partners.front().on = 0;
    return c;
  }();
  const MultiContactPlan plan{{0.5, 1.0}};
  SoftParticleSpec soft;
  soft.sizes = Grading::power_law(3.0, 1e-3, 3e-3);
  expect_in_key<SoftParticleSpec>(
      soft, [&](const SoftParticleSpec& s) { return multi_contact_run_key(s, configuration, plan, {}, "seed 1"); },
      [](const SoftParticleSpec&, const void*) { return false; });
  expect_in_key<MultiContactConfiguration>(
      configuration,
      [&](const MultiContactConfiguration& c) { return multi_contact_run_key(soft, c, plan, {}, "seed 1"); },
      [](const MultiContactConfiguration& c, const void* place) {
        return within(c.name, place) || within(c.held_out, place);
      });
  expect_in_key<MultiContactOptions>(
      {}, [&](const MultiContactOptions& o) { return multi_contact_run_key(soft, configuration, plan, o, "seed 1"); },
      [](const MultiContactOptions&, const void*) { return false; });
  expect_in_key<MultiContactPlan>(
      plan, [&](const MultiContactPlan& p) { return multi_contact_run_key(soft, configuration, p, {}, "seed 1"); },
      [](const MultiContactPlan&, const void*) { return false; });
  EXPECT_NE(multi_contact_run_key(soft, configuration, plan, {}, "seed 1"),
            multi_contact_run_key(soft, configuration, plan, {}, "seed 2"));
}

TEST(CacheKeys, ListsAndTextsCannotBeMistakenForEachOther) {
  const auto key = [](const auto&... values) { return KeyText(values...).text(); };
  using Lists = std::vector<std::vector<double>>;
  EXPECT_NE(key(Lists{{1.0}, {2.0}}), key(Lists{{1.0, 2.0}, {}}));
  EXPECT_NE(key(std::string("a b")), key(std::string("a"), std::string("b")));
  EXPECT_NE(key(std::string(1000, 'a')), key(std::string(1001, 'a')));
  EXPECT_NE(key(0.1), key(std::nextafter(0.1, 1.0)));
  EXPECT_NE(key(std::optional<double>{}), key(std::optional<double>{0.0}));
  EXPECT_LT(key(std::string(100000, 'a')).size(), 100U) << "keys have to fit into an attribute";
}

/// Box and places of a packing in two numbers.
std::array<double, 2> fingerprint(const MacroPacking& packing) {
  double sum = 0.0;
  for (std::size_t k = 0; k < packing.bodies.size(); ++k)
    for (int a = 0; a < 3; ++a) sum += (1.0 + 0.1 * static_cast<double>(k)) * packing.bodies[k].x[a];
  const Vec3 size = packing.size();
  return {size[0] * size[1] * size[2], sum};
}

struct PreparedPacking {
  Preparation preparation;
  Boundary boundary;
  std::array<double, 2> fingerprint;
};

/// When this fails, preparations have changed: packings of earlier versions that lie in caches are others. Raise
/// kPackingSchema, and put what is found here in place of these numbers.
TEST(CacheSchemas, PackingsAreThoseOfTheirSchema) {
  EXPECT_EQ(kPackingSchema, 4);
  const std::vector<PreparedPacking> prepared{
      {Preparation::frictionless, Boundary::walls, {0.000153444234, 1.36172463}},
      {Preparation::fast, Boundary::walls, {0.000164896796, 1.3672688}},
      {Preparation::slow, Boundary::walls, {0.000164900821, 1.36732063}},
      {Preparation::dense, Boundary::walls, {0.000146563284, 1.27021872}},
      {Preparation::lammps, Boundary::walls, {0.000206873637, 1.36380355}},
      {Preparation::frictionless, Boundary::periodic, {0.000456861843, 13.33799}},
      {Preparation::fast, Boundary::periodic, {0.000501266658, 13.9621838}},
  };
  for (const PreparedPacking& p : prepared) {
    const auto found = fingerprint(make_packing(small_spec(p.preparation, p.boundary), 1, 0));
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], p.fingerprint[k], 1e-4 * std::abs(p.fingerprint[k]))
          << to_string(p.preparation) << fmt::format(": {:.9g}, {:.9g}", found[0], found[1]);
  }
}

/// The same of kTwinSchema: a grain that a soft particle touches, pressed together as a twin.
TEST(CacheSchemas, TwinsAreThoseOfTheirSchema) {
  EXPECT_EQ(kTwinSchema, 2);
  const std::vector<std::pair<TwinRelaxation, std::array<double, 2>>> known{
      {TwinRelaxation::damped, {1.27267751, 1.24715904}}, {TwinRelaxation::slow_dynamics, {1.1459172, 1.21517407}}};
  for (const auto& [relaxation, stresses] : known) {
    MacroSpec spec;
    spec.twin.relaxation = relaxation;
    spec.twin.settle_time = 10.0;
    spec.twin.speed = 1e-3;
    spec.steps = 2;
    spec.strain_end = 0.1;
    SoftParticleSpec inside;
    inside.trials = 200;
    inside.polydispersity = 3.0;
    inside.beta = 8.0;
    const MacroPacking packing = make_packing(small_spec(Preparation::frictionless), 1, 0);
    CompressionState state;
    state.macro = make_shelled_system(spec, packing, {generate_shell_packing(inside, 1, 0)}, 1, 0);
    state.curve = begin_curve(spec, packing, state.macro, "shelled", 0);
    compress(state, spec);
    ASSERT_FALSE(state.curve.stress_axial.empty());
    const std::array<double, 2> found{state.curve.stress_axial.back(), state.curve.stress_lateral.back()};
    for (std::size_t k = 0; k < found.size(); ++k)
      EXPECT_NEAR(found[k], stresses[k], 1e-2 * std::abs(stresses[k]))
          << to_string(relaxation) << fmt::format(": {:.9g}, {:.9g}", found[0], found[1]);
  }
}

}  // namespace
}  // namespace softgrain
