// Any text as a scene of every kind: it is read, or refused with an Error; nothing else may happen.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "pipelines/kinds/kinds.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const softgrain::Scene scene = softgrain::Scene::parse(text, "scene.toml");
    softgrain::kind_of(scene).read(scene);
  } catch (const softgrain::Error&) {  // the message that a user sees
  }
  return 0;
}
