#include "common/statics/stiffness.h"

#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/cell.h"

namespace softgrain::statics {

namespace {

/// Number of links below which one thread is faster than two.
constexpr std::int32_t kParallelBlocks = 8000;

/// What a link answers to a displacement of its grains: minus the change of the force on i, and of the moments.
struct LinkAnswer {
  Vec3 force{};
  Vec3 roll{};   ///< n x force
  Vec3 twist{};  ///< [N m / m]
};

template <int kStride, Sliding kSliding>
LinkAnswer answer_of(const LinkTangent& t, const GrainPack& pack, const Unknowns& in, std::int32_t li,
                     std::int32_t lj) {
  constexpr auto kWidth = static_cast<std::size_t>(kStride);
  const auto i = static_cast<std::size_t>(li);
  const auto j = static_cast<std::size_t>(lj);
  const bool wall = lj >= pack.grains();
  LinkAnswer out;
  Vec3 moved = triple(in, i * kWidth);
  if (!wall) moved -= triple(in, j * kWidth);
  Vec3 delta = moved;
  if constexpr (kStride == 6) {
    const Vec3 turn_i = triple(in, i * kWidth + 3);
    const Vec3 turn_j = wall ? Vec3{} : triple(in, j * kWidth + 3);
    delta += cross(t.normal, turn_i * t.arm_i + turn_j * t.arm_j);
    if (t.twist != 0.0) {
      const Vec3 relative = turn_i * t.curvature_i - turn_j * t.curvature_j;
      out.twist = t.normal * (t.twist * softgrain::dot(relative, t.normal));
    }
  }
  const double along = softgrain::dot(t.normal, delta);
  out.force = t.normal * (t.normal_stiffness * along);
  if constexpr (kStride == 6) {
    Vec3 friction = (delta - t.normal * along) * t.tangential;
    if constexpr (kSliding == Sliding::exact) {
      if (t.drag != 0.0) friction += t.slip * (t.drag * along - t.tangential * softgrain::dot(t.slip, delta));
    }
    out.force += friction;
    out.roll = cross(t.normal, friction);
  }
  return out;
}

template <int kStride>
void add_to_grain(const LinkAnswer& a, const LinkTangent& t, bool first, Unknowns& out, std::size_t g) {
  const std::size_t at = g * static_cast<std::size_t>(kStride);
  add_triple(out, at, first ? a.force : -a.force);
  if constexpr (kStride == 6) {
    add_triple(out, at + 3, a.roll * -(first ? t.arm_i : t.arm_j));
    if (t.twist != 0.0) add_triple(out, at + 3, a.twist * (first ? t.curvature_i : -t.curvature_j));
  }
}

template <int kStride, Sliding kSliding>
void scatter(const PackProblem& problem, const std::vector<LinkTangent>& tangents, const Unknowns& in, Unknowns& out) {
  const Links& links = problem.links();
  const GrainPack& pack = problem.pack();
  for (std::size_t c = 0; c < tangents.size(); ++c) {
    const LinkTangent& t = tangents[c];
    if (!t.closed) continue;
    const LinkAnswer a = answer_of<kStride, kSliding>(t, pack, in, links.i[c], links.j[c]);
    const auto i = static_cast<std::size_t>(links.i[c]);
    add_to_grain<kStride>(a, t, true, out, i);
    if (links.j[c] >= pack.grains()) continue;
    const auto j = static_cast<std::size_t>(links.j[c]);
    add_to_grain<kStride>(a, t, false, out, j);
  }
}

/// Computes the sums of scatter() in the same order.
template <int kStride, Sliding kSliding>
void gather(const PackProblem& problem, const std::vector<LinkTangent>& tangents, const Unknowns& in, Unknowns& out) {
  const Links& links = problem.links();
  const GrainPack& pack = problem.pack();
  const auto count = static_cast<std::int32_t>(tangents.size());
  std::vector<LinkAnswer> answers(tangents.size());
#pragma omp parallel
  {
#pragma omp for schedule(static)
    for (std::int32_t c = 0; c < count; ++c) {
      const auto k = static_cast<std::size_t>(c);
      if (tangents[k].closed) answers[k] = answer_of<kStride, kSliding>(tangents[k], pack, in, links.i[k], links.j[k]);
    }
#pragma omp for schedule(static)
    for (std::int32_t g = 0; g < pack.grains(); ++g) {
      const auto u = static_cast<std::size_t>(g);
      for (std::int32_t k = links.start[u]; k < links.start[u + 1]; ++k) {
        const auto c = static_cast<std::size_t>(links.of_grain[static_cast<std::size_t>(k)]);
        if (tangents[c].closed) add_to_grain<kStride>(answers[c], tangents[c], links.i[c] == g, out, u);
      }
    }
  }
}

template <int kStride, Sliding kSliding>
void apply_as(const PackProblem& problem, const std::vector<LinkTangent>& tangents, const Unknowns& in, Unknowns& out) {
  if (problem.links().size() >= kParallelBlocks && omp_get_max_threads() > 1 && omp_in_parallel() == 0) {
    gather<kStride, kSliding>(problem, tangents, in, out);
  } else {
    scatter<kStride, kSliding>(problem, tangents, in, out);
  }
}

}  // namespace

Stiffness::Stiffness(const PackProblem& problem, const std::vector<LinkTangent>& tangents, Sliding sliding)
    : problem_(problem), tangents_(tangents), sliding_(sliding) {}

void Stiffness::apply(const Unknowns& in, Unknowns& out) const {
  out.assign(in.size(), 0.0);
  if (problem_.stride() == 3) {
    apply_as<3, Sliding::secant>(problem_, tangents_, in, out);
  } else if (sliding_ == Sliding::exact) {
    apply_as<6, Sliding::exact>(problem_, tangents_, in, out);
  } else {
    apply_as<6, Sliding::secant>(problem_, tangents_, in, out);
  }
}

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

/// Adds the stiffness of a link to the block of its grain i (`first`) or j.
template <int kWidth>
void add_to_block(const LinkTangent& t, bool first, Block<kWidth>& out) {
  const double curvature = first ? t.curvature_i : t.curvature_j;
  add_link<kWidth>(t, first ? t.arm_i : -t.arm_j, t.twist * curvature * curvature, out);
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
    if (!tangents[c].closed) continue;
    const auto i = static_cast<std::size_t>(links.i[c]);
    add_to_block<kWidth>(tangents[c], true, blocks[i]);
    if (links.j[c] >= pack.grains()) continue;
    const auto j = static_cast<std::size_t>(links.j[c]);
    add_to_block<kWidth>(tangents[c], false, blocks[j]);
  }
  return blocks;
}

