#include "common/data/snapshot.h"

#include <cmath>

namespace softgrain {

std::string to_string(SnapshotKind kind) {
  switch (kind) {
    case SnapshotKind::particles:
      return "particles";
    case SnapshotKind::soft_particle:
      return "soft-particle";
    case SnapshotKind::macro:
      return "macro";
    case SnapshotKind::twin:
      return "twin";
    case SnapshotKind::powder:
      return "powder";
    case SnapshotKind::grain_box:
      return "grain-box";
  }
  return "";
}

std::string to_string(ParticleRole role) {
  switch (role) {
    case ParticleRole::solid:
      return "solid";
    case ParticleRole::soft:
      return "soft";
    case ParticleRole::inner:
      return "inner";
  }
  return "";
}

double Snapshot::moment() const {
  for (const double x : {time, strain, overlap})
    if (!std::isnan(x)) return x;
  return 0.0;
}

std::string Snapshot::moment_name() const {
  if (!std::isnan(time)) return "time";
  if (!std::isnan(strain)) return "strain";
  return std::isnan(overlap) ? "frame" : "Delta";
}

bool is_snapshot(std::int64_t point, std::int64_t points, std::int64_t wanted) {
  if (wanted <= 0 || point < 0 || point >= points) return false;
  if (wanted >= points || point == points - 1) return true;
  // The first of the points that share a number; the last one has the last number to itself.
  const auto number = [&](std::int64_t f) { return f * (wanted - 1) / (points - 1); };
  return wanted > 1 && (point == 0 || number(point) != number(point - 1));
}

}  // namespace softgrain
