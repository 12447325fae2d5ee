#include "pipelines/law/law_draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/statistics.h"
#include "common/core/text.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr std::uint64_t kCellStream = 101;  ///< random numbers of its own

/// Standard deviation of a number, of its logarithm where it is drawn so: the wider side of its interval that ends at
/// no bound.
double deviation_of(const CellCardNumber& n) {
  const auto at = [&](double x) { return n.logarithm ? std::log(x) : x; };
  const double above = (at(n.estimate.high) - at(n.estimate.value)) / kNormal95;
  const double below = (at(n.estimate.value) - at(n.estimate.low)) / kNormal95;
  return std::isfinite(below) ? std::max(above, below) : above;
}

/// The card with other values of some of its numbers, logarithms where these are drawn so.
CellCard card_with(CellCard card, const std::vector<CellCardNumber>& drawn, const std::vector<double>& numbers) {
  for (std::size_t k = 0; k < drawn.size(); ++k)
    set_number(card, drawn[k].key, drawn[k].logarithm ? std::exp(numbers[k]) : numbers[k]);
  if (card.memory) {
    double& a = card.memory->dilatancy.value;
    a = std::min(a, most_dilatancy(card.memory->strength_range.value));
  }
  return card;
}

}  // namespace

LawDraws cell_draws(const CellCard& card, const std::string& name, std::int64_t count) {
  const CellCorrelation& c = card.correlation;
  if (c.numbers.empty())
    throw InputError(
        "the card of the cell law has no [correlation] of its numbers: measure it from two samples or more with "
        "this version (kind \"material-law\")");
  std::vector<CellCardNumber> drawn;
  std::vector<std::string> held;
  for (const CellCardNumber& n : numbers_of(card)) {
    if (std::ranges::find(c.numbers, n.key) == c.numbers.end()) {
      if (n.is_drawn) held.push_back(n.key);
      continue;
    }
    if (!std::isfinite(deviation_of(n)))
      throw InputError(
          fmt::format("the interval of {} is not known: give one in the card of the cell law, or take {} out of its "
                      "[correlation]",
                      n.key, n.key));
    drawn.push_back(n);
  }
  std::vector<double> mean;
  std::vector<double> covariance;
  for (const CellCardNumber& a : drawn) {
    mean.push_back(a.logarithm ? std::log(a.estimate.value) : a.estimate.value);
    const auto row = static_cast<std::size_t>(std::ranges::find(c.numbers, a.key) - c.numbers.begin());
    for (const CellCardNumber& b : drawn) {
      const auto column = static_cast<std::size_t>(std::ranges::find(c.numbers, b.key) - c.numbers.begin());
      covariance.push_back(c.matrix[row * c.numbers.size() + column] * deviation_of(a) * deviation_of(b));
    }
  }
  LawDraws out;
  out.law.name = name;
  out.numbers = mean;
  out.draws = normal_draws(mean, covariance, count, kCellStream);
  out.origin = fmt::format("{} draws from the errors of the card of the cell law", count);
  if (!held.empty()) out.origin += fmt::format(" ({} held: their errors are not known)", join_text(held));
  out.discrepancy_origin = "not known: a card of the cell law has no tests that its fit did not see";
  out.with = [=](const std::vector<double>& numbers) {
    NamedLaws law;
    law.name = name;
    law.cells = card_with(card, drawn, numbers);
    law.tag = short_hash(join_text(numbers, "_", [](double x) { return fmt::format("{:a}", x); }));
    return law;
  };
  return out;
}

}  // namespace softgrain
