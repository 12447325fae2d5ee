// Laws between the entries of a table, and the shapes they promise: inside the neighbouring entries, monotone, smooth.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/monotone_curve.h"
#include "tests/property/random_cloud.h"
#include "tests/support/synthetic_multi_contact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRounding = 1e-12;

/// Points of a curve: x ascending by 0.01 to 1, y from -2 to 2, neighbours equal now and then.
struct Points {
  std::vector<double> x;
  std::vector<double> y;
};

Points any_points(int least) {
  Points p;
  const int n = *rc::gen::inRange(least, 8);
  for (int k = 0; k < n; ++k) {
    p.x.push_back((k == 0 ? 0.0 : p.x.back()) + 0.01 + 0.99 * share());
    const bool flat = k > 0 && *rc::gen::inRange(0, 5) == 0;
    p.y.push_back(flat ? p.y.back() : 4.0 * share() - 2.0);
  }
  return p;
}

RC_GTEST_PROP(CurveProperty, NeverLeavesItsNeighboursAndIsMonotoneBetweenThem, ()) {
  const Points p = any_points(1);
  const MonotoneCurve curve(p.x, p.y);
  for (std::size_t k = 0; k < p.x.size(); ++k) RC_ASSERT(std::abs(curve.value(p.x[k]) - p.y[k]) < kRounding);
  RC_ASSERT(curve.value(p.x.front() - 1.0) == curve.value(p.x.front()));
  RC_ASSERT(curve.value(p.x.back() + 1.0) == curve.value(p.x.back()));
  for (std::size_t k = 1; k < p.x.size(); ++k) {
    const double up = p.y[k] >= p.y[k - 1] ? 1.0 : -1.0;
    double last = p.y[k - 1];
    for (int m = 0; m <= 50; ++m) {
      const double v = curve.value(p.x[k - 1] + (p.x[k] - p.x[k - 1]) * m / 50.0);
      RC_ASSERT(v >= std::min(p.y[k - 1], p.y[k]) - kRounding);
      RC_ASSERT(v <= std::max(p.y[k - 1], p.y[k]) + kRounding);
      RC_ASSERT(up * (v - last) >= -kRounding);
      last = v;
    }
  }
}

/// Slopes from both sides of a point agree: the curve has no corner inside.
RC_GTEST_PROP(CurveProperty, HasNoCorners, ()) {
  const Points p = any_points(3);
  const MonotoneCurve curve(p.x, p.y);
  for (std::size_t k = 1; k + 1 < p.x.size(); ++k) {
    const double left = (p.y[k] - p.y[k - 1]) / (p.x[k] - p.x[k - 1]);
    const double right = (p.y[k + 1] - p.y[k]) / (p.x[k + 1] - p.x[k]);
    const double h = 1e-5 * std::min(p.x[k] - p.x[k - 1], p.x[k + 1] - p.x[k]);
    const double before = (curve.value(p.x[k]) - curve.value(p.x[k] - h)) / h;
    const double after = (curve.value(p.x[k] + h) - curve.value(p.x[k])) / h;
    // A cubic with end slopes up to twice its secant bends by at most 12 secants per length of its piece.
    const double bend = 12.0 * (std::abs(left) / (p.x[k] - p.x[k - 1]) + std::abs(right) / (p.x[k + 1] - p.x[k]));
    RC_ASSERT(std::abs(after - before) <= bend * h + 1e-14 / h);
    if (left * right <= 0.0) RC_ASSERT(std::abs(after) <= bend * h + 1e-14 / h);  // a turning point is level
  }
}

LawTable any_table() {
  LawTable table;
  const int n = *rc::gen::inRange(1, 6);
  double fraction = 0.5;
  for (int k = 0; k < n; ++k) {
    fraction += 0.005 + 0.05 * share();
    table.entries.push_back(synthetic::law_entry(fraction, 0.1 * share() - 0.05));
  }
  return table;
}

/// Numbers of an entry that forces depend on.
std::vector<double> numbers_of(const LawTableEntry& e) {
  std::vector<double> out{e.volume_max, e.overlap_max, e.unloading.value, e.slide_plane.kt_ratio.value,
                          e.slide_soft.friction.value};
  for (const MultiContactLaw& law : e.laws) {
    for (const MultiContactParameterName& p : kMultiContactParameters) out.push_back((law.*p.estimate).value);
    for (const PartnerRow& row : law.partners) out.insert(out.end(), {row.weight.value, row.exponent.value});
  }
  return out;
}

