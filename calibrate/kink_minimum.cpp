#include "calibrate/kink_minimum.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace softgrain {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;
using Index = Eigen::Index;

constexpr int kMaxSteps = 200;
/// Steps below this share of a standard deviation are nothing.
constexpr double kNoStep = 1e-9;
/// How far beside a kink its slopes are taken, in the units of a step. S does not notice it.
constexpr double kBeside = 1e-7;
/// A kink counts as reached within this share of a step.
constexpr double kReached = 1e-6;
/// Kinks whose gradients are as near as this to those of others are one with them.
constexpr double kParallel = 1e-6;

/// Residuals, slopes and kinks at one place. Columns of what is free, over their norms: a change of a parameter by one
/// changes the residuals by one.
struct Local {
  Vector residuals;
  Matrix slopes;     ///< residuals x free
  Vector unit;       ///< change of each free parameter that is one
  Vector kinks;      ///< g
  Matrix gradients;  ///< kinks x free
};

Eigen::Map<const Vector> as_vector(const std::vector<double>& v) { return {v.data(), static_cast<Index>(v.size())}; }

class KinkSearch {
 public:
  KinkSearch(const LeastSquaresProblem& problem, const std::vector<double>& from, double rank_tolerance)
      : problem_(problem), rank_tolerance_(rank_tolerance), p_(from), held_(from.size(), false) {
    sum_ = sum_at(p_);
    hold_at_bounds();
  }

  std::optional<KinkMinimum> run() {
    if (!std::isfinite(sum_)) return {};
    for (int k = 0; k < kMaxSteps; ++k) {
      const std::optional<Matrix> slopes = all_slopes(p_);
      if (!slopes) return {};
      hold_what_has_no_effect(*slopes);
      const std::optional<Local> at = local(*slopes);
      if (!at) return {};
      if (k == 0) take_reached(*at);
      const std::optional<Vector> step = step_along_kinks(*at);
      if (!step) return {};
      if ((at->slopes * *step).norm() > kNoStep * deviation()) {
        if (!advance(*at, *step)) return {};
      } else {
        if (active_.empty()) return KinkMinimum{p_, 0, linearise(problem_, p_, rank_tolerance_)};
        if (!leave_worst(*at)) return finish(*at);
      }
    }
    return {};
  }

 private:
  [[nodiscard]] double sum_at(const std::vector<double>& p) const {
    std::vector<double> r(problem_.residuals);
    if (!problem_.evaluate(p, r)) return HUGE_VAL;
    const double sum = as_vector(r).squaredNorm();
    return std::isfinite(sum) ? sum : HUGE_VAL;
  }

  [[nodiscard]] double deviation() const {
    return std::sqrt(sum_ / std::max(1.0, static_cast<double>(problem_.residuals) - static_cast<double>(p_.size())));
  }

  /// Parameters on a bound stay there. Where S falls inwards, finish() finds a step left.
  void hold_at_bounds() {
    free_.clear();
    for (std::size_t j = 0; j < p_.size(); ++j) {
      if (!problem_.bounds.empty()) {
        const ParameterBounds& b = problem_.bounds[j];
        const double slack = 1e-9 * std::max(std::abs(p_[j]), std::isfinite(b.high - b.low) ? b.high - b.low : 0.0);
        held_[j] = held_[j] || p_[j] - b.low <= slack || b.high - p_[j] <= slack;
      }
      if (!held_[j]) free_.push_back(j);
    }
  }

