#include "macrosim/lammps_run/input_script.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/io/provenance.h"
#include "macrosim/lammps_run/data_file.h"
#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"

namespace softgrain::lammps {

namespace {

constexpr std::size_t kWidth = 78;

/// Comment lines; the text breaks at blanks.
std::string comment(const std::string& text) {
  std::string out;
  std::string line = "#";
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (line.size() > 1 && line.size() + end - begin >= kWidth) {
      out += line + "\n";
      line = "#";
    }
    line += " " + text.substr(begin, end - begin);
    begin = end + 1;
  }
  return out + line + "\n";
}

std::string heading(const ScriptScene& s) {
  const Provenance build = build_provenance();
  std::string name = s.title.empty() ? "" : s.title + ": ";
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == '&' || c == '$'; }, ' ');
  return comment(fmt::format("{}{} test of {} bodies, written by softgrain {} ({})", name, to_string(s.spec.test),
                             s.packing.bodies.size(), build.version, build.commit)) +
         "#\n" + comment("Needs what lies beside it and the program softgrain-lammps:") +
         "#   mpirun -np 4 softgrain-lammps -in scene.in\n" +
         comment("goes through the test and appends a row to points.txt at every recorded point;") +
         "#   mpirun -np 4 softgrain-lammps -in scene.in -var from 12\n" +
         comment(
             "goes on after point 12, whose restart file is kept until point 14 has its own. Every variable below "
             "can be set in this way.");
}

/// What every test has. Lists are made for bodies that move by half the skin; the smallest bodies have the most to do
/// with it.
std::string common_numbers(const ScriptScene& s) {
  const MacroSpec& spec = s.spec;
  const double largest = *std::max_element(s.types.largest.begin(), s.types.largest.end());
  std::string text;
  if (spec.test != MacroTest::stages)
    text +=
        setting("tolerance", fmt::format("{}", spec.tolerance), "largest net force over mean contact force, at rest");
  text += setting("floor", fmt::format("{}", test_force_floor(spec, largest)),
                  "the mean contact force counts for this at least [N]");
  text += setting("max_passes", fmt::format("{}", spec.max_passes), "of every relaxation");
  text += setting("states", fmt::format("{}", std::max<std::int64_t>(1, s.states)),
                  "states that are kept, with the last one");
  text += setting("skin", fmt::format("{}", 0.2 * smallest_radius(s.packing)),
                  "lists of near pairs reach farther by this [m]");
  return text;
}

std::string numbers(const ScriptScene& s) {
  const MacroSpec& spec = s.spec;
  std::string text = section("What may be changed");
  text += setting("from", fmt::format("{}", -1), "recorded point to go on from; -1: from the beginning");
  if (spec.preparation == Preparation::lammps) text += compaction_settings(s);
  if (spec.test == MacroTest::stages) return text + stage_settings(s) + common_numbers(s);
  text += setting("strain_end", fmt::format("{}", spec.strain_end), "at the end of the test");
  text += setting("steps", fmt::format("{}", spec.steps), "recorded points up to there");
  if (preload_points(spec) > 0) {
    text += setting("preload", fmt::format("{}", spec.preload), "isotropic strain before");
    text += setting("preload_steps", fmt::format("{}", spec.preload_steps), "recorded points of it");
  }
  text += setting("increments", fmt::format("{}", spec.increments_per_step), "relaxed strain increments per point");
  return text + common_numbers(s);
}

/// Large bodies among small ones have many neighbours: lists of LAMMPS have room for 2000 unless told.
std::string room_for_neighbours(const ScriptScene& s) {
  const double largest = *std::max_element(s.types.largest.begin(), s.types.largest.end());
  const double ratio = largest / smallest_radius(s.packing) + 1.0;
  const auto most = static_cast<std::int64_t>(16.0 * ratio * ratio);
  return most > 2000 ? fmt::format(" one {} page {}", most, 20 * most) : "";
}

