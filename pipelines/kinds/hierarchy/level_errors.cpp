#include "pipelines/kinds/hierarchy/level.h"

#include <algorithm>
#include <cmath>

#include "calibrate/bootstrap.h"
#include "common/contact/make_laws.h"
#include "common/data/multi_contact_replicates.h"
#include "microsim/multi_contact_arrangements.h"

namespace softgrain {

namespace {

/// Place of `a` in a row of multi_contact_numbers().
constexpr std::size_t kA = 0;

std::vector<double> column(const MultiContactLaw& law, std::size_t number) {
  std::vector<double> out;
  for (const std::vector<double>& row : law.replicates) out.push_back(row.at(number));
  return out;
}

std::vector<double> strengths(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw& law = *entry.find(form);
  const double fitted = law_strength(law, entry.overlap_max);
  std::vector<double> out;
  for (const std::vector<double>& row : law.replicates)
    out.push_back(law_strength(with_numbers(law, row), entry.overlap_max) / fitted);
  return out;
}

}  // namespace

std::vector<MultiContactPartner> six_planes() {
  std::vector<MultiContactPartner> planes;
  for (const Vec3& direction : directions_of(Arrangement::cube)) planes.push_back({PartnerKind::plane, 0.0, direction});
  return planes;
}

double law_strength(const MultiContactLaw& law, double overlap) {
  const MultiContactModel model = multi_contact_model(law);
  const std::vector<MultiContactPartner> planes = six_planes();
  const double one = multi_contact_forces(model, {planes[0]}, {overlap})[0];
  const double six = multi_contact_forces(model, planes, std::vector<double>(planes.size(), 2.0 / 3.0 * overlap))[0];
  return std::sqrt(one * six);
}

double law_onset(const MultiContactLaw& law, double most) {
  const MultiContactModel model = multi_contact_model(law);
  const std::vector<MultiContactPartner> planes = six_planes();
  double low = 0.0;
  double high = most;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (multi_contact_forces(model, planes, std::vector<double>(planes.size(), middle))[0] > 0.0 ? high : low) = middle;
  }
  return high;
}

LawTableEntry scaled_law(LawTableEntry entry, double factor) {
  for (MultiContactLaw& law : entry.laws) law.a.value *= factor;
  return entry;
}

std::vector<double> strength_draws(const LawTableEntry& below, LawForm form, double sensitivity) {
  std::vector<double> out;
  for (const double s : strengths(below, form)) out.push_back(std::pow(s, sensitivity));
  return out;
}

void spread(LawTableEntry& entry, const std::vector<double>& draws) {
  if (draws.empty()) return;
  const double of_draws = scatter_of(draws);
  for (MultiContactLaw& law : entry.laws) {
    if (law.replicates.empty()) continue;
    for (std::size_t r = 0; r < law.replicates.size(); ++r) law.replicates[r][kA] *= draws[r % draws.size()];
    const auto [low, high] = interval95(column(law, kA));
    law.a.standard_error = std::hypot(law.a.standard_error, of_draws * law.a.value);
    law.a.low = std::min(law.a.low, low);
    law.a.high = std::max(law.a.high, high);
  }
}

double strength_error(const LawTableEntry& entry, LawForm form) {
  const std::vector<double> values = strengths(entry, form);
  return values.size() < 2 ? NAN : scatter_of(values);
}

}  // namespace softgrain
