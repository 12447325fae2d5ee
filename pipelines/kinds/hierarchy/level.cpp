// One level of a hierarchy, measured and fitted, and its error bars through the levels below.
#include "pipelines/kinds/hierarchy/level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "calibrate/bootstrap.h"
#include "common/contact/make_laws.h"
#include "common/core/cost.h"
#include "common/core/limits.h"
#include "common/core/particles.h"
#include "common/data/multi_contact_replicates.h"
#include "common/packing/void_filling.h"
#include "microsim/filled_shell.h"
#include "microsim/multi_contact_arrangements.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

SOFTGRAIN_EVERY_MEMBER(ShellFilling, inner_radius, soft_over_grains, onset)

namespace {

constexpr double kStronger = 1.25;  ///< law of the level below, to see how the forces follow it
constexpr std::int64_t kSensitivityPackings = 6;

/// All that the content of a level depends on beside the packings that it is filled into.
std::string tag_of(const HierarchySetup& setup, const HierarchyLevel& below) {
  return KeyText(setup.form, setup.unloading, setup.rolling, setup.fill, setup.inner_radius_min,
                 filling_above(setup, below), below.entry.solid_fraction, numbers_of(below.entry, setup.form))
      .text();
}

/// Facts about the content, means over the packings of the pool.
void describe_content(LevelContents& contents, double fraction_inside, HierarchyLevel& level) {
  const std::vector<ShellPacking>& pool = contents.packings;
  const double share = 1.0 / static_cast<double>(pool.size());
  level.inner_low = 1.0;
  for (std::size_t k = 0; k < pool.size(); ++k) {
    const SoftContent content = contents.of(pool[k], static_cast<std::int64_t>(k));
    for (const InnerSoft& inner : content.inner) {
      level.inner_volume += share * inner.r * inner.r * inner.r;
      level.inner_low = std::min(level.inner_low, inner.r);
      level.inner_high = std::max(level.inner_high, inner.r);
    }
    level.grain_volume += share * content.grains.solid_fraction();
    level.inner_mean += share * static_cast<double>(content.inner.size());
    level.grains += share * static_cast<double>(content.grains.radius.size());
  }
  level.entry.solid_fraction = level.grain_volume + fraction_inside * level.inner_volume;
}

/// Sum over the neighbours of the centre at the last loading point of a run, -1 when it is not there.
double summed_end_force(const MultiContactConfiguration& c, const MultiContactRun& run) {
  const MultiContactPoint* last = nullptr;
  for (const MultiContactPoint& p : run.points)
    if (p.stage == 0) last = &p;
  if (last == nullptr || !last->converged) return -1.0;
  const auto end = last->normal.begin() + static_cast<std::ptrdiff_t>(c.touching());
  return std::accumulate(last->normal.begin(), end, 0.0);
}

const std::string& name_of(const MultiContactMeasurements& data, const MultiContactRun& run) {
  return data.configurations[static_cast<std::size_t>(run.configuration)].name;
}

}  // namespace

std::optional<LevelChange> level_change(const MultiContactMeasurements& data, const MultiContactMeasurements& below,
                                        std::int64_t configuration) {
  const MultiContactConfiguration& c = data.configurations[static_cast<std::size_t>(configuration)];
  std::map<std::int64_t, std::pair<double, double>> pairs;  // by packing, sums over its orientations
  for (const MultiContactRun& a : data.runs)
    for (const MultiContactRun& b : below.runs)
      if (a.configuration == configuration && name_of(below, b) == c.name && a.packing == b.packing &&
          a.orientation == b.orientation) {
        const double here = summed_end_force(c, a);
        const double there = summed_end_force(c, b);
        if (!(here >= 0.0 && there >= 0.0)) continue;
        pairs[a.packing].first += here;
        pairs[a.packing].second += there;
      }
  LevelChange change{c.name, 1.0, 0.0};
  double here = 0.0;
  double there = 0.0;
  for (const auto& [packing, forces] : pairs) {
    here += forces.first;
    there += forces.second;
  }
  if (!(there > 0.0)) return std::nullopt;
  change.ratio = here / there;
  double square = 0.0;
  for (const auto& [packing, forces] : pairs) {
    const double off = forces.first - change.ratio * forces.second;
    square += off * off;
  }
  const auto n = static_cast<double>(pairs.size());
  if (n > 1.0) change.error = std::sqrt(square * n / (n - 1.0)) / there;
  return change;
}

