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

}  // namespace softgrain::statics
