// Tensors of a state: stress and fabric of its contacts; and its inertial number, where it has a rate.
#pragma once

#include <cmath>
#include <vector>

#include "common/core/cell.h"
#include "common/core/limits.h"
#include "common/dynamics/force_pass.h"
#include "common/system.h"

namespace softgrain {

/// Sum over contacts of branch (x) force, row k of the branch's component k, f the whole force on i [N m]. Over the
/// volume it is the stress, compression positive (Love 1927; Christoffersen, Mehrabadi, Nemat-Nasser 1981, DOI
/// 10.1115/1.3157619). A contact with a plane counts with the distance from it. Symmetric where all bodies are in
/// equilibrium of moments.
template <int D>
Matrix<D> branch_force_sum(const std::vector<ContactRecord<D>>& contacts, Slot first_plane) {
  Matrix<D> sum;
  for (const ContactRecord<D>& c : contacts) {
    const Vec<D> force = c.normal * c.normal_force + c.tangential_force;
    const Vec<D> branch = c.j >= first_plane ? c.normal * dot(c.branch, c.normal) : c.branch;
    for (int k = 0; k < D; ++k) sum[k] += force * branch[k];
  }
  return sum;
}

/// Share of a tensor that is antisymmetric: |t - t^T|/2 over |t|, Frobenius norms; 0 of zero.
template <int D>
double asymmetry(const Matrix<D>& t) {
  double skew = 0.0;
  double all = 0.0;
  for (int k = 0; k < D; ++k)
    for (int l = 0; l < D; ++l) {
      const double half = 0.5 * (t[k][l] - t[l][k]);
      skew += half * half;
      all += t[k][l] * t[k][l];
    }
  return all > 0.0 ? std::sqrt(skew / all) : 0.0;
}

/// Fabric tensor, mean of n (x) n over unit vectors n (Satake 1982; Oda 1982, DOI 10.3208/sandf1972.22.4_96): trace 1,
/// 1/D on the diagonal where no direction is preferred; zero without any.
template <int D>
Matrix<D> fabric_tensor(const std::vector<Vec<D>>& directions) {
  Matrix<D> sum;
  for (const Vec<D>& n : directions)
    for (int k = 0; k < D; ++k) sum[k] += n * n[k];
  for (int k = 0; k < D && !directions.empty(); ++k) sum[k] = sum[k] * (1.0 / static_cast<double>(directions.size()));
  return sum;
}

/// Rate of shear of a velocity gradient, sqrt(2 e : e) of its deviatoric symmetric part e [1/s]: of simple shear its
/// only component.
template <int D>
double shear_rate(const Matrix<D>& gradient) {
  double trace = 0.0;
  for (int k = 0; k < D; ++k) trace += gradient[k][k] / static_cast<double>(D);
  double sum = 0.0;
  for (int k = 0; k < D; ++k)
    for (int l = 0; l < D; ++l) {
      const double e = 0.5 * (gradient[k][l] + gradient[l][k]) - (k == l ? trace : 0.0);
      sum += 2.0 * e * e;
    }
  return std::sqrt(sum);
}

/// I = rate d sqrt(density/pressure) (GDR MiDi 2004, DOI 10.1140/epje/i2003-10153-0; da Cruz, Emam, Prochnow, Roux,
/// Chevoir 2005, DOI 10.1103/PhysRevE.72.021309): time of rearrangement over that of strain; below 1e-3 a flow counts
/// as quasi-static. `rate` [1/s], `diameter` d [m], `density` of the grains [kg/m^3; disks: per area], `pressure` [Pa;
/// disks N/m]. NaN where the pressure is not positive.
inline double inertial_number(double rate, double diameter, double density, double pressure) {
  return pressure > 0.0 ? rate * diameter * std::sqrt(density / pressure) : kNaN;
}

}  // namespace softgrain
