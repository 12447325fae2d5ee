#include "common/statics/block_jacobi.h"

#include <algorithm>
#include <cmath>

#include "common/core/cell.h"

namespace softgrain::statics {

namespace {

template <int kWidth>
using Block = std::array<std::array<double, kWidth>, kWidth>;

template <int kWidth>
double& at(Block<kWidth>& b, int r, int c) {
  return b[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
}

/// Adds B^T A B, B = [1, arm [n x]], A = tangential 1 + (normal - tangential) nn, plus torsion. Only the lower
/// triangle. `arm` and `twist` are scaled with the radius.
template <int kWidth>
void add_link(const LinkTangent& t, double arm, double twist, Block<kWidth>& out) {
  const Vec3& n = t.normal;
  const double k = t.tangential;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c <= r; ++c) at<kWidth>(out, r, c) += (t.normal_stiffness - k) * n[r] * n[c] + (r == c ? k : 0.0);
  if constexpr (kWidth == 6) {
    const double roll = k * arm;
    const Matrix<3> turned{{Vec3{{0.0, n[2], -n[1]}}, Vec3{{-n[2], 0.0, n[0]}}, Vec3{{n[1], -n[0], 0.0}}}};  // n x e_r
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) at<kWidth>(out, r + 3, c) += roll * turned[r][c];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c)
        at<kWidth>(out, r + 3, c + 3) += (twist - roll * arm) * n[r] * n[c] + (r == c ? roll * arm : 0.0);
  }
}

/// Lower Cholesky factor with inverted diagonal; a pivot below `least` is raised to it.
template <int kWidth>
void factorise(Block<kWidth>& b, double least) {
  for (int c = 0; c < kWidth; ++c) {
    double pivot = at<kWidth>(b, c, c);
    for (int k = 0; k < c; ++k) pivot -= at<kWidth>(b, c, k) * at<kWidth>(b, c, k);
    const double inverse = 1.0 / std::sqrt(std::max(pivot, least));
    at<kWidth>(b, c, c) = inverse;
    for (int r = c + 1; r < kWidth; ++r) {
      double s = at<kWidth>(b, r, c);
      for (int k = 0; k < c; ++k) s -= at<kWidth>(b, r, k) * at<kWidth>(b, c, k);
      at<kWidth>(b, r, c) = s * inverse;
    }
  }
}

template <int kWidth>
double largest_diagonal(Block<kWidth>& b) {
  double most = 0.0;
  for (int k = 0; k < kWidth; ++k) most = std::max(most, at<kWidth>(b, k, k));
  return most;
}

template <int kWidth>
std::vector<Block<kWidth>> own_stiffness(const PackProblem& problem, const std::vector<LinkTangent>& tangents) {
  const Links& links = problem.links();
  const GrainPack& pack = problem.pack();
  std::vector<Block<kWidth>> blocks(pack.position.size(), Block<kWidth>{});
  for (std::size_t c = 0; c < tangents.size(); ++c) {
    const LinkTangent& t = tangents[c];
    if (!t.closed) continue;
    const auto i = static_cast<std::size_t>(links.i[c]);
    add_link<kWidth>(t, t.arm_i, t.twist / (pack.radius[i] * pack.radius[i]), blocks[i]);
    if (links.j[c] >= pack.grains()) continue;
    const auto j = static_cast<std::size_t>(links.j[c]);
    add_link<kWidth>(t, -t.arm_j, t.twist / (pack.radius[j] * pack.radius[j]), blocks[j]);
  }
  return blocks;
}

template <int kWidth>
void build_factors(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor,
                   std::vector<double>& largest, std::vector<double>& factor) {
  std::vector<Block<kWidth>> blocks = own_stiffness<kWidth>(problem, tangents);
  double mean = 0.0;
  for (Block<kWidth>& b : blocks) mean += largest_diagonal<kWidth>(b);
  mean = mean > 0.0 ? mean / static_cast<double>(blocks.size()) : 1.0;
  factor.clear();
  largest.clear();
  for (Block<kWidth>& b : blocks) {
    const double most = largest_diagonal<kWidth>(b);
    largest.push_back(most > 0.0 ? most : mean);
    const double added = most > 0.0 ? floor * most : mean;
    for (int k = 0; k < kWidth; ++k) at<kWidth>(b, k, k) += added;
    factorise<kWidth>(b, 0.5 * added);
    for (const auto& row : b) factor.insert(factor.end(), row.begin(), row.end());
  }
}

template <int kWidth>
void solve_blocks(const std::vector<double>& factor, const Unknowns& in, Unknowns& out) {
  constexpr auto kSize = static_cast<std::size_t>(kWidth);
  for (std::size_t g = 0; g * kSize < in.size(); ++g) {
    const double* l = &factor[g * kSize * kSize];
    double y[kSize];
    for (std::size_t r = 0; r < kSize; ++r) {
      double s = in[g * kSize + r];
      for (std::size_t k = 0; k < r; ++k) s -= l[r * kSize + k] * y[k];
      y[r] = s * l[r * kSize + r];
    }
    for (std::size_t r = kSize; r-- > 0;) {
      double s = y[r];
      for (std::size_t k = r + 1; k < kSize; ++k) s -= l[k * kSize + r] * y[k];
      y[r] = s * l[r * kSize + r];
      out[g * kSize + r] = y[r];
    }
  }
}

}  // namespace

void BlockJacobi::build(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor) {
  width_ = problem.stride();
  if (width_ == 6) {
    build_factors<6>(problem, tangents, floor, largest_, factor_);
  } else {
    build_factors<3>(problem, tangents, floor, largest_, factor_);
  }
}

void BlockJacobi::apply(const Unknowns& in, Unknowns& out) const {
  out.resize(in.size());
  if (width_ == 6) {
    solve_blocks<6>(factor_, in, out);
  } else {
    solve_blocks<3>(factor_, in, out);
  }
}

void BlockJacobi::add_diagonal(const Unknowns& in, double share, Unknowns& out) const {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t g = 0; g < largest_.size(); ++g) {
    const double spring = share * largest_[g];
    for (std::size_t k = g * width; k < (g + 1) * width; ++k) out[k] += spring * in[k];
  }
}

}  // namespace softgrain::statics
