// Result files, checkpoints, kept states and tables: raw bytes, or (first byte above 15) a good small file with changes
// that keep its checksums right, so that mutations reach our own readers instead of ending at the first sum that does
// not match. What the readers let pass goes on to all that works with it: a number that makes no sense shows there.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>

#include "calibrate/multi_contact_side_fits.h"
#include "calibrate/threshold_fit.h"
#include "common/core/error.h"
#include "common/data/law_card.h"
#include "common/data/law_card_format.h"
#include "common/data/multi_contact_replicates.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/export/export.h"
#include "pipelines/kinds/cohesive_powder/powder_data.h"
#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/grain_box/report.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/report/packing_data.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"
#include "pipelines/snapshots/snapshots.h"
#include "tests/fuzz/input_file.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/tiny_files.h"

namespace {

using namespace softgrain;
using Bytes = std::vector<std::uint8_t>;

/// A good file and the name that it has in a run directory.
struct GoodFile {
  const char* name;
  Bytes bytes;
};

GoodFile good_file(const char* name, void (*write)(const std::string&)) {
  const std::string path = (std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()) + ".h5"));
  write(path);
  std::ifstream in(path, std::ios::binary);
  Bytes bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::filesystem::remove(path);
  return {name, std::move(bytes)};
}

void tiny_law_table(const std::string& path) { write_table(synthetic::card(), path, build_provenance(), ""); }

const std::vector<GoodFile>& good_files() {
  static const std::vector<GoodFile> files{good_file("measurements.h5", test::tiny_measurements),
                                           good_file("multi_contact.h5", test::tiny_multi_contact),
                                           good_file("macro.h5", test::tiny_macro),
                                           good_file("grain_box.h5", test::tiny_grain_boxes),
                                           good_file("powder.h5", test::tiny_powder),
                                           good_file("checkpoint.h5", test::tiny_checkpoint),
                                           good_file("law.h5", tiny_law_table),
                                           good_file("states_tiny.h5", test::tiny_states),
                                           good_file("run.h5", test::tiny_particles_run)};
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

report::RunData run_of(const std::string& path) {
  report::RunData run;
  run.directory = std::filesystem::path(path).parent_path();
  run.summary = nlohmann::json::object();
  return run;
}

/// Drawn beside a table, summed up, its slides and retreats taken; a whole fit takes too long here.
void use_multi_contact(const std::string& path) {
  const MultiContactMeasurements data = load_multi_contact(path);
  report::RunData run = run_of(path);
  LawTableEntry entry = synthetic::law_entry();
  entry.solid_fraction = 0.0;
  for (const PackingInfo& p : data.packings)
    entry.solid_fraction += p.solid_fraction / static_cast<double>(data.packings.size());
  run.law_table = LawTable{1, {entry}};
  run.multi_contact = data;
  (void)report::law_table_section(run);
  (void)json_of(summary_of(data, 0.04)).dump();
  (void)multi_contact_remarks(data, 0.04);
  (void)multi_contact_text(data);
  (void)side_values(average_states(data), multi_contact_model(entry.laws.front()));
}

void use_measurements(const std::string& path, bool fit) {
  report::RunData run = run_of(path);
  run.measurements = load_measurements(path);
  run.card = synthetic::card();
  for (const auto section : {report::normal_section, report::tangential_section, report::stiffness_section,
                             report::relaxations_section, report::radii_section})
    attempt([&] { (void)section(run); });
  (void)measurement_remarks(*run.measurements);
  FitOptions options;
  options.replicates = 2;
  options.min_packings = 2;
  if (fit) attempt([&] { (void)calibrate(*run.measurements, options, nullptr); });
}

void use_macro(const std::string& path) {
  report::RunData run = run_of(path);
  run.macro = load_macro(path);
  attempt([&] { (void)report::macro_section(run); });
  (void)score_table(score_engines(run.macro));
  (void)macro_remarks(run.macro);
  attempt([&] { (void)compare_curves(curves_of(run.macro, "law"), curves_of(run.macro, "shelled")); });
}

void use_states(const std::string& path) {
  for_each_snapshot(path, SnapshotChoice::all, [](const Snapshot& s) {
    for (const auto files : {vtp_files, dump_files, csv_files}) (void)files(s, 0);
  });
  for (const auto& series : report::packing_series_of(std::filesystem::path(path).parent_path(), 2)) (void)series;
}

/// As check, report, export, calibrate and --resume do.
void read(const std::string& path, bool fit) {
  attempt([&] {
    const h5::Group root = h5::open_file(path);
    if (root.has("configurations")) attempt([&] { use_multi_contact(path); });
    if (root.has("runs") && !root.has("configurations")) attempt([&] { use_measurements(path, fit); });
    if (root.has("packs"))
      attempt([&] {
        report::RunData run = run_of(path);
        run.hold("grain_box.h5", load_grain_boxes(path));
        (void)report::grain_box_section(run);
        use_states(path);
      });
    if (root.has("curves")) attempt([&] { use_macro(path); });
    if (root.has("sample_0"))
      attempt([&] {
        report::RunData run = run_of(path);
        run.hold("powder.h5", load_powder(path));
        (void)report::powder_section(run);
        use_states(path);
      });
    if (root.has("system")) attempt([&] { read_checkpoint(path); });
    if (root.has("states") || root.has("trajectory")) attempt([&] { use_states(path); });
    LawCard card = synthetic::card();
    if (root.has("soft-solid"))
      attempt([&] {
        read_table(card, path);
        report::RunData run = run_of(path);
        run.card = card;
        (void)report::laws_section(run);
      });
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
  if (size < 3) return 0;
  const bool fit = data[1] == 0;
  const GoodFile& good = good_files()[data[0] % good_files().size()];
  if (data[0] < 16) {
    const fuzz::InputFile file(data + 2, size - 2, good.name);
    read(file.path(), fit);
    return 0;
  }
  const fuzz::InputFile file(good.bytes.data(), good.bytes.size(), good.name);
  Script script{data + 2, data + size};
  for (int k = 0; k < 4 && script.at < script.end; ++k) {
    test::Hdf5Edit edit(file.path());
    change(edit, script);
  }
  read(file.path(), fit);
  return 0;
}
