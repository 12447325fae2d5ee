#include "common/statics/stiffness.h"

#include <omp.h>

namespace softgrain::statics {

namespace {

/// Below this many links one thread is faster than two.
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

/// The same sums in the same order.
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

}  // namespace softgrain::statics