std::string loading(const ScriptScene& s) {
  std::string text = section("Bodies and box");
  text += "units        si\natom_style   sphere\natom_modify  map yes\nnewton       off\nboundary     " +
          std::string(s.spec.boundary == Boundary::periodic ? "p p p" : "f f f") + "\n";
  text += "if \"${from} >= 0\" then &\n  \"read_restart restart.${from}\" &\n";
  if (s.spec.preparation == Preparation::lammps)
    text +=
        "elif \"${prepared} > 0\" &\n  \"read_restart restart.prepared\" &\n"
        "elif \"${round_done} > 0\" &\n  \"read_restart restart.compaction.${round_done}\" &\n";
  text += fmt::format("else &\n  \"read_data {}\"\n", kDataFile);
  text += "neighbor     ${skin} multi\ncomm_modify  mode multi vel yes\n";
  text += fmt::format("neigh_modify delay 0 every 1 check yes{}\n", room_for_neighbours(s));
  return text;
}

std::string laws(const ScriptScene& s) {
  const std::string solid = s.types.solid_range();
  const std::string soft = s.types.soft_range();
  std::string text = section(fmt::format("Laws: {} holds their numbers", kLawsFile));
  text += comment(fmt::format("types {} are solid, {} soft; classes halve the radius", solid.empty() ? "none" : solid,
                              soft.empty() ? "none" : soft));
  const std::string style = fmt::format("pair_style   softgrain soft {}", soft.empty() ? "none" : soft);
  text += has_springs(s.spec, s.packing)
              ? fmt::format(
                    "# contacts begin with what they bore when the preparation ended\n"
                    "if \"${{from}} < 0\" then &\n  \"{0} springs {1}\" &\nelse &\n  \"{0}\"\n",
                    style, kSpringsFile)
              : style + "\n";
  if (!solid.empty()) text += fmt::format("pair_coeff   {} {} {} solid-solid\n", solid, solid, kLawsFile);
  if (!solid.empty() && !soft.empty())
    text += fmt::format("pair_coeff   {} {} {} soft-solid\n", soft, solid, kLawsFile);
  if (!soft.empty()) text += fmt::format("pair_coeff   {} {} {} soft-soft\n", soft, soft, kLawsFile);
  if (s.spec.boundary == Boundary::walls) {
    text += "fix          walls all softgrain/wall box";
    if (!solid.empty()) text += fmt::format(" law {} {} solid-wall", solid, kLawsFile);
    if (!soft.empty()) text += fmt::format(" law {} {} soft-wall", soft, kLawsFile);
    text += "\n";
  }
  text += watching(s);
  const bool staged = s.spec.test == MacroTest::stages;
  text += fmt::format(
      "fix          relax all softgrain/relax tolerance ${{{}}} floor ${{floor}} max_passes ${{max_passes}}",
      staged ? "tolerance1" : "tolerance");
  if (staged) text += fmt::format(" &\n  least_stress {} farthest {}", least_stress(s.spec), kFarthestStrain);
  text += "\n";
  return text +
         "# a look at the start: from here on the box may change, after a restart file too\n"
         "run 0 post no\n"
         "variable     looked_before equal $(f_relax[6]:%.17g)\n";
}

}  // namespace

double smallest_radius(const MacroPacking& packing) {
  double r = packing.bodies.front().r;
  for (const MacroBody& b : packing.bodies) r = std::min(r, b.r);
  return r;
}

std::string bodies_file(const std::string& point) { return "bodies." + point + ".txt"; }
std::string contacts_file(const std::string& point) { return "contacts." + point + ".txt"; }

std::string script_text(const ScriptScene& s) {
  const bool compacts = s.spec.preparation == Preparation::lammps;
  return heading(s) + numbers(s) + loading(s) + (compacts ? compaction(s) : "") + laws(s) + test_variables(s) +
         test_loop(s) + recording(s) + the_end();
}

}  // namespace softgrain::lammps