namespace {

Cost cost_of(const MultiContactMeasurements& data) {
  Cost cost;
  for (const MultiContactRun& run : data.runs) cost += run.cost;
  return cost;
}

/// What a level's soft particles hold: grains only on the lowest one, soft particles with the law of `below` above.
MultiContactLevel multi_contact_level(const HierarchySetup& setup, LevelContents& contents, std::int64_t number,
                                      const HierarchyLevel* below) {
  MultiContactLevel multi_contact;
  multi_contact.file = fmt::format("multi_contact_level_{}.h5", number);
  if (below == nullptr) return multi_contact;
  multi_contact.fill = [&contents](const ShellPacking& packing, std::int64_t k) { return contents.of(packing, k); };
  multi_contact.laws = inner_laws(setup, below->entry);
  multi_contact.tag = tag_of(setup, *below);
  return multi_contact;
}

bool of_planes(const MultiContactConfiguration& c) {
  return !c.held_out && std::all_of(c.partners.begin(), c.partners.end(), [](const MultiContactPartner& p) {
    return p.kind == PartnerKind::plane && !p.smooth;
  });
}

/// Planes alone, one and as many as there are: what shows how the law follows that of the level below.
MultiContactSetup planes_of(const MultiContactSetup& setup) {
  MultiContactSetup out = setup;
  std::erase_if(out.configurations, [](const MultiContactConfiguration& c) { return !of_planes(c); });
  std::stable_sort(out.configurations.begin(), out.configurations.end(),
                   [](const auto& a, const auto& b) { return a.partners.size() < b.partners.size(); });
  if (out.configurations.size() > 2)
    out.configurations.erase(out.configurations.begin() + 1, out.configurations.end() - 1);
  out.packings_max = out.packings_min = std::min(kSensitivityPackings, setup.packings_min);
  out.packings.clear();
  out.plan.clear();
  return out;
}

/// Relative change of the forces of planes over that of the law below, from the same packings with that law stronger.
Sensitivity sensitivity_of(const HierarchySetup& setup, LevelContents& contents, const HierarchyLevel& below,
                           HierarchyLevel& level, const MultiContactMeasurements& data, const Run& run) {
  HierarchyLevel stronger = below;
  stronger.entry = scaled_law(below.entry, kStronger);
  MultiContactLevel multi_contact = multi_contact_level(setup, contents, level.number, &stronger);
  multi_contact.file = fmt::format("multi_contact_level_{}_sensitivity.h5", level.number);
  std::vector<ShellPacking> pool = contents.packings;
  const MultiContactMeasurements moved =
      run_multi_contact_stage(planes_of(setup.multi_contact), run, level.left_out, pool, &multi_contact);
  Sensitivity out;
  double weights = 0.0;
  for (std::size_t c = 0; c < moved.configurations.size(); ++c) {
    const std::optional<LevelChange> change = level_change(moved, data, static_cast<std::int64_t>(c));
    if (!change) continue;
    const double error = std::max(change->error, 1e-3);
    out.value += std::log(change->ratio) / std::log(kStronger) / (error * error);
    weights += 1.0 / (error * error);
  }
  out.value = weights > 0.0 ? std::max(0.0, out.value / weights) : 1.0;  // not known: all of it goes on
  out.error = weights > 0.0 ? 1.0 / std::sqrt(weights) / std::log(kStronger) : kInfinity;
  level.cost += cost_of(moved);
  return out;
}

/// How far the law has moved from one level to the next, and how much of that packings alone would make of the forces
/// of planes, which the distance is of.
void compare_with_below(HierarchyLevel& level, const HierarchyLevel& below, const MultiContactMeasurements& data,
                        const MultiContactMeasurements& data_below, LawForm form) {
  double noise = 0.0;
  int planes = 0;
  for (std::size_t c = 0; c < data.configurations.size(); ++c) {
    const std::optional<LevelChange> change = level_change(data, data_below, static_cast<std::int64_t>(c));
    if (!change) continue;
    level.changes.push_back(*change);
    if (!of_planes(data.configurations[c])) continue;
    noise += change->error * change->error;
    ++planes;
  }
  level.distance = law_distance(level.entry, below.entry, form);
  level.distance_noise = planes > 0 ? std::sqrt(noise / planes) : 0.0;
}

/// Draws of the law below go into the draws of this one.
void add_errors_below(const HierarchySetup& setup, LevelContents& contents, const HierarchyLevel& below,
                      const MultiContactMeasurements& data, HierarchyLevel& level, const Run& run) {
  if (setup.replicates == 0) return;
  level.sensitivity = sensitivity_of(setup, contents, below, level, data, run);
  spread(level.entry, strength_draws(below.entry, setup.form, level.sensitivity->value));
  level.error = strength_error(level.entry, setup.form);
}

}  // namespace