RC_GTEST_PROP(LawTableProperty, EveryNumberLiesBetweenThoseOfTheNeighbouringEntries, ()) {
  const LawTable table = any_table();
  const double x = table.entries.front().solid_fraction +
                   share() * (table.entries.back().solid_fraction - table.entries.front().solid_fraction);
  std::size_t k = 1;
  while (k + 1 < table.entries.size() && table.entries[k].solid_fraction < x) ++k;
  const auto low = numbers_of(table.entries[k < table.entries.size() ? k - 1 : 0]);
  const auto high = numbers_of(table.entries[std::min(k, table.entries.size() - 1)]);
  std::string remark;
  const LawTableEntry entry = entry_at(table, x, RangePolicy::reject, remark);
  const auto found = numbers_of(entry);
  RC_ASSERT(remark.empty());
  RC_ASSERT(found.size() == low.size());
  for (std::size_t n = 0; n < found.size(); ++n) {
    RC_ASSERT(found[n] >= std::min(low[n], high[n]) - kRounding);
    RC_ASSERT(found[n] <= std::max(low[n], high[n]) + kRounding);
  }
}

RC_GTEST_PROP(LawTableProperty, BeyondItsEndsTheNearestEntryHoldsOrNone, ()) {
  const LawTable table = any_table();
  const double beyond = table.entries.back().solid_fraction + 0.0201 + 0.2 * share();
  std::string remark;
  RC_ASSERT_THROWS_AS((void)entry_at(table, beyond, RangePolicy::reject, remark), InputError);
  const auto clamped = numbers_of(entry_at(table, beyond, RangePolicy::clamp, remark));
  const auto last = numbers_of(table.entries.back());
  for (std::size_t n = 0; n < last.size(); ++n) RC_ASSERT(std::abs(clamped[n] - last[n]) < kRounding);
  RC_ASSERT(!remark.empty());
}

/// Nothing below the threshold, never less with more overlap, no jump at the threshold, the derivative is the slope.
RC_GTEST_PROP(LawProperty, AThresholdLawStartsAtZeroAndGrows, ()) {
  ThresholdPowerLaw law;
  law.a.value = 0.01 + 3.0 * share();
  law.b.value = 1.01 + 3.0 * share();
  law.delta.value = 0.3 * share();
  law.c.value = -law.a.value * std::pow(law.delta.value, law.b.value);
  double last = 0.0;
  for (int k = 0; k <= 200; ++k) {
    const double d = 0.005 * k;
    const double f = law.value(d);
    if (d < law.delta.value) RC_ASSERT(f == 0.0);
    RC_ASSERT(f >= last - kRounding);
    last = f;
    const double h = 1e-6;
    if (d < law.delta.value + 2.0 * h) continue;
    RC_ASSERT(std::abs((law.value(d + h) - law.value(d - h)) / (2.0 * h) - law.derivative(d)) <
              1e-4 * (1.0 + law.derivative(d)));
  }
  RC_ASSERT(law.value(law.delta.value + 1e-9) < 1e-6);
}

/// The equivalent volume is homogeneous of degree one in what contacts take, so one contact alone feels no coupling.
RC_GTEST_PROP(LawProperty, OneContactAloneKnowsNoCoupling, ()) {
  MultiContactLaw coupled = synthetic::multi_contact_law(LawForm::directional, 0.05 * share());
  coupled.m0.value = 2.0 * share();
  coupled.m1.value = 2.0 * share() - 1.0;
  coupled.m2.value = 0.5 * share();
  MultiContactLaw plain = coupled;
  plain.form = LawForm::isotropic;
  plain.m0.value = 1.0;
  plain.m1.value = plain.m2.value = 0.0;
  const std::vector<MultiContactPartner> one{{PartnerKind::plane, 0.0, {{0.0, 0.6, 0.8}}}};
  const std::vector<double> overlap{0.05 + 0.4 * share()};
  const double with = multi_contact_forces(multi_contact_model(coupled), one, overlap).front();
  const double without = multi_contact_forces(multi_contact_model(plain), one, overlap).front();
  RC_ASSERT(with >= 0.0);
  RC_ASSERT(std::abs(with - without) <= 1e-9 * (1e-6 + without));
}

RC_GTEST_PROP(LawProperty, TheCapHasTheVolumeItIsMadeFor, ()) {
  const double volume = std::pow(10.0, -12.0 * share());
  const double d = cap_depth(volume);
  RC_ASSERT(std::abs(0.75 * d * d * (1.0 - d / 3.0) - volume) <= 1e-9 * volume);
  RC_ASSERT(cap_depth(0.999 * volume) < d);
}

}  // namespace
