#include "tests/verification/cases/lattice_cases.h"

#include <array>
#include <cmath>
#include <vector>

#include "microsim/particles/trajectory.h"
#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/outside_run.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

namespace {

constexpr double kRadius = 0.01;
const SceneMaterial kGlass{};

/// A box that repeats itself: edges over the bond length, places over the edges, bonds (one of each pair of opposite
/// ones) over the bond length.
struct LatticeShape {
  Vec3 edges;
  std::array<int, 3> repeats;  ///< per axis: the cell holds more than two diameters
  std::vector<Vec3> places;
  std::vector<Vec3> bonds;
  [[nodiscard]] double volume() const { return edges[0] * edges[1] * edges[2] / static_cast<double>(places.size()); }
};

LatticeShape shape_of(Lattice lattice) {
  if (lattice == Lattice::simple_cubic)
    return {
        {{1.0, 1.0, 1.0}}, {3, 3, 3}, {{{0.5, 0.5, 0.5}}}, {{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 1.0}}}};
  if (lattice == Lattice::body_centred) {
    const double s = 1.0 / std::sqrt(3.0);
    return {{{2.0 * s, 2.0 * s, 2.0 * s}},
            {2, 2, 2},
            {{{0.25, 0.25, 0.25}}, {{0.75, 0.75, 0.75}}},
            {{{s, s, s}}, {{s, s, -s}}, {{s, -s, s}}, {{-s, s, s}}}};
  }
  const double s = 1.0 / std::sqrt(2.0);
  if (lattice == Lattice::face_centred_turned)
    return {
        {{1.0, 1.0, 2.0 * s}},
        {3, 3, 2},
        {{{0.25, 0.25, 0.25}}, {{0.75, 0.75, 0.75}}},
        {{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.5, 0.5, s}}, {{0.5, -0.5, s}}, {{-0.5, 0.5, s}}, {{0.5, 0.5, -s}}}};
  return {{{2.0 * s, 2.0 * s, 2.0 * s}},
          {2, 2, 2},
          {{{0.25, 0.25, 0.25}}, {{0.75, 0.75, 0.25}}, {{0.75, 0.25, 0.75}}, {{0.25, 0.75, 0.75}}},
          {{{s, s, 0.0}}, {{s, -s, 0.0}}, {{s, 0.0, s}}, {{s, 0.0, -s}}, {{0.0, s, s}}, {{0.0, s, -s}}}};
}

double bond_length(const LatticeState& s) { return kRadius * (2.0 - s.overlap); }

double stiffness() {
  return hertz_stiffness(effective_modulus(kGlass.youngs_modulus, kGlass.poisson_ratio), 0.5 * kRadius);
}

/// Grains of a block stretched by `strain`; velocities and spins of a shear with `rate`.
std::string grains(const LatticeState& s, const Vec3& strain, double rate, Vec3& size) {
  const LatticeShape shape = shape_of(s.lattice);
  Vec3 edge;
  for (int k = 0; k < 3; ++k) {
    edge[k] = shape.edges[k] * bond_length(s) * (1.0 + strain[k]);
    size[k] = shape.repeats[static_cast<std::size_t>(k)] * edge[k];
  }
  std::string text;
  const auto& n = shape.repeats;
  for (int box = 0; box < n[0] * n[1] * n[2]; ++box)
    for (const Vec3& place : shape.places) {
      Ball b;
      b.radius = kRadius;
      const Vec3 at = place + Vec3{{double(box % n[0]), double(box / n[0] % n[1]), double(box / (n[0] * n[1]))}};
      for (int k = 0; k < 3; ++k) b.position[k] = edge[k] * at[k];
      b.velocity[0] = rate * b.position[1];
      b.spin[2] = -0.5 * rate;
      text += text_of(b);
    }
  return text;
}

std::string scene_of(const LatticeState& s, const Vec3& strain, double rate, std::int64_t steps) {
  HertzContact contact;
  if (s.has_friction) contact.mu = 1e3;
  Vec3 size{};
  const std::string block = grains(s, strain, rate, size);
  return heading("Cubic lattice of spheres") + text_of(kGlass) + text_of(contact) + block +
         cell(size, true, true, true, rate) + timing(1e-8, steps);
}

Matrix<3> final_stress(const std::string& scene) { return contact_totals(run_text(scene).result.system).stress; }

