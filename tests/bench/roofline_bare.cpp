// Programs written for one scene alone: equal spheres in a periodic cube at rest, contacts known and fixed, every
// number that can be a constant is one. What the general loop costs beyond these is the price of being general.
//   bench_softgrain --benchmark_filter=Bare
// The compiler vectorises over contacts (numbers of bodies and contacts each in an array of their own); forces are then
// added to the bodies one contact after the other. Branches are selections: a limit that is not reached scales by 1.
#include <benchmark/benchmark.h>

#include <array>

#include "tests/bench/roofline_scene.h"

namespace {

using namespace softgrain;
using namespace softgrain::bench;

constexpr std::size_t kBlock = 256;

using Column = std::vector<double>;
using Columns = std::array<Column, 3>;

struct BareScene {
  std::vector<std::int32_t> first, second;
  Columns x, v, w, spring;
  std::vector<Stored<3>> force, torque;
  double box = 0.0;  ///< edge of the cube [m]
  double reach = 0.0;
  double a = 0.0;  ///< sqrt(R12)
  double b = 0.0;  ///< alpha sqrt(m12 sqrt(R12)/D)
  HertzCoefficients k;

  explicit BareScene(const System<3>& s, const HertzCoefficients& coefficients) : k(coefficients) {
    const auto& p = s.particles;
    for (std::size_t c = 0; c < 3; ++c) {
      const int axis = static_cast<int>(c);
      for (std::size_t u = 0; u < p.sphere.size(); ++u) {
        x[c].push_back(p.sphere[u].x[axis]);
        v[c].push_back(p.velocity[u][axis]);
        w[c].push_back(p.spin[u][axis]);
      }
    }
    for (const ContactRecord<3>& r : contact_records(s)) {
      first.push_back(r.i);
      second.push_back(r.j);
    }
    take_springs(s);
    force.resize(p.sphere.size());
    torque.resize(p.sphere.size());
    box = s.cell.edges[0][0];
    reach = 2.0 * p.sphere[0].r;
    a = s.contacts.constants.at(0).a;
    b = s.contacts.constants.at(0).b;
  }

  /// Of the pairs that touch; both lists are in the same order.
  void take_springs(const System<3>& s) {
    for (Column& column : spring) column.assign(first.size(), 0.0);
    if (!s.contacts.has_spring) return;
    std::size_t c = 0;
    for (std::size_t pair = 0; pair < s.contacts.i.size() && c < first.size(); ++pair) {
      if (s.contacts.i[pair] != first[c] || s.contacts.j[pair] != second[c]) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) spring[axis][c] = s.contacts.spring[pair][static_cast<int>(axis)];
      ++c;
    }
  }

  void clear() {
    std::fill(force.begin(), force.end(), Stored<3>{});
    std::fill(torque.begin(), torque.end(), StoredRot<3>{});
  }
};

struct Rows {
  std::array<std::array<double, kBlock>, 3> force, moment;
  std::array<double, kBlock> arm;
};

inline void add(Stored<3>& to, const std::array<std::array<double, kBlock>, 3>& rows, std::size_t k, double factor) {
  for (std::size_t c = 0; c < 3; ++c) to[static_cast<int>(c)] += factor * rows[c][k];
}

template <bool kTorque>
void scatter(BareScene& s, const Rows& rows, std::size_t begin, std::size_t many) {
  for (std::size_t k = 0; k < many; ++k) {
    const auto i = static_cast<std::size_t>(s.first[begin + k]);
    const auto j = static_cast<std::size_t>(s.second[begin + k]);
    add(s.force[i], rows.force, k, 1.0);
    add(s.force[j], rows.force, k, -1.0);
    if constexpr (kTorque) {
      add(s.torque[i], rows.moment, k, -rows.arm[k]);
      add(s.torque[j], rows.moment, k, -rows.arm[k]);
    }
  }
}