/// Inverse of a block from its factor, row by row: applied more often than it is made, and without the chain of
/// dependent sums of a solution by the factor.
template <int kWidth>
void append_inverse(Block<kWidth>& l, std::vector<double>& out) {
  // Columns of L^-1 in place; then L^-T L^-1.
  Block<kWidth> inverse{};
  for (int c = 0; c < kWidth; ++c) {
    at<kWidth>(inverse, c, c) = at<kWidth>(l, c, c);
    for (int r = c + 1; r < kWidth; ++r) {
      double s = 0.0;
      for (int k = c; k < r; ++k) s -= at<kWidth>(l, r, k) * at<kWidth>(inverse, k, c);
      at<kWidth>(inverse, r, c) = s * at<kWidth>(l, r, r);
    }
  }
  for (int r = 0; r < kWidth; ++r)
    for (int c = 0; c < kWidth; ++c) {
      double s = 0.0;
      for (int k = std::max(r, c); k < kWidth; ++k) s += at<kWidth>(inverse, k, r) * at<kWidth>(inverse, k, c);
      out.push_back(s);
    }
}

template <int kWidth>
void build_inverses(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor,
                    std::vector<double>& largest, std::vector<double>& inverse) {
  std::vector<Block<kWidth>> blocks = own_stiffness<kWidth>(problem, tangents);
  double mean = 0.0;
  for (Block<kWidth>& b : blocks) mean += largest_diagonal<kWidth>(b);
  mean = mean > 0.0 ? mean / static_cast<double>(blocks.size()) : 1.0;
  inverse.clear();
  largest.clear();
  for (Block<kWidth>& b : blocks) {
    const double most = largest_diagonal<kWidth>(b);
    largest.push_back(most > 0.0 ? most : mean);
    const double added = most > 0.0 ? floor * most : mean;
    for (int k = 0; k < kWidth; ++k) at<kWidth>(b, k, k) += added;
    factorise<kWidth>(b, 0.5 * added);
    append_inverse<kWidth>(b, inverse);
  }
}

