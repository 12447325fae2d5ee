// Draws of a cell law from the errors of its card.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "pipelines/law/law_draws.h"

namespace softgrain {
namespace {

/// An interval of +-2 standard deviations about a value, or about its logarithm.
Estimate within(double value, double relative) {
  return {value, relative * value, value * std::exp(-kNormal95 * relative), value * std::exp(kNormal95 * relative)};
}

CellCard drawn_card() {
  CellCard card;
  card.modulus = within(0.05, 0.2);
  card.exponent = {1.7, 0.1, 1.7 - 0.1 * kNormal95, 1.7 + 0.1 * kNormal95};
  card.void_ratio = within(0.56, 0.01);
  card.friction = within(0.6, 0.1);
  card.stiffness = within(1.0, 0.3);
  card.correlation = {{"n", "K", "mu_f"}, {1.0, 0.9, 0.0, 0.9, 1.0, 0.0, 0.0, 0.0, 1.0}};
  return card;
}

TEST(CellDraws, HaveTheErrorsAndCorrelationsOfTheCard) {
  const LawDraws d = cell_draws(drawn_card(), "law", 4000);
  ASSERT_EQ(d.draws.size(), 4000U);
  ASSERT_EQ(d.numbers.size(), 3U);  // K, n, mu_f: in the order of the card
  double mean[3] = {0.0, 0.0, 0.0};
  double product[3][3] = {};
  for (const auto& row : d.draws)
    for (int a = 0; a < 3; ++a) {
      mean[a] += (row[a] - d.numbers[a]) / 4000.0;
      for (int b = 0; b < 3; ++b) product[a][b] += (row[a] - d.numbers[a]) * (row[b] - d.numbers[b]) / 4000.0;
    }
  const double sd[3] = {0.2, 0.1, 0.1};
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(mean[a], 0.0, 4.0 * sd[a] / std::sqrt(4000.0));
    EXPECT_NEAR(std::sqrt(product[a][a]), sd[a], 0.05 * sd[a]);
  }
  EXPECT_NEAR(product[0][1] / (sd[0] * sd[1]), 0.9, 0.06);
  EXPECT_NEAR(product[0][2] / (sd[0] * sd[2]), 0.0, 0.06);
  EXPECT_NE(d.origin.find("e_J"), std::string::npos) << d.origin;
  EXPECT_EQ(d.origin.find("K0"), std::string::npos) << d.origin;
  const NamedLaws one = d.with(d.draws.front());
  ASSERT_TRUE(one.cells);
  EXPECT_DOUBLE_EQ(one.cells->modulus.value, std::exp(d.draws.front()[0]));
  EXPECT_EQ(one.cells->exponent.value, d.draws.front()[1]);
  EXPECT_EQ(one.cells->void_ratio.value, 0.56);
  EXPECT_NE(one.tag, d.with(d.draws.back()).tag);
}

/// Slip must not give energy back, whatever is drawn: A c <= 1 + c.
TEST(CellDraws, StayLaws) {
  CellCard card = drawn_card();
  card.memory.emplace();
  card.memory->dilatancy = {1.8, 1.0, 0.0, 4.0};
  card.memory->strength_range = {0.9, 0.5, 0.0, 1.0};
  card.correlation = {{"A", "c"}, {1.0, 0.0, 0.0, 1.0}};
  const LawDraws d = cell_draws(card, "law", 200);
  for (const auto& numbers : d.draws) {
    const CellCard drawn = *d.with(numbers).cells;
    const double c = drawn.memory->strength_range.value;
    EXPECT_GE(c, 0.0);
    EXPECT_LE(c, 1.0);
    EXPECT_GE(drawn.memory->dilatancy.value, 0.0);
    EXPECT_LE(drawn.memory->dilatancy.value * c, (1.0 + c) * (1.0 + 1e-12));
  }
}

TEST(CellDraws, WantTheCorrelationsOfTheCard) {
  CellCard card = drawn_card();
  card.correlation = {};
  EXPECT_THROW((void)cell_draws(card, "law", 8), InputError);
}

}  // namespace
}  // namespace softgrain
