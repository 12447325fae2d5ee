// What was run and what came out, in a few lines.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/core/text.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

std::string status_of(const RunData& run, const AnySummary& summary) {
  if (run.unfinished) return "unfinished";
  return summary.status.empty() ? "no summary" : summary.status;
}

std::string directory_name(const RunData& run) {
  return std::filesystem::weakly_canonical(run.directory).filename().string();
}

/// What the scene calls itself, else command and directory.
std::string title_text(const RunData& run, const AnySummary& summary) {
  if (!summary.title.empty()) return summary.title;
  return (summary.command.empty() ? "softgrain" : "softgrain " + summary.command) + ": " + directory_name(run);
}

std::string title_lines(const RunData& run, const AnySummary& summary) {
  const std::string status = status_of(run, summary);
  std::string small = "softgrain " + summary.command + ", directory " + directory_name(run);
  if (!summary.version.empty()) small += ", version " + summary.version;
  if (!summary.commit.empty()) small += ", commit " + summary.commit;
  return "<p class=\"kicker\">" + escape(small) + "</p>\n<h1>" + escape(title_text(run, summary)) +
         " <span class=\"status status-" + (is_good(status) ? "good" : "bad") + "\">" + escape(status) +
         "</span></h1>\n";
}

/// Said before anything else when the result must not be used.
std::string verdict(const RunData& run, const AnySummary& summary) {
  if (run.unfinished)
    return "<p class=\"verdict\"><strong>Results of an unfinished run:</strong> it was stopped, or is still at work. "
           "What "
           "is below was there by then; measurements, fits and scenes may be missing. The same command with --resume "
           "goes "
           "on with it.</p>\n";
  if (summary.status.empty() || is_good(summary.status)) return "";
  const std::vector<std::string> why = warnings_of(summary);
  return "<p class=\"verdict\"><strong>Do not use this result as it is:</strong> " +
         escape(why.empty() ? "see the notes at the end." : why.front()) + "</p>\n";
}

/// Command, seed, threads, time.
std::string run_line(const RunData& run, const AnySummary& summary) {
  std::string out;
  const auto add = [&](const std::string& text) { append_part(out, text, ", "); };
  if (const auto& p = summary.provenance) {
    if (!is_set(run)) add(fmt::format("seed {}", p->seed));
    add(p->threads == 1 ? "one thread" : fmt::format("{} threads", p->threads));
  }
  if (summary.seconds) add(format_seconds(*summary.seconds));
  return out.empty() ? "" : out + ".";
}

std::string material_line(const RunData& run) {
  const SoftParticleSpec& s = run.measurements ? run.measurements->spec : run.card->spec;
  if (!run.measurements && !packing_known(s))
    return fmt::format("Soft particle of an experiment: radius Rs = {} mm, E = {} MPa; what is inside is not known",
                       format_number(1e3 * s.shell_radius), format_number(1e-6 * s.youngs_modulus));
  const std::string sizes = s.sizes ? s.sizes->name() : "number of radii ~ r^-" + format_number(s.exponent);
  return fmt::format(
      "Soft particle of radius Rs = {} mm, grains with E = {} MPa, ν = {}, μ = {}; {} over a factor {}, largest {} Rs",
      format_number(1e3 * s.shell_radius), format_number(1e-6 * s.youngs_modulus), format_number(s.poisson_ratio),
      format_number(s.friction), sizes, format_number(s.polydispersity), format_number(s.rmax_over_shell));
}

/// What came out, a few lines whatever the kind of run.
std::vector<HeadLine> result_lines(const RunData& run) {
  std::vector<HeadLine> lines = set_lines(run);
  for (const KindResults& kind : results_of_kinds())
    if (kind.lines != nullptr)
      for (HeadLine& line : kind.lines(run)) lines.push_back(std::move(line));
  for (const auto more : {law_lines, material_lines})
    for (HeadLine& line : more(run)) lines.push_back(std::move(line));
  std::erase_if(lines, [](const HeadLine& line) { return line.second.empty(); });
  return lines;
}

/// Lines with the same label follow each other under one.
std::string list_of(const std::vector<HeadLine>& lines) {
  std::string out;
  std::string open;
  for (const auto& [label, text] : lines) {
    out += label == open ? "<br>" : (out.empty() ? "" : "</dd>\n") + ("<dt>" + escape(label) + "</dt><dd>");
    out += escape(text);
    open = label;
  }
  return out.empty() ? "" : "<dl class=\"lead\">\n" + out + "</dd>\n</dl>\n";
}

}  // namespace

std::string heading_section(const RunData& run) {
  const auto summary = run.summary_as<AnySummary>();
  std::string what = run_line(run, summary);
  if (run.measurements || run.card) {
    const std::string material = material_line(run);
    what = material + (what.empty() ? "." : "; " + what);
  }
  std::vector<HeadLine> lines = result_lines(run);
  if (!what.empty()) lines.insert(lines.begin(), {"Run", what});
  std::stable_partition(lines.begin(), lines.end(), [](const HeadLine& line) { return line.first == kResultLabel; });
  return title_lines(run, summary) + verdict(run, summary) + list_of(lines);
}

}  // namespace softgrain::report
