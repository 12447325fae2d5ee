#include "macrosim/lammps_run/script_parts.h"

#include <fmt/format.h>

#include "macrosim/lammps_run/points_columns.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/test_protocol.h"

namespace softgrain::lammps {

namespace {

constexpr std::size_t kRowWidth = 90;

/// All columns of a row as one print command, over several lines.
std::string row_command(const MacroSpec& spec) {
  const bool periodic = spec.boundary == Boundary::periodic;
  std::string text = "print \"${point}";
  std::size_t width = text.size();
  const auto add = [&](const std::string& expression) {
    const bool none = periodic && expression.starts_with("f_walls");
    const std::string cell = none ? " 0" : fmt::format(" $({}:%.17g)", expression);
    if (width + cell.size() > kRowWidth) {
      text += " &\n ";
      width = 1;
    }
    text += cell;
    width += cell.size();
  };
  for (std::size_t k = 1; k < kPointColumns.size(); ++k) add(kPointColumns[k].expression);
  for (const GrainColumn& c : grain_columns(spec)) add(c.expression);
  return text + " &\n  \" append ${file} screen no\n";
}

/// Nominal strain `end` in `total` equal increments: the box after increment n over that before.
std::string nominal_factor(const std::string& end, const std::string& total) {
  return fmt::format("(1-{0}*v_n/{1})/ &\n  (1-{0}*(v_n-1)/{1})", end, total);
}

std::string variable(const std::string& name, const std::string& formula) {
  return fmt::format("variable {} equal \"{}\"\n", name, formula);
}

/// Commands that dump bodies and contacts at the next `run 0`, each between `before` and `after`.
std::string dumps(const std::string& point, const std::string& before, const std::string& after) {
  const std::string commands[] = {
      "dump bodies all custom 1 " + bodies_file(point) + " id type radius x y z",
      "dump_modify bodies sort id format float %.17g",
      "dump contacts all local 1 " + contacts_file(point) + " c_contacts[*]",
      "dump_modify contacts format float %.17g",
  };
  std::string text;
  for (const std::string& command : commands) text += before + command + after;
  return text;
}

/// Names of the columns as a comment of points.txt, over several lines of the script.
std::string column_names(const MacroSpec& spec) {
  std::string text;
  std::string line = "#";
  const auto add = [&](const std::string& name) {
    if (line.size() + name.size() > kRowWidth) {
      text += line + " &\n";
      line = " ";
    }
    line += " " + name;
  };
  for (const PointColumn& c : kPointColumns) add(c.name);
  for (const std::string& name : grain_names(spec)) add(name);
  return text + line;
}

}  // namespace

std::string kept_states() {
  // Products of whole numbers first: what they are over `last` is exact where it is whole, as in is_snapshot().
  return variable("kept", "floor(v_point*(v_states-1)/v_last) > floor((v_point-1)*(v_states-1)/v_last)");
}

std::string counting() {
  return "variable end equal $(f_relax[3])\n"
         "variable residual equal $(f_relax[2]:%.17g)\n"
         "variable mean_force equal $(f_relax[4]:%.17g)\n"
         "variable passes equal $(v_passes+f_relax[1]+1:%.17g)\n"
         "variable looked_at equal $(v_looked_at+f_relax[6]-v_looked_before:%.17g)\n"
         "variable looked_before equal $(f_relax[6]:%.17g)\n"
         "variable seconds equal $(v_seconds+f_clock:%.17g)\n";
}

std::string unrest_begins() {
  return "variable unrest equal 0\nvariable unrest_at equal 0\nvariable unrest_end equal 1\n";
}

std::string unrest_watch() {
  return "# of all increments the one that ended farthest from rest is recorded\n"
         "if \"(${end} != 1 && ${unrest_end} == 1) || ((${end} != 1) == (${unrest_end} != 1) && &\n"
         "    $(v_residual:%.17g) >= $(v_unrest:%.17g))\" then &\n"
         "  \"variable unrest equal $(v_residual:%.17g)\" \"variable unrest_at equal ${k}\" &\n"
         "  \"variable unrest_end equal ${end}\"\n";
}

std::string heads(const ScriptScene& s) {
  return section("Heads of the tables of points") + fmt::format(
                                                        "variable file index {} {}\n"
                                                        "label head\n"
                                                        "if \"${{from}} < 0\" then &\n"
                                                        "  'print \"{}, scene {}\" file ${{file}} screen no' &\n"
                                                        "  'print \"{}\" append ${{file}} screen no'\n"
                                                        "next file\njump SELF head\n",
                                                        kPointsFile, kPointsCopy, kPointsHead, s.key,
                                                        column_names(s.spec));
}

std::string section(const std::string& title) {
  std::string line = "\n# ---- " + title + " ";
  line.resize(std::max<std::size_t>(line.size(), 79), '-');
  return line + "\n";
}

std::string setting(const std::string& name, const std::string& value, const std::string& meaning) {
  return fmt::format("variable {:<13} index {:<22} # {}\n", name, value, meaning);
}

std::string watching(const ScriptScene& s) {
  return "compute      contacts all softgrain/contacts" + grain_words(s.spec, s.packing) +
         "\n"
         "thermo_style custom step atoms c_contacts[1] c_contacts[3] c_contacts[11]\n"
         "thermo_modify lost error\n"
         "thermo       1000\n"
         "variable     clock equal cpu\n"
         "fix          clock all ave/time 1 1 1 v_clock\n";
}

std::string test_variables(const ScriptScene& s) {
  if (s.spec.test == MacroTest::stages) return stage_variables(s);
  const std::string total = "(v_steps*v_increments)";
  std::string text = section("The test: strain of the box in increment n of all");
  text += variable("n", "(v_point-1)*v_increments + v_k");
  text += "# every axis goes by strain\n" + variable("wantx", "0") + variable("wanty", "0") + variable("wantz", "0") +
          variable("over", "0");
  if (is_shear(s.spec.test)) {  // tests that slide are refused
    const bool undrained = s.spec.test == MacroTest::undrained;
    const char* const way = undrained ? "z shortens, x and y lengthen by half of its logarithmic strain"
                                      : "z shortens, x lengthens by equal logarithmic strains";
    const std::string grow = fmt::format("exp({}v_strain_end/{})", undrained ? "0.5*" : "", total);
    const std::string grow_y = undrained ? grow : "1";
    const std::string shrink = "exp(-v_strain_end/" + total + ")";
    if (preload_points(s.spec) > 0) {
      const std::string loads = "(v_preload_steps*v_increments)";
      text += fmt::format("# all axes to the nominal strain of the preload; then z shortens, {}\n",
                          undrained ? "x and y lengthen" : "x lengthens");
      text += variable("loading", "v_n <= " + loads);
      text += variable("load", nominal_factor("v_preload", loads));
      text += variable("fx", "v_loading*v_load + (1-v_loading)*" + grow);
      text += variable("fy", "v_loading*v_load + (1-v_loading)" + (undrained ? "*" + grow_y : ""));
      text += variable("fz", "v_loading*v_load + (1-v_loading)*" + shrink);
      text += variable("since", "v_point - v_preload_steps");
      text += variable("strain",
                       "(v_since<0)*v_preload*v_since/v_preload_steps &\n  + (v_since>0)*v_strain_end*v_since/v_steps");
      return text + variable("last", "v_preload_steps + v_steps") + kept_states();
    }
    text += fmt::format("# {}\n", way);
    text += variable("fx", grow) + variable("fy", grow_y) + variable("fz", shrink);
  } else {
    const bool all = s.spec.test == MacroTest::isotropic;
    text += all ? "# all axes shorten\n" : "# z shortens, x and y stand\n";
    text += variable("fz", nominal_factor("v_strain_end", total));
    text += variable("fx", all ? "v_fz" : "1") + variable("fy", all ? "v_fz" : "1");
  }
  return text + variable("strain", "v_strain_end*v_point/v_steps") + variable("last", "v_steps") + kept_states();
}

namespace {

/// Commands of one increment: the box is strained, then all comes to rest.
std::string one_increment() {
  return "if \"${point} > 0\" then &\n"
         "  \"change_box all x scale $(v_fx:%.17g) y scale $(v_fy:%.17g) &\n"
         "   z scale $(v_fz:%.17g) remap units box\"\n"
         "run ${max_passes} post no\n" +
         counting();
}

}  // namespace

std::string test_loop(const ScriptScene& s) {
  if (s.spec.test == MacroTest::stages)
    return heads(s) + section("The test: points, and increments between them") + stage_loop(s);
  std::string text = heads(s) + section("The test: points, and increments between them");
  text +=
      "if \"${from} >= ${last}\" then \"jump SELF end\"\n"
      "variable point loop $(v_from+1) ${last}\n"
      "label point\n"
      "variable passes equal 0\n"
      "variable looked_at equal 0\n"
      "variable seconds equal 0\n" +
      unrest_begins() +
      "# point 0 is the start at rest: relaxed once, without strain\n"
      "variable k loop $((v_point==0)+(v_point>0)*v_increments)\n"
      "label increment\n"
      "# the box is strained, bodies move with it, springs of contacts go along; then all\n"
      "# relax\n";
  text += one_increment();
  text +=
      fmt::format("if \"${{end}} == 3\" then &\n  'print \"${{point}} $(v_strain:%.17g)\" file {}' &\n  \"quit 0\"\n",
                  kDivergedFile);
  return text + unrest_watch() + "next k\njump SELF increment\n";
}

std::string recording(const ScriptScene& s) {
  const bool staged = s.spec.test == MacroTest::stages;
  std::string states = dumps("${point}", "  \"", "\" &\n");
  states.erase(states.size() - 3, 2);  // nothing follows the last command
  return section("A recorded point: restart file, state, row") +
         "write_restart restart.${point}\n"
         "if \"${point} > 1\" then \"shell rm restart.$(v_point-2)\"\n"
         "# states are kept evenly spread over the points\n"
         "if \"${kept} > 0\" then &\n" +
         states +
         "# forces and sums of the state at rest\n"
         "run 0 post no\n"
         "variable looked_before equal $(f_relax[6]:%.17g)\n"
         "if \"${kept} > 0\" then \"undump bodies\" \"undump contacts\"\n"
         "# twice: a table that is cut short or damaged differs from its copy\n"
         "variable file index " +
         kPointsFile + " " + kPointsCopy + "\nlabel row\n" + row_command(s.spec) +
         "next file\njump SELF row\n"
         "# a law that is asked beyond its range and does not allow it, or a body behind a wall,\n"
         "# ends the test\n"
         "if \"$(c_contacts[15]) > 0 || $(c_contacts[17]) > 0\" then \"jump SELF end\"\n" +
         (staged ? "if \"${over} > 0\" then \"jump SELF end\"\n" + stage_begins(s) : "") +
         "next point\njump SELF point\n";
}

std::string the_end() {
  return section("The last state") + "label end\n" + dumps("end", "", "\n") +
         "run 0 post no\n"
         "undump bodies\n"
         "undump contacts\n" +
         fmt::format("print \"both files of the last state are complete\" file {} screen no\n", kEndFile);
}

}  // namespace softgrain::lammps
