#include "pipelines/kinds/hierarchy/level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/contact/crowd_from_table.h"
#include "common/core/stopwatch.h"
#include "pipelines/run/key_text.h"

namespace softgrain {

SOFTGRAIN_EVERY_MEMBER(VoidFillingOptions, r_max, r_min, volume, count, tolerance)

namespace {

/// All that the content of a level depends on beside the packings that it is filled into.
std::string tag_of(const HierarchySetup& setup, const LawTableEntry& below) {
  return KeyText(setup.form, setup.unloading, setup.rolling, setup.voids, below.solid_fraction,
                 numbers_of(below, setup.form))
      .text();
}

/// Facts about the inner soft particles, over the packings of the pool.
void describe_inner(LevelContents& contents, HierarchyLevel& level) {
  const std::vector<ShellPacking>& pool = contents.packings;
  level.inner_low = 1.0;
  for (std::size_t k = 0; k < pool.size(); ++k) {
    const SoftContent content = contents.of(pool[k], static_cast<std::int64_t>(k));
    for (const InnerSoft& inner : content.inner) {
      level.inner_volume += inner.r * inner.r * inner.r / static_cast<double>(pool.size());
      level.inner_low = std::min(level.inner_low, inner.r);
      level.inner_high = std::max(level.inner_high, inner.r);
    }
    level.inner_mean += static_cast<double>(content.inner.size()) / static_cast<double>(pool.size());
  }
}

/// Sum over the neighbours of the centre at the last loading point of a run, -1 when it is not there.
double summed_end_force(const CrowdConfiguration& c, const CrowdRun& run) {
  const CrowdPoint* last = nullptr;
  for (const CrowdPoint& p : run.points)
    if (p.stage == 0) last = &p;
  if (last == nullptr || !last->converged) return -1.0;
  const auto end = last->normal.begin() + static_cast<std::ptrdiff_t>(c.touching());
  return std::accumulate(last->normal.begin(), end, 0.0);
}

/// Ratio of mean end forces on the packings that both levels have, with its error by linear propagation of the paired
/// residuals.
LevelChange change_of(const CrowdMeasurements& data, const CrowdMeasurements& below, std::int64_t configuration) {
  std::vector<std::pair<double, double>> pairs;
  for (const CrowdRun& a : data.runs)
    for (const CrowdRun& b : below.runs)
      if (a.configuration == configuration && b.configuration == configuration && a.packing == b.packing &&
          a.orientation == b.orientation) {
        const double here = summed_end_force(data.configurations[static_cast<std::size_t>(configuration)], a);
        const double there = summed_end_force(data.configurations[static_cast<std::size_t>(configuration)], b);
        if (here >= 0.0 && there >= 0.0) pairs.emplace_back(here, there);
      }
  LevelChange change{data.configurations[static_cast<std::size_t>(configuration)].name, 1.0, 0.0};
  double here = 0.0;
  double there = 0.0;
  for (const auto& [a, b] : pairs) {
    here += a;
    there += b;
  }
  if (!(there > 0.0)) return change;
  change.ratio = here / there;
  double square = 0.0;
  for (const auto& [a, b] : pairs) square += (a - change.ratio * b) * (a - change.ratio * b);
  const auto n = static_cast<double>(pairs.size());
  if (n > 1.0) change.error = std::sqrt(square * n / (n - 1.0)) / there;
  return change;
}

Cost cost_of(const CrowdMeasurements& data) {
  Cost cost;
  for (const CrowdRun& run : data.runs) cost += run.cost;
  return cost;
}

/// What a level's soft particles hold: grains only on the lowest one, soft particles with the law of `below` above.
CrowdLevel crowd_level(const HierarchySetup& setup, LevelContents& contents, std::int64_t number,
                       const HierarchyLevel* below) {
  CrowdLevel crowd;
  crowd.file = fmt::format("crowd_level_{}.h5", number);
  if (below == nullptr) return crowd;
  crowd.fill = [&contents](const ShellPacking& packing, std::int64_t k) { return contents.of(packing, k); };
  crowd.laws = inner_laws(setup, below->entry);
  crowd.tag = tag_of(setup, below->entry);
  return crowd;
}

/// How far the law has moved from one level to the next, and how much of that packings alone would make.
void compare_with_below(HierarchyLevel& level, const HierarchyLevel& below, const CrowdMeasurements& data,
                        const CrowdMeasurements& data_below, Crowd form) {
  double noise = 0.0;
  for (std::size_t c = 0; c < data.configurations.size(); ++c) {
    level.changes.push_back(change_of(data, data_below, static_cast<std::int64_t>(c)));
    noise += level.changes.back().error * level.changes.back().error;
  }
  level.distance = law_distance(level.entry, below.entry, form);
  level.distance_noise = std::sqrt(noise / static_cast<double>(level.changes.size()));
}

}  // namespace

SoftContent fill_level(const HierarchySetup& setup, const ShellPacking& packing) {
  SoftContent content{packing, {}, {}};
  std::vector<PackedSphere> placed;
  for (std::size_t k = 0; k < packing.radius.size(); ++k) placed.push_back({packing.position[k], packing.radius[k]});
  for (const PackedSphere& s : fill_voids(placed, VoidDomain::unit_sphere(), setup.voids).added)
    content.inner.push_back({s.x, s.r});
  return content;
}

SoftContent LevelContents::of(const ShellPacking& packing, std::int64_t number) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = known_.find(number);
    if (found != known_.end()) return found->second;
  }
  SoftContent content = fill_level(setup_, packing);
  const std::lock_guard<std::mutex> lock(mutex_);
  return known_.emplace(number, std::move(content)).first->second;
}

