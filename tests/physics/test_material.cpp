// Resolved materials: who rattles, who bears, what a preparation with friction hands over.
#include <gtest/gtest.h>

#include "macrosim/body_contacts.h"
#include "macrosim/compression.h"
#include "macrosim/preparation.h"

namespace softgrain {
namespace {

MacroSpec material_spec(std::int64_t grains) {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.soft_share = 0.0;
  spec.bodies = grains;
  spec.splits = {0.5};
  return spec;
}

/// Rows of touching spheres along all axes of a cell, and what is told of them.
struct Lattice {
  MacroSpec spec = material_spec(27);
  MacroPacking packing;

  Lattice() {
    constexpr double kSpacing = 0.0318;  // radius 0.016: overlap 2e-4
    packing.high = {{3 * kSpacing, 3 * kSpacing, 3 * kSpacing}};
    for (int k = 0; k < 27; ++k)
      packing.bodies.push_back(
          {Vec3{{(k % 3 + 0.5) * kSpacing, (k / 3 % 3 + 0.5) * kSpacing, (k / 9 + 0.5) * kSpacing}}, 0.016, false});
  }
  [[nodiscard]] MacroCurve look() const {
    MacroSystem macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
    MacroCurve curve;
    record_grains(macro, spec, curve);
    return curve;
  }
};

/// Six contacts each: nobody rattles. A small one in every hole, touching none, does; where one of the large ones goes,
/// its neighbours have five and stay.
TEST(Material, WhoIsNotHeldRattles) {
  Lattice lattice;
  EXPECT_EQ(lattice.look().more.at(kRattlers), std::vector<double>{0.0});
  lattice.packing.bodies.push_back({{{0.0318, 0.0318, 0.0318}}, 0.005, false});
  EXPECT_NEAR(lattice.look().more.at(kRattlers)[0], 1.0 / 28.0, 1e-12);
  lattice.packing.bodies.erase(lattice.packing.bodies.begin());
  EXPECT_NEAR(lattice.look().more.at(kRattlers)[0], 1.0 / 27.0, 1e-12);
}

/// A chain that ends in nothing falls link by link, with friction (two contacts hold) as without (four do).
TEST(Material, ARattlerLetsGoOfItsNeighbours) {
  MacroSpec spec = material_spec(5);
  MacroPacking packing;
  packing.high = {{1.0, 1.0, 1.0}};
  for (int k = 0; k < 5; ++k) packing.bodies.push_back({Vec3{{0.1 + 0.0318 * k, 0.5, 0.5}}, 0.016, false});
  for (const double friction : {0.0, 0.5}) {
    spec.friction = friction;
    MacroCurve curve;
    record_grains(make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0), spec, curve);
    EXPECT_EQ(curve.more.at(kRattlers)[0], 1.0) << friction;
  }
}

/// Every contact counts once: in a lattice in which layers of large and small spheres alternate along z, contacts
/// across are mixed, those within are of one kind; forces are known.
TEST(Material, SharesAreThoseOfTheVirial) {
  MacroSpec spec = material_spec(0);
  MacroPacking packing;
  const double big = 0.016;
  const double small = 0.007;
  const double spacing = 2.0 * big * 0.99;
  const double height = (big + small) * 0.99;
  packing.high = {{4 * spacing, 4 * spacing, 4 * height}};
  for (int layer = 0; layer < 4; ++layer)
    for (int k = 0; k < 16; ++k)
      packing.bodies.push_back({Vec3{{(k % 4 + 0.5) * spacing, (k / 4 + 0.5) * spacing, (layer + 0.5) * height}},
                                layer % 2 == 0 ? big : small, false});
  MacroSystem macro = make_law_system(spec, packing, pair_soft_laws({}, {}, 0.0), 1.0);
  MacroCurve curve;
  record_grains(macro, spec, curve);
  // Hertz: force ~ sqrt(R*) overlap^(3/2), times distance; two contacts within a layer per big sphere, two mixed.
  const double among = std::sqrt(0.5 * big) * std::pow(0.02 * big, 1.5) * spacing;
  const double mixed = std::sqrt(big * small / (big + small)) * std::pow(0.01 * (big + small), 1.5) * height;
  const double all = 2.0 * among + 2.0 * mixed;
  EXPECT_NEAR(curve.more.at(share_name(Bearers::coarse_coarse, 0.5))[0], 2.0 * among / all, 1e-10);
  EXPECT_NEAR(curve.more.at(share_name(Bearers::coarse_fine, 0.5))[0], 2.0 * mixed / all, 1e-10);
  EXPECT_EQ(curve.more.at(share_name(Bearers::fine_fine, 0.5))[0], 0.0);
  const double volume = 4.0 / 3.0 * 3.141592653589793 * 32.0 * (big * big * big + small * small * small);
  EXPECT_NEAR(curve.more.at(kSolidFraction)[0], volume / (4 * spacing * 4 * spacing * 4 * height), 1e-10);
}

/// With its springs the packing bears at once what it was pressed to; without them it would give way.
TEST(Material, SpringsOfThePreparationGoOnBearing) {
  MacroSpec spec = material_spec(200);
  spec.start_pressure = 1e-4;
  spec.preparation = Preparation::fast;
  spec.protocol = protocol_of(Preparation::fast, spec.friction);
  spec.protocol.tolerance = 3e-3;
  MacroPacking packing = make_macro_packing(spec, 1, 0);
  ASSERT_GT(packing.springs.size(), 100U);
  const auto start_pressure = [&](const MacroPacking& p) {
    CompressionState state;
    state.macro = make_law_system(spec, p, pair_soft_laws({}, {}, 0.0), 1.0);
    state.curve = begin_curve(spec, p, state.macro, "material", 0);
    MacroSpec still = spec;
    still.steps = 1;
    still.strain_end = 1e-9;
    compress(state, still);
    return (state.curve.stress_x[0] + state.curve.stress_y[0] + state.curve.stress_axial[0]) / 3.0 /
           spec.youngs_modulus;
  };
  EXPECT_NEAR(start_pressure(packing), 1e-4, 2e-6);
  packing.springs.clear();
  EXPECT_LT(start_pressure(packing), 0.97e-4);
}

/// q/p at the end of a shear at constant volume, mean of some packings.
double stress_ratio(double mu_r) {
  double sum = 0.0;
  constexpr std::uint64_t kPackings = 3;
  for (std::uint64_t seed = 1; seed <= kPackings; ++seed) {
    MacroSpec spec = material_spec(200);
    spec.friction = 0.5;
    spec.rolling.friction = mu_r;
    spec.start_pressure = 1e-3;
    spec.test = MacroTest::shear;
    spec.strain_end = 0.08;
    spec.steps = 8;
    spec.increments_per_step = 2;
    const MacroPacking packing = make_macro_packing(spec, seed, 0);
    CompressionState state;
    state.macro = make_law_system(spec, packing, {}, 1.0);
    state.curve = begin_curve(spec, packing, state.macro, "material", 0);
    compress(state, spec);
    const MacroCurve& c = state.curve;
    const double mean = (c.stress_x.back() + c.stress_y.back() + c.stress_axial.back()) / 3.0;
    sum += (c.stress_axial.back() - c.stress_x.back()) / mean;
  }
  return sum / static_cast<double>(kPackings);
}

/// Rolling resistance stands for the shape of grains: the same packings bear more shear.
TEST(Material, RollingResistanceMakesItStronger) {
  const double free = stress_ratio(0.0);
  EXPECT_GT(free, 0.4);
  EXPECT_GT(stress_ratio(0.5), 1.1 * free);
}

}  // namespace
}  // namespace softgrain
