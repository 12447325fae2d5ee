#include "pipelines/kinds/hierarchy/level_errors.h"

#include <algorithm>
#include <cmath>

#include "calibrate/bootstrap.h"
#include "common/contact/crowd_from_table.h"
#include "common/data/crowd_replicates.h"
#include "microsim/crowd_arrangements.h"

namespace softgrain {

namespace {

/// Of `a` in a row of crowd_numbers().
constexpr std::size_t kA = 0;

std::vector<double> column(const CrowdLaw& law, std::size_t number) {
  std::vector<double> out;
  for (const std::vector<double>& row : law.replicates) out.push_back(row.at(number));
  return out;
}

std::vector<double> strengths(const LawTableEntry& entry, Crowd form) {
  const CrowdLaw& law = *entry.find(form);
  const double fitted = law_strength(law, entry.overlap_max);
  std::vector<double> out;
  for (const std::vector<double>& row : law.replicates)
    out.push_back(law_strength(with_numbers(law, row), entry.overlap_max) / fitted);
  return out;
}

}  // namespace

std::vector<CrowdPartner> six_planes() {
  std::vector<CrowdPartner> planes;
  for (const Vec3& direction : directions_of(Arrangement::cube)) planes.push_back({PartnerKind::plane, 0.0, direction});
  return planes;
}

double law_strength(const CrowdLaw& law, double overlap) {
  const CrowdModel model = crowd_model(law);
  const std::vector<CrowdPartner> planes = six_planes();
  const double one = crowd_forces(model, {planes[0]}, {overlap})[0];
  const double six = crowd_forces(model, planes, std::vector<double>(planes.size(), 2.0 / 3.0 * overlap))[0];
  return std::sqrt(one * six);
}

double law_onset(const CrowdLaw& law, double most) {
  const CrowdModel model = crowd_model(law);
  const std::vector<CrowdPartner> planes = six_planes();
  double low = 0.0;
  double high = most;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (crowd_forces(model, planes, std::vector<double>(planes.size(), middle))[0] > 0.0 ? high : low) = middle;
  }
  return high;
}

LawTableEntry scaled_law(LawTableEntry entry, double factor) {
  for (CrowdLaw& law : entry.laws) law.a.value *= factor;
  return entry;
}

std::vector<double> strength_draws(const LawTableEntry& below, Crowd form, double sensitivity) {
  std::vector<double> out;
  for (const double s : strengths(below, form)) out.push_back(std::pow(s, sensitivity));
  return out;
}

void spread(LawTableEntry& entry, const std::vector<double>& draws) {
  if (draws.empty()) return;
  const double of_draws = scatter_of(draws);
  for (CrowdLaw& law : entry.laws) {
    if (law.replicates.empty()) continue;
    for (std::size_t r = 0; r < law.replicates.size(); ++r) law.replicates[r][kA] *= draws[r % draws.size()];
    const auto [low, high] = interval95(column(law, kA));
    law.a.standard_error = std::hypot(law.a.standard_error, of_draws * law.a.value);
    law.a.low = std::min(law.a.low, low);
    law.a.high = std::max(law.a.high, high);
  }
}

double strength_error(const LawTableEntry& entry, Crowd form) {
  const std::vector<double> values = strengths(entry, form);
  return values.size() < 2 ? NAN : scatter_of(values);
}

}  // namespace softgrain
