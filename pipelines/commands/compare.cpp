// softgrain compare A B ...: in what runs differ, their numbers side by side, error norms and cost against the last
// one. With one argument: what can be compared inside that run.
#include <filesystem>

#include "common/core/text.h"
#include "common/io/provenance.h"
#include "common/io/text_file.h"
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/report/report.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/run_context.h"
#include "pipelines/runs/set_text.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Writes the summary to standard output alone, or also to --out with a report and the differences as CSV.
ExitStatus finish(const CommonOptions& options, json summary, const std::string& console,
                  const std::optional<PairedSummary>& paired = {}) {
  const bool usable = is_good(summary.value("status", ""));
  if (!options.out.empty()) {
    const RunContext context(options, "compare", "compare");
    summary["files"] = {{"report", context.path("report.html")}};
    if (paired) {
      write_text_atomic(context.path("differences.csv"), as_csv(table_of(*paired)));
      summary["files"]["differences"] = context.path("differences.csv");
    }
    context.finish(summary, console + "report: " + context.path("report.html"));
    write_report(context.directory());
  } else {
    const Provenance build = build_provenance();
    summary.update({{"command", "compare"}, {"version", build.version}, {"commit", build.commit}});
    write_standard_output(options.json ? summary.dump(2, ' ', false, json::error_handler_t::replace) + "\n" : console);
  }
  return usable ? ExitStatus::good : ExitStatus::not_usable;
}

ExitStatus compare_inside(const CommonOptions& options) {
  const std::string& path = options.inputs.front();
  if (options.different) throw InputError("compare: --different goes with two runs or more");
  const CompareResult result = compare_within(load_side(path));
  json summary = to_json(result);
  summary["status"] = to_string(result.undefined.empty() ? RunStatus::good : RunStatus::not_usable);
  summary["candidate"] = summary["reference"] = path;
  std::string console = to_text(result);
  if (report::is_unfinished(path)) {
    const std::string note = "the run has not come to its end: what is there so far is compared";
    summary["remarks"].push_back(note);
    console += "note: " + note + "; run --resume goes on with it\n";
  }
  return finish(options, std::move(summary), console);
}

/// Directories as the report in `out` finds them, wherever both are moved together.
std::string place_of(const std::string& path, const std::string& out) {
  const fs::path whole = fs::weakly_canonical(path);
  return out.empty() ? whole.string() : whole.lexically_relative(fs::weakly_canonical(out)).string();
}

/// The runs, in the order in which they are given; names are told apart by number where one is given twice.
SetSummary set_of(const CommonOptions& options) {
  SetSummary set;
  set.differences = scene_differences(options.inputs);
  for (std::size_t k = 0; k < options.inputs.size(); ++k) {
    const std::string& path = options.inputs[k];
    if (!fs::exists(path)) throw IoError(path + ": no such file or directory");
    RunEntry entry{.name = path, .directory = place_of(path, options.out)};
    for (const RunEntry& other : set.runs)
      if (other.name == path) entry.name = path + " (" + std::to_string(k + 1) + ")";
    for (const SweptKey& one : set.differences) entry.values[one.key] = one.values[k];
    if (fs::is_directory(path))
      read_numbers(path, entry);
    else
      entry.status = RunStatus::good;
    set.runs.push_back(std::move(entry));
  }
  set.reference = set.runs.back().name;
  return set;
}

bool has_numbers(const RunEntry& run) { return !run.numbers.empty(); }

/// What is in a run for norms; nothing where it has numbers alone, as many kinds of runs do.
std::optional<CompareSide> side_of(const std::string& path, const RunEntry& entry) {
  try {
    return load_side(path);
  } catch (const InputError&) {
    if (!has_numbers(entry)) throw;
    return std::nullopt;
  }
}

void add_norms(const CompareResult& result, const std::string& run, SetSummary& set) {
  for (const MacroPart& part : result.macro) {
    for (const ComparedQuantity& q : headline_of(part.result))
      if (!q.is_ratio && q.value.n > 0)
        set.norms.push_back({run,
                             (q.what == "stress" ? "axial stress" : q.what) + ", " + part.candidate_engine +
                                 " against " + part.reference_engine,
                             100.0 * q.value.mean, 100.0 * q.value.error, ""});
  }
}

