#include "pipelines/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "calibrate/experiment_fit.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/force_curves.h"
#include "common/io/csv_file.h"
#include "common/packing/grading_scene.h"
#include "pipelines/kinds/macro/scene.h"

namespace softgrain {

namespace {

bool has_column(const CsvFile& table, std::initializer_list<const char*> begins) {
  return std::any_of(table.columns().begin(), table.columns().end(), [&](const CsvColumn& c) {
    return std::any_of(begins.begin(), begins.end(), [&](const char* word) { return c.name.starts_with(word); });
  });
}

/// What the file may leave to the command line gets a value here, and a word about it.
ForceCurveOptions assumed_values(const CsvFile& table, Findings& out) {
  ForceCurveOptions options;
  const SaidByFile said = said_by_comments(table);
  const auto missing = [&](bool is_said, const char* comment, const char* option) {
    if (!is_said)
      out.warn(fmt::format("the file has no comment `# {} = ...`: softgrain calibrate needs {}", comment, option));
    return !is_said;
  };
  if (missing(said.kind, "kind", "--kind soft-solid or soft-soft")) options.kind = PairKind::soft_solid;
  if (missing(said.shell_radius, "Rs", "--radius \"16 mm\"")) options.shell_radius = 1.0;
  if (missing(said.youngs_modulus, "E", "--modulus \"0.5 MPa\"")) options.youngs_modulus = 1.0;
  return options;
}

void check_force_curves(const CsvFile& table, Findings& out) {
  ForceCurveOptions options = assumed_values(table, out);
  options.unloading = Unloading::fit;
  ForceCurves curves = read_force_curves(table.path(), options);
  (void)subtract_offsets(curves);  // its remarks say it
  std::size_t points = 0;
  std::size_t returned = 0;
  double largest_delta = 0.0;
  double largest_force = 0.0;
  for (const ForceCurve& s : curves.samples) {
    points += s.normal.size() + s.tangential.size();
    for (const UnloadedCurve& u : s.unloaded) returned += u.points.size();
    for (const ForcePoint& p : s.normal) {
      largest_delta = std::max(largest_delta, p.delta);
      largest_force = std::max(largest_force, p.force);
    }
  }
  out.add("kind", "force curves",
          fmt::format("{}force over overlap of an experiment; softgrain calibrate fits a law to it", kNoScene));
  out.add("samples", curves.samples.size(), counted(curves.samples.size(), "sample") + ", " + counted(points, "point"));
  out.facts["points"] = points;
  if (returned > 0)
    out.add("unloading_points", returned, counted(returned, "point") + " of unloading, to which a branch is fitted");
  if (!options.kind) out.add("contact", to_string(curves.kind), "contact: " + to_string(curves.kind));
  if (!options.shell_radius)
    out.add("largest_delta", largest_delta,
            fmt::format("Rs = {:g} m: overlaps up to Delta = {:.3g}", curves.spec.shell_radius, largest_delta));
  if (!options.youngs_modulus)
    out.add("youngs_modulus", curves.spec.youngs_modulus, fmt::format("E = {:g} Pa", curves.spec.youngs_modulus));
  out.add("largest_force", largest_force, fmt::format("forces up to {:.4g} N", largest_force));
  if (const std::string doubt = touch_doubt(curves); !doubt.empty()) out.warn(doubt);
  if (!options.shell_radius && !options.youngs_modulus)
    for (const std::string& one : implausible_forces(curves)) out.warn(one);
  if (const std::string turns = judge_turns(curves, {}).why; !turns.empty()) out.warn(turns);
  for (const std::string& remark : curves.remarks) out.warn(remark);
}

void check_radii(const Grading& sizes, Findings& out) {
  out.add("kind", "radii of grains", fmt::format("{}radii of grains; {}", kNoScene, kTakenBySizes));
  out.add("radius", {sizes.smallest(), sizes.largest()},
          fmt::format("radii {:.4g} to {:.4g} m", sizes.smallest(), sizes.largest()));
}

/// Bodies of a macro scene. A periodic packing has bodies that stick out of its cell.
void check_packing(const CsvFile& table, Findings& out) {
  MacroPacking packing;
  bool periodic = false;
  try {
    packing = read_packing_file(table.path());
  } catch (const InputError&) {
    if (!table.setting({"box"})) throw;
    try {
      packing = read_packing_file(table.path(), Boundary::periodic);
      periodic = true;
    } catch (const InputError&) {
    }
    if (!periodic) throw;
  }
  const std::int64_t soft = packing.soft_count();
  const Vec3 size = packing.size();
  out.add("kind", "packing", fmt::format("{}a packing; the key `packing` of a macro scene takes it", kNoScene));
  out.add("bodies", packing.bodies.size(),
          fmt::format("{}, {} of them soft", counted(packing.bodies.size(), "body", "bodies"), soft));
  out.facts["soft"] = soft;
  out.add("box", {size[0], size[1], size[2]},
          fmt::format("box {:.4g} x {:.4g} x {:.4g} m{}", size[0], size[1], size[2],
                      table.setting({"box"}) ? "" : ", the tightest one around all bodies"));
  out.add("solid_fraction", packing.solid_fraction(), fmt::format("solid fraction {:.4g}", packing.solid_fraction()));
  if (periodic) out.warn("bodies stick out of the box: the packing serves boundary = \"periodic\" alone");
}

}  // namespace

void check_table(const std::string& path, const std::vector<std::string>& overrides, Findings& out) {
  std::error_code ignored;
  const auto sieves = [&] { return std::filesystem::is_regular_file(path, ignored) && is_sieve_file(path); };
  if (!overrides.empty() && !sieves()) throw InputError("--set: " + path + " is no scene");
  std::optional<CsvFile> read;
  try {
    read = CsvFile::read(path);
  } catch (const InputError&) {  // tables of laboratories have lines of text
    if (!sieves()) throw;
  }
  if (!read) return check_sieves(path, overrides, out);
  const CsvFile& table = *read;
  const auto has = [&](const char* name) {
    return std::any_of(table.columns().begin(), table.columns().end(),
                       [&](const CsvColumn& c) { return c.name == name; });
  };
  const auto names = [&](std::initializer_list<const char*> parts) {
    return std::any_of(table.columns().begin(), table.columns().end(), [&](const CsvColumn& c) {
      return std::any_of(parts.begin(), parts.end(),
                         [&](const char* part) { return c.name.find(part) != std::string::npos; });
    });
  };
  if (has_column(table, {"fn", "f_n", "force", "normal force", "load", "kraft", "standardkraft", "hn", "overlap",
                         "displacement", "indentation", "weg", "standardweg"}) ||
      has("f"))
    check_force_curves(table, out);
  else if (has("x") && has("y") && has("z"))
    check_packing(table, out);
  else if (names({"passing", "finer", "retained"}) || sieves())
    check_sieves(path, overrides, out);
  else if (has_column(table, {"radius", "diameter"}) || has("r") || has("d"))
    check_radii(read_radii(path), out);
  else
    throw InputError(
        path +
        ": a table of data, no scene, and none of those that softgrain reads: force over overlap (columns hn "
        "[mm], Fn [N]), a sieve curve (opening [mm], passing [%]), radii (radius [mm]), a packing (x [m], y [m], z "
        "[m], r [m], kind)");
}

}  // namespace softgrain
