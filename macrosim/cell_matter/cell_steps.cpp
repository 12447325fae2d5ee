// Steps that bring the sites of cells to rest: their mixing, and the tangent that gives them.
#include "macrosim/cell_matter/cell_steps.h"

#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace softgrain {

namespace {

struct Freed {
  void operator()(gsl_matrix* m) const { gsl_matrix_free(m); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
};
using GslMatrix = std::unique_ptr<gsl_matrix, Freed>;
using GslVector = std::unique_ptr<gsl_vector, Freed>;

/// Shares of the columns whose sum is nearest to f; columns that others already make get little (singular values).
std::vector<double> least_squares(const std::deque<std::vector<Vec3>>& columns, const std::vector<Vec3>& f) {
  const GslMatrix a(gsl_matrix_alloc(3 * f.size(), columns.size()));
  const GslMatrix v(gsl_matrix_alloc(columns.size(), columns.size()));
  const GslVector singular(gsl_vector_alloc(columns.size()));
  const GslVector work(gsl_vector_alloc(columns.size()));
  const GslVector share(gsl_vector_alloc(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < f.size(); ++i)
      for (int k = 0; k < 3; ++k) gsl_matrix_set(a.get(), 3 * i + static_cast<std::size_t>(k), c, columns[c][i][k]);
  gsl_linalg_SV_decomp(a.get(), v.get(), singular.get(), work.get());
  constexpr double kLeast = 1e-6;
  const double least = kLeast * gsl_vector_get(singular.get(), 0);
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (gsl_vector_get(singular.get(), c) < least) gsl_vector_set(singular.get(), c, 0.0);
  const gsl_vector_const_view b = gsl_vector_const_view_array(f.data()->v.data(), 3 * f.size());
  gsl_linalg_SV_solve(a.get(), v.get(), singular.get(), &b.vector, share.get());
  return {share->data, share->data + columns.size()};
}

}  // namespace

std::vector<Vec3> StepMixer::mix(const std::vector<Vec3>& f) {
  if (!step_.empty() && !f_.empty()) {
    std::vector<Vec3> change(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) change[i] = f[i] - f_[i];
    changes_.push_back(std::move(change));
    steps_.push_back(std::move(step_));
    if (changes_.size() > depth_) {
      changes_.pop_front();
      steps_.pop_front();
    }
  }
  step_.clear();
  f_ = f;
  std::vector<Vec3> out = f;
  if (changes_.empty()) return out;
  const std::vector<double> share = least_squares(changes_, f);
  for (std::size_t c = 0; c < changes_.size(); ++c)
    for (std::size_t i = 0; i < f.size(); ++i) out[i] -= (steps_[c][i] + changes_[c][i]) * share[c];
  return out;
}

void StepMixer::forget() {
  changes_.clear();
  steps_.clear();
  step_.clear();
  f_.clear();
}

namespace {

/// Stiffness against the turning of a face, in parts of |p_i - p_j| A/d.
constexpr double kTurn = 0.5;
/// Share of its stiffness that a sliding spring is taken to have along its force. The true value is 0, which would let
/// steps of soft modes overshoot.
constexpr double kSlide = 0.3;
/// Least diagonal of a block, in parts of the mean one: sites that nothing holds stay where they are.
constexpr double kLeast = 1e-3;

void add_dyad(Matrix<3>& m, const Vec3& a, double factor) {
  for (int k = 0; k < 3; ++k) m[k] += a * (factor * a[k]);
}

Matrix<3> sum(Matrix<3> a, const Matrix<3>& b) {
  for (int k = 0; k < 3; ++k) a[k] += b[k];
  return a;
}

double trace(const Matrix<3>& m) { return m[0][0] + m[1][1] + m[2][2]; }

/// Inverse of a symmetric positive matrix.
Matrix<3> inverse(const Matrix<3>& m) {
  Matrix<3> out;
  for (int k = 0; k < 3; ++k) {
    const Vec3& a = m[(k + 1) % 3];
    const Vec3& b = m[(k + 2) % 3];
    out[k] = {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
  }
  const double determinant = dot(m[0], out[0]);
  for (int k = 0; k < 3; ++k) out[k] *= 1.0 / determinant;
  return out;
}

Matrix<3> stiffness_of(const CellFace& face, const FaceSpring& spring, double step_of_pressure) {
  Matrix<3> out;
  const double turn = kTurn * step_of_pressure * face.area / face.distance;
  const double k = spring.tangent * spring.kept;
  const Vec3 normal = face.separation * (1.0 / face.distance);
  for (int a = 0; a < 3; ++a) out[a][a] = turn + k;
  add_dyad(out, normal, -k);
  if (const double size = norm(spring.force); spring.yields > 0.0 && size > 0.0)
    add_dyad(out, spring.force * (1.0 / size), (kSlide - 1.0) * k * spring.yields);
  return out;
}

double product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double out = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) out += dot(a[i], b[i]);
  return out;
}

}  // namespace

CellTangent::CellTangent(const std::vector<Sphere<3>>& sites, const RadicalCells& cells, const CellForces& forces)
    : force_(&forces.force), inverse_(sites.size()), own_(sites.size()) {
  for (const CellResponse& r : forces.response) stiffness_.push_back(r.stiffness);
  for (std::size_t f = 0; f < cells.faces.size(); ++f) {
    const CellFace& face = cells.faces[f];
    if (face.i == face.j) continue;
    const auto i = static_cast<std::size_t>(face.i);
    const auto j = static_cast<std::size_t>(face.j);
    const double step = std::abs(forces.pressure[i] - forces.pressure[j]);
    const FaceSlopes slopes(face, sites[i].x);
    faces_.push_back({i, j, slopes.upper, slopes.lower, stiffness_of(face, forces.trial.springs[f], step)});
    own_[i] -= slopes.lower;
    own_[j] -= slopes.upper;
  }
  find_diagonal();
}

void CellTangent::find_diagonal() {
  for (const Face& f : faces_) {
    for (const std::size_t i : {f.i, f.j}) inverse_[i] = sum(inverse_[i], f.pull);
    add_dyad(inverse_[f.j], f.upper, stiffness_[f.i]);
    add_dyad(inverse_[f.i], f.lower, stiffness_[f.j]);
  }
  double mean = 0.0;
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    add_dyad(inverse_[i], own_[i], stiffness_[i]);
    mean += trace(inverse_[i]) / (3.0 * static_cast<double>(inverse_.size()));
  }
  ridge_ = kLeast * mean;
  for (Matrix<3>& m : inverse_) {
    for (int k = 0; k < 3; ++k) m[k][k] += ridge_;
    m = inverse(m);
  }
}