  [[nodiscard]] std::vector<double> moved(const Local& at, const Vector& step) const {
    std::vector<double> out = p_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const std::size_t j = free_[k];
      out[j] += step[static_cast<Index>(k)] * at.unit[static_cast<Index>(k)];
      if (!problem_.bounds.empty()) out[j] = std::clamp(out[j], problem_.bounds[j].low, problem_.bounds[j].high);
    }
    return out;
  }

  [[nodiscard]] std::optional<Matrix> all_slopes(const std::vector<double>& p) const {
    std::vector<double> j(problem_.residuals * p.size());
    if (!jacobian_at(problem_, p, j)) return {};
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Matrix out =
        Eigen::Map<const RowMajor>(j.data(), static_cast<Index>(problem_.residuals), static_cast<Index>(p.size()));
    return out.allFinite() ? std::optional<Matrix>(out) : std::nullopt;
  }

  [[nodiscard]] Vector kinks_at(const std::vector<double>& p) const { return as_vector(problem_.kinks(p)); }

  void hold_what_has_no_effect(const Matrix& slopes) {
    std::erase_if(free_, [&](std::size_t j) { return !(slopes.col(static_cast<Index>(j)).norm() > 0.0); });
  }

  [[nodiscard]] std::optional<Local> local(const Matrix& slopes) const {
    Local at;
    std::vector<double> r(problem_.residuals);
    if (!problem_.evaluate(p_, r) || free_.empty()) return {};
    at.residuals = as_vector(r);
    const auto width = static_cast<Index>(free_.size());
    at.slopes.resize(slopes.rows(), width);
    at.unit.resize(width);
    at.kinks = kinks_at(p_);
    at.gradients.resize(at.kinks.size(), width);
    for (Index k = 0; k < width; ++k) {
      const std::size_t j = free_[static_cast<std::size_t>(k)];
      const double norm = slopes.col(static_cast<Index>(j)).norm();
      at.unit[k] = 1.0 / norm;
      at.slopes.col(k) = slopes.col(static_cast<Index>(j)) / norm;
      at.gradients.col(k) = kink_slopes(j) * at.unit[k];
    }
    return at.gradients.allFinite() ? std::optional<Local>(at) : std::nullopt;
  }

  /// dg/dp_j by central differences.
  [[nodiscard]] Vector kink_slopes(std::size_t j) const {
    const double h = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(std::abs(p_[j]), 1e-3);
    std::vector<double> beside = p_;
    beside[j] = p_[j] + h;
    const Vector up = kinks_at(beside);
    beside[j] = p_[j] - h;
    return (up - kinks_at(beside)) / (2.0 * h);
  }

  /// Whether a kink can be held beside the active ones.
  [[nodiscard]] bool independent(const Local& at, Index kink) const {
    if (active_.size() + 1 > free_.size()) return false;
    const Vector gradient = at.gradients.row(kink).transpose();
    if (!(gradient.norm() > 0.0)) return false;
    if (active_.empty()) return true;
    const Matrix others = active_gradients(at).transpose();
    const Vector rest = gradient - others * others.completeOrthogonalDecomposition().solve(gradient);
    return rest.norm() > kParallel * gradient.norm();
  }

  void take_reached(const Local& at) {
    for (Index k = 0; k < at.kinks.size(); ++k)
      if (std::abs(at.kinks[k]) <= kReached * deviation() * at.gradients.row(k).norm() && independent(at, k))
        active_.push_back(k);
  }

  [[nodiscard]] Matrix active_gradients(const Local& at) const {
    Matrix out(static_cast<Index>(active_.size()), at.gradients.cols());
    for (std::size_t k = 0; k < active_.size(); ++k) out.row(static_cast<Index>(k)) = at.gradients.row(active_[k]);
    return out;
  }

  /// Of all steps that change the active kinks by `change`, the one that leaves |r + J x| least; none where J does not
  /// determine it.
  [[nodiscard]] std::optional<Vector> best_step(const Local& at, const Vector& change, const Vector& residuals,
                                                const Matrix& slopes) const {
    const Index free = at.gradients.cols();
    const auto held = static_cast<Index>(active_.size());
    Vector x = Vector::Zero(free);
    Matrix along = Matrix::Identity(free, free);
    if (held > 0) {
      const Matrix g = active_gradients(at);
      x = g.completeOrthogonalDecomposition().solve(change);
      along = (Eigen::HouseholderQR<Matrix>(g.transpose()).householderQ() * along).rightCols(free - held);
    }
    if (held == free) return x;
    Eigen::ColPivHouseholderQR<Matrix> qr(slopes * along);
    qr.setThreshold(rank_tolerance_);
    if (qr.rank() < free - held) return {};
    return x - along * qr.solve(residuals + slopes * x);
  }

  [[nodiscard]] std::optional<Vector> step_along_kinks(const Local& at) const {
    Vector change(static_cast<Index>(active_.size()));
    for (std::size_t k = 0; k < active_.size(); ++k) change[static_cast<Index>(k)] = -at.kinks[active_[k]];
    return best_step(at, change, at.residuals, at.slopes);
  }

  struct Crossing {
    double share = 0.0;  ///< of the step
    Index kink = -1;     ///< -1: none
  };

  /// Shares of a step to try: halves, and where it meets a kink.
  [[nodiscard]] std::vector<Crossing> shares_to_try(const Local& at, const Vector& step) const {
    constexpr int kHalves = 12;
    std::vector<Crossing> out;
    for (Index k = 0; k < at.kinks.size(); ++k) {
      if (std::find(active_.begin(), active_.end(), k) != active_.end()) continue;
      const double share = -at.kinks[k] / at.gradients.row(k).dot(step);
      if (share >= 0.0 && share < 1.0 && independent(at, k)) out.push_back({share, k});
    }
    for (int k = 0; k <= kHalves; ++k) out.push_back({std::ldexp(1.0, -k), -1});
    std::sort(out.begin(), out.end(), [](const Crossing& a, const Crossing& b) { return a.share < b.share; });
    return out;
  }

  /// Moves to the least S along a step; where that is on a kink, or a kink lies right ahead, it is held from then on.
  bool advance(const Local& at, const Vector& step) {
    const std::vector<Crossing> shares = shares_to_try(at, step);
    Crossing best;
    double least = sum_;
    for (const Crossing& c : shares)
      if (const double sum = sum_at(moved(at, c.share * step)); sum < least) {
        least = sum;
        best = c;
      }
    const bool last_digits = (at.slopes * step).norm() <= 1e-4 * deviation();
    if (!(best.share > 0.0)) {
      const auto ahead = std::find_if(shares.begin(), shares.end(), [](const Crossing& c) { return c.kink >= 0; });
      if (ahead != shares.end() && ahead->share <= 1e-2) {
        active_.push_back(ahead->kink);
        return true;
      }
      if (!last_digits || sum_at(moved(at, step)) > sum_ * (1.0 + 1e-9)) return false;
      best = {1.0, -1};  // S carries the rounding of the residuals, the step does not
    }
    p_ = moved(at, best.share * step);
    sum_ = sum_at(p_);
    if (best.kink >= 0) active_.push_back(best.kink);
    hold_at_bounds();
    return true;
  }

  /// A place beside the active kinks: above those in `above`, below the others.
  [[nodiscard]] std::vector<double> beside(const Local& at, const std::vector<bool>& above) const {
    const Matrix g = active_gradients(at);
    Vector change(g.rows());
    for (Index k = 0; k < g.rows(); ++k)
      change[k] = (above[static_cast<std::size_t>(k)] ? 1.0 : -1.0) * kBeside * deviation() * g.row(k).norm() -
                  at.kinks[active_[static_cast<std::size_t>(k)]];
    return moved(at, g.completeOrthogonalDecomposition().solve(change));
  }

  /// Slopes below all active kinks, then above each with the others below; nothing where they are not to be had.
  [[nodiscard]] std::vector<Matrix> slopes_beside(const Local& at) const {
    std::vector<Matrix> out;
    for (std::size_t k = 0; k <= active_.size(); ++k) {
      std::vector<bool> above(active_.size(), false);
      if (k > 0) above[k - 1] = true;
      const std::vector<double> place = beside(at, above);
      const Vector kinks = kinks_at(place);
      for (std::size_t j = 0; j < active_.size(); ++j)
        if ((kinks[active_[j]] > 0.0) != above[j]) return {};
      const std::optional<Matrix> slopes = all_slopes(place);
      if (!slopes) return {};
      out.push_back(*slopes);
    }
    return out;
  }

  /// How S changes across the active kinks, by one unit of each: it rises by 2 (jump - share) above and 2 share below.
  struct Corners {
    std::vector<Matrix> slopes;  ///< as slopes_beside() has them
    Vector jump;                 ///< r^T h
    Vector share;                ///< l r^T h
  };

  [[nodiscard]] std::optional<Corners> corners(const Local& at) const {
    Corners out{slopes_beside(at), {}, {}};
    if (out.slopes.empty()) return {};
    const auto gradient = [&](const Matrix& slopes) {
      const Vector all = slopes.transpose() * at.residuals;
      Vector free(at.unit.size());
      for (std::size_t k = 0; k < free_.size(); ++k)
        free[static_cast<Index>(k)] = all[static_cast<Index>(free_[k])] * at.unit[static_cast<Index>(k)];
      return free;
    };
    const Matrix g = active_gradients(at);
    const Vector low = gradient(out.slopes[0]);
    out.share = g.transpose().completeOrthogonalDecomposition().solve(-low);
    out.jump.resize(g.rows());
    for (Index k = 0; k < g.rows(); ++k)
      out.jump[k] =
          (gradient(out.slopes[static_cast<std::size_t>(k) + 1]) - low).dot(g.row(k)) / g.row(k).squaredNorm();
    return out;
  }

  /// Steps off the kink across which S falls most; false when it rises to either side of all.
  bool leave_worst(const Local& at) {
    const std::optional<Corners> c = corners(at);
    if (!c) return false;
    double most = 0.0;
    std::size_t worst = 0;
    bool up = false;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const auto i = static_cast<Index>(k);
      const double size = at.gradients.row(active_[k]).norm();
      for (const bool above : {false, true}) {
        const double fall = -size * (above ? c->jump[i] - c->share[i] : c->share[i]);
        if (fall <= most) continue;
        most = fall;
        worst = k;
        up = above;
      }
    }
    if (!(most > 0.0)) return false;
    std::vector<bool> above(active_.size(), false);
    above[worst] = up;
    p_ = beside(at, above);
    sum_ = sum_at(p_);
    active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(worst));
    return true;
  }

  /// Whether S is larger a hundredth of a standard deviation to either side of every kink, with the other parameters
  /// as they are best there and the other kinks held.
  [[nodiscard]] bool rises(const Local& at, const Matrix& slopes) const {
    constexpr double kAside = 1e-2;
    const Vector nothing = Vector::Zero(slopes.rows());
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const Vector change = Vector::Unit(static_cast<Index>(active_.size()), static_cast<Index>(k));
      const std::optional<Vector> aside = best_step(at, change, nothing, slopes);
      if (!aside) return false;
      const double size = (slopes * *aside).norm();
      if (!(size > 0.0)) return false;
      for (const double side : {-1.0, 1.0})
        if (!(sum_at(moved(at, *aside * (side * kAside * deviation() / size))) > sum_)) return false;
    }
    return true;
  }

  [[nodiscard]] std::optional<KinkMinimum> finish(const Local& at) const {
    const std::optional<Corners> c = corners(at);
    if (!c) return {};
    Matrix slopes = c->slopes[0];
    for (Index k = 0; k < c->jump.size(); ++k) {
      if (!(c->jump[k] > 0.0) || c->share[k] < 0.0 || c->share[k] > c->jump[k]) return {};
      slopes += (c->share[k] / c->jump[k]) * (c->slopes[static_cast<std::size_t>(k) + 1] - c->slopes[0]);
    }
    Matrix own(slopes.rows(), at.slopes.cols());
    for (std::size_t k = 0; k < free_.size(); ++k)
      own.col(static_cast<Index>(k)) = slopes.col(static_cast<Index>(free_[k])) * at.unit[static_cast<Index>(k)];
    if (!rises(at, own)) return {};
    const Matrix rows = slopes.transpose();  // column-major: row after row of the slopes
    return KinkMinimum{p_, active_.size(),
                       linearised(problem_, p_, {at.residuals.data(), at.residuals.data() + at.residuals.size()},
                                  {rows.data(), rows.data() + rows.size()}, rank_tolerance_)};
  }

  const LeastSquaresProblem& problem_;
  double rank_tolerance_;
  std::vector<double> p_;
  double sum_ = 0.0;
  std::vector<bool> held_;
  std::vector<std::size_t> free_;
  std::vector<Index> active_;  ///< kinks that are held
};

}  // namespace

std::optional<KinkMinimum> find_kink_minimum(const LeastSquaresProblem& problem, const std::vector<double>& from,
                                             double rank_tolerance) {
  return KinkSearch(problem, from, rank_tolerance).run();
}

}  // namespace softgrain
