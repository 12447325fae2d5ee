#include "common/data/spec_io.h"

#include <cmath>

#include "common/core/error.h"
#include "common/core/material.h"
#include "common/data/columns.h"
#include "common/data/fields.h"
#include "common/io/provenance.h"
#include "common/packing/grading_scene.h"

namespace softgrain {

namespace {

struct SpecField {
  const char* name;
  double SoftParticleSpec::*value;
  Limits limits;
};

constexpr double kLeast = std::numeric_limits<double>::min();  ///< above zero
constexpr double kAny = std::numeric_limits<double>::max();

constexpr SpecField kFields[] = {{"shell_radius", &SoftParticleSpec::shell_radius, {kLeast, kAny}},
                                 {"youngs_modulus", &SoftParticleSpec::youngs_modulus, {kLeast, kAny}},
                                 {"poisson_ratio", &SoftParticleSpec::poisson_ratio, {kPoissonLowest, kPoissonHighest}},
                                 {"friction", &SoftParticleSpec::friction, {0.0, kAny}},
                                 {"density", &SoftParticleSpec::density, {kLeast, kAny}},
                                 {"restitution", &SoftParticleSpec::restitution, {0.0, 1.0}},
                                 {"exponent", &SoftParticleSpec::exponent, {-kAny, kAny}},
                                 {"polydispersity", &SoftParticleSpec::polydispersity, {1.0, kAny}},
                                 {"rmax_over_shell", &SoftParticleSpec::rmax_over_shell, {kLeast, 1.0}},
                                 {"beta", &SoftParticleSpec::beta, {kLeast, kAny}}};
constexpr const char* kUnits = "shell_radius m, youngs_modulus Pa, density kg/m^3, all others 1";

}  // namespace

void write_spec(const h5::Group& root, const SoftParticleSpec& spec) {
  const h5::Group group = root.create("spec");
  group.attribute("units", kUnits);
  for (const SpecField& field : kFields)
    if (is_known(spec.*field.value)) group.attribute(field.name, spec.*field.value);
  if (spec.sizes) group.attribute("sizes", spec.sizes->text());
  if (!packing_known(spec)) return;
  group.attribute("trials", spec.trials);
  group.attribute("placement", to_string(spec.placement));
}

SoftParticleSpec read_spec(const h5::Group& root) {
  const h5::Group group = root.open("spec");
  SoftParticleSpec spec;
  if (group.text("units") != kUnits) throw IoError("spec: units '" + group.text("units") + "' are not known");
  if (group.has_attribute("sizes")) {
    spec.sizes = stored_grading(group.text("sizes"));
    spec.exponent = std::numeric_limits<double>::quiet_NaN();
  }
  for (const SpecField& field : kFields)
    if (!spec.sizes || field.value != &SoftParticleSpec::exponent)
      spec.*field.value = read_attribute(group, field.name, field.limits);
  spec.trials = group.integer("trials");
  if (spec.trials < 1) throw IoError("attribute 'trials' is " + std::to_string(spec.trials) + "; allowed: at least 1");
  if (!group.has_attribute("placement")) return spec;
  const auto placement = parse_enum<Placement>(group.text("placement"));
  if (!placement) throw IoError("spec: unknown placement '" + group.text("placement") + "'");
  spec.placement = *placement;
  return spec;
}

void write_format(const h5::Group& root, const std::string& format) {
  root.attribute("format", format);
  root.attribute("schema_version", std::int64_t{kSchemaVersion});
}

void require_format(const h5::Group& root, const std::string& format, const std::string& path) {
  if (!root.has_attribute("format") || root.text("format") != format) throw IoError(path + ": holds no " + format);
  const std::int64_t schema = root.integer("schema_version");
  if (schema != kSchemaVersion)
    throw IoError(path + ": schema version " + std::to_string(schema) + ", this program reads version " +
                  std::to_string(kSchemaVersion));
}

void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings) {
  const h5::Group group = root.create("packings");
  write_records(group, packings);
  write_column(group, "radius_count", "1", packings, [](const auto& p) { return p.radii.size(); });
  std::vector<double> radii;
  for (const PackingInfo& p : packings) radii.insert(radii.end(), p.radii.begin(), p.radii.end());
  group.write("radii", std::span<const double>(radii));
  group.attribute_of("radii", "unit", "m");
}

std::vector<PackingInfo> read_packings(const h5::Group& root) {
  const h5::Group group = root.open("packings");
  std::vector<PackingInfo> packings(column_length(group, "seed"));
  read_records(group, packings);
  const std::vector<double> radii =
      read_numbers(group, "radii", "m", {group.doubles("radii").size()}, Limits::not_negative());
  Slices slices(radii.size());
  read_integers(group, "radius_count", packings, [&](auto& p, auto v) { p.radii = take(radii, slices, v); });
  slices.finish();
  return packings;
}

}  // namespace softgrain
