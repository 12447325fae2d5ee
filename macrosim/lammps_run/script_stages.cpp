// A test in stages: for every stage its formulas, one loop over points and increments for all.
#include <fmt/format.h>

#include <algorithm>

#include "macrosim/lammps_run/input_script.h"
#include "macrosim/lammps_run/points_columns.h"
#include "macrosim/lammps_run/script_parts.h"
#include "macrosim/test_protocol.h"

namespace softgrain::lammps {

namespace {

constexpr const char* kAxes = "xyz";

std::string equal(const std::string& name, const std::string& formula) {
  return fmt::format("variable {} equal \"{}\"\n", name, formula);
}

/// The stress along an axis when a stage began: what was recorded then.
std::string begin_name(std::int64_t stage, int axis) { return fmt::format("begin{}{}", stage + 1, kAxes[axis]); }

/// The last point of the stages that ask for stresses by what they were when this stage began; its first one where none
/// does.
std::int64_t begin_needed_until(const std::vector<MacroStage>& stages, std::int64_t stage) {
  std::int64_t until = first_point(stages, stage);
  for (std::int64_t s = stage; s < static_cast<std::int64_t>(stages.size()); ++s) {
    const MacroStage& one = stages[static_cast<std::size_t>(s)];
    const bool asks = s == stage ? one.by_stress()
                                 : std::any_of(one.axis.begin(), one.axis.end(),
                                               [&](const AxisDrive& d) { return d.by_stress && d.as_at == stage; });
    if (asks) until = first_point(stages, s + 1);
  }
  return until;
}

/// Commands that stop a run which goes on in the middle of stages without the stresses at which they began: it would
/// take another way.
std::string require_begins(const std::vector<MacroStage>& stages) {
  std::string text;
  for (std::int64_t k = 0; k < static_cast<std::int64_t>(stages.size()); ++k) {
    const std::int64_t first = first_point(stages, k);
    const std::int64_t until = begin_needed_until(stages, k);
    if (until == first) continue;
    const auto name = [&](int axis) { return begin_name(k, axis); };
    text += fmt::format(
        "if \"${{from}} >= {0} && ${{from}} < {1} && &\n"
        "    $(is_defined(variable,{2})*is_defined(variable,{3})*is_defined(variable,{4})) == 0\" then &\n"
        "  'print \"ERROR: after point ${{from}} the target stresses depend on the stresses at the start of stage {5}: "
        "&\n"
        "give -var {2} SX -var {3} SY -var {4} SZ, &\n"
        "the columns stress_x, stress_y and stress_z of point {0} in {6}\"' &\n"
        "  \"quit 1\"\n",
        first, until, name(0), name(1), name(2), k + 1, kPointsFile);
  }
  return text.empty() ? text : "# a run that goes on needs the stresses at which its stages began\n" + text;
}

std::string tolerance_name(std::int64_t stage) { return fmt::format("tolerance{}", stage + 1); }

/// The box along an axis after increment n over that before.
std::string factor(const MacroStage& stage, int axis) {
  const AxisDrive& drive = stage.axis[static_cast<std::size_t>(axis)];
  if (drive.by_stress || drive.value == 0.0) return "1";
  if (stage.logarithmic) return fmt::format("exp({}/v_total)", -drive.value);
  return fmt::format("(1-{0}*v_n/v_total)/(1-{0}*(v_n-1)/v_total)",
                     drive.value < 0.0 ? fmt::format("({})", drive.value) : fmt::format("{}", drive.value));
}

/// Stress asked along an axis at the end of increment n, on the straight way to its target.
std::string asked(const MacroStage& stage, std::int64_t number, int axis) {
  const AxisDrive& drive = stage.axis[static_cast<std::size_t>(axis)];
  if (!drive.by_stress) return "0";
  const std::string target = drive.as_at < 0 ? fmt::format("{}", drive.value) : "v_" + begin_name(drive.as_at, axis);
  return fmt::format("(1-v_n/v_total)*v_{}+v_n/v_total*{}", begin_name(number, axis), target);
}

bool presses_alike_first(const MacroStage& stage) {
  return !stage.isotropic && stage.axis[0].by_stress && stage.axis[1].by_stress && stage.axis[2].by_stress;
}

bool strains(const MacroStage& stage) {
  return std::any_of(stage.axis.begin(), stage.axis.end(),
                     [](const AxisDrive& d) { return !d.by_stress && d.value != 0.0; });
}

/// What the loop needs to know of a stage, and a jump into it.
std::string block(const MacroStage& stage, std::int64_t number, std::int64_t first) {
  std::string text =
      fmt::format("# {}: {}\nlabel stage{}\n", stage.record.name, to_string(stage.record.kind), number + 1);
  text += equal("first", fmt::format("{}", first)) + equal("increments", fmt::format("{}", stage.increments_per_step));
  text += equal("total", fmt::format("{}", stage.steps * stage.increments_per_step));
  text += equal("strained", strains(stage) ? "1" : "0") + equal("pressed", stage.by_stress() ? "1" : "0");
  text += equal("evened", presses_alike_first(stage) ? "1" : "0");
  for (int k = 0; k < 3; ++k) {
    text += equal(fmt::format("f{}", kAxes[k]), factor(stage, k));
    text += equal(fmt::format("by{}", kAxes[k]), stage.axis[static_cast<std::size_t>(k)].by_stress ? "1" : "0");
    text += equal(fmt::format("asked{}", kAxes[k]), asked(stage, number, k));
  }
  return text + fmt::format("variable isotropic string {}\nvariable rest equal v_{}\njump SELF staged\n",
                            stage.isotropic ? "yes" : "no", tolerance_name(number));
}

std::string targets() {
  std::string text;
  for (int k = 0; k < 3; ++k)
    text += fmt::format(
        "if \"${{point}} > 0 && ${{by{0}}} > 0\" then &\n"
        "  \"variable press{0} string $(v_asked{0}:%.17g)\" &\n"
        "  \"variable want{0} equal $(v_asked{0}:%.17g)\" &\n"
        "else \"variable press{0} string no\" \"variable want{0} equal 0\"\n",
        kAxes[k]);
  return text;
}

}  // namespace

std::string stage_settings(const ScriptScene& s) {
  std::string text = "# stages, in the order of their points:\n";
  const auto stages = stages_of(s.spec);
  std::int64_t point = 0;
  for (const MacroStage& stage : stages) {
    text += fmt::format("#   points {} to {}: {} ({})\n", point + 1, point + stage.steps, stage.record.name,
                        to_string(stage.record.kind));
    point += stage.steps;
  }
  text += setting("z_start", fmt::format("{}", s.packing.size()[2]), "length of the box along z at the start [m]");
  for (std::size_t k = 0; k < stages.size(); ++k)
    text += setting(tolerance_name(static_cast<std::int64_t>(k)), fmt::format("{}", stages[k].tolerance),
                    fmt::format("largest net force over the mean one, stage {}", k + 1));
  return text +
         "# A run that goes on within stages also needs the stresses at which they began [Pa]:\n"
         "# -var begin1x SX -var begin1y SY -var begin1z SZ, of stage 1\n";
}

std::string stage_variables(const ScriptScene& s) {
  const auto stages = stages_of(s.spec);
  std::string text = section("The test: what increment n of a stage asks for");
  text += equal("n", "(v_point-v_first-1)*v_increments + v_k") + equal("strain", "1-lz/v_z_start");
  text += equal("last", fmt::format("{}", first_point(stages, static_cast<std::int64_t>(stages.size()))));
  text += equal("over", "0");
  if (s.spec.preparation == Preparation::lammps)
    text += "if \"${from} < 0\" then &\n  \"variable z_start delete\" &\n  \"variable z_start index $(lz:%.17g)\"\n";
  return text + kept_states();
}

std::string stage_loop(const ScriptScene& s) {
  const auto stages = stages_of(s.spec);
  std::string text = "if \"${from} >= ${last}\" then \"jump SELF end\"\n" + require_begins(stages) +
                     "variable point loop $(v_from+1) ${last}\n"
                     "label point\n"
                     "variable passes equal 0\n"
                     "variable looked_at equal 0\n"
                     "variable seconds equal 0\n" +
                     unrest_begins();
  for (std::size_t k = stages.size(); k-- > 1;)
    text += fmt::format("if \"${{point}} > {}\" then \"jump SELF stage{}\"\n",
                        first_point(stages, static_cast<std::int64_t>(k)), k + 1);
  for (std::size_t k = 0; k < stages.size(); ++k)
    text += block(stages[k], static_cast<std::int64_t>(k), first_point(stages, static_cast<std::int64_t>(k)));
  text +=
      "# point 0 is the start at rest: relaxed once, without strain or stress\n"
      "label staged\n"
      "variable k loop $((v_point==0)+(v_point>0)*v_increments)\n"
      "label increment\n"
      "# the box is strained along axes that go by strain, bodies and springs go along\n"
      "if \"${point} > 0 && ${strained} > 0\" then &\n"
      "  \"change_box all x scale $(v_fx:%.17g) y scale $(v_fy:%.17g) &\n"
      "   z scale $(v_fz:%.17g) remap units box\"\n";
  text += targets();
  text +=
      "# where all go by stress the mean comes first, without change of shape\n"
      "if \"${point} == 0 || ${evened} == 0\" then \"jump SELF pressed\"\n"
      "variable mean equal (v_askedx+v_askedy+v_askedz)/3\n"
      "fix_modify relax stress $(v_mean:%.17g) $(v_mean:%.17g) $(v_mean:%.17g) isotropic yes &\n"
      "  tolerance $(10*v_rest:%.17g) stress_tolerance $(10*v_rest/3:%.17g)\n"
      "run ${max_passes} post no\n";
  text += counting();
  text +=
      "label pressed\n"
      "# then all relax, with the axes that go by stress\n"
      "fix_modify relax stress ${pressx} ${pressy} ${pressz} isotropic ${isotropic} &\n"
      "  tolerance $(v_rest:%.17g) stress_tolerance $(v_rest/3:%.17g)\n"
      "run ${max_passes} post no\n";
  text += counting();
  text +=
      fmt::format("if \"${{end}} == 3\" then &\n  'print \"${{point}} $(v_strain:%.17g)\" file {}' &\n  \"quit 0\"\n",
                  kDivergedFile);
  return text + unrest_watch() +
         "# a stress that is not reached ends the test\n"
         "if \"${point} > 0 && ${pressed} > 0 && ${end} != 1\" then &\n"
         "  \"variable over equal 1\" \"variable k delete\" \"jump SELF recorded\"\n"
         "next k\njump SELF increment\n"
         "label recorded\n";
}

std::string stage_begins(const ScriptScene& s) {
  const auto stages = stages_of(s.spec);
  std::string text = "# the stress at which a stage begins\n";
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    text += fmt::format("if \"${{point}} == {}\" then", first_point(stages, number));
    for (int axis = 0; axis < 3; ++axis)
      text += fmt::format(" &\n  \"variable {0} delete\" \"variable {0} index $(f_relax[{1}]:%.17g)\"",
                          begin_name(number, axis), 7 + axis);
    text += "\n";
  }
  return text;
}

std::vector<std::string> begin_settings(const std::vector<MacroStage>& stages, const std::vector<PointRow>& rows) {
  std::vector<std::string> out{"-var", "z_start", fmt::format("{}", rows.front()[Point::lz])};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    const auto first = static_cast<std::size_t>(first_point(stages, number));
    if (first >= rows.size()) break;
    for (int axis = 0; axis < 3; ++axis) {
      const auto column =
          static_cast<Point>(static_cast<std::size_t>(Point::stress_x) + static_cast<std::size_t>(axis));
      out.insert(out.end(), {"-var", begin_name(number, axis), fmt::format("{}", rows[first][column])});
    }
  }
  return out;
}

}  // namespace softgrain::lammps
