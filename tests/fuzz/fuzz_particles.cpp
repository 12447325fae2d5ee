// Any bytes as a file of spheres: as they are, or (first byte odd) packed by zlib and cut short, so that mutations
// reach the text inside.
#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/error.h"
#include "microsim/particles/scene_bodies.h"
#include "tests/fuzz/input_file.h"

namespace {

using namespace softgrain;

constexpr std::int64_t kMost = 100000;

void read(const std::vector<std::uint8_t>& bytes) {
  const fuzz::InputFile file(bytes.data(), bytes.size());
  try {
    (void)read_xyzr(file.path(), [](std::int64_t n) {
      if (n > kMost) throw InputError("too many");  // as a scene refuses what does not fit into the memory
    });
  } catch (const Error&) {
  }
}

std::vector<std::uint8_t> packed(const std::uint8_t* data, std::size_t size) {
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  std::vector<std::uint8_t> out(deflateBound(&z, size) + 32);
  z.next_in = const_cast<Bytef*>(data);
  z.avail_in = static_cast<uInt>(size);
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  (void)deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  (void)deflateEnd(&z);
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  if (data[0] % 2 == 0) {
    read({data + 1, data + size});
    return 0;
  }
  std::vector<std::uint8_t> bytes = packed(data + 2, size - 2);
  bytes.resize(bytes.size() - std::min<std::size_t>(data[1] / 4, bytes.size()));
  read(bytes);
  return 0;
}
