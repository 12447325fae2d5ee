#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/preparation.h"

namespace softgrain::lammps {

namespace {

/// Passes after which a relaxation writes a restart file and goes on. The lead of single bodies doubles there.
constexpr std::int64_t kRoundPasses = MoveLimit::kLeadDoubles;
/// Skin over the smallest radius. With 0.2, as in the test, lists took three quarters of the time: of 20,000 bodies on
/// two ranks the first 1,800 to 2,000 passes took 18.1 s; 9.8 with 0.5, 9.6 with 1, 7.9 with 1.5.
constexpr double kLooseSkin = 1.2;
/// Logarithmic strain of the box in one round beyond which nothing will press.
constexpr double kFarthestPressed = 3.0;

/// First pressure of the compaction over its last one. LAMMPS loses bodies whose centre walls press out of the box,
/// where our own engine lets them come back.
double first_pressure(const MacroSpec& spec) {
  constexpr double kMost = 5e-3;  ///< largest first pressure, over E
  if (spec.boundary == Boundary::periodic) return spec.protocol.first_pressure;
  return std::min(spec.protocol.first_pressure, std::max(1.0, kMost / spec.start_pressure));
}

/// Every law is that of hard grains without friction.
std::string hard_laws(bool periodic) {
  const std::string pairs = fmt::format(
      "pair_style   softgrain soft none\n"
      "pair_coeff   * * {} hard\n",
      kLawsFile);
  return periodic ? pairs : pairs + fmt::format("fix          walls all softgrain/wall box law * {} hard\n", kLawsFile);
}

double mean_radius(const MacroPacking& packing) {
  double sum = 0.0;
  for (const MacroBody& b : packing.bodies) sum += b.r;
  return sum / static_cast<double>(packing.bodies.size());
}

/// Options of the relaxation of a box whose faces bear 1 N.
DampedOptions options(const ScriptScene& s, bool last) {
  return pressing_options(s.spec, last, 1.0, static_cast<double>(s.packing.bodies.size()), mean_radius(s.packing));
}

}  // namespace

std::string compaction_settings(const ScriptScene& s) {
  std::string text = setting("round_done", "0", "round of the compaction to go on after; 0: none");
  text += setting("next_pressure", fmt::format("{}", first_pressure(s.spec)),
                  "the pressure that comes next, times the last one");
  text += setting("passes_under", "0", "passes that were made under it");
  text += setting("prepared", "0", "1: go on where the compaction was done");
  text += setting("pressure_end", fmt::format("{}", s.spec.start_pressure * s.spec.youngs_modulus),
                  "last pressure of the compaction [Pa]");
  text += setting("loose_skin", fmt::format("{}", kLooseSkin * smallest_radius(s.packing)),
                  "as skin below, while bodies find their places [m]");
  return text;
}

namespace {

/// Relaxation of bodies and box under one pressure, or a part of it.
std::string one_round(const ScriptScene& s) {
  const DampedOptions last = options(s, true);
  std::string text = fmt::format(
      "variable lowest equal $(v_times<=1)\n"
      "variable bear equal $(v_times*v_pressure_end:%.17g)\n"
      "variable face_load equal $(v_bear*lx*ly:%.17g)\n"
      "variable press_rest equal $(v_lowest*{}+(1-v_lowest)*{})\n"
      "variable press_even equal $(v_lowest*{}+(1-v_lowest)*{})\n",
      last.tolerance, options(s, false).tolerance, pressing_stress_tolerance(s.spec, true),
      pressing_stress_tolerance(s.spec, false));
  text += fmt::format(
      "fix relax all softgrain/relax stress ${{bear}} ${{bear}} ${{bear}} isotropic yes &\n"
      "  tolerance ${{press_rest}} stress_tolerance ${{press_even}} floor $({}*v_face_load:%.17g) &\n"
      "  least_stiffness $({}*v_face_load^(1/3):%.17g) unbalanced_fraction {}{} &\n"
      "  max_passes {} farthest {} log_lists yes\n"
      "run {} post no\n",
      last.force_floor, last.least_stiffness, last.unbalanced_fraction,
      std::isfinite(last.max_lead)
          ? fmt::format(" max_displacement_ratio $({}*2^floor(v_so_far/{}))", last.max_lead, kRoundPasses)
          : "",
      kRoundPasses, kFarthestPressed, kRoundPasses);
  return text +
         "variable passes equal $(f_relax[1])\n"
         "variable end equal $(f_relax[3])\n"
         "variable pressure equal $((f_relax[7]+f_relax[8]+f_relax[9])/3:%.17g)\n"
         "unfix relax\n";
}

/// Commands that repeat the pressure while bodies and box are not at rest, and else go on to the next one.
std::string next_pressure(const ScriptScene& s) {
  return fmt::format(
             "if \"${{end}} == 3\" then \"jump SELF loose\"\n"
             "if \"$(v_end==2) > $(v_passes>={0})\" then \"jump SELF loose\"\n"
             "variable so_far equal $(v_so_far+v_passes)\n"
             "variable again equal $((v_end==2)*(v_so_far<{1}))\n"
             "if \"${{lowest}} > 0 && ${{again}} == 0 && ${{end}} == 2\" then \"jump SELF loose\"\n"
             "if \"${{lowest}} > 0 && ${{again}} == 0\" then \"jump SELF touching\"\n",
             kRoundPasses, s.spec.protocol.max_passes) +
         fmt::format(
             "if \"${{again}} == 0\" then &\n"
             "  \"variable so_far equal 0\" &\n"
             "  \"variable times equal $(1+(v_times*{0}>1)*(v_times*{0}-1):%.17g)\"\n",
             kPressureFall);
}

/// A row says which round it was, what comes next, how far the box is and what it bears.
std::string row() {
  return fmt::format(
      "print \"${{round}} $(v_times:%.17g) $(v_so_far) $(lx:%.17g) $(v_pressure:%.17g) &\n"
      "  $(v_passes) $(v_end)\" append {} screen no\n",
      kCompactionFile);
}

/// The restart file of a round is complete when its row is there.
std::string note_round() {
  return "write_restart restart.compaction.${round}\n" + row() +
         "if \"${round} > 2\" then \"shell rm restart.compaction.$(v_round-2)\"\n";
}

/// Bodies touch: they are written down, and what served the compaction goes.
std::string touching(bool periodic) {
  return "label touching\n" + row() +
         fmt::format(
             "dump bodies all custom 1 {} id type radius x y z\n"
             "dump_modify bodies sort id format float %.17g\n"
             "run 0 post no\n"
             "undump bodies\n"
             "write_restart restart.new\n"
             "shell mv restart.new restart.prepared\n"
             "if \"${{round}} > 1\" then \"shell rm restart.compaction.$(v_round-1)\"\n"
             "if \"${{round}} > 2\" then \"shell rm restart.compaction.$(v_round-2)\"\n"
             "unfix clock\n"
             "uncompute contacts\n"
             "neighbor ${{skin}} multi\n"
             "neigh_modify delay 0 every 1 check yes\n"
             "{}"
             "label prepared\n",
             kPreparedFile, periodic ? "" : "unfix walls\n");
}

}  // namespace

std::string compaction(const ScriptScene& s) {
  constexpr int kMostRounds = 10000;
  std::string text = section("Preparation: bodies placed loosely are pressed into touch");
  text +=
      "# hard and without friction, bodies and box relax together under a pressure that\n"
      "# falls to the last one\n"
      "if \"${from} >= 0 || ${prepared} > 0\" then \"jump SELF prepared\"\n";
  const bool periodic = s.spec.boundary == Boundary::periodic;
  text += hard_laws(periodic) + watching(s);
  text +=
      "# the relaxation itself says when lists are made\nneighbor ${loose_skin} multi\nneigh_modify delay 0 every "
      "1000000 check no\nrun 0 post no\n";
  text += fmt::format(
      "variable times equal ${{next_pressure}}\nvariable so_far equal ${{passes_under}}\n"
      "if \"${{round_done}} == 0\" then &\n"
      "  'print \"# round next_pressure passes_under_it lx pressure passes end\" file {} screen no'\n"
      "variable round loop $(v_round_done+1) {}\nlabel round\n",
      kCompactionFile, kMostRounds);
  text += one_round(s) + next_pressure(s) + note_round();
  text += "next round\njump SELF round\nlabel loose\n";
  text += fmt::format("print \"ERROR: {}\"\nquit 1\n", kNotJammed);
  return text + touching(periodic);
}

}  // namespace softgrain::lammps
