#include "microsim/grain_box/record.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/data/columns.h"
#include "common/data/soft_particle_schema.h"

namespace softgrain {

namespace {

constexpr const char* kFormat = "grain boxes";

struct VectorColumn {
  const char* name;
  const char* unit;
  Vec3 BoxPoint::*values;
};
constexpr VectorColumn kVectors[] = {
    {"strain", "1", &BoxPoint::strain}, {"lengths", "m", &BoxPoint::lengths}, {"stress", "Pa", &BoxPoint::stress}};

struct NumberColumn {
  const char* name;
  const char* unit;
  double BoxPoint::*values;
};
constexpr NumberColumn kNumbers[] = {{"shear_stress", "Pa", &BoxPoint::shear},
                                     {"imbalance", "1", &BoxPoint::imbalance},
                                     {"pressure", "Pa", &BoxPoint::pressure},
                                     {"deviator", "Pa", &BoxPoint::deviator},
                                     {"bulk_modulus", "Pa", &BoxPoint::bulk},
                                     {"shear_modulus", "Pa", &BoxPoint::shear_modulus},
                                     {"bulk_modulus_elastic_probe", "Pa", &BoxPoint::bulk_probe},
                                     {"shear_modulus_elastic_probe", "Pa", &BoxPoint::shear_probe},
                                     {"bulk_modulus_effective_medium", "Pa", &BoxPoint::bulk_medium},
                                     {"shear_modulus_effective_medium", "Pa", &BoxPoint::shear_medium},
                                     {"sliding_share", "1", &BoxPoint::sliding_share},
                                     {"coordination", "1", &BoxPoint::coordination},
                                     {"coordination_without_rattlers", "1", &BoxPoint::coordination_without},
                                     {"mean_normal_force", "N", &BoxPoint::mean_force},
                                     {"solid_fraction", "1", &BoxPoint::solid_fraction}};

/// Columns that files of older versions do not have.
constexpr NumberColumn kLaterNumbers[] = {{"wall_moment", "Pa", &BoxPoint::moment},
                                          {"sliding_limit_at_start", "1", &BoxPoint::at_start_limit}};

struct CountColumn {
  const char* name;
  std::int64_t BoxPoint::*values;
};
constexpr CountColumn kCounts[] = {{"rattlers", &BoxPoint::rattlers}, {"fewest_contacts", &BoxPoint::fewest_contacts}};

struct EffortColumn {
  const char* name;
  std::int64_t StepEffort::*values;
};
constexpr EffortColumn kEffort[] = {{"iterations", &StepEffort::iterations},
                                    {"loop_passes", &StepEffort::loop_passes},
                                    {"contact_evaluations", &StepEffort::contact_evaluations},
                                    {"factorisations", &StepEffort::factorisations},
                                    {"linear_iterations", &StepEffort::linear_iterations},
                                    {"equilibria", &StepEffort::solutions},
                                    {"retries", &StepEffort::retries}};

void write_vector(const h5::Group& g, const VectorColumn& c, const std::vector<BoxPoint>& points) {
  std::vector<double> flat;
  for (const BoxPoint& p : points) flat.insert(flat.end(), (p.*c.values).v.begin(), (p.*c.values).v.end());
  g.write(c.name, std::span<const double>(flat), {points.size(), 3});
  g.attribute_of(c.name, "unit", c.unit);
}

void read_vector(const h5::Group& g, const VectorColumn& c, std::vector<BoxPoint>& points) {
  require_shape(g, c.name, {points.size(), 3});
  require_unit(g, c.name, c.unit);
  const std::vector<double> flat = g.doubles(c.name);
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a) (points[k].*c.values).v[a] = flat[3 * k + a];
}

BoxPhase phase_of(std::int64_t number) {
  if (number < 0 || number > static_cast<std::int64_t>(BoxPhase::done)) throw IoError("a phase that is not known");
  return static_cast<BoxPhase>(number);
}

void write_points(const h5::Group& g, const std::vector<BoxPoint>& points) {
  write_column(g, "phase", "1", points, [](const BoxPoint& p) { return static_cast<std::int64_t>(p.phase); });
  for (const VectorColumn& c : kVectors) write_vector(g, c, points);
  for (const NumberColumn& c : kNumbers)
    write_column(g, c.name, c.unit, points, [&](const BoxPoint& p) { return p.*c.values; });
  for (const NumberColumn& c : kLaterNumbers)
    write_column(g, c.name, c.unit, points, [&](const BoxPoint& p) { return p.*c.values; });
  for (const CountColumn& c : kCounts)
    write_column(g, c.name, "1", points, [&](const BoxPoint& p) { return p.*c.values; });
  for (const EffortColumn& c : kEffort)
    write_column(g, c.name, "1", points, [&](const BoxPoint& p) { return p.effort.*c.values; });
  write_column(g, "residual", "1", points, [](const BoxPoint& p) { return p.effort.residual; });
}

std::vector<BoxPoint> read_points(const h5::Group& g) {
  std::vector<BoxPoint> points(column_length(g, "phase"));
  read_integers(g, "phase", points, [](BoxPoint& p, std::int64_t v) { p.phase = phase_of(v); });
  for (const VectorColumn& c : kVectors) read_vector(g, c, points);
  for (const NumberColumn& c : kNumbers)
    read_doubles(g, c.name, c.unit, points, [&](BoxPoint& p, double v) { p.*c.values = v; });
  for (const NumberColumn& c : kLaterNumbers)
    if (g.has(c.name)) read_doubles(g, c.name, c.unit, points, [&](BoxPoint& p, double v) { p.*c.values = v; });
  for (const CountColumn& c : kCounts)
    read_integers(g, c.name, points, [&](BoxPoint& p, std::int64_t v) { p.*c.values = v; });
  for (const EffortColumn& c : kEffort)
    read_integers(g, c.name, points, [&](BoxPoint& p, std::int64_t v) { p.effort.*c.values = v; });
  read_doubles(g, "residual", "1", points, [](BoxPoint& p, double v) { p.effort.residual = v; });
  return points;
}

void write_failures(const h5::Group& g, const std::vector<BoxFailure>& failures) {
  write_column(g, "before_point", "1", failures, [](const BoxFailure& f) { return f.before_point; });
  for (int a = 0; a < 3; ++a)
    write_column(g, fmt::format("strain_{}", "xyz"[a]), "1", failures,
                 [a](const BoxFailure& f) { return f.tried.strain[a]; });
  write_column(g, "residual", "1", failures, [](const BoxFailure& f) { return f.tried.residual; });
  for (std::size_t k = 0; k < failures.size(); ++k)
    g.attribute(fmt::format("reason_{:06}", k), failures[k].tried.reason);
}

std::vector<BoxFailure> read_failures(const h5::Group& g) {
  std::vector<BoxFailure> failures(column_length(g, "before_point"));
  read_integers(g, "before_point", failures, [](BoxFailure& f, std::int64_t v) { f.before_point = v; });
  for (int a = 0; a < 3; ++a)
    read_doubles(g, fmt::format("strain_{}", "xyz"[a]), "1", failures,
                 [a](BoxFailure& f, double v) { f.tried.strain[a] = v; });
  read_doubles(g, "residual", "1", failures, [](BoxFailure& f, double v) { f.tried.residual = v; });
  for (std::size_t k = 0; k < failures.size(); ++k) failures[k].tried.reason = g.text(fmt::format("reason_{:06}", k));
  return failures;
}

void write_fit(const h5::Group& g, const std::string& name, const PowerFit& fit) {
  g.attribute(name + "_exponent", fit.exponent);
  g.attribute(name + "_standard_error", fit.standard_error);
  g.attribute(name + "_prefactor", fit.prefactor);
  g.attribute(name + "_points", static_cast<std::int64_t>(fit.points));
}

void write_fits(const h5::Group& g, const GrainBoxResult& result) {
  const GrainBoxFits fits = fit_growth(result);
  write_fit(g, "K_low", fits.bulk_low);
  write_fit(g, "K_high", fits.bulk_high);
  write_fit(g, "G_low", fits.shear_low);
  write_fit(g, "G_high", fits.shear_high);
  const GrainBoxFit& range = result.spec.fit;
  const double ranges[] = {range.low[0], range.low[1], range.high[0], range.high[1]};
  g.write("ranges", std::span<const double>(ranges), {2, 2});
  g.attribute_of("ranges", "unit", "Pa");
}

void write_spec(const h5::Group& g, const GrainBoxSpec& spec) {
  g.attribute("name", spec.name);
  g.attribute("arrangement_of", spec.of);
  g.attribute("grains", spec.grains);
  g.attribute("friction", spec.friction);
  g.attribute("wall_friction", spec.walls.friction);
  g.attribute("generation_pressure_Pa", spec.generation.pressure);
  if (!spec.generation.lower_pressures.empty())
    g.write("generation_lower_pressures_Pa", std::span<const double>(spec.generation.lower_pressures));
  g.attribute("youngs_modulus_Pa", spec.material.youngs_modulus);
  g.attribute("poisson_ratio", spec.material.poisson_ratio);
  g.attribute("density_kg_m3", spec.material.density);
  const double radii[] = {spec.material.radius_min, spec.material.radius_max};
  g.write("radii", std::span<const double>(radii));
  g.attribute_of("radii", "unit", "m");
  g.attribute("test", spec.loading.test);
  g.write("increments", std::span<const double>(spec.loading.increments));
}

void write_result(const h5::Group& g, const GrainBoxResult& result) {
  write_spec(g, result.spec);
  g.attribute("usable", static_cast<std::int64_t>(result.usable));
  g.attribute("reason", result.reason);
  write_fits(g.create("fits"), result);
  write_state(g, result.state);
}

/// Files of earlier versions do not say it.
void read_material(const h5::Group& g, GrainBoxMaterial& material) {
  const std::vector<double> radii = g.doubles("radii");
  if (radii.size() != 2) throw IoError("data set 'radii' has a wrong length");
  material.radius_min = radii[0];
  material.radius_max = radii[1];
  material.youngs_modulus = g.number("youngs_modulus_Pa");
  material.poisson_ratio = g.number("poisson_ratio");
  if (g.has_attribute("density_kg_m3")) material.density = g.number("density_kg_m3");
}

GrainBoxResult read_result(const h5::Group& g) {
  GrainBoxResult result;
  GrainBoxSpec& spec = result.spec;
  spec.material.youngs_modulus = kNaN;
  spec.material.density = kNaN;
  spec.name = g.text("name");
  spec.of = g.has_attribute("arrangement_of") ? g.text("arrangement_of") : spec.name;
  spec.grains = g.integer("grains");
  spec.friction = g.number("friction");
  spec.walls.friction = g.number("wall_friction");
  spec.generation.pressure = g.number("generation_pressure_Pa");
  if (g.has("generation_lower_pressures_Pa"))
    spec.generation.lower_pressures = g.doubles("generation_lower_pressures_Pa");
  if (g.has("radii")) read_material(g, spec.material);
  spec.loading.test = g.text("test");
  spec.loading.increments = g.doubles("increments");
  const std::vector<double> ranges = g.open("fits").doubles("ranges");
  if (ranges.size() != 4) throw IoError("data set 'ranges' has a wrong length");
  spec.fit = {{ranges[0], ranges[1]}, {ranges[2], ranges[3]}};
  result.usable = g.integer("usable") != 0;
  result.reason = g.text("reason");
  result.state = read_state(g);
  return result;
}

}  // namespace