/// Differences of two runs of one kind that offers them.
std::optional<PairedSummary> paired_of(const CommonOptions& options, const SetSummary& set) {
  if (options.inputs.size() != 2) return std::nullopt;
  for (const std::string& path : options.inputs)
    if (!fs::is_directory(path)) return std::nullopt;
  const report::RunData a = report::load_run(options.inputs.front());
  const report::RunData b = report::load_run(options.inputs.back());
  std::vector<std::string> keys;
  for (const SweptKey& one : set.differences) keys.push_back(one.key);
  for (const KindResults& kind : results_of_kinds())
    if (kind.differences != nullptr && a.kind() == kind.kind && b.kind() == kind.kind)
      return kind.differences(a, b, keys);
  return std::nullopt;
}

/// Error norms of a candidate, as far as there are any.
struct Norms {
  std::optional<CompareResult> result;
  std::string reason;  ///< why there are none
};

Norms norms_of(const std::optional<CompareSide>& candidate, const std::optional<CompareSide>& reference,
               const CommonOptions& options, bool required) {
  Norms out;
  if (!candidate || !reference) {
    out.reason = "no curves that could be compared";
    return out;
  }
  try {
    out.result = compare_sides(*candidate, *reference, options.different);
  } catch (const InputError& e) {
    if (required) throw;  // it was all that was asked for
    out.reason = e.what();
  }
  return out;
}

/// A refusal on one line: of a list the items alone.
std::string in_one_line(const std::string& text) {
  const std::size_t list = text.find("\n  ");
  std::string out = list == std::string::npos ? text : text.substr(list + 3);
  for (std::size_t at = out.find("\n  "); at != std::string::npos; at = out.find("\n  ", at)) out.replace(at, 3, "; ");
  return out;
}

ExitStatus compare_several(const CommonOptions& options) {
  SetSummary set = set_of(options);
  set.paired = paired_of(options, set);
  const std::optional<CompareSide> reference = side_of(options.inputs.back(), set.runs.back());
  const bool two = options.inputs.size() == 2;
  json comparisons = json::array();
  std::string details;
  for (std::size_t k = 0; k + 1 < options.inputs.size(); ++k) {
    const RunEntry& run = set.runs[k];
    const Norms norms = norms_of(side_of(options.inputs[k], run), reference, options, two && !set.paired);
    if (!norms.result) {
      set.norms.push_back({run.name, "", kNaN, kNaN, in_one_line(norms.reason)});
      continue;
    }
    add_norms(*norms.result, run.name, set);
    comparisons.push_back(to_json(*norms.result));
    comparisons.back()["candidate"] = run.name;
    if (two) details = to_text(*norms.result);
    for (const std::string& one : norms.result->undefined) set.head.mark_unusable(run.name + ": " + one);
  }
  json summary = json_of(set);
  if (two && !comparisons.empty()) summary.update(comparisons.front());
  summary["status"] = to_string(set.head.status);
  summary["candidate"] = options.inputs.front();
  summary["reference"] = options.inputs.back();
  if (!two) summary["comparisons"] = std::move(comparisons);
  std::string remarks;
  for (const std::string& one : set.head.remarks) remarks += two ? "" : "undefined: " + one + "\n";
  const bool any = std::any_of(set.runs.begin(), set.runs.end(), has_numbers);
  return finish(options, std::move(summary),
                (set.paired ? paired_text(*set.paired) : "") + differences_text(set) + details +
                    (any ? numbers_text(set) : "") + (two ? "" : norms_text(set)) + remarks +
                    curves_text(set, options.out.empty() ? "" : options.out),
                set.paired);
}

}  // namespace

ExitStatus command_compare(const CommonOptions& options) {
  if (options.inputs.empty())
    throw InputError(
        "compare: needs runs, the reference last (directories, macro.h5, measurements.h5 or law.toml), or one run to "
        "compare within");
  return options.inputs.size() == 1 ? compare_inside(options) : compare_several(options);
}

}  // namespace softgrain
