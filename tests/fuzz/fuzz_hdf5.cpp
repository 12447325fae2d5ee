// Result files, checkpoints and tables: raw bytes, or (first byte above 15) a good small file with changes that keep
// its checksums right, so that mutations reach our own readers instead of ending at the first sum that does not match.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>

#include "common/core/error.h"
#include "common/data/law_card.h"
#include "common/data/law_card_format.h"
#include "pipelines/report/powder_data.h"
#include "tests/fuzz/input_file.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/tiny_files.h"

namespace {

using namespace softgrain;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(void (*write)(const std::string&)) {
  const std::string path = (std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()) + ".h5"));
  write(path);
  std::ifstream in(path, std::ios::binary);
  Bytes bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::filesystem::remove(path);
  return bytes;
}

void tiny_law_table(const std::string& path) { write_table(synthetic::card(), path, build_provenance()); }

const std::vector<Bytes>& good_files() {
  static const std::vector<Bytes> files{bytes_of(test::tiny_measurements), bytes_of(test::tiny_crowd),
                                        bytes_of(test::tiny_macro),        bytes_of(test::tiny_grain_boxes),
                                        bytes_of(test::tiny_powder),       bytes_of(test::tiny_checkpoint),
                                        bytes_of(tiny_law_table)};
  return files;
}

template <class Reader>
void attempt(Reader reader) {
  try {
    reader();
  } catch (const Error&) {  // the message that a user sees
  }
}

void read_checkpoint(const std::string& path) {
  std::string note;
  const auto saved = open_checkpoint(path, test::kTinyCheckpointScene, note);
  if (!saved) return;
  System3 s = test::tiny_system();
  read_system(saved->open("system"), s);
  (void)contact_records(s);
}

/// As check, report and --resume do.
void read(const std::string& path) {
  attempt([&] {
    const h5::Group root = h5::open_file(path);
    if (root.has("configurations")) attempt([&] { (void)load_crowd(path); });
    if (root.has("runs")) attempt([&] { (void)load_measurements(path); });
    if (root.has("packs")) attempt([&] { (void)load_grain_boxes(path); });
    if (root.has("curves")) attempt([&] { (void)load_macro(path); });
    if (root.has("sample_0")) attempt([&] { (void)report::load_powder(path); });
    if (root.has("system")) attempt([&] { read_checkpoint(path); });
    LawCard card = synthetic::card();
    if (root.has("soft-solid")) attempt([&] { read_table(card, path); });
  });
}

/// Hands out the bytes of an input one by one, zeros behind the end.
struct Script {
  const std::uint8_t* at;
  const std::uint8_t* end;
  std::uint8_t next() { return at < end ? *at++ : std::uint8_t{0}; }
  double number() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kOdd[] = {0.0,        -1.0,  1.0, 2.0,  3.0,  std::numeric_limits<double>::quiet_NaN(),
                               kInfinity,  1e300, 4e9, -4e9, 2e18, 0.5,
                               -kInfinity, 1e-300};
    const std::uint8_t k = next();
    return k < std::size(kOdd) ? kOdd[k] : static_cast<double>(k) - 16.0;
  }
};

void change(test::Hdf5Edit& file, Script& script) {
  const std::vector<std::string> items = file.items();
  if (items.empty()) return;
  const std::uint8_t what = script.next();
  std::size_t at = script.next();
  at = (at << 8U | script.next()) % (items.size() + 1);
  const std::string item = at == items.size() ? "/" : items[at];
  const std::vector<std::string> names = file.attributes(item);
  const std::string name = names.empty() ? "none" : names[script.next() % names.size()];
  switch (what % 8) {
    case 0:
      return file.remove(item);
    case 1:
      return file.set(item, script.next(), script.number());
    case 2:
      return file.resize(item, script.next());
    case 3:
      return file.replace(item, std::vector<double>(script.next(), script.number()));
    case 4:
      return file.set_attribute(item, name, script.number());
    case 5:
      return file.set_attribute(item, name, static_cast<long long>(script.next()) - 2);
    case 6:
      return file.set_attribute(item, name, std::string(script.next(), 'x'));
    default:
      return file.remove_attribute(item, name);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  if (data[0] < 16) {
    const fuzz::InputFile file(data + 1, size - 1);
    read(file.path());
    return 0;
  }
  const Bytes& good = good_files()[data[0] % good_files().size()];
  const fuzz::InputFile file(good.data(), good.size());
  Script script{data + 1, data + size};
  for (int k = 0; k < 4 && script.at < script.end; ++k) {
    test::Hdf5Edit edit(file.path());
    change(edit, script);
  }
  read(file.path());
  return 0;
}
