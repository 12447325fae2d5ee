#include "microsim/grain_box/record.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/data/attributes.h"
#include "common/data/columns.h"
#include "common/data/rows.h"

namespace softgrain {

namespace {

constexpr const char* kFormat = "grain boxes";

BoxPhase phase_of(std::int64_t number) {
  if (number < 0 || number > static_cast<std::int64_t>(BoxPhase::done)) throw IoError("a phase that is not known");
  return static_cast<BoxPhase>(number);
}

}  // namespace

void fields(auto&& visit, Of<BoxPoint> auto& p) {
  const Limits any = Limits::anything();  // NaN: not defined for this loading, or not probed
  visit("phase", p.phase, "1", UpTo{BoxPhase::done, "a phase that is not known"});
  visit("strain", p.strain, "1", kAsRows);
  visit("lengths", p.lengths, "m", kAsRows);
  visit("stress", p.stress, "Pa", kAsRows);
  visit("shear_stress", p.shear, "Pa");
  visit("imbalance", p.imbalance, "1");
  visit("pressure", p.pressure, "Pa");
  visit("deviator", p.deviator, "Pa");
  visit("bulk_modulus", p.bulk, "Pa", any);
  visit("shear_modulus", p.shear_modulus, "Pa", any);
  visit("bulk_modulus_elastic_probe", p.bulk_probe, "Pa", any);
  visit("shear_modulus_elastic_probe", p.shear_probe, "Pa", any);
  visit("bulk_modulus_effective_medium", p.bulk_medium, "Pa", any);
  visit("shear_modulus_effective_medium", p.shear_medium, "Pa", any);
  visit("sliding_share", p.sliding_share, "1", any);
  visit("coordination", p.coordination, "1");
  visit("coordination_without_rattlers", p.coordination_without, "1");
  visit("mean_normal_force", p.mean_force, "N");
  visit("solid_fraction", p.solid_fraction, "1");
  visit("wall_moment", p.moment, "Pa", kLater);
  visit("sliding_limit_at_start", p.at_start_limit, "1", any, kLater);
  visit("rattlers", p.rattlers, "1");
  visit("fewest_contacts", p.fewest_contacts, "1");
  visit("iterations", p.effort.iterations, "1");
  visit("loop_passes", p.effort.loop_passes, "1");
  visit("contact_evaluations", p.effort.contact_evaluations, "1");
  visit("factorisations", p.effort.factorisations, "1");
  visit("linear_iterations", p.effort.linear_iterations, "1");
  visit("equilibria", p.effort.solutions, "1");
  visit("retries", p.effort.retries, "1");
  visit("residual", p.effort.residual, "1");
}

void fields(auto&& visit, Of<BoxFailure> auto& f) {
  visit("before_point", f.before_point, "1");
  visit("strain", f.tried.strain, "1", Limits::anything());
  visit("residual", f.tried.residual, "1", Limits::anything());
}

/// What the file holds of a specification, beside its lists. Files of earlier versions know no material.
void fields(auto&& visit, Of<GrainBoxSpec> auto& s) {
  visit("name", s.name);
  visit("arrangement_of", s.of, kLater);
  visit("grains", s.grains);
  visit("friction", s.friction);
  visit("wall_friction", s.walls.friction);
  visit("generation_pressure_Pa", s.generation.pressure);
  visit("youngs_modulus_Pa", s.material.youngs_modulus, kLater);
  visit("poisson_ratio", s.material.poisson_ratio, kLater);
  visit("density_kg_m3", s.material.density, kLater);
  visit("test", s.loading.test);
}

/// Its numbers beside phase, points and pack.
void fields(auto&& visit, Of<GrainBoxState> auto& s) {
  visit("pressures_met", s.pressures_met, kLater);
  visit("growth_passes", s.growth_passes);
  visit("loose_passes", s.loose_passes);
  visit("seconds", s.seconds);
}

namespace {

std::vector<BoxPoint> read_points(const h5::Group& g) {
  std::vector<BoxPoint> points(column_length(g, "phase"));
  read_records(g, points);
  return points;
}

void write_failures(const h5::Group& g, const std::vector<BoxFailure>& failures) {
  write_records(g, failures);
  for (std::size_t k = 0; k < failures.size(); ++k)
    g.attribute(fmt::format("reason_{:06}", k), failures[k].tried.reason);
}

std::vector<BoxFailure> read_failures(const h5::Group& g) {
  std::vector<BoxFailure> failures(column_length(g, "before_point"));
  read_records(g, failures);
  for (std::size_t k = 0; k < failures.size(); ++k) failures[k].tried.reason = g.text(fmt::format("reason_{:06}", k));
  return failures;
}

/// Ranges of the fits, low and high, a row each.
constexpr auto kRanges = [](auto&& visit, auto& fit) {
  visit(fit.low);
  visit(fit.high);
};
constexpr auto kRadii = [](auto&& visit, auto& material) {
  visit(material.radius_min);
  visit(material.radius_max);
};

void write_fits(const h5::Group& g, const GrainBoxResult& result) {
  const AttributeWriter write{g};
  const auto write_fit = [&](const std::string& name, const PowerFit& fit, const auto&...) {
    fields([&](const char* number, const auto& value, const auto&...) { write(name + "_" + number, value); }, fit);
  };
  const GrainBoxFits fits = fit_growth(result);
  fields(write_fit, fits);
  g.write("ranges", flat_rows<double>(std::span(&result.spec.fit, 1), kRanges), {2, 2});
  g.attribute_of("ranges", "unit", "Pa");
}

void write_box_spec(const h5::Group& g, const GrainBoxSpec& spec) {
  write_attributes(g, spec);
  if (!spec.generation.lower_pressures.empty())
    g.write("generation_lower_pressures_Pa", std::span<const double>(spec.generation.lower_pressures));
  write_row(g, "radii", spec.material, kRadii);
  g.attribute_of("radii", "unit", "m");
  g.write("increments", std::span<const double>(spec.loading.increments));
}

GrainBoxSpec read_box_spec(const h5::Group& g) {
  GrainBoxSpec spec;
  spec.of.clear();
  spec.material.youngs_modulus = kNaN;
  spec.material.density = kNaN;
  read_attributes(g, spec);
  if (spec.of.empty()) spec.of = spec.name;
  if (g.has("generation_lower_pressures_Pa"))
    spec.generation.lower_pressures = g.doubles("generation_lower_pressures_Pa");
  if (g.has("radii")) read_row(g, "radii", spec.material, kRadii);
  spec.loading.increments = g.doubles("increments");
  read_row(g.open("fits"), "ranges", spec.fit, kRanges);
  return spec;
}

void write_result(const h5::Group& g, const GrainBoxResult& result) {
  write_box_spec(g, result.spec);
  g.attribute("usable", static_cast<std::int64_t>(result.usable));
  g.attribute("reason", result.reason);
  write_fits(g.create("fits"), result);
  write_state(g, result.state);
}

GrainBoxResult read_result(const h5::Group& g) {
  GrainBoxResult result;
  result.spec = read_box_spec(g);
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
  write_attributes(g, state);
  g.write("stress_free_lengths", std::span<const double>(state.stress_free_lengths.v));
  write_records(g.create("points"), state.points);
  write_failures(g.create("failures"), state.failures);
  write_pack(g.create("pack"), state.pack);
}

GrainBoxState read_state(const h5::Group& g) {
  GrainBoxState state;
  state.phase = phase_of(g.integer("phase"));
  read_attributes(g, state);
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