/// Normal forces alone.
void elastic_block(const BareScene& s, std::size_t begin, std::size_t many, Rows& rows) {
  const std::int32_t* const first = s.first.data() + begin;
  const std::int32_t* const second = s.second.data() + begin;
  const double* const x = s.x[0].data();
  const double* const y = s.x[1].data();
  const double* const z = s.x[2].data();
  const double box = s.box;
  const double inverse_box = 1.0 / box;
  const double stiffness = s.a * s.k.inverse_d;
  const double reach = s.reach;
#pragma omp simd
  for (std::size_t k = 0; k < many; ++k) {
    const std::int32_t i = first[k];
    const std::int32_t j = second[k];
    double dx = x[i] - x[j];
    double dy = y[i] - y[j];
    double dz = z[i] - z[j];
    dx -= box * __builtin_rint(dx * inverse_box);
    dy -= box * __builtin_rint(dy * inverse_box);
    dz -= box * __builtin_rint(dz * inverse_box);
    const double distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const double overlap = reach - distance;
    const double force = stiffness * overlap * std::sqrt(overlap) / distance;
    rows.force[0][k] = force * dx;
    rows.force[1][k] = force * dy;
    rows.force[2][k] = force * dz;
  }
}

/// Friction, rolling bodies, damping, history.
void full_block(BareScene& s, double dt, std::size_t begin, std::size_t many, Rows& rows) {
  const std::int32_t* const first = s.first.data() + begin;
  const std::int32_t* const second = s.second.data() + begin;
  const double* const x = s.x[0].data();
  const double* const y = s.x[1].data();
  const double* const z = s.x[2].data();
  const double* const vx = s.v[0].data();
  const double* const vy = s.v[1].data();
  const double* const vz = s.v[2].data();
  const double* const wx = s.w[0].data();
  const double* const wy = s.w[1].data();
  const double* const wz = s.w[2].data();
  double* const sx = s.spring[0].data() + begin;
  double* const sy = s.spring[1].data() + begin;
  double* const sz = s.spring[2].data() + begin;
  const double box = s.box;
  const double inverse_box = 1.0 / box;
  const double reach = s.reach;
  const double a = s.a;
  const double b = s.b;
  const HertzCoefficients law = s.k;
#pragma omp simd
  for (std::size_t k = 0; k < many; ++k) {
    const std::int32_t i = first[k];
    const std::int32_t j = second[k];
    double nx = x[i] - x[j];
    double ny = y[i] - y[j];
    double nz = z[i] - z[j];
    nx -= box * __builtin_rint(nx * inverse_box);
    ny -= box * __builtin_rint(ny * inverse_box);
    nz -= box * __builtin_rint(nz * inverse_box);
    const double distance = std::sqrt(nx * nx + ny * ny + nz * nz);
    const double inverse = 1.0 / distance;
    nx *= inverse;
    ny *= inverse;
    nz *= inverse;
    const double overlap = reach - distance;
    const double root = std::sqrt(overlap);
    const double contact_radius = a * root;
    const double eta = b * std::sqrt(root);
    const double arm = 0.5 * distance;
    const double tx = (wx[i] + wx[j]) * arm;
    const double ty = (wy[i] + wy[j]) * arm;
    const double tz = (wz[i] + wz[j]) * arm;
    const double ux = vx[i] - vx[j] - (ty * nz - tz * ny);
    const double uy = vy[i] - vy[j] - (tz * nx - tx * nz);
    const double uz = vz[i] - vz[j] - (tx * ny - ty * nx);
    const double speed = ux * nx + uy * ny + uz * nz;
    const double normal = contact_radius * overlap * law.inverse_d - eta * speed;
    const double limit = law.friction * (normal > 0.0 ? normal : 0.0);
    const double gx = ux - nx * speed;
    const double gy = uy - ny * speed;
    const double gz = uz - nz * speed;
    const double along = sx[k] * nx + sy[k] * ny + sz[k] * nz;
    const double before = sx[k] * sx[k] + sy[k] * sy[k] + sz[k] * sz[k];
    double hx = sx[k] - nx * along;
    double hy = sy[k] - ny * along;
    double hz = sz[k] - nz * along;
    const double after = hx * hx + hy * hy + hz * hz;
    const double stretch = std::sqrt(before / (after > 0.0 ? after : 1.0));
    hx = hx * stretch + gx * dt;
    hy = hy * stretch + gy * dt;
    hz = hz * stretch + gz * dt;
    const double stiffness = -law.shear * contact_radius;
    const double size2 = stiffness * stiffness * (hx * hx + hy * hy + hz * hz);
    const double limit2 = limit * limit;
    const bool slides = size2 > limit2;
    const double dashpot = slides ? 0.0 : eta;
    double fx = stiffness * hx - gx * dashpot;
    double fy = stiffness * hy - gy * dashpot;
    double fz = stiffness * hz - gz * dashpot;
    const double total2 = fx * fx + fy * fy + fz * fz;
    // One root and one division serve both limits: of the spring and of spring and dashpot together.
    const double share = total2 > limit2 ? limit / std::sqrt(total2) : 1.0;
    const double kept = slides ? share : 1.0;
    sx[k] = hx * kept;
    sy[k] = hy * kept;
    sz[k] = hz * kept;
    fx *= share;
    fy *= share;
    fz *= share;
    rows.force[0][k] = nx * normal + fx;
    rows.force[1][k] = ny * normal + fy;
    rows.force[2][k] = nz * normal + fz;
    rows.moment[0][k] = ny * fz - nz * fy;
    rows.moment[1][k] = nz * fx - nx * fz;
    rows.moment[2][k] = nx * fy - ny * fx;
    rows.arm[k] = arm;
  }
}