template <int kWidth>
void apply_inverses(const std::vector<double>& inverse, const Unknowns& in, Unknowns& out) {
  constexpr auto kSize = static_cast<std::size_t>(kWidth);
  for (std::size_t g = 0; g * kSize < in.size(); ++g) {
    const double* m = &inverse[g * kSize * kSize];
    // Symmetric: rows serve as columns, so that all sums grow together.
    double sums[kSize] = {};
    for (std::size_t k = 0; k < kSize; ++k)
      for (std::size_t r = 0; r < kSize; ++r) sums[r] += m[k * kSize + r] * in[g * kSize + k];
    for (std::size_t r = 0; r < kSize; ++r) out[g * kSize + r] = sums[r];
  }
}

template <int kWidth>
void solve_grain(const PackProblem& problem, std::size_t g, const GrainForces& grain, double floor, Unknowns& step) {
  Block<kWidth> block{};
  for (std::size_t k = 0; k < grain.links.size(); ++k) {
    const bool first = problem.links().i[grain.links[k]] == static_cast<std::int32_t>(g);
    add_to_block<kWidth>(grain.tangents[k], first, block);
  }
  const double added = floor * largest_diagonal<kWidth>(block);
  step.assign(kWidth, 0.0);
  if (!(added > 0.0)) return;
  for (int k = 0; k < kWidth; ++k) at<kWidth>(block, k, k) += added;
  factorise<kWidth>(block, 0.5 * added);
  std::vector<double> inverse;
  append_inverse<kWidth>(block, inverse);
  apply_inverses<kWidth>(inverse, grain.force, step);
}

}  // namespace

void own_step(const PackProblem& problem, std::size_t g, const GrainForces& grain, double floor, Unknowns& step) {
  if (problem.stride() == 6) {
    solve_grain<6>(problem, g, grain, floor, step);
  } else {
    solve_grain<3>(problem, g, grain, floor, step);
  }
}

void BlockJacobi::build(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor) {
  width_ = problem.stride();
  if (width_ == 6) {
    build_inverses<6>(problem, tangents, floor, largest_, inverse_);
  } else {
    build_inverses<3>(problem, tangents, floor, largest_, inverse_);
  }
}

void BlockJacobi::apply(const Unknowns& in, Unknowns& out) const {
  out.resize(in.size());
  if (width_ == 6) {
    apply_inverses<6>(inverse_, in, out);
  } else {
    apply_inverses<3>(inverse_, in, out);
  }
}

Unknowns BlockJacobi::stiffness() const {
  const auto width = static_cast<std::size_t>(width_);
  Unknowns out(largest_.size() * width);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = largest_[k / width];
  return out;
}

void BlockJacobi::add_diagonal(const Unknowns& in, double share, Unknowns& out) const {
  const auto width = static_cast<std::size_t>(width_);
  for (std::size_t g = 0; g < largest_.size(); ++g) {
    const double spring = share * largest_[g];
    for (std::size_t k = g * width; k < (g + 1) * width; ++k) out[k] += spring * in[k];
  }
}

}  // namespace softgrain::statics
