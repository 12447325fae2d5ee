// Layout of measurements.h5: "spec", "packings", "runs" (one row per run), "normal" and "tangential" (one row per
// point, the points of a run are consecutive; "runs" says how many it has).
#include "common/data/measurements.h"

#include <algorithm>

#include "common/data/columns.h"
#include "common/data/packing_io.h"
#include "common/data/spec_io.h"

namespace softgrain {

namespace {

constexpr const char* kMeasurementsFormat = "soft-particle measurements";

void write_normal(const h5::Group& root, const std::vector<NormalPoint>& points) {
  const h5::Group group = root.create("normal");
  write_column(group, "delta", "1", points, [](const auto& p) { return p.delta; });
  write_column(group, "force", "N", points, [](const auto& p) { return p.force; });
  write_column(group, "residual", "1", points, [](const auto& p) { return p.residual; });
  write_column(group, "max_overlap", "1", points, [](const auto& p) { return p.max_overlap; });
  write_column(group, "converged", "1", points, [](const auto& p) { return p.converged; });
}

std::vector<NormalPoint> read_normal(const h5::Group& root) {
  const h5::Group group = root.open("normal");
  std::vector<NormalPoint> points(column_length(group, "converged"));
  read_finite(
      group, "delta", "1", points, [](auto& p, double v) { p.delta = v; }, kOverlaps);
  read_finite(group, "force", "N", points, [](auto& p, double v) { p.force = v; });
  read_doubles(group, "residual", "1", points, [](auto& p, double v) { p.residual = v; });
  read_finite(
      group, "max_overlap", "1", points, [](auto& p, double v) { p.max_overlap = v; }, Limits::not_negative());
  read_integers(
      group, "converged", points, [](auto& p, auto v) { p.converged = v != 0; }, Limits::flag());
  return points;
}

void write_tangential(const h5::Group& root, const std::vector<TangentialPoint>& points) {
  const h5::Group group = root.create("tangential");
  write_column(group, "delta", "1", points, [](const auto& p) { return p.delta; });
  write_column(group, "angle", "degree", points, [](const auto& p) { return p.angle_deg; });
  write_column(group, "force_parallel", "N", points, [](const auto& p) { return p.force_parallel; });
  write_column(group, "force_perpendicular", "N", points, [](const auto& p) { return p.force_perpendicular; });
  write_column(group, "residual", "1", points, [](const auto& p) { return p.residual; });
  write_column(group, "converged", "1", points, [](const auto& p) { return p.converged; });
}

std::vector<TangentialPoint> read_tangential(const h5::Group& root) {
  const h5::Group group = root.open("tangential");
  std::vector<TangentialPoint> points(column_length(group, "converged"));
  read_finite(
      group, "delta", "1", points, [](auto& p, double v) { p.delta = v; }, kOverlaps);
  read_finite(group, "angle", "degree", points, [](auto& p, double v) { p.angle_deg = v; }, {-360.0, 360.0});
  read_finite(group, "force_parallel", "N", points, [](auto& p, double v) { p.force_parallel = v; });
  read_finite(group, "force_perpendicular", "N", points, [](auto& p, double v) { p.force_perpendicular = v; });
  read_doubles(group, "residual", "1", points, [](auto& p, double v) { p.residual = v; });
  read_integers(
      group, "converged", points, [](auto& p, auto v) { p.converged = v != 0; }, Limits::flag());
  return points;
}

void write_cost(const h5::Group& group, const std::string& prefix, const std::vector<PackingRun>& runs,
                Cost PackingRun::*cost) {
  write_column(group, prefix + "_loop_passes", "1", runs, [cost](const auto& r) { return (r.*cost).loop_passes; });
  write_column(group, prefix + "_contact_evaluations", "1", runs,
               [cost](const auto& r) { return (r.*cost).contact_evaluations; });
  write_column(group, prefix + "_seconds", "s", runs, [cost](const auto& r) { return (r.*cost).seconds; });
}

void read_cost(const h5::Group& group, const std::string& prefix, std::vector<PackingRun>& runs,
               Cost PackingRun::*cost) {
  const Limits limits = Limits::not_negative();
  read_integers(
      group, prefix + "_loop_passes", runs, [cost](auto& r, auto v) { (r.*cost).loop_passes = v; }, limits);
  read_integers(
      group, prefix + "_contact_evaluations", runs, [cost](auto& r, auto v) { (r.*cost).contact_evaluations = v; },
      limits);
  read_finite(
      group, prefix + "_seconds", "s", runs, [cost](auto& r, double v) { (r.*cost).seconds = v; }, limits);
}

/// Names of relaxations in order of appearance; runs store the number.
std::vector<std::string> relaxations_of(const std::vector<PackingRun>& runs) {
  std::vector<std::string> names;
  for (const PackingRun& run : runs)
    if (std::find(names.begin(), names.end(), run.relaxation) == names.end()) names.push_back(run.relaxation);
  return names;
}

void write_runs(const h5::Group& root, const std::vector<PackingRun>& runs) {
  const h5::Group group = root.create("runs");
  const std::vector<std::string> names = relaxations_of(runs);
  group.attribute("relaxations", static_cast<std::int64_t>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) group.attribute("relaxation_" + std::to_string(k), names[k]);
  group.attribute("kinds", "0 soft-solid, 1 soft-soft");
  write_column(group, "packing", "1", runs, [](const auto& r) { return r.packing; });
  write_column(group, "kind", "1", runs, [](const auto& r) { return r.kind == PairKind::soft_solid ? 0 : 1; });
  write_column(group, "relaxation", "1", runs,
               [&](const auto& r) { return std::find(names.begin(), names.end(), r.relaxation) - names.begin(); });
  write_column(group, "normal_points", "1", runs, [](const auto& r) { return r.normal.size(); });
  write_column(group, "tangential_points", "1", runs, [](const auto& r) { return r.tangential.size(); });
  write_cost(group, "normal", runs, &PackingRun::normal_cost);
  write_cost(group, "tangential", runs, &PackingRun::tangential_cost);
  std::vector<NormalPoint> normal;
  std::vector<TangentialPoint> tangential;
  for (const PackingRun& run : runs) {
    normal.insert(normal.end(), run.normal.begin(), run.normal.end());
    tangential.insert(tangential.end(), run.tangential.begin(), run.tangential.end());
  }
  write_normal(root, normal);
  write_tangential(root, tangential);
}

std::vector<std::string> read_relaxations(const h5::Group& group) {
  std::vector<std::string> names;
  const std::int64_t count = group.integer("relaxations");
  for (std::int64_t k = 0; k < count; ++k) names.push_back(group.text("relaxation_" + std::to_string(k)));
  return names;
}

std::vector<PackingRun> read_runs(const h5::Group& root, std::size_t packings) {
  const h5::Group group = root.open("runs");
  std::vector<PackingRun> runs(column_length(group, "packing"));
  const std::vector<std::string> names = read_relaxations(group);
  read_integers(group, "packing", runs, [&](auto& r, auto v) { r.packing = below(v, packings, "packing of a run"); });
  read_integers(group, "kind", runs, [](auto& r, auto v) {
    r.kind = below(v, 2, "kind of a run") == 0 ? PairKind::soft_solid : PairKind::soft_soft;
  });
  read_integers(group, "relaxation", runs, [&](auto& r, auto v) {
    r.relaxation = names[static_cast<std::size_t>(below(v, names.size(), "relaxation of a run"))];
  });
  read_cost(group, "normal", runs, &PackingRun::normal_cost);
  read_cost(group, "tangential", runs, &PackingRun::tangential_cost);
  const std::vector<NormalPoint> normal = read_normal(root);
  const std::vector<TangentialPoint> tangential = read_tangential(root);
  Slices normal_slices(normal.size());
  Slices tangential_slices(tangential.size());
  read_integers(group, "normal_points", runs, [&](auto& r, auto v) { r.normal = take(normal, normal_slices, v); });
  read_integers(group, "tangential_points", runs,
                [&](auto& r, auto v) { r.tangential = take(tangential, tangential_slices, v); });
  normal_slices.finish();
  tangential_slices.finish();
  return runs;
}

}  // namespace

SoftParticleSpec unknown_soft_particle(double shell_radius, double youngs_modulus) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  SoftParticleSpec s;
  for (double SoftParticleSpec::*value :
       {&SoftParticleSpec::poisson_ratio, &SoftParticleSpec::friction, &SoftParticleSpec::density,
        &SoftParticleSpec::restitution, &SoftParticleSpec::exponent, &SoftParticleSpec::polydispersity,
        &SoftParticleSpec::rmax_over_shell, &SoftParticleSpec::beta})
    s.*value = kUnknown;
  s.trials = 0;
  s.shell_radius = shell_radius;
  s.youngs_modulus = youngs_modulus;
  return s;
}

void save(const Measurements& data, const std::string& path, const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kMeasurementsFormat);
  root.attribute("shell_turns", static_cast<std::int64_t>(data.shell_turns));
  root.attribute("approach_speed", data.approach_speed);
  root.attribute("approach_speed_unit", "m/s");
  write_spec(root, data.spec);
  write_packings(root, data.packings);
  write_runs(root, data.runs);
  write_provenance(root, provenance);
  file.commit();
}

Measurements load_measurements(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kMeasurementsFormat, path);
  Measurements data;
  data.shell_turns = root.integer("shell_turns") != 0;
  data.approach_speed = root.number("approach_speed");
  try {
    data.spec = read_spec(root);
    data.packings = read_packings(root);
    data.runs = read_runs(root, data.packings.size());
  } catch (const FileTrouble& e) {
    const std::string text = e.what();
    throw FileTrouble(text.starts_with(path) ? text : path + ": damaged: " + text);
  }
  return data;
}

}  // namespace softgrain
