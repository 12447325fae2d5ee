#include "common/statics/unknowns.h"

#include <algorithm>
#include <cmath>

namespace softgrain::statics {

double dot(const Unknowns& a, const Unknowns& b) {
  constexpr std::size_t kBlock = 4096;
  double total = 0.0;
  for (std::size_t begin = 0; begin < a.size(); begin += kBlock) {
    // Four sums: the compiler may not reorder one.
    double s[4] = {};
    const std::size_t end = std::min(begin + kBlock, a.size());
    std::size_t k = begin;
    for (; k + 4 <= end; k += 4)
      for (std::size_t l = 0; l < 4; ++l) s[l] += a[k + l] * b[k + l];
    for (; k < end; ++k) s[0] += a[k] * b[k];
    total += (s[0] + s[1]) + (s[2] + s[3]);
  }
  return total;
}

void add_scaled(Unknowns& y, double s, const Unknowns& x) {
  for (std::size_t k = 0; k < y.size(); ++k) y[k] += s * x[k];
}

namespace {

Unknowns difference(const Unknowns& a, const Unknowns& b) {
  Unknowns out = a;
  add_scaled(out, -1.0, b);
  return out;
}

}  // namespace

Unknowns AndersonMixing::mixed(const Unknowns& x, const Unknowns& d, const Unknowns& weight) {
  const auto weighted = [&](const Unknowns& a) {
    Unknowns out = a;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] *= weight[k];
    return out;
  };
  // Modified Gram-Schmidt on the changes of d, newest first; a change that adds nothing new is left out.
  Unknowns step = d;
  Unknowns rest = weighted(d);
  std::vector<Unknowns> basis, moves;
  for (std::size_t k = states_.size(); k-- > 0;) {
    const bool newest = k + 1 == states_.size();
    const Unknowns plain = difference(newest ? d : steps_[k + 1], steps_[k]);
    Unknowns move = difference(newest ? x : states_[k + 1], states_[k]);
    add_scaled(move, 1.0, plain);
    Unknowns change = weighted(plain);
    const double before = dot(change, change);
    for (std::size_t b = 0; b < basis.size(); ++b) {
      const double share = dot(basis[b], change);
      add_scaled(change, -share, basis[b]);
      add_scaled(move, -share, moves[b]);
    }
    const double left = dot(change, change);
    if (!(left > 1e-12 * before)) continue;
    const double scale = 1.0 / std::sqrt(left);
    for (double& v : change) v *= scale;
    for (double& v : move) v *= scale;
    const double share = dot(change, rest);
    add_scaled(rest, -share, change);
    add_scaled(step, -share, move);
    basis.push_back(std::move(change));
    moves.push_back(std::move(move));
  }
  states_.push_back(x);
  steps_.push_back(d);
  if (states_.size() > memory_) {
    states_.erase(states_.begin());
    steps_.erase(steps_.begin());
  }
  return step;
}

KrylovResult conjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                std::int64_t most, Unknowns& x) {
  KrylovResult out;
  x.assign(rhs.size(), 0.0);
  Unknowns rest = rhs;
  Unknowns scaled, direction, image;
  inverse(rest, scaled);
  direction = scaled;
  double gain = dot(rest, scaled);
  const double first = std::sqrt(dot(rhs, rhs));
  if (!(first > 0.0)) return out;
  while (out.iterations < most && out.reduction > reduction) {
    ++out.iterations;
    map(direction, image);
    const double curvature = dot(direction, image);
    if (!(curvature > 0.0)) {
      out.indefinite = true;
      if (out.iterations == 1) x = direction;
      break;
    }
    const double step = gain / curvature;
    add_scaled(x, step, direction);
    add_scaled(rest, -step, image);
    out.reduction = std::sqrt(dot(rest, rest)) / first;
    inverse(rest, scaled);
    const double next = dot(rest, scaled);
    const double beta = next / gain;
    gain = next;
    for (std::size_t k = 0; k < direction.size(); ++k) direction[k] = scaled[k] + beta * direction[k];
  }
  return out;
}

KrylovResult biconjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                  std::int64_t most, Unknowns& x) {
  KrylovResult out;
  x.assign(rhs.size(), 0.0);
  Unknowns rest = rhs;
  Unknowns direction = rhs;
  Unknowns scaled, image, image_of_rest;
  double gain = dot(rhs, rest);
  const double first = std::sqrt(gain);
  if (!(first > 0.0)) return out;
  while (out.iterations < most && out.reduction > reduction) {
    inverse(direction, scaled);
    map(scaled, image);
    const double along = dot(rhs, image);
    if (along == 0.0 || gain == 0.0) break;
    const double step = gain / along;
    add_scaled(x, step, scaled);
    add_scaled(rest, -step, image);
    inverse(rest, scaled);
    map(scaled, image_of_rest);
    out.iterations += 2;
    const double size2 = dot(image_of_rest, image_of_rest);
    const double smoothing = size2 > 0.0 ? dot(image_of_rest, rest) / size2 : 0.0;
    add_scaled(x, smoothing, scaled);
    add_scaled(rest, -smoothing, image_of_rest);
    out.reduction = std::sqrt(dot(rest, rest)) / first;
    if (smoothing == 0.0) break;
    const double next = dot(rhs, rest);
    const double beta = next / gain * (step / smoothing);
    gain = next;
    for (std::size_t k = 0; k < direction.size(); ++k)
      direction[k] = rest[k] + beta * (direction[k] - smoothing * image[k]);
  }
  return out;
}

}  // namespace softgrain::statics
