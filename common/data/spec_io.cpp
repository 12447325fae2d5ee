#include "common/data/spec_io.h"

#include "common/core/error.h"
#include "common/io/provenance.h"

namespace softgrain {

namespace {

struct SpecField {
  const char* name;
  double SoftParticleSpec::*value;
};

constexpr SpecField kFields[] = {{"shell_radius", &SoftParticleSpec::shell_radius},
                                 {"youngs_modulus", &SoftParticleSpec::youngs_modulus},
                                 {"poisson_ratio", &SoftParticleSpec::poisson_ratio},
                                 {"friction", &SoftParticleSpec::friction},
                                 {"density", &SoftParticleSpec::density},
                                 {"restitution", &SoftParticleSpec::restitution},
                                 {"exponent", &SoftParticleSpec::exponent},
                                 {"polydispersity", &SoftParticleSpec::polydispersity},
                                 {"rmax_over_shell", &SoftParticleSpec::rmax_over_shell},
                                 {"beta", &SoftParticleSpec::beta}};

}  // namespace

void write_spec(const h5::Group& root, const SoftParticleSpec& spec) {
  const h5::Group group = root.create("spec");
  group.attribute("units", "shell_radius m, youngs_modulus Pa, density kg/m^3, all others 1");
  for (const SpecField& field : kFields) group.attribute(field.name, spec.*field.value);
  group.attribute("trials", spec.trials);
  group.attribute("placement", std::string(spec.placement == Placement::voids ? "voids" : "trials"));
}

SoftParticleSpec read_spec(const h5::Group& root) {
  const h5::Group group = root.open("spec");
  SoftParticleSpec spec;
  for (const SpecField& field : kFields) spec.*field.value = group.number(field.name);
  spec.trials = group.integer("trials");
  if (group.has_attribute("placement") && group.text("placement") == "voids") spec.placement = Placement::voids;
  return spec;
}

void write_format(const h5::Group& root, const std::string& format) {
  root.attribute("format", format);
  root.attribute("schema_version", std::int64_t{kSchemaVersion});
}

void require_format(const h5::Group& root, const std::string& format, const std::string& path) {
  if (!root.has_attribute("format") || root.text("format") != format) throw FileTrouble(path + ": holds no " + format);
  const std::int64_t schema = root.integer("schema_version");
  if (schema != kSchemaVersion)
    throw FileTrouble(path + ": schema version " + std::to_string(schema) + ", this program reads version " +
                      std::to_string(kSchemaVersion));
}

}  // namespace softgrain
