// Measurements as an HDF5 file, and several such files as one ensemble.
// Layout of measurements.h5: "spec", "packings", "runs" (one row per run), "normal" and "tangential" (one row per
// point, the points of a run are consecutive; "runs" says how many it has).
#include "common/data/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/data/fields.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

void fields(auto&& visit, Of<Measurements> auto& m) {
  visit("shell_turns", m.shell_turns);
  visit("approach_speed", m.approach_speed);
  visit("turn", m.turn, kLater);
  visit("turn_speed", m.turn_speed, kLater);
}

namespace {

constexpr const char* kMeasurementsFormat = "soft-particle measurements";

constexpr const char* kRelaxationNumber = "relaxation";
constexpr ListColumn kNormalPoints{"normal_points", &PackingRun::normal};
constexpr ListColumn kTangentialPoints{"tangential_points", &PackingRun::tangential};

template <class Record>
std::vector<Record> read_points(const h5::Group& group) {
  std::vector<Record> points(column_length(group, "converged"));
  read_records(group, points);
  return points;
}

/// Names of relaxations in order of appearance; runs store the number.
std::vector<std::string> relaxations_of(const std::vector<PackingRun>& runs) {
  std::vector<std::string> names;
  for (const PackingRun& run : runs)
    if (std::find(names.begin(), names.end(), run.relaxation) == names.end()) names.push_back(run.relaxation);
  return names;
}

/// Name of the attribute with the settings of relaxation number k.
std::string settings_name(std::size_t k) { return "settings_" + std::to_string(k); }

void write_runs(const h5::Group& root, const Measurements& data) {
  const std::vector<PackingRun>& runs = data.runs;
  const h5::Group group = root.create("runs");
  const std::vector<std::string> names = relaxations_of(runs);
  group.attribute("relaxations", static_cast<std::int64_t>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    group.attribute("relaxation_" + std::to_string(k), names[k]);
    if (const auto said = data.settings.find(names[k]); said != data.settings.end())
      group.attribute(settings_name(k), said->second);
  }
  group.attribute("kinds", "0 soft-solid, 1 soft-soft");
  write_records(group, runs);
  write_column(group, kRelaxationNumber, "1", runs,
               [&](const auto& r) { return std::find(names.begin(), names.end(), r.relaxation) - names.begin(); });
  kNormalPoints.write(group, runs);
  kTangentialPoints.write(group, runs);
  write_records(root.create("normal"), kNormalPoints.joined(runs));
  write_records(root.create("tangential"), kTangentialPoints.joined(runs));
}

std::vector<std::string> read_relaxations(const h5::Group& group) {
  std::vector<std::string> names;
  const std::int64_t count = group.integer("relaxations");
  for (std::int64_t k = 0; k < count; ++k) names.push_back(group.text("relaxation_" + std::to_string(k)));
  return names;
}

std::map<std::string, std::string> read_settings(const h5::Group& root) {
  const h5::Group group = root.open("runs");
  std::map<std::string, std::string> settings;
  const std::vector<std::string> names = read_relaxations(group);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (group.has_attribute(settings_name(k))) settings[names[k]] = group.text(settings_name(k));
  return settings;
}

std::vector<PackingRun> read_runs(const h5::Group& root, std::size_t packings) {
  const h5::Group group = root.open("runs");
  std::vector<PackingRun> runs(column_length(group, "packing"));
  const std::vector<std::string> names = read_relaxations(group);
  read_records(group, runs);
  for (const PackingRun& run : runs) (void)below(run.packing, packings, "packing of a run");
  read_integers(group, kRelaxationNumber, runs, [&](auto& r, auto v) {
    r.relaxation = names[static_cast<std::size_t>(below(v, names.size(), "relaxation of a run"))];
  });
  kNormalPoints.read(group, runs, read_points<NormalPoint>(root.open("normal")));
  kTangentialPoints.read(group, runs, read_points<TangentialPoint>(root.open("tangential")));
  return runs;
}

}  // namespace

SoftParticleSpec unknown_soft_particle(double shell_radius, double youngs_modulus) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  SoftParticleSpec s;
  for (const SoftParticleNumber& number : soft_particle_numbers())
    if (!number.always) s.*number.value = kUnknown;
  s.trials = 0;
  s.shell_radius = shell_radius;
  s.youngs_modulus = youngs_modulus;
  return s;
}

void save(const Measurements& data, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kMeasurementsFormat);
  write_attributes(root, data);
  root.attribute("approach_speed_unit", "m/s");
  root.attribute("turn_speed_unit", "m/s");
  write_spec(root, data.spec);
  write_packings(root, data.packings);
  write_runs(root, data);
  write_provenance(root, provenance);
  file.commit();
}

Measurements load_measurements(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kMeasurementsFormat, path);
  Measurements data;
  data.turn = TurnProtocol::frozen;
  try {
    read_attributes(root, data);
    data.spec = read_spec(root);
    data.packings = read_packings(root);
    data.runs = read_runs(root, data.packings.size());
    data.settings = read_settings(root);
  } catch (const IoError& e) {
    const std::string text = e.what();
    throw IoError(text.starts_with(path) ? text : path + ": damaged: " + text);
  }
  return data;
}

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

/// Settings of every relaxation with the file that said them first.
using Said = std::map<std::string, std::pair<std::string, std::string>>;

void require_same_settings(const Measurements& part, const std::string& name, Said& said) {
  for (const auto& [relaxation, settings] : part.settings) {
    const auto [at, fresh] = said.try_emplace(relaxation, settings, name);
    if (!fresh && at->second.first != settings)
      throw InputError(fmt::format("cannot merge {} and {}: their relaxations \"{}\" differ:\n  {}\n  {}",
                                   at->second.second, name, relaxation, at->second.first, settings));
  }
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
  Said said;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    require_same(parts.front(), parts[k], names.front(), names[k]);
    if (turned != parts.end())
      require_same(*turned, parts[k], names[static_cast<std::size_t>(turned - parts.begin())], names[k]);
    require_same_settings(parts[k], names[k], said);
    all.settings.insert(parts[k].settings.begin(), parts[k].settings.end());
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
