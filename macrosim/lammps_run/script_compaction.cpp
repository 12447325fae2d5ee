#include <fmt/format.h>

#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/preparation.h"

namespace softgrain::lammps {

namespace {

/// Every law is that of hard grains without friction.
std::string hard_laws(bool periodic) {
  const std::string pairs = fmt::format(
      "pair_style   softgrain soft none\n"
      "pair_coeff   * * {} hard\n",
      kLawsFile);
  return periodic ? pairs : pairs + fmt::format("fix          walls all softgrain/wall box law * {} hard\n", kLawsFile);
}

/// The mean stress on the box: of its walls, or of the contacts in a periodic cell.
std::string box_pressure(bool periodic) {
  if (periodic) return "variable walls equal \"(c_contacts[5]+c_contacts[6]+c_contacts[7])/(3*lx*ly*lz)\"\n";
  return "variable walls equal \"((f_walls[1]+f_walls[2])*lx + (f_walls[3]+f_walls[4])*ly &\n"
         "  + (f_walls[5]+f_walls[6])*lz)/(6*lx*ly*lz)\"\n";
}

/// A row says which round it was, what step comes next, and how far the box and its walls are. Its restart file is
/// complete when it is there.
std::string note_round() {
  return fmt::format(
      "write_restart restart.compaction.${{round}}\n"
      "print \"${{round}} $(v_step:%.17g) $(lx:%.17g) $(v_pressure:%.17g) &\n"
      "  $(v_passes) $(v_end)\" append {} screen no\n"
      "if \"${{round}} > 2\" then \"shell rm restart.compaction.$(v_round-2)\"\n",
      kCompactionFile);
}

}  // namespace

std::string compaction_settings(const ScriptScene& s) {
  const CompactionProtocol p = compaction_protocol(s.spec, s.packing.size(), s.packing.bodies.size());
  std::string text = setting("round_done", "0", "round of the compaction to go on after; 0: none");
  text += setting("first_step", fmt::format("{}", p.first_step), "strain of its first (or next) round");
  text += setting("prepared", "0", "1: go on where the compaction was done");
  text += setting("pressure_end", fmt::format("{}", p.pressure), "of the walls when bodies touch [Pa]");
  text += setting("loose_floor", fmt::format("{}", p.force_floor), "as floor below, for the compaction [N]");
  return text;
}

namespace {

/// One round: `pressure` is what the walls bear at rest.
std::string one_round(const CompactionProtocol& p) {
  return "change_box all x scale $(1-v_step:%.17g) y scale $(1-v_step:%.17g) &\n"
         "  z scale $(1-v_step:%.17g) remap units box\n" +
         fmt::format(
             "fix relax all softgrain/relax tolerance {} floor ${{loose_floor}} max_passes {}\nrun {} post no\n",
             p.tolerance, p.max_passes, p.max_passes) +
         "variable passes equal $(f_relax[1])\n"
         "variable end equal $(f_relax[3])\n"
         "unfix relax\n"
         "if \"${end} == 3\" then \"jump SELF loose\"\n"
         "run 0 post no\n"
         "variable pressure equal $(v_walls:%.17g)\n" +
         fmt::format("variable far equal $(v_pressure>={}*v_pressure_end)\n", p.overshoot) +
         "if \"$(v_pressure>=v_pressure_end) > ${far}\" then \"jump SELF touching\"\n"
         "if \"${far} > 0\" then &\n"
         "  \"change_box all x scale $(1/(1-v_step):%.17g) y scale $(1/(1-v_step):%.17g) &\n"
         "   z scale $(1/(1-v_step):%.17g) remap units box\" &\n"
         "  \"variable step equal $(0.5*v_step:%.17g)\"\n";
}

/// Bodies touch: they are written down, and what served the compaction goes.
std::string touching(bool periodic) {
  return fmt::format(
      "label touching\n"
      "dump bodies all custom 1 {} id type radius x y z\n"
      "dump_modify bodies sort id format float %.17g\n"
      "run 0 post no\n"
      "undump bodies\n"
      "write_restart restart.new\n"
      "shell mv restart.new restart.prepared\n"
      "unfix clock\n"
      "uncompute contacts\n"
      "{}"
      "label prepared\n",
      kPreparedFile, periodic ? "" : "unfix walls\n");
}

}  // namespace

std::string compaction(const ScriptScene& s) {
  const CompactionProtocol p = compaction_protocol(s.spec, s.packing.size(), s.packing.bodies.size());
  std::string text = section("Preparation: bodies placed loosely are brought into touch");
  text +=
      "# hard and without friction; the box shrinks until it bears the pressure, a step\n"
      "# that overshoots is taken back and halved\n"
      "if \"${from} >= 0 || ${prepared} > 0\" then \"jump SELF prepared\"\n";
  const bool periodic = s.spec.boundary == Boundary::periodic;
  text += hard_laws(periodic) + watching(s) + "run 0 post no\n";
  text += "variable step equal ${first_step}\n" + box_pressure(periodic);
  text += fmt::format(
      "if \"${{round_done}} == 0\" then &\n"
      "  'print \"# round next_step lx pressure passes end\" file {} screen no'\n"
      "variable round loop $(v_round_done+1) {}\nlabel round\n",
      kCompactionFile, p.most_rounds);
  text += one_round(p) + note_round();
  text += fmt::format("if \"${{step}} < {}\" then \"jump SELF loose\"\n", p.smallest_step);
  text += "next round\njump SELF round\nlabel loose\n";
  text += fmt::format("print \"ERROR: {}\"\nquit 1\n", kNotJammed);
  return text + touching(periodic);
}

}  // namespace softgrain::lammps
