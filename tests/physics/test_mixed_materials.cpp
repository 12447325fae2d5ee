// Packings of grains of several materials: contacts of unlike grains against the closed forms of Hertz and Mindlin,
// grains of one material bit for bit as without materials, and a mixture between its constituents.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/time_step.h"
#include "common/dynamics/verlet.h"
#include "common/neighbours/verlet_list.h"
#include "macrosim/compression.h"
#include "macrosim/grain_materials.h"
#include "macrosim/preparation.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

const GrainMaterial kQuartz{"quartz", 9.0e10, 0.08, 0.5, 2650.0};
const GrainMaterial kLimestone{"limestone", 3.0e10, 0.3, 0.3, 2710.0};

MacroSpec mixed_spec(std::vector<GrainMaterial> materials) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.soft_share = 0.0;
  spec.grain_materials.each = std::move(materials);
  spec.poisson_ratio = spec.grain_materials.each.front().poisson_ratio;
  spec.solid_sizes = Grading::list({1e-3});
  spec.solid_radius_max = 1e-3;
  spec.friction = 0.5;
  take_reference(spec, *spec.solid_sizes);
  return spec;
}

/// Two grains, of the first material and the last one, which overlap by `overlap`, or are so far apart.
MacroPacking two_grains(double r1, double r2, double overlap, std::int32_t last) {
  MacroPacking packing;
  packing.high = {{1.0, 1.0, 1.0}};
  packing.bodies = {{{{0.5, 0.5, 0.5}}, r1, false, 0}, {{{0.5 + r1 + r2 - overlap, 0.5, 0.5}}, r2, false, last}};
  return packing;
}

double effective_modulus(const GrainMaterial& a, const GrainMaterial& b) {
  return 1.0 / ((1.0 - a.poisson_ratio * a.poisson_ratio) / a.youngs_modulus +
                (1.0 - b.poisson_ratio * b.poisson_ratio) / b.youngs_modulus);
}

double effective_shear(const GrainMaterial& a, const GrainMaterial& b) {
  const auto shear = [](const GrainMaterial& m) { return m.youngs_modulus / (2.0 * (1.0 + m.poisson_ratio)); };
  return 1.0 / ((2.0 - a.poisson_ratio) / shear(a) + (2.0 - b.poisson_ratio) / shear(b));
}

TEST(MixedMaterials, UnlikeGrainsPressEachOtherAsHertzSays) {
  constexpr double kR1 = 1e-3;
  constexpr double kR2 = 3e-3;
  constexpr double kOverlap = 1e-6;
  for (const bool unlike : {false, true}) {
    const MacroSpec spec = mixed_spec({kQuartz, kLimestone});
    MacroSystem macro =
        make_law_system(spec, two_grains(kR1, kR2, kOverlap, unlike ? 1 : 0), pair_soft_laws({}, {}, 0.0), 1.0);
    const GrainMaterial& other = unlike ? kLimestone : kQuartz;
    const double radius = kR1 * kR2 / (kR1 + kR2);
    const double force = 4.0 / 3.0 * effective_modulus(kQuartz, other) * std::sqrt(radius) * std::pow(kOverlap, 1.5);
    rebuild_neighbours(macro.system);
    const auto records = contact_records(macro.system);
    ASSERT_EQ(records.size(), 1U);
    EXPECT_NEAR(records.front().normal_force / force, 1.0, 1e-9);
    const auto& p = macro.system.particles;
    EXPECT_NEAR(p.inverse_mass[1] * other.density * kSphereVolume * cube(kR2), 1.0, 1e-12);
    const AnyLaw& law = macro.system.laws.law(macro.system.laws.index(p.material[0], p.material[1]));
    const auto& k = std::get<HertzMindlin<Tangential::mindlin, false>>(law).k;
    EXPECT_NEAR(k.shear / (8.0 * effective_shear(kQuartz, other)), 1.0, 1e-12);
    EXPECT_EQ(k.friction, unlike ? 0.3 : 0.5);
  }
}

TEST(MixedMaterials, TheFrictionOfAPairIsTheSmallerOne) {
  EXPECT_EQ(pair_friction(0.3, 0.5), 0.3);
  EXPECT_EQ(pair_friction(0.5, 0.3), 0.3);
  EXPECT_EQ(pair_friction(0.4, 0.4), 0.4);
  EXPECT_EQ(pair_friction(0.0, 0.7), 0.0);
  const MacroSpec spec = mixed_spec({kQuartz, kLimestone});
  EXPECT_EQ(friction_between(spec, 0, 0), 0.5);
  EXPECT_EQ(friction_between(spec, 0, 1), 0.3);
  EXPECT_EQ(friction_between(spec, 1, 1), 0.3);
}

struct MeasuredImpact {
  double overlap = 0.0;      ///< largest [m]
  double restitution = 0.0;  ///< speed after over speed before
};

