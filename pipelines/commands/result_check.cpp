#include "pipelines/commands/result_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>

#include "common/core/error.h"
#include "common/data/crowd_measurements.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "common/data/snapshot_io.h"
#include "common/io/hdf5_file.h"
#include "common/io/text_file.h"
#include "microsim/grain_box/record.h"
#include "pipelines/commands/law_check.h"
#include "pipelines/run/run_context.h"
#include "pipelines/snapshots/powder_data.h"
#include "pipelines/snapshots/snapshots.h"
#include "pipelines/snapshots/snapshots_of_kinds.h"

namespace softgrain {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

void check_measurements_file(const std::string& path, Findings& out) {
  const Measurements data = load_measurements(path);
  std::size_t open = 0;
  for (const PackingRun& run : data.runs) {
    open += static_cast<std::size_t>(
        std::count_if(run.normal.begin(), run.normal.end(), [](const NormalPoint& p) { return !p.converged; }));
    open += static_cast<std::size_t>(std::count_if(run.tangential.begin(), run.tangential.end(),
                                                   [](const TangentialPoint& p) { return !p.converged; }));
  }
  out.add("kind", "measurements",
          fmt::format("measurements: {} packings, {} runs", data.packings.size(), data.runs.size()));
  if (open > 0) out.warn(fmt::format("{} recorded points did not converge; fits leave them out", open));
}

void check_crowd_file(const std::string& path, Findings& out) {
  const CrowdMeasurements data = load_crowd(path);
  std::size_t open = 0;
  for (const CrowdRun& run : data.runs)
    open += static_cast<std::size_t>(
        std::count_if(run.points.begin(), run.points.end(), [](const CrowdPoint& p) { return !p.converged; }));
  out.add("kind", "crowd measurements",
          fmt::format("crowd measurements: {} configurations, {} packings, {} runs", data.configurations.size(),
                      data.packings.size(), data.runs.size()));
  if (open > 0) out.warn(fmt::format("{} recorded points did not converge", open));
}

void check_macro_file(const std::string& path, Findings& out) {
  const std::vector<MacroCurve> curves = load_macro(path);
  out.add("kind", "macro curves", fmt::format("macro curves: {}", curves.size()));
  out.facts["curves"] = json::array();
  for (const MacroCurve& c : curves) {
    const bool recorded = !c.strain.empty() && !c.stress_axial.empty();
    out.facts["curves"].push_back({{"engine", c.engine}, {"sample", c.sample}, {"usable", c.usable}});
    if (recorded)
      out.lines += fmt::format(
          "    {} sample {}: {} bodies, {} points to a strain of {:.3g}, axial stress {:.4g} Pa{}\n", c.engine,
          c.sample, c.bodies, c.strain.size(), c.strain.back(), c.stress_axial.back(), c.usable ? "" : ", not usable");
    if (!c.usable) out.warn(fmt::format("{} sample {} is not usable: {}", c.engine, c.sample, c.note));
    if (!c.law_beyond.empty() && c.law_beyond.back() > 0.0)
      out.warn(fmt::format("{} sample {}: {:.0f} of {:.0f} uses of its law lay beyond what was measured at the end",
                           c.engine, c.sample, c.law_beyond.back(), c.law_asked.empty() ? 0.0 : c.law_asked.back()));
  }
}

void check_grain_box_file(const std::string& path, Findings& out) {
  out.add("kind", "grain boxes", fmt::format("grain boxes: {} packs", load_grain_boxes(path).size()));
}

void check_powder_file(const std::string& path, Findings& out) {
  const PowderRun run = load_powder(path);
  const auto unusable =
      std::count_if(run.samples.begin(), run.samples.end(), [](const PowderSample& s) { return !s.usable; });
  out.add("kind", "powders", fmt::format("cohesive powders: {} samples", run.samples.size()));
  if (unusable > 0) out.warn(fmt::format("{} samples did not come to rest", unusable));
}

void check_states_file(const std::string& path, Findings& out) {
  const h5::Group states = open_snapshots(path).open("states");
  std::size_t contacts = 0;
  for (const std::string& name : states.children()) {
    try {
      contacts += read_snapshot(states.open(name)).contacts.size();
    } catch (const FileTrouble& e) {
      throw FileTrouble(path + ": state " + name + ": " + e.what());
    }
  }
  out.add("kind", "states",
          fmt::format("kept states: {}, with {} contacts in all", states.children().size(), contacts));
}

void check_particles_file(const std::string& path, Findings& out) {
  std::size_t frames = 0;
  try {
    visit_particles(path, SnapshotChoice::all, [&](const Snapshot&) { ++frames; });
  } catch (const FileTrouble& e) {
    const std::string text = e.what();
    throw FileTrouble(text.starts_with(path) ? text : path + ": " + text);
  }
  out.add("kind", "particles", fmt::format("particles: {} recorded frames", frames));
}

void check_other(const h5::Group& root, Findings& out) {
  std::string names;
  for (const std::string& child : root.children()) names += (names.empty() ? "" : ", ") + child;
  const std::string format = root.has_attribute("format") ? root.text("format") + ", " : "";
  out.add("kind", format.empty() ? "HDF5" : root.text("format"), "readable HDF5 file: " + format + "with " + names);
}

/// Facts of one file of a directory under its name; its lines and warnings say which file they are of.
void check_one(const std::string& directory, const std::string& name,
               const std::function<void(const std::string&, Findings&)>& check, Findings& out) {
  Findings one;
  check(directory + "/" + name, one);
  out.facts["files"][name] = one.facts;
  out.lines += "  " + name + ":\n" + one.lines;
  for (const std::string& warning : one.warnings()) out.warn(name + ": " + warning);
}

/// Files that only a run at work needs are not looked at.
bool is_scratch(const std::string& name) {
  return name.starts_with("checkpoint") || name.ends_with(".tmp") || name.find(".previous") != std::string::npos;
}

}  // namespace

