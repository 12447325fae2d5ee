#include "common/io/provenance.h"

#include "common/core/error.h"
#include "softgrain_build.h"

namespace softgrain {

Provenance build_provenance() {
  Provenance p;
  p.version = SOFTGRAIN_BUILD_VERSION;
  p.commit = SOFTGRAIN_BUILD_COMMIT;
  p.compiler = SOFTGRAIN_BUILD_COMPILER;
  return p;
}

void write_provenance(const h5::Group& root, const Provenance& provenance) {
  const h5::Group group = root.create("provenance");
  group.attribute("schema_version", std::int64_t{kSchemaVersion});
  group.attribute("program", "softgrain");
  group.attribute("version", provenance.version);
  group.attribute("commit", provenance.commit);
  group.attribute("compiler", provenance.compiler);
  group.attribute("threads", static_cast<std::int64_t>(provenance.threads));
  group.attribute("seed", static_cast<std::int64_t>(provenance.seed));
  group.attribute("command", provenance.command);
  if (!provenance.kind.empty()) group.attribute("kind", provenance.kind);
  group.attribute("scene", provenance.scene);
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

}  // namespace softgrain