/// Two grains that meet at this speed as hard bodies of a preparation.
MeasuredImpact impact_of(const MacroSpec& spec, double r1, double r2, double speed, double restitution, double step) {
  HardBodies hard(spec, two_grains(r1, r2, -1e-9, 1), 0.0, restitution);
  System3& s = hard.system;
  s.particles.velocity[1] = Vec3{{-speed, 0.0, 0.0}};
  VelocityVerlet<3> motion(step);
  motion.initialise(s);
  MeasuredImpact out;
  const auto overlap = [&] { return r1 + r2 - norm(s.particles.sphere[1].x - s.particles.sphere[0].x); };
  for (int k = 0; k < 100000; ++k) {
    motion.step(s);
    if (k > 100 && overlap() < 0.0) break;
    out.overlap = std::max(out.overlap, overlap());
  }
  const Vec3 apart = Vec3(s.particles.velocity[1]) - Vec3(s.particles.velocity[0]);
  out.restitution = apart[0] / speed;
  return out;
}

/// Largest overlap by energy: 8/15 E* sqrt(R*) h^(5/2) = 1/2 m* v^2. With dashpots the coefficient of restitution is
/// the one asked for, whatever the two materials are: the damping goes by modulus and mass of the pair.
TEST(MixedMaterials, UnlikeGrainsCollideAsHertzSays) {
  constexpr double kR1 = 1e-3;
  constexpr double kR2 = 2e-3;
  constexpr double kSpeed = 0.1;
  const MacroSpec spec = mixed_spec({kQuartz, kLimestone});
  const double m1 = kQuartz.density * kSphereVolume * cube(kR1);
  const double m2 = kLimestone.density * kSphereVolume * cube(kR2);
  const double mass = m1 * m2 / (m1 + m2);
  const double stiffness = effective_modulus(kQuartz, kLimestone) * std::sqrt(kR1 * kR2 / (kR1 + kR2));
  const double expected = std::pow(15.0 / 16.0 * mass * kSpeed * kSpeed / stiffness, 0.4);
  const double step = 2.94 * expected / kSpeed / 2000.0;
  const MeasuredImpact elastic = impact_of(spec, kR1, kR2, kSpeed, 1.0, step);
  EXPECT_NEAR(elastic.overlap / expected, 1.0, 1e-3);
  EXPECT_NEAR(elastic.restitution, 1.0, 1e-4);
  EXPECT_NEAR(impact_of(spec, kR1, kR2, kSpeed, 0.6, step).restitution, 0.6, 2e-3);
}

/// The stiffest pair bounds the step of a grain, although its own pairs may be softer.
TEST(MixedMaterials, TheTimeStepFollowsTheStiffestPair) {
  const auto natural_time = [](const std::vector<GrainMaterial>& materials) {
    return step_limit(HardBodies(mixed_spec(materials), two_grains(1e-3, 1e-3, 1e-6, 0)).system, 1e-3).natural_time;
  };
  GrainMaterial stiff = kQuartz;
  stiff.youngs_modulus *= 9.0;
  EXPECT_NEAR(natural_time({kQuartz}) / natural_time({stiff}), 3.0, 1e-9);
  EXPECT_LT(natural_time({kQuartz, stiff}), natural_time({kQuartz}));
}

MacroSpec packed_spec(std::vector<GrainMaterial> materials, Preparation preparation = Preparation::frictionless) {
  MacroSpec spec = mixed_spec(std::move(materials));
  spec.bodies = 60;
  std::vector<SizePiece> pieces;
  const auto count = std::max<std::size_t>(1, spec.grain_materials.each.size());
  for (std::size_t m = 0; m < count; ++m)
    pieces.push_back({1e-3, 1.5e-3, 4.0, 1.0 / static_cast<double>(count), static_cast<std::int32_t>(m)});
  spec.solid_sizes = Grading::classes(pieces);
  spec.solid_radius_max = 1.5e-3;
  spec.preparation = preparation;
  spec.protocol = protocol_of(preparation, spec.friction);
  spec.start_pressure = 1e-4;
  spec.strain_end = 0.01;
  spec.steps = 2;
  take_reference(spec, *spec.solid_sizes);
  return spec;
}

/// One material in the list is the same as none, in every bit.
TEST(MixedMaterials, OneMaterialIsAsWithoutMaterials) {
  const MacroSpec one = packed_spec({kQuartz}, Preparation::fast);
  MacroSpec none = one;
  none.grain_materials.each.clear();
  none.youngs_modulus = kQuartz.youngs_modulus;
  none.poisson_ratio = kQuartz.poisson_ratio;
  none.friction = kQuartz.friction;
  none.density = kQuartz.density;
  const MacroPacking a = make_macro_packing(one, 1, 0);
  const MacroPacking b = make_macro_packing(none, 1, 0);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  EXPECT_EQ(a.high, b.high);
  for (std::size_t k = 0; k < a.bodies.size(); ++k) EXPECT_EQ(a.bodies[k].x, b.bodies[k].x);
  ASSERT_FALSE(a.springs.empty());
  EXPECT_EQ(a.springs.size(), b.springs.size());
}

