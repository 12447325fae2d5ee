#include "common/io/provenance.h"

#include <type_traits>

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
  const auto write = [&group](const char* name, const auto& value, const auto&...) {
    if constexpr (std::is_integral_v<std::remove_cvref_t<decltype(value)>>)
      group.attribute(name, static_cast<std::int64_t>(value));
    else
      group.attribute(name, value);
  };
  fields(write, provenance, !provenance.kind.empty());
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