void check_data(const std::string& path, Findings& out) {
  const h5::Group root = h5::open_file(path);
  if (root.has("configurations"))
    check_crowd_file(path, out);
  else if (root.has("runs"))
    check_measurements_file(path, out);
  else if (root.has("packs"))
    check_grain_box_file(path, out);
  else if (root.has("curves"))
    check_macro_file(path, out);
  else if (root.has("sample_0") && root.has("spec"))
    check_powder_file(path, out);
  else if (root.has("states"))
    check_states_file(path, out);
  else if (root.has("trajectory"))
    check_particles_file(path, out);
  else
    check_other(root, out);
  std::error_code failed;
  const auto bytes = fs::file_size(path, failed);
  if (!failed) out.facts["bytes"] = bytes;
}

void check_summary(const std::string& path, Findings& out) {
  const json summary = json::parse(read_text(path), nullptr, false);
  if (summary.is_discarded()) throw BadInput(path + ": no JSON");
  if (!summary.is_object() || !summary.contains("status") || !summary["status"].is_string())
    throw BadInput(path + ": no summary of a run: it has no \"status\"");
  const auto text = [&](const char* key) {
    return summary.contains(key) && summary[key].is_string() ? summary[key].get<std::string>() : std::string();
  };
  const std::string status = text("status");
  out.add("kind", "summary",
          fmt::format("summary of softgrain {} ({} {}): {}", text("command"), text("version"), text("commit"), status));
  out.facts["run_status"] = status;
  out.facts["command"] = text("command");
  if (!has_status(summary, RunStatus::good)) out.warn("the run says of itself: " + status);
  if (!summary.contains("remarks") || !summary["remarks"].is_array()) return;
  for (const json& remark : summary["remarks"])
    if (remark.is_string()) out.warn(remark.get<std::string>());
}

void check_directory(const std::string& path, Findings& out) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  out.add("kind", "run directory", "run directory");
  static const std::map<std::string, void (*)(const std::string&, Findings&)> kNamed{
      {"law.toml", check_laws}, {"law_table.toml", check_laws}, {"summary.json", check_summary}};
  bool any = false;
  const auto has = [&](const std::string& name) { return std::binary_search(names.begin(), names.end(), name); };
  for (const std::string& name : names) {
    if (is_scratch(name)) continue;
    const auto known = kNamed.find(name);
    if (known == kNamed.end() && file_form(name) != FileForm::hdf5) continue;
    any = true;
    check_one(path, name, known == kNamed.end() ? check_data : known->second, out);
  }
  if (!any) throw BadInput(path + ": no run directory: neither summary.json nor a file of results is in it");
  if (!has("summary.json"))
    out.warn("no summary.json: the run has not ended; go on with --resume, or see log.txt for what stopped it");
  if (has("checkpoint.h5")) out.warn("a checkpoint is there: the run was stopped, --resume goes on with it");
}

}  // namespace softgrain