InnerLaws inner_laws(const HierarchySetup& setup, const LawTableEntry& below) {
  CrowdChoices choices;
  choices.form = setup.form;
  choices.modulus = setup.crowd.spec.youngs_modulus;
  choices.unloading = setup.unloading;
  choices.rolling = setup.rolling;
  const CrowdLaws laws = make_crowd_laws(below, choices);
  return {laws.soft_plane, laws.soft_solid, laws.solid_soft, laws.soft_soft, below.solid_fraction};
}

double law_distance(const LawTableEntry& law, const LawTableEntry& below, Crowd form) {
  const CrowdModel here = crowd_model(*law.find(form));
  const CrowdModel there = crowd_model(*below.find(form));
  std::vector<CrowdPartner> cube;
  for (int k = 0; k < 6; ++k) {
    CrowdPartner plane;
    plane.direction[k / 2] = k % 2 == 0 ? 1.0 : -1.0;
    cube.push_back(plane);
  }
  double total = 0.0;
  for (const std::size_t planes : {std::size_t{1}, cube.size()}) {
    const std::vector<CrowdPartner> partners(cube.begin(), cube.begin() + static_cast<std::ptrdiff_t>(planes));
    const double end = planes == 1 ? below.overlap_max : 2.0 / 3.0 * below.overlap_max;
    double miss = 0.0;
    double all = 0.0;
    for (int k = 1; k <= 30; ++k) {
      const std::vector<double> overlap(planes, end * k / 30.0);
      const double b = crowd_forces(there, partners, overlap)[0];
      const double d = crowd_forces(here, partners, overlap)[0] - b;
      miss += d * d;
      all += b * b;
    }
    total += all > 0.0 ? miss / all : 0.0;
  }
  return std::sqrt(0.5 * total);
}

HierarchyLevel run_level(const HierarchySetup& setup, LevelContents& contents, std::int64_t number,
                         const HierarchyLevel* below, const CrowdMeasurements* data_below, CrowdMeasurements& data,
                         const Run& run) {
  const Stopwatch watch;
  HierarchyLevel level;
  level.number = number;
  const CrowdLevel crowd = crowd_level(setup, contents, number, below);
  data = run_crowd_stage(setup.crowd, run, level.left_out, contents.packings, &crowd);
  if (below != nullptr) describe_inner(contents, level);
  CrowdFitOptions fit;
  fit.seed = run.seed;
  fit.replicates = 0;
  level.entry = fit_crowd_laws(data, fit);
  double grains = 0.0;
  for (const ShellPacking& p : contents.packings)
    grains += static_cast<double>(p.radius.size()) / static_cast<double>(contents.packings.size());
  level.grains = grains + (below != nullptr ? level.inner_mean * below->grains : 0.0);
  level.cost = cost_of(data);
  if (below != nullptr) compare_with_below(level, *below, data, *data_below, setup.form);
  level.seconds = watch.seconds();
  return level;
}

}  // namespace softgrain
