#include "common/data/snapshot.h"

#include <cmath>

namespace softgrain {

double Snapshot::moment() const {
  for (const double x : {time, strain, overlap})
    if (!std::isnan(x)) return x;
  return 0.0;
}

Moment Snapshot::moment_name() const {
  if (!std::isnan(time)) return Moment::time;
  if (!std::isnan(strain)) return Moment::strain;
  return std::isnan(overlap) ? Moment::frame : Moment::overlap;
}

bool is_snapshot(std::int64_t point, std::int64_t points, std::int64_t wanted) {
  if (wanted <= 0 || point < 0 || point >= points) return false;
  if (wanted >= points || point == points - 1) return true;
  // The first of the points that share a number; the last one has the last number to itself.
  const auto number = [&](std::int64_t f) { return f * (wanted - 1) / (points - 1); };
  return wanted > 1 && (point == 0 || number(point) != number(point - 1));
}

}  // namespace softgrain
