// Lines at the head of the report that name the law (form, solid fraction, material, hash) and the material of the run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "common/contact/rolling_scene.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

constexpr std::size_t kMostLaws = 4;

void add_once(std::vector<HeadLine>& lines, const char* label, const std::string& text) {
  const HeadLine line{label, text + "."};
  if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
}

/// Adds the laws that curves were computed with, and their engine where it is not "law".
void add_laws_of(const std::vector<MacroCurve>& curves, std::vector<HeadLine>& lines) {
  for (const MacroCurve& c : curves)
    if (!c.twin() && !c.law.hash.empty())
      add_once(lines, "Law used", (c.engine == "law" ? "" : engine_name(c.engine) + ": ") + identity_text(c.law));
}

/// E, nu and mu that a measured law is taken with where nothing else is said: those of the measurement.
MacroSpec spec_of(const SoftParticleSpec& measured) {
  MacroSpec spec;
  if (is_known(measured.youngs_modulus)) spec.youngs_modulus = measured.youngs_modulus;
  if (is_known(measured.poisson_ratio)) spec.poisson_ratio = measured.poisson_ratio;
  if (is_known(measured.friction)) spec.friction = measured.friction;
  return spec;
}

/// The law of a card or table as a scene of the same material would take it; nothing where it is not usable.
void add_law(const LawSources& sources, const SoftParticleSpec& measured, double fraction,
             std::vector<HeadLine>& lines) {
  try {
    add_once(lines, "Law written", identity_text(scene_law(sources, spec_of(measured), fraction, "law").identity));
  } catch (const Error&) {  // no usable law: the other lines say why
  }
}

void add_made_laws(const RunData& run, std::vector<HeadLine>& lines) {
  if (run.card) {
    LawSources sources;
    sources.laws = {{*run.card}};
    add_law(sources, run.card->spec, 0.0, lines);
  }
  if (!run.law_table) return;
  for (const LawTableEntry& entry : run.law_table->entries) {
    LawSources sources;
    sources.laws = {{*run.law_table}};
    sources.forms = {entry.best};
    sources.solid_fraction = entry.solid_fraction;
    add_law(sources, entry.spec, entry.solid_fraction, lines);
  }
}

/// "E = 5e+05 Pa, nu = 0.3, mu = 0.3 (walls 0)" of the grains that curves began with.
std::string started_with(const MacroStart& s) {
  return fmt::format("E = {:.4g} Pa, nu = {:g}, mu = {:g}{}, walls mu = {:g}; radii {} to {} m", s.youngs_modulus,
                     s.poisson_ratio, s.friction, rolling_text(s.rolling), s.wall_friction,
                     format_number(s.radius_min, 3), format_number(s.radius_max, 3));
}

/// Tables of a scene that say what grains are of.
constexpr std::array kMaterialTables{"material.", "contact.", "disks."};

/// "E = 0.5 MPa, mu = 0.3" from the scene.
std::string material_of_scene(const std::string& scene) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> said;
  for (const auto& [key, value] : flat_scene(scene, "scene"))
    for (const std::string table : kMaterialTables)
      if (key.starts_with(table)) said.push_back(key.substr(table == "material." ? table.size() : 0) + " = " + value);
  const std::string text = join_text(std::span(said).first(std::min(said.size(), kMost)));
  return said.size() > kMost ? text + fmt::format(" and {} of the scene", counted(said.size() - kMost, "more key"))
                             : text;
}

}  // namespace

std::vector<HeadLine> law_lines(const RunData& run) {
  std::vector<HeadLine> lines;
  add_laws_of(run.macro, lines);
  for (const ComparedCurves& scene : run.macro_scenes) add_laws_of(scene.curves, lines);
  if (lines.empty()) add_made_laws(run, lines);
  const std::size_t all = lines.size();
  if (all <= kMostLaws) return lines;
  lines.resize(kMostLaws);
  lines.emplace_back(lines.back().first, fmt::format("and {} more.", all - kMostLaws));
  return lines;
}

std::vector<HeadLine> material_lines(const RunData& run) {
  if (run.measurements || run.card) return {};  // said with the soft particle
  std::vector<HeadLine> lines;
  for (const MacroCurve& c : run.macro)
    if (c.start.youngs_modulus > 0.0) add_once(lines, "Material", started_with(c.start));
  for (const ComparedCurves& scene : run.macro_scenes)
    for (const MacroCurve& c : scene.curves)
      if (c.start.youngs_modulus > 0.0) add_once(lines, "Material", started_with(c.start));
  if (!lines.empty()) return {lines.front()};
  const auto summary = run.summary_as<AnySummary>();
  if (!summary.provenance || summary.provenance->scene.empty() || is_set(run)) return {};
  try {
    const std::string said = material_of_scene(summary.provenance->scene);
    if (!said.empty()) add_once(lines, "Material", said);
  } catch (const InputError&) {  // a scene that was edited by hand
  }
  return lines;
}

}  // namespace softgrain::report