/// n (x) n terms of the moduli.
struct BondSums {
  double s1 = 0.0, s4 = 0.0, s22 = 0.0;
};

BondSums sums_of(Lattice lattice) {
  if (lattice == Lattice::simple_cubic) return {1.0, 1.0, 0.0};
  if (lattice == Lattice::body_centred) return {4.0 / 3.0, 4.0 / 9.0, 4.0 / 9.0};
  if (lattice == Lattice::face_centred) return {2.0, 1.0, 0.5};
  return {2.0, 1.25, 0.25};
}

/// Volume per grain over l^3.
double volume_of(Lattice lattice) {
  if (lattice == Lattice::simple_cubic) return 1.0;
  return lattice == Lattice::body_centred ? 4.0 / (3.0 * std::sqrt(3.0)) : 1.0 / std::sqrt(2.0);
}

}  // namespace

std::string name_of(Lattice lattice) {
  if (lattice == Lattice::simple_cubic) return "simple cubic";
  if (lattice == Lattice::body_centred) return "body-centred cubic";
  return lattice == Lattice::face_centred ? "face-centred cubic" : "face-centred cubic, turned by 45°";
}

std::string stretched_scene(const LatticeState& s, const Vec3& strain) { return scene_of(s, strain, 0.0, 1); }

Matrix<3> run_stretched(const LatticeState& s, const Vec3& strain) { return final_stress(stretched_scene(s, strain)); }

Matrix<3> stretched_closed_form(const LatticeState& s, const Vec3& strain) {
  const LatticeShape shape = shape_of(s.lattice);
  const double l = bond_length(s);
  const double volume = shape.volume() * l * l * l * (1.0 + strain[0]) * (1.0 + strain[1]) * (1.0 + strain[2]);
  Matrix<3> out;
  for (const Vec3& bond : shape.bonds) {
    Vec3 b;
    for (int k = 0; k < 3; ++k) b[k] = l * bond[k] * (1.0 + strain[k]);
    const double h = 2.0 * kRadius - norm(b);
    if (h <= 0.0) continue;
    const double share = -stiffness() * std::pow(h, 1.5) / (norm(b) * volume);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out[r][c] += share * b[r] * b[c];
  }
  return out;
}

double run_shear_modulus(const LatticeState& s) {
  // A strain that changes overlaps by a thousandth, in 20 steps.
  const double gamma = 1e-3 * s.overlap;
  constexpr std::int64_t kSteps = 20;
  const Matrix<3> stress = final_stress(scene_of(s, {}, gamma / (1e-8 * kSteps), kSteps));
  return 0.5 * (stress[0][1] + stress[1][0]) / gamma;
}

Moduli run_moduli(const LatticeState& s) {
  const double strain = 1e-3 * s.overlap;
  const Matrix<3> longer = run_stretched(s, {{strain, 0.0, 0.0}});
  const Matrix<3> shorter = run_stretched(s, {{-strain, 0.0, 0.0}});
  Moduli out;
  out.c11 = (longer[0][0] - shorter[0][0]) / (2.0 * strain);
  out.c12 = (longer[1][1] - shorter[1][1]) / (2.0 * strain);
  out.c44 = run_shear_modulus(s);
  out.pressure = -run_stretched(s, {})[0][0];
  return out;
}

Moduli moduli_closed_form(const LatticeState& s) {
  const double h = s.overlap * kRadius;
  const double l = bond_length(s);
  const double volume = volume_of(s.lattice) * l * l * l;
  const double nu = kGlass.poisson_ratio;
  const double k = 1.5 * stiffness() * std::sqrt(h);
  const double kt =
      s.has_friction ? 2.0 * kGlass.youngs_modulus / ((2.0 - nu) * (1.0 + nu)) * std::sqrt(0.5 * kRadius * h) : 0.0;
  const double f = stiffness() * std::pow(h, 1.5);
  const BondSums b = sums_of(s.lattice);
  return {(k * l * l * b.s4 + f * l * (b.s4 - b.s1)) / volume, (k * l * l * b.s22 + f * l * (b.s22 + b.s1)) / volume,
          (k * l * l * b.s22 + kt * l * l * (0.5 * b.s1 - b.s22) + f * l * (b.s22 - b.s1)) / volume,
          f * l * b.s1 / volume};
}

}  // namespace softgrain::verification
