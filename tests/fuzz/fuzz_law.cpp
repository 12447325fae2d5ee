// Any text as a law card, a law table, a card of the cell law or a library of law tables, of which a material in the
// middle is asked.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_library.h"
#include "tests/fuzz/input_file.h"

namespace {

void ask_in_the_middle(const softgrain::LawLibrary& library) {
  using namespace softgrain;
  LibraryPoint middle;
  for (const LibraryVariable& v : kLibraryVariables) {
    const auto [low, high] = std::ranges::minmax(library.materials, {}, [&](const auto& m) { return m.at.*v.value; });
    middle.*v.value = 0.5 * (low.at.*v.value + high.at.*v.value);
  }
  (void)table_of(library, ask_library(library, middle), LibraryMatter{}, 2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softgrain;
  const fuzz::InputFile file(data, size);
  try {
    const FittedLaw law = load_law(file.path());
    (void)law::law_text(law, true);
  } catch (const Error&) {
  }
  try {
    const LawLibrary library = read_library(Scene::load(file.path()));
    if (!library.checks.empty()) ask_in_the_middle(library);  // to check one takes seconds
  } catch (const Error&) {
  }
  return 0;
}
