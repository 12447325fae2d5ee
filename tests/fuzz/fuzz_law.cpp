// Any text as a law card or a law table.
#include <cstddef>
#include <cstdint>

#include "common/core/error.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"
#include "tests/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softgrain;
  const fuzz::InputFile file(data, size);
  try {
    (void)load_card(file.path());
  } catch (const Error&) {
  }
  try {
    (void)load_law_table(file.path());
  } catch (const Error&) {
  }
  return 0;
}
