#include "macrosim/cell_matter/step_mixer.h"

#include <gsl/gsl_linalg.h>

#include <memory>

namespace softgrain {

namespace {

struct Freed {
  void operator()(gsl_matrix* m) const { gsl_matrix_free(m); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
};
using GslMatrix = std::unique_ptr<gsl_matrix, Freed>;
using GslVector = std::unique_ptr<gsl_vector, Freed>;

/// Shares of the columns whose sum is nearest to f; columns that others already make get little (singular values).
std::vector<double> least_squares(const std::deque<std::vector<Vec3>>& columns, const std::vector<Vec3>& f) {
  const GslMatrix a(gsl_matrix_alloc(3 * f.size(), columns.size()));
  const GslMatrix v(gsl_matrix_alloc(columns.size(), columns.size()));
  const GslVector singular(gsl_vector_alloc(columns.size()));
  const GslVector work(gsl_vector_alloc(columns.size()));
  const GslVector share(gsl_vector_alloc(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < f.size(); ++i)
      for (int k = 0; k < 3; ++k) gsl_matrix_set(a.get(), 3 * i + static_cast<std::size_t>(k), c, columns[c][i][k]);
  gsl_linalg_SV_decomp(a.get(), v.get(), singular.get(), work.get());
  constexpr double kLeast = 1e-6;
  const double least = kLeast * gsl_vector_get(singular.get(), 0);
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (gsl_vector_get(singular.get(), c) < least) gsl_vector_set(singular.get(), c, 0.0);
  const gsl_vector_const_view b = gsl_vector_const_view_array(f.data()->v.data(), 3 * f.size());
  gsl_linalg_SV_solve(a.get(), v.get(), singular.get(), &b.vector, share.get());
  return {share->data, share->data + columns.size()};
}

}  // namespace

std::vector<Vec3> StepMixer::mix(const std::vector<Vec3>& f) {
  if (!step_.empty() && !f_.empty()) {
    std::vector<Vec3> change(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) change[i] = f[i] - f_[i];
    changes_.push_back(std::move(change));
    steps_.push_back(std::move(step_));
    if (changes_.size() > depth_) {
      changes_.pop_front();
      steps_.pop_front();
    }
  }
  step_.clear();
  f_ = f;
  std::vector<Vec3> out = f;
  if (changes_.empty()) return out;
  const std::vector<double> share = least_squares(changes_, f);
  for (std::size_t c = 0; c < changes_.size(); ++c)
    for (std::size_t i = 0; i < f.size(); ++i) out[i] -= (steps_[c][i] + changes_[c][i]) * share[c];
  return out;
}

void StepMixer::forget() {
  changes_.clear();
  steps_.clear();
  step_.clear();
  f_.clear();
}

}  // namespace softgrain
