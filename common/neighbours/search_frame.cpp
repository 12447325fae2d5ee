#include "common/neighbours/search_frame.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Perpendicular distance between opposite faces of the cell, per axis (upper triangular edges).
template <int D>
Vec<D> face_distances(const Cell<D>& cell) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) {
    // Row k of the inverse of the edges is the gradient of the fractional coordinate k; its norm is 1/distance.
    Vec<D> gradient;
    for (int c = 0; c < D; ++c) {
      Vec<D> e;
      e[c] = 1.0;
      gradient[c] = cell.fractional(e)[k];
    }
    out[k] = 1.0 / norm(gradient);
  }
  return out;
}

/// Where most grains are along one axis; those outside go by the cells at the border. One that has flown off would
/// otherwise leave a single cell to all others.
template <int D>
void leave_out_the_far(const Particles<D>& p, const Cell<D>& cell, int axis, double& low, double& high) {
  constexpr double kWide = 16.0;  // mean deviations
  for (;;) {
    double mean = 0.0;
    double deviation = 0.0;
    for (double* sum : {&mean, &deviation}) {
      double inside = 0.0;
      double total = 0.0;
      for (Slot i = 0; i < p.grains; ++i) {
        const double s = cell.fractional(p.sphere[static_cast<std::size_t>(i)].x)[axis];
        if (!(s >= low && s <= high)) continue;
        inside += 1.0;
        total += sum == &mean ? s : std::abs(s - mean);
      }
      *sum = total / inside;
    }
    const double from = std::max(low, mean - kWide * deviation);
    const double to = std::min(high, mean + kWide * deviation);
    if (!(to - from < 0.5 * (high - low)) || !(deviation > 0.0)) return;
    low = from;
    high = to;
  }
}

}  // namespace

template <int D>
SearchFrame<D> search_frame(const Particles<D>& p, const Cell<D>& cell) {
  constexpr double kSparse = 64.0;  // volume of the box over that of the grains
  SearchFrame<D> frame;
  frame.cell = &cell;
  const Vec<D> faces = face_distances(cell);
  Vec<D> low = cell.fractional(p.sphere[0].x);
  Vec<D> high = low;
  double largest = 0.0;
  double filled = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const Sphere<D>& sphere = p.sphere[static_cast<std::size_t>(i)];
    const Vec<D> s = cell.fractional(sphere.x);
    double cube = 1.0;
    for (int k = 0; k < D; ++k) {
      low[k] = std::min(low[k], s[k]);
      high[k] = std::max(high[k], s[k]);
      cube *= 2.0 * sphere.r;
    }
    filled += cube;
    largest = std::max(largest, 2.0 * sphere.r);
  }
  double volume = 1.0;
  for (int k = 0; k < D; ++k) {
    if (cell.periodic[static_cast<std::size_t>(k)]) {
      low[k] = 0.0;
      high[k] = 1.0;
    }
    volume *= std::max((high[k] - low[k]) * faces[k], largest);
  }
  for (int k = 0; k < D; ++k) {
    if (!cell.periodic[static_cast<std::size_t>(k)] && volume > kSparse * filled)
      leave_out_the_far(p, cell, k, low[k], high[k]);
    frame.low[k] = low[k];
    frame.extent[k] = std::max(high[k] - low[k], 1e-300);
    frame.width[k] = frame.extent[k] * faces[k];
  }
  return frame;
}

template SearchFrame<2> search_frame<2>(const Particles<2>&, const Cell<2>&);
template SearchFrame<3> search_frame<3>(const Particles<3>&, const Cell<3>&);

}  // namespace softgrain
