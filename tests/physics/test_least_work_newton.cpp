// Newton steps of the fast minimiser: the exact stiffness of sliding contacts against finite differences, the linear
// solver for it, and what they save.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "common/statics/stiffness.h"
#include "common/statics/unknowns.h"
#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// 343 grains after 10 increments: about a sixth of the contacts slide.
const GrainPack& sliding_pack() {
  static const GrainPack pack = [] {
    GrainPack p = random_pack(7, 0.3);
    for (int k = 0; k < 10; ++k) advance(p, squeeze(p, {{0.0, 0.0, 1e-4}}), {});
    return p;
  }();
  return pack;
}

statics::Unknowns difference(const statics::Unknowns& a, const statics::Unknowns& b, double scale) {
  statics::Unknowns out = a;
  statics::add_scaled(out, -1.0, b);
  for (double& v : out) v *= scale;
  return out;
}

double size_of(const statics::Unknowns& a) { return std::sqrt(statics::dot(a, a)); }

TEST(LeastWorkNewton, ExactStiffnessIsTheDerivativeOfTheForcesOfSlidingContacts) {
  const GrainPack& pack = sliding_pack();
  RandomStream random(3, RandomPurpose::test, 0);
  statics::PackProblem problem(pack, std::vector<Vec3>(6), CoulombRule::current, true);
  // Displacements of 1e-5 R make part of the contacts slide; the derivative is taken over 1e-10 R, so that next to none
  // changes between stick and slip.
  statics::Unknowns theta(problem.size()), direction(problem.size());
  for (double& v : theta) v = 1e-8 * (random.uniform() - 0.5);
  for (double& v : direction) v = random.uniform() - 0.5;
  std::vector<statics::LinkTangent> tangents;
  problem.linearise(theta, tangents);
  const auto sliding =
      std::count_if(tangents.begin(), tangents.end(), [](const statics::LinkTangent& t) { return t.drag != 0.0; });
  ASSERT_GT(sliding, 50);
  constexpr double kStep = 1e-13;
  statics::PackForces high, low;
  statics::add_scaled(theta, kStep, direction);
  problem.evaluate(theta, high);
  statics::add_scaled(theta, -2.0 * kStep, direction);
  problem.evaluate(theta, low);
  const statics::Unknowns expected = difference(low.force, high.force, 0.5 / kStep);
  statics::Unknowns exact, secant;
  statics::Stiffness(problem, tangents, statics::Sliding::exact).apply(direction, exact);
  statics::Stiffness(problem, tangents).apply(direction, secant);
  const double error = size_of(difference(exact, expected, 1.0)) / size_of(expected);
  const double secant_error = size_of(difference(secant, expected, 1.0)) / size_of(expected);
  std::cout << sliding << " of " << pack.contacts.size() << " contacts slide; error of the exact stiffness " << error
            << ", of the secant one " << secant_error << "\n";
  // What is left out is of the order of the overlap over the radius.
  double overlap = 0.0;
  for (const PackContact& c : pack.contacts) overlap = std::max(overlap, c.overlap / 0.7e-3);
  EXPECT_LT(error, overlap);
  EXPECT_GT(secant_error, 5.0 * error);
}

TEST(LeastWorkNewton, BiconjugateGradientSolvesAnUnsymmetricSystem) {
  constexpr std::size_t kSize = 50;
  const auto map = [](const statics::Unknowns& in, statics::Unknowns& out) {
    out.assign(kSize, 0.0);
    for (std::size_t k = 0; k < kSize; ++k) {
      out[k] = (2.0 + 0.1 * static_cast<double>(k)) * in[k];
      if (k > 0) out[k] -= 1.5 * in[k - 1];
      if (k + 1 < kSize) out[k] -= 0.2 * in[k + 1];
    }
  };
  const auto inverse = [](const statics::Unknowns& in, statics::Unknowns& out) {
    out = in;
    for (std::size_t k = 0; k < kSize; ++k) out[k] /= 2.0 + 0.1 * static_cast<double>(k);
  };
  statics::Unknowns rhs(kSize), x, image;
  for (std::size_t k = 0; k < kSize; ++k) rhs[k] = std::sin(static_cast<double>(k + 1));
  const statics::KrylovResult r = statics::biconjugate_gradient(map, inverse, rhs, 1e-12, 200, x);
  EXPECT_LE(r.reduction, 1e-12);
  map(x, image);
  EXPECT_LT(size_of(difference(image, rhs, 1.0)), 1e-11 * size_of(rhs));
  EXPECT_EQ(statics::biconjugate_gradient(map, inverse, statics::Unknowns(kSize, 0.0), 1e-12, 200, x).iterations, 0);
}

TEST(LeastWorkNewton, IncrementsTakeFewIterations) {
  GrainPack pack = sliding_pack();
  std::vector<std::int64_t> iterations;
  for (int k = 0; k < 11; ++k) {
    const LeastWorkResult r = advance(pack, squeeze(pack, {{0.0, 0.0, 1e-4}}), {});
    ASSERT_TRUE(r.converged) << to_string(r.stopped_by);
    iterations.push_back(r.iterations);
  }
  std::sort(iterations.begin(), iterations.end());
  std::cout << "iterations: median " << iterations[5] << ", most " << iterations.back() << "\n";
  EXPECT_LT(iterations[5], 15);  // symmetric steps alone take about 30
  EXPECT_LT(iterations.back(), 60);
}

}  // namespace