/// Mean of the three stresses at the end of a short compression, over the same packing of grains [Pa].
double end_pressure(const MacroSpec& spec, const MacroPacking& packing) {
  CompressionState state{make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0), {}};
  state.curve = begin_curve(spec, packing, state.macro, "material", 0);
  compress(state, spec);
  const MacroCurve& c = state.curve;
  EXPECT_TRUE(c.usable) << c.note;
  return (c.stress_axial.back() + 2.0 * c.stress_lateral.back()) / 3.0;
}

/// The same places of grains of the stiff material, of the soft one, and of both: the mixture lies between, and above
/// what it would be if all its contacts were soft.
TEST(MixedMaterials, AMixtureLiesBetweenItsConstituents) {
  GrainMaterial soft = kQuartz;
  soft.name = "soft";
  soft.youngs_modulus = kQuartz.youngs_modulus / 10.0;
  const MacroSpec mixed = packed_spec({kQuartz, soft});
  const MacroPacking packing = make_macro_packing(mixed, 3, 0);
  const auto second = std::ranges::count_if(packing.bodies, [](const MacroBody& b) { return b.material == 1; });
  EXPECT_EQ(second, 30);
  const auto all_of = [&](const GrainMaterial& m) {
    MacroSpec spec = mixed;
    spec.grain_materials.each = {m, m};
    return end_pressure(spec, packing);
  };
  const double stiff_pressure = all_of(kQuartz);
  const double soft_pressure = all_of(soft);
  const double pressure = end_pressure(mixed, packing);
  EXPECT_NEAR(stiff_pressure / soft_pressure, 10.0, 0.5);
  EXPECT_GT(pressure, 1.3 * soft_pressure);
  EXPECT_LT(pressure, 0.8 * stiff_pressure);
}

TEST(MixedMaterials, AFileOfAPackingHoldsWhatItsGrainsAreMadeOf) {
  const test::TemporaryDirectory directory;
  const std::string path = directory.file("packing.h5");
  MacroPacking packing = two_grains(1e-3, 2e-3, 0.0, 1);
  {
    h5::AtomicFile file(path);
    write_macro_packing(file.root().create("mixed"), packing);
    packing.bodies[1].material = 0;
    write_macro_packing(file.root().create("alike"), packing);
    file.commit();
  }
  const h5::Group root = h5::open_file(path);
  const MacroPacking read = read_macro_packing(root.open("mixed"));
  EXPECT_EQ(read.bodies[0].material, 0);
  EXPECT_EQ(read.bodies[1].material, 1);
  EXPECT_EQ(read_macro_packing(root.open("alike")).bodies[1].material, 0);
  EXPECT_FALSE(root.open("alike").has("material"));
}

/// The share of each constituent in a level that holds several.
TEST(MixedMaterials, GrainsOfASizeHaveTheMaterialsOfTheirPieces) {
  const Grading sizes = Grading::classes({{1e-3, 2e-3, 4.0, 0.25, 0}, {1e-3, 2e-3, 4.0, 0.75, 2}});
  RandomStream random(5, kMacroRadii, 0);
  const std::vector<DrawnGrain> grains = sizes.draw_grains(1000, random);
  EXPECT_NEAR(static_cast<double>(std::ranges::count(grains, 2, &DrawnGrain::material)), 750.0, 1.0);
  EXPECT_TRUE(std::ranges::is_sorted(grains, {}, &DrawnGrain::radius));
  const std::vector<SizePiece> part = pieces_between(sizes, 1.2e-3, 1.5e-3);
  ASSERT_EQ(part.size(), 2U);
  EXPECT_EQ(part[1].material, 2);
  EXPECT_NE(sizes.text(), Grading::classes({{1e-3, 2e-3, 4.0, 0.25, 0}, {1e-3, 2e-3, 4.0, 0.75, 1}}).text());
  EXPECT_FALSE(sizes.same_shape(1.0, Grading::classes({{1e-3, 2e-3, 4.0, 0.25}, {1e-3, 2e-3, 4.0, 0.75}}), 1.0));
}

TEST(MixedMaterials, TheReferenceIsTheHarmonicMeanOverTheVolume) {
  const MacroSpec spec = packed_spec({kQuartz, kLimestone});
  EXPECT_NEAR(spec.youngs_modulus, 4.5e10, 1.0);  // half of each: 1/E is the mean of 1/E
  EXPECT_NEAR(spec.density, 2680.0, 1e-6);
  EXPECT_EQ(lowest_modulus(spec), kLimestone.youngs_modulus);
  EXPECT_EQ(highest_density(spec), kLimestone.density);
}

}  // namespace
}  // namespace softgrain
