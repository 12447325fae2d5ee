#include "common/statics/krylov.h"

#include <cmath>

namespace softgrain::statics {

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
