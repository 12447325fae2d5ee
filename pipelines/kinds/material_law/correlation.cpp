#include "pipelines/kinds/material_law/fit.h"

#include <algorithm>
#include <cmath>

#include "calibrate/draws.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

/// Correlations of both, which know nothing of each other.
CellCorrelation side_by_side(const CellCorrelation& a, const CellCorrelation& b) {
  CellCorrelation out = a;
  out.numbers.insert(out.numbers.end(), b.numbers.begin(), b.numbers.end());
  const std::size_t first = a.numbers.size();
  const std::size_t n = out.numbers.size();
  out.matrix.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if ((i < first) == (j < first))
        out.matrix[i * n + j] = i < first ? a.matrix[i * first + j] : b.matrix[(i - first) * (n - first) + j - first];
  return out;
}

const CellCardNumber& number_of(const std::vector<CellCardNumber>& numbers, const std::string& key) {
  return *std::ranges::find(numbers, key, &CellCardNumber::key);
}

/// Those numbers alone whose errors are known.
CellCorrelation of_known(const CellCorrelation& all, const std::vector<CellCardNumber>& numbers) {
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < all.numbers.size(); ++k) {
    const double error = number_of(numbers, all.numbers[k]).estimate.standard_error;
    if (error > 0.0 && std::isfinite(error)) kept.push_back(k);
  }
  CellCorrelation out;
  for (const std::size_t i : kept) {
    out.numbers.push_back(all.numbers[i]);
    for (const std::size_t j : kept) out.matrix.push_back(all.matrix[i * all.numbers.size() + j]);
  }
  return out;
}

}  // namespace

CellCorrelation correlation_of_card(const CellCard& card, const StateFit& states,
                                    const std::vector<std::array<double, 4>>& pores, const CellCorrelation& faces) {
  CellCorrelation state{{"K", "n", "e_J", "e_c", "w_inf", "xi"}, {}};
  const std::size_t size = state.numbers.size();
  std::vector<std::vector<double>> refits;
  for (std::size_t r = 0; r < pores.size(); ++r) {
    const auto& [alone, coarse, many, log_decay] = pores[r];
    if (!std::isnan(many))
      refits.push_back(
          {states.replicates[r][0], states.replicates[r][1], std::log(alone), std::log(coarse), many, log_decay});
  }
  state.matrix = correlations(refits, size);
  const std::vector<CellCardNumber> numbers = numbers_of(card);
  std::vector<double> share;
  for (std::size_t k = 0; k < size; ++k) {
    const CellCardNumber& n = number_of(numbers, state.numbers[k]);
    const double error = n.estimate.standard_error / (n.logarithm ? n.estimate.value : 1.0);
    std::vector<double> values;
    for (const std::vector<double>& one : refits) values.push_back(one[k]);
    share.push_back(error > 0.0 ? std::min(1.0, mean_error(values).deviation_or_zero() / error) : 0.0);
  }
  for (std::size_t k = 0; k < size * size; ++k)
    if (k / size != k % size) state.matrix[k] *= share[k / size] * share[k % size];
  return of_known(side_by_side(state, faces), numbers);
}

}  // namespace softgrain
