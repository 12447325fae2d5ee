#include "calibrate/merge_measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "common/core/error.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

namespace {

struct Quantity {
  const char* name;
  double value;
};

/// Everything that must agree before two files belong to one ensemble.
std::vector<Quantity> conditions(const Measurements& m) {
  const SoftParticleSpec& s = m.spec;
  std::vector<Quantity> out;
  for (const SoftParticleNumber& number : soft_particle_numbers()) out.push_back({number.scene_key, s.*number.value});
  out.insert(out.end(), {{"trials", static_cast<double>(s.trials)},
                         {"shell_turns", m.shell_turns ? 1.0 : 0.0},
                         {"approach_speed", m.approach_speed}});
  return out;
}

bool rotates(const Measurements& m) {
  return std::any_of(m.runs.begin(), m.runs.end(), [](const PackingRun& r) { return !r.tangential.empty(); });
}

void require_same(const Measurements& first, const Measurements& other, const std::string& first_name,
                  const std::string& other_name) {
  const auto a = conditions(first);
  const auto b = conditions(other);
  for (std::size_t k = 0; k < a.size(); ++k)
    if (a[k].value != b[k].value && !(std::isnan(a[k].value) && std::isnan(b[k].value)))
      throw InputError(fmt::format("cannot merge {} and {}: {} = {} and {}", first_name, other_name, a[k].name,
                                   a[k].value, b[k].value));
  if (rotates(first) && rotates(other) && (first.turn != other.turn || first.turn_speed != other.turn_speed))
    throw InputError(fmt::format("cannot merge {} and {}: their rotations are a {} at {} m/s and a {} at {} m/s",
                                 first_name, other_name, to_string(first.turn), first.turn_speed, to_string(other.turn),
                                 other.turn_speed));
  if (!same_sizes(first.spec, other.spec))
    throw InputError(fmt::format("cannot merge {} and {}: the sizes of the grains differ", first_name, other_name));
}

/// A packing is the same when its radii are (every grain was grown to a random neighbour: no two packings agree by
/// chance).
using Measured = std::map<std::tuple<std::vector<double>, PairKind, std::string>, std::string>;

void require_new(const PackingRun& run, const Measurements& part, const std::string& name, Measured& seen) {
  if (run.packing < 0 || run.packing >= static_cast<std::int64_t>(part.packings.size()))
    throw InputError(
        fmt::format("{}: a run refers to packing {}, the file holds {}", name, run.packing, part.packings.size()));
  const PackingInfo& packing = part.packings[static_cast<std::size_t>(run.packing)];
  if (packing.radii.empty()) return;
  const auto [at, fresh] = seen.try_emplace({packing.radii, run.kind, run.relaxation}, name);
  if (!fresh)
    throw InputError(fmt::format("cannot merge {} and {}: packing {} ({}, {}) was measured in both", at->second, name,
                                 packing.seed, to_string(run.kind), run.relaxation));
}

}  // namespace

Measurements merge_measurements(const std::vector<Measurements>& parts, const std::vector<std::string>& names) {
  if (parts.empty() || parts.size() != names.size()) throw InputError("no measurements given");
  Measurements all;
  all.spec = parts.front().spec;
  all.shell_turns = parts.front().shell_turns;
  all.approach_speed = parts.front().approach_speed;
  const auto turned = std::find_if(parts.begin(), parts.end(), rotates);
  if (turned != parts.end()) {
    all.turn = turned->turn;
    all.turn_speed = turned->turn_speed;
  }
  Measured seen;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    require_same(parts.front(), parts[k], names.front(), names[k]);
    if (turned != parts.end())
      require_same(*turned, parts[k], names[static_cast<std::size_t>(turned - parts.begin())], names[k]);
    const auto shift = static_cast<std::int64_t>(all.packings.size());
    all.packings.insert(all.packings.end(), parts[k].packings.begin(), parts[k].packings.end());
    for (PackingRun run : parts[k].runs) {
      require_new(run, parts[k], names[k], seen);
      run.packing += shift;
      all.runs.push_back(std::move(run));
    }
  }
  return all;
}

}  // namespace softgrain