void CellTangent::apply(const std::vector<Vec3>& u, std::vector<double>& pressed, std::vector<Vec3>& out) const {
  for (std::size_t i = 0; i < u.size(); ++i) pressed[i] = dot(own_[i], u[i]);
  for (const Face& f : faces_) {
    pressed[f.i] += dot(f.upper, u[f.j]);
    pressed[f.j] += dot(f.lower, u[f.i]);
  }
  for (std::size_t i = 0; i < u.size(); ++i) {
    pressed[i] *= stiffness_[i];
    out[i] = own_[i] * pressed[i] + u[i] * ridge_;
  }
  for (const Face& f : faces_) {
    const Vec3 pull = f.pull * (u[f.j] - u[f.i]);
    out[f.j] += f.upper * pressed[f.i] + pull;
    out[f.i] += f.lower * pressed[f.j] - pull;
  }
}

std::vector<Vec3> CellTangent::answer(double tolerance, int most) const {
  const std::size_t n = inverse_.size();
  std::vector<Vec3> u(n);
  std::vector<Vec3> left = *force_;
  std::vector<Vec3> along(n);
  std::vector<Vec3> image(n);
  std::vector<Vec3> scaled(n);
  std::vector<double> pressed(n);
  const double enough = tolerance * tolerance * product(left, left);
  double before = 0.0;
  for (int pass = 0; pass < most && product(left, left) > enough; ++pass) {
    for (std::size_t i = 0; i < n; ++i) scaled[i] = inverse_[i] * left[i];
    const double now = product(scaled, left);
    for (std::size_t i = 0; i < n; ++i) along[i] = scaled[i] + along[i] * (pass > 0 ? now / before : 0.0);
    before = now;
    apply(along, pressed, image);
    const double step = now / product(along, image);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] += along[i] * step;
      left[i] -= image[i] * step;
    }
  }
  return u;
}

}  // namespace softgrain
