#include "common/core/monotone_curve.h"

#include <gsl/gsl_spline.h>

#include <algorithm>
#include <stdexcept>

namespace softgrain {

MonotoneCurve::MonotoneCurve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
  if (x_.empty() || x_.size() != y_.size() ||
      std::adjacent_find(x_.begin(), x_.end(), [](double a, double b) { return !(a < b); }) != x_.end())
    throw std::invalid_argument("a curve needs as many values as strictly ascending points");
  if (x_.size() < 2) return;
  const gsl_interp_type* type = x_.size() == 2 ? gsl_interp_linear : gsl_interp_steffen;
  std::shared_ptr<gsl_spline> spline(gsl_spline_alloc(type, x_.size()), gsl_spline_free);
  gsl_spline_init(spline.get(), x_.data(), y_.data(), x_.size());
  spline_ = spline;
}

double MonotoneCurve::value(double x) const {
  if (x_.empty()) throw std::logic_error("value of an empty curve");
  if (x_.size() == 1 || x <= x_.front()) return y_.front();
  if (x >= x_.back()) return y_.back();
  return gsl_spline_eval(static_cast<const gsl_spline*>(spline_.get()), x, nullptr);
}

}  // namespace softgrain