SoftContent fill_holes(const HierarchySetup& setup, const ShellFilling& filling, const ShellPacking& packing) {
  SoftContent content{packing, {}, {}};
  std::vector<PackedSphere> placed;
  for (std::size_t k = 0; k < packing.radius.size(); ++k) placed.push_back({packing.position[k], packing.radius[k]});
  VoidFillingOptions holes;
  holes.r_max = setup.inner_radius;
  holes.r_min = setup.inner_radius_min;
  holes.volume = kSphereVolume * filling.soft_over_grains * packing.solid_fraction();
  for (const PackedSphere& s : fill_voids(placed, VoidDomain::unit_sphere(), holes).added)
    content.inner.push_back({s.x, s.r});
  return content;
}

ShellFilling filling_above(const HierarchySetup& setup, const HierarchyLevel& below) {
  return {setup.inner_radius, setup.next_volume / below.grain_volume,
          law_onset(*below.entry.find(setup.form), below.entry.overlap_max)};
}

void LevelContents::begin_level(const HierarchyLevel* below) {
  filling_.reset();
  if (below != nullptr) filling_ = filling_above(setup_, *below);
  known_.clear();
}

SoftContent LevelContents::of(const ShellPacking& packing, std::int64_t number) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = known_.find(number);
    if (found != known_.end()) return found->second;
  }
  SoftContent content{packing, {}, {}};
  if (filling_ && setup_.fill == LevelFill::masses)
    content = fill_shell(setup_.multi_contact.spec, *filling_, packing, seed_);
  else if (filling_)
    content = fill_holes(setup_, *filling_, packing);
  const std::lock_guard<std::mutex> lock(mutex_);
  return known_.emplace(number, std::move(content)).first->second;
}

InnerLaws inner_laws(const HierarchySetup& setup, const LawTableEntry& below) {
  MultiContactChoices choices;
  choices.form = setup.form;
  choices.modulus = setup.multi_contact.spec.youngs_modulus;
  choices.unloading = setup.unloading;
  choices.rolling = setup.rolling;
  const MultiContactLaws laws = make_multi_contact_laws(below, choices);
  return {laws.soft_plane, laws.soft_solid, laws.solid_soft, laws.soft_soft, below.solid_fraction};
}

double law_distance(const LawTableEntry& law, const LawTableEntry& below, LawForm form) {
  const MultiContactModel here = multi_contact_model(*law.find(form));
  const MultiContactModel there = multi_contact_model(*below.find(form));
  const std::vector<MultiContactPartner> cube = six_planes();
  double total = 0.0;
  for (const std::size_t planes : {std::size_t{1}, cube.size()}) {
    const std::vector<MultiContactPartner> partners(cube.begin(), cube.begin() + static_cast<std::ptrdiff_t>(planes));
    const double end = planes == 1 ? below.overlap_max : 2.0 / 3.0 * below.overlap_max;
    double miss = 0.0;
    double all = 0.0;
    for (int k = 1; k <= 30; ++k) {
      const std::vector<double> overlap(planes, end * k / 30.0);
      const double b = multi_contact_forces(there, partners, overlap)[0];
      const double d = multi_contact_forces(here, partners, overlap)[0] - b;
      miss += d * d;
      all += b * b;
    }
    total += all > 0.0 ? miss / all : 0.0;
  }
  return std::sqrt(0.5 * total);
}

HierarchyLevel run_level(const HierarchySetup& setup, LevelContents& contents, std::int64_t number,
                         const HierarchyLevel* below, const MultiContactMeasurements* data_below,
                         MultiContactMeasurements& data, const Run& run) {
  const Stopwatch watch;
  HierarchyLevel level;
  level.number = number;
  contents.begin_level(below);
  const MultiContactLevel multi_contact = multi_contact_level(setup, contents, number, below);
  data = run_multi_contact_stage(setup.multi_contact, run, level.left_out, contents.packings, &multi_contact);
  MultiContactFitOptions fit;
  fit.seed = run.seed;
  fit.replicates = static_cast<int>(setup.replicates);
  level.entry = fit_multi_contact_laws(data, fit);
  describe_content(contents, below != nullptr ? below->entry.solid_fraction : 0.0, level);
  if (below != nullptr) level.grains += level.inner_mean * below->grains;
  level.entry.grains = level.grains;
  level.cost = cost_of(data);
  level.own_error = strength_error(level.entry, setup.form);
  level.error = level.own_error;
  if (below != nullptr) {
    compare_with_below(level, *below, data, *data_below, setup.form);
    add_errors_below(setup, contents, *below, data, level, run);
  }
  level.seconds = watch.seconds();
  return level;
}

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
