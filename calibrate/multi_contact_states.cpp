#include "calibrate/multi_contact_states.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/core/statistics.h"
#include "common/data/multi_contact_measurements.h"

namespace softgrain {

namespace {

struct Sums {
  std::vector<Tally> overlap;
  std::vector<Tally> force;
  Tally tangential;
  Tally moment;
};

/// What holds the first neighbour back on its slide, over E Rs^2.
double against_slide(const MultiContactPoint& point, const MultiContactConfiguration& configuration) {
  if (configuration.partners.empty()) return 0.0;
  return -dot(point.tangential.front(), slide_direction(configuration.partners.front().direction));
}

/// What holds it back from rolling, over E Rs^3; 0 where moments were not recorded.
double against_roll(const MultiContactPoint& point, const MultiContactConfiguration& configuration) {
  if (point.moment.empty()) return 0.0;
  const Vec3& n = configuration.partners.front().direction;
  return -dot(point.moment.front(), cross(n, slide_direction(n)));
}

void average(const MultiContactMeasurements& data, std::size_t configuration, const std::vector<double>& weight,
             MultiContactStates& out) {
  const std::size_t neighbours = out.configuration->partners.size();
  const std::size_t touching = out.configuration->touching();
  std::vector<Sums> sums;
  for (const MultiContactRun& run : data.runs) {
    if (run.configuration != static_cast<std::int64_t>(configuration)) continue;
    const double w = weight.empty() ? 1.0 : weight[static_cast<std::size_t>(run.packing)];
    if (!(w > 0.0)) continue;
    for (std::size_t k = 0; k < run.points.size(); ++k) {
      if (k >= sums.size()) {
        sums.push_back({std::vector<Tally>(neighbours), std::vector<Tally>(neighbours), {}, {}});
        out.states.emplace_back();
      }
      const MultiContactPoint& point = run.points[k];
      if (!point.converged) continue;
      for (std::size_t j = 0; j < neighbours; ++j) {
        sums[k].overlap[j].add(point.overlap[j], w);
        sums[k].force[j].add(point.normal[j], w);
      }
      sums[k].tangential.add(against_slide(point, *out.configuration), w);
      sums[k].moment.add(against_roll(point, *out.configuration), w);
      MultiContactState& state = out.states[k];
      state.stage = point.stage;
      state.slide = point.slide;
      state.roll = point.roll;
      state.max_overlap = std::max(state.max_overlap, point.max_overlap);
      ++state.packings;
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k) {
    MultiContactState& state = out.states[k];
    if (state.packings == 0) continue;
    for (std::size_t j = 0; j < neighbours; ++j) {
      state.overlap.push_back(sums[k].overlap[j].mean());
      if (j >= touching) continue;
      state.mean.push_back(sums[k].force[j].mean());
      state.error.push_back(sums[k].force[j].statistics().error_or_zero());
    }
    state.tangential = sums[k].tangential.mean();
    state.moment = sums[k].moment.mean();
  }
  std::erase_if(out.states, [](const MultiContactState& s) { return s.packings < 2; });
}

/// Stages before the first slide, roll or retreat of all; a path that slides from the start counts its first one.
std::span<const MultiContactStage> loading_of(const MultiContactConfiguration& c) {
  const auto end = std::find_if(c.stages.begin() + 1, c.stages.end(),
                                [](const MultiContactStage& s) { return s.move != MultiContactMove::load; });
  return {c.stages.begin(), end};
}

double deepest(const MultiContactConfiguration& c) {
  const std::vector<double>& overlap = loading_of(c).back().overlap;
  return *std::max_element(overlap.begin(), overlap.end());
}

/// Overlaps of the same neighbours in the same proportion.
bool same_way(const std::vector<double>& x, double deep_x, const std::vector<double>& y, double deep_y) {
  constexpr double kSame = 1e-9;
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [&](double a, double b) { return std::abs(a / deep_x - b / deep_y) <= kSame; });
}

/// Whether two configurations begin by pressing the same neighbours in the same way, however deep.
bool same_loading(const MultiContactConfiguration& a, const MultiContactConfiguration& b) {
  constexpr double kSame = 1e-9;
  if (a.partners.size() != b.partners.size()) return false;
  const auto x = loading_of(a);
  const auto y = loading_of(b);
  if (!std::equal(x.begin(), x.end(), y.begin(), y.end(), [&](const MultiContactStage& s, const MultiContactStage& t) {
        return same_way(s.overlap, deepest(a), t.overlap, deepest(b));
      }))
    return false;
  for (std::size_t k = 0; k < a.partners.size(); ++k) {
    const MultiContactPartner& p = a.partners[k];
    const MultiContactPartner& q = b.partners[k];
    if (p.kind != q.kind || p.ratio != q.ratio || p.smooth != q.smooth || p.on != q.on ||
        norm(p.direction - q.direction) > kSame)
      return false;
  }
  return true;
}

/// Held out as a loading, not only as a path that goes on from it.
bool holds_out(const MultiContactStates& c) {
  return c.configuration->held_out && loading_of(*c.configuration).size() == c.configuration->stages.size();
}

/// One loading: of its configurations the deepest is used, the others repeat it. `free`: shells that are free count.
void assign_use(const std::vector<MultiContactStates*>& group, bool free) {
  const auto may_be_fitted = [free](const MultiContactStates& c) {
    return !c.configuration->held_out && (free || !c.configuration->centre_free);
  };
  for (MultiContactStates* c : group) c->use = MultiContactUse::repeated;
  const auto deepest_of = [&](auto&& wanted) {
    MultiContactStates* best = nullptr;
    for (MultiContactStates* c : group)
      if (wanted(*c) && (best == nullptr || deepest(*c->configuration) > deepest(*best->configuration))) best = c;
    return best;
  };
  MultiContactStates* const held_out = deepest_of(holds_out);
  MultiContactStates* const fitted = deepest_of(may_be_fitted);
  if (held_out == nullptr && fitted != nullptr)
    fitted->use = MultiContactUse::fitted;
  else
    (held_out != nullptr ? held_out : group.front())->use = MultiContactUse::predicted;
}

/// Begins with a loading; what slides from the start has none.
bool begins_with_load(const MultiContactStates& c) { return c.configuration->stages.front().slide == 0.0; }

/// Whether configurations have free shells.
bool enough_free(const std::vector<MultiContactStates>& all) {
  return kEnoughFree <= std::count_if(all.begin(), all.end(), [](const MultiContactStates& c) {
           return c.configuration->centre_free && !c.configuration->held_out && begins_with_load(c) &&
                  c.all_of(PartnerKind::plane);
         });
}

void assign_uses(std::vector<MultiContactStates>& all) {
  const bool free = enough_free(all);
  std::vector<std::vector<MultiContactStates*>> groups;
  for (MultiContactStates& c : all) {
    c.use = MultiContactUse::repeated;
    c.for_multi_contact = !free || c.configuration->centre_free;
    if (!begins_with_load(c)) continue;
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const std::vector<MultiContactStates*>& g) {
      const MultiContactConfiguration& first = *g.front()->configuration;
      return same_loading(first, *c.configuration) && first.turning == c.configuration->turning &&
             (!free || first.centre_free == c.configuration->centre_free);
    });
    if (known == groups.end())
      groups.push_back({&c});
    else
      known->push_back(&c);
  }
  for (const auto& group : groups) assign_use(group, free);
}

}  // namespace

bool MultiContactStates::all_of(PartnerKind kind) const {
  return std::all_of(configuration->partners.begin(), configuration->partners.end(),
                     [kind](const MultiContactPartner& p) { return p.kind == kind || p.on >= 0; });
}

double MultiContactStates::largest_force() const {
  double largest = 0.0;
  for (const MultiContactState& s : states)
    for (const double f : s.mean) largest = std::max(largest, f);
  return largest;
}

std::vector<MultiContactStates> average_states(const MultiContactMeasurements& data,
                                               const std::vector<double>& weight) {
  std::vector<MultiContactStates> out(data.configurations.size());
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c].configuration = &data.configurations[c];
    average(data, c, weight, out[c]);
  }
  assign_uses(out);
  return out;
}

}  // namespace softgrain