enum class Part { whole, blocks };

template <bool kFull, Part kPart>
void bare_pass(BareScene& s) {
  static Rows rows;
  const std::size_t contacts = s.first.size();
  for (std::size_t begin = 0; begin < contacts; begin += kBlock) {
    const std::size_t many = std::min(kBlock, contacts - begin);
    if constexpr (kFull)
      full_block(s, 0.0, begin, many, rows);
    else
      elastic_block(s, begin, many, rows);
    if constexpr (kPart == Part::whole) scatter<kFull>(s, rows, begin, many);
    benchmark::ClobberMemory();
  }
}

/// By the largest force.
double disagreement(const BareScene& bare, const System<3>& s) {
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t u = 0; u < bare.force.size(); ++u) {
    largest = std::max(largest, norm(s.particles.force[u]));
    difference = std::max(difference, norm(Vec3(bare.force[u]) - s.particles.force[u]));
  }
  return difference / largest;
}

template <bool kFull, Part kPart>
void Bare(benchmark::State& state, bool sorted) {
  const OneThread one_thread;
  const Needs needs{.friction = kFull, .damping = kFull, .sorted = sorted};
  System<3> s = packing(needs);
  constexpr Tangential kTangential = kFull ? Tangential::mindlin : Tangential::none;
  BareScene bare(s, std::get<HertzMindlin<kTangential, kFull>>(law_of(needs)).k);
  clear_forces(s.particles);
  add_contact_forces(s, 0.0, History::advance);
  bare_pass<kFull, Part::whole>(bare);
  if (!(disagreement(bare, s) < 1e-9)) {
    state.SkipWithError("the bare loop and the general one differ");
    return;
  }
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    bare.clear();
    state.ResumeTiming();
    bare_pass<kFull, kPart>(bare);
  }
  const auto contacts = static_cast<double>(bare.first.size());
  state.counters["per_contact"] = {contacts,
                                   benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert};
  state.counters["touching"] = contacts;
}

void BareFull(benchmark::State& state, bool sorted) { Bare<true, Part::whole>(state, sorted); }
void BareElastic(benchmark::State& state, bool sorted) { Bare<false, Part::whole>(state, sorted); }
/// Without adding forces to the bodies.
void BareFullForces(benchmark::State& state, bool sorted) { Bare<true, Part::blocks>(state, sorted); }
void BareElasticForces(benchmark::State& state, bool sorted) { Bare<false, Part::blocks>(state, sorted); }

BENCHMARK_CAPTURE(BareFull, sorted, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BareFull, as_read, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BareFullForces, sorted, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BareElastic, sorted, true)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BareElastic, as_read, false)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BareElasticForces, sorted, true)->Unit(benchmark::kMicrosecond);

}  // namespace