std::string to_string(BoxPhase phase) {
  switch (phase) {
    case BoxPhase::compaction:
      return "frictionless compaction";
    case BoxPhase::friction:
      return "compression with friction";
    case BoxPhase::loading:
      return "loading";
    case BoxPhase::done:
      return "done";
    default:
      return "start";
  }
}

std::vector<const BoxPoint*> GrainBoxResult::points_of(BoxPhase phase) const {
  std::vector<const BoxPoint*> out;
  for (const BoxPoint& p : state.points)
    if (p.phase == phase) out.push_back(&p);
  return out;
}

GrainBoxFits fit_growth(const GrainBoxResult& result) {
  std::vector<double> pressure;
  std::vector<double> bulk;
  std::vector<double> shear;
  for (const BoxPoint* p : result.points_of(BoxPhase::loading)) {
    pressure.push_back(p->pressure);
    bulk.push_back(p->bulk);
    shear.push_back(p->shear_modulus);
  }
  const GrainBoxFit& r = result.spec.fit;
  return {fit_power(pressure, bulk, r.low[0], r.low[1]), fit_power(pressure, bulk, r.high[0], r.high[1]),
          fit_power(pressure, shear, r.low[0], r.low[1]), fit_power(pressure, shear, r.high[0], r.high[1])};
}

void write_state(const h5::Group& g, const GrainBoxState& state) {
  g.attribute("phase", static_cast<std::int64_t>(state.phase));
  g.attribute("pressures_met", state.pressures_met);
  g.attribute("growth_passes", state.growth_passes);
  g.attribute("loose_passes", state.loose_passes);
  g.attribute("seconds", state.seconds);
  g.write("stress_free_lengths", std::span<const double>(state.stress_free_lengths.v));
  write_points(g.create("points"), state.points);
  write_failures(g.create("failures"), state.failures);
  write_pack(g.create("pack"), state.pack);
}

GrainBoxState read_state(const h5::Group& g) {
  GrainBoxState state;
  state.phase = phase_of(g.integer("phase"));
  if (g.has_attribute("pressures_met")) state.pressures_met = g.integer("pressures_met");
  state.growth_passes = g.integer("growth_passes");
  state.loose_passes = g.integer("loose_passes");
  state.seconds = g.number("seconds");
  const std::vector<double> lengths = g.doubles("stress_free_lengths");
  if (lengths.size() != 3) throw IoError("data set 'stress_free_lengths' has a wrong length");
  state.stress_free_lengths = {{lengths[0], lengths[1], lengths[2]}};
  state.points = read_points(g.open("points"));
  state.failures = read_failures(g.open("failures"));
  state.pack = read_pack(g.open("pack"));
  return state;
}

void save_grain_boxes(const std::string& path, const std::vector<GrainBoxResult>& results,
                      const Provenance& provenance) {
  h5::AtomicFile file(path);
  const h5::Group root = file.root();
  write_format(root, kFormat);
  const h5::Group packs = root.create("packs");
  for (std::size_t k = 0; k < results.size(); ++k) write_result(packs.create(fmt::format("pack_{:03}", k)), results[k]);
  write_provenance(root, provenance);
  file.commit();
}

std::vector<GrainBoxResult> load_grain_boxes(const std::string& path) {
  const h5::Group root = h5::open_file(path);
  require_format(root, kFormat, path);
  const h5::Group packs = root.open("packs");
  std::vector<GrainBoxResult> results;
  for (const std::string& name : packs.children()) {
    try {
      results.push_back(read_result(packs.open(name)));
    } catch (const IoError& e) {
      throw IoError(path + ": packs/" + name + ": " + e.what());
    }
  }
  return results;
}

}  // namespace softgrain
