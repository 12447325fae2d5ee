#include "pipelines/commands/law_options.h"

#include <CLI/CLI.hpp>

#include "common/core/text.h"

namespace softgrain {

namespace {

/// "error|clamp|extrapolate"
template <NamedEnum Enum>
std::string alternatives() {
  return join_text(enum_names<Enum>, "|", [](const EnumName<Enum>& w) { return std::string(w.text); });
}

/// An option that takes the words of an enum.
template <NamedEnum Enum, class Target>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Target& target, const std::string& help) {
  return app
      .add_option_function<std::string>(
          name, [&target](const std::string& word) { target = *parse_enum<Enum>(word); }, help)
      ->option_text(alternatives<Enum>())
      ->check(CLI::IsMember(all_enum_names<Enum>()).description(""));
}

void add_files(CLI::App& app, LawOptions& o, const char* help) {
  app.add_option("LAW", o.files, help)->option_text(" ");
  app.add_flag("--json", o.json, "One JSON object on standard output");
}

void add_overlaps(CLI::App& app, LawOptions& o, const std::string& to) {
  app.add_option("--delta", o.deltas, "Overlaps Delta = h/R (multi-contact laws: h/Rs)")->option_text("D1 D2 ...");
  app.add_option("--from", o.from, "First overlap; default 0")->option_text("D");
  app.add_option(to, o.to_delta, "Last overlap; default the end of the measured range")->option_text("D");
  app.add_option("--steps", o.steps, "Overlaps from first to last")->option_text("N");
}

void add_law_choices(CLI::App& app, LawOptions& o) {
  app.add_option_function<std::vector<std::string>>(
         "--kind",
         [&o](const std::vector<std::string>& kinds) {
           for (const std::string& word : kinds) o.kinds.push_back(*parse_enum<PairKind>(word));
         },
         "Cards and pair tables: kind of pair; default all")
      ->option_text(alternatives<PairKind>())
      ->check(CLI::IsMember(all_enum_names<PairKind>()).description(""));
  app.add_option("--deepest", o.deepest, "Cards: values of a contact that was pressed in so far before and unloads")
      ->option_text("D");
  add_choice<Extrapolation>(app, "--beyond", o.beyond, "Beyond the measured range, instead of what the law says");
  app.add_option("--E", o.modulus, "Young's modulus, \"0.5 MPa\" or in Pa; default as measured. Asks for SI units")
      ->option_text("E");
  app.add_option("--radius", o.radius, "Radius of the soft particle, \"16 mm\" or in m; as measured. Asks for SI units")
      ->option_text("R");
  add_choice<LawForm>(app, "--form", o.form, "Tables: form of the law; default the best");
  app.add_option("--solid-fraction", o.solid_fraction, "Tables: of the soft particle; default that of the main entry")
      ->option_text("PHI");
  add_choice<RangePolicy>(app, "--range", o.range, "Tables: what to do with solid fractions that were not measured");
}

void add_neighbours(CLI::App& app, LawOptions& o) {
  add_choice<Arrangement>(app, "--arrangement", o.arrangement, "Tables: neighbours; all are pressed in by Delta")
      ->option_text("NAME");
  add_choice<PartnerKind>(app, "--partner", o.partner, "Tables: kind of neighbours; default plane");
  app.add_option("--ratio", o.ratio, "Tables: radius of the neighbours over that of the soft particle; default 1")
      ->option_text("Q");
  app.add_option("--shallow", o.shallow, "Tables: overlap of the first of beside-five over that of the others")
      ->option_text("S");
  add_choice<TangentialSlope>(app, "--kt", o.tangential,
                              "Tangential stiffness in the terminal's table; default initial");
}

void add_export(CLI::App& app, LawOptions& o) {
  add_choice<LawFormat>(app, "--to", o.format, "Format");
  app.add_option("--out", o.out, "File to write; default standard output")->option_text("FILE");
  app.add_option("--ratios", o.ratios, "lammps-table: radii of the other body over that of the soft one; default 1")
      ->option_text("Q1 Q2 ...");
  app.add_option("--rows", o.rows, "lammps-table: rows of a table; default 1001")->option_text("N");
  app.add_option("--delta-max", o.delta_max, "lammps-table: deepest overlap; default the end of the measured range")
      ->option_text("D");
}

void add_plan(CLI::App& app, LawOptions& o) {
  app.add_option("--for", o.target, "Macro scene with bands, which is run; or the directory of such a run")
      ->option_text("SCENE|RUN");
  app.add_option("--measure", o.measure, "Law-table scene: its [[configuration]]s are what could be measured")
      ->option_text("TABLE.toml");
  app.add_option("--packings", o.packings, "Packings that are added at a time; default 8")->option_text("N");
  app.add_option("--narrow", o.narrow, "Wanted: what packings leave open over what they do now; default 0.5")
      ->option_text("SHARE");
  app.add_option("--out", o.out, "Directory of the run of --for SCENE; default results/plan_SCENE")->option_text("DIR");
  add_choice<LawForm>(app, "--form", o.form, "Form of the law; default the best that the run has error bars of");
  app.add_flag("--toml", o.as_scene, "The plan as [[plan]] tables, to be appended to the law-table scene");
}

void add_get(CLI::App& app, LawOptions& o) {
  app.add_flag("--json", o.json, "One JSON object on standard output");
  app.add_option("--mu", o.friction, "Coulomb friction of the grains")->option_text("MU");
  app.add_option("--exponent", o.exponent, "Exponent b of the size distribution r^-b")->option_text("B");
  app.add_option("--ratio", o.ratio, "Size ratio rmax/rmin of the grains")->option_text("Q");
  app.add_option("--solid-fraction", o.solid_fraction, "Volume of grains over that of the shell")->option_text("PHI");
  app.add_option("--nu", o.poisson_ratio, "Poisson's ratio; default 0.3")->option_text("NU");
  app.add_option("--E", o.modulus, "Young's modulus, \"0.5 MPa\" or in Pa; default 0.5 MPa")->option_text("E");
  app.add_option("--radius", o.radius, "Radius of the soft particle, \"16 mm\" or in m; default 16 mm")
      ->option_text("R");
  app.add_option("--library", o.library, "Library; default that of the program")->option_text("FILE");
  app.add_option("--own", o.own, "Law table of own packings of this material, with its .h5: corrects the answer")
      ->option_text("TABLE");
  app.add_option(
         "--press-test", o.press_test,
         "Press test of one soft particle on a plane (table or law card) instead of the material; --mu beside it")
      ->option_text("TABLE");
  app.add_option("--draws", o.draws, "Draws of the law for error bars of macro runs; default 64")->option_text("N");
  app.add_option("--out", o.out, "Law table to write, and an .h5 beside it; default: numbers alone, on the terminal")
      ->option_text("FILE.toml");
}

/// Names of the options that stand on the command line.
std::vector<std::string> given_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    if (option->count() > 0) names.push_back(option->get_name());
  return names;
}

}  // namespace

void add_law_command(CLI::App& app, LawOptions& options) {
  CLI::App* law = app.add_subcommand("law", "Shows, evaluates and converts law cards and law tables");
  law->require_subcommand(0, 1);
  law->parse_complete_callback([law, &options] {
    if (law->get_subcommands().empty()) options.action = LawAction::none;
  });
  const auto add = [&](LawAction action, const char* does) {
    CLI::App* sub = law->add_subcommand(to_string(action), does);
    sub->parse_complete_callback([sub, action, &options] {
      options.action = action;
      options.given = given_options(*sub);
    });
    return sub;
  };
  CLI::App* show = add(LawAction::show, "Parameters, intervals, range and a plot; of two laws: how they differ");
  add_files(*show, options, "card (law.toml), table (law_table.toml) or run directory; two: A and B");
  CLI::App* eval = add(LawAction::eval, "Forces and stiffnesses at given overlaps, with 95 % intervals");
  add_files(*eval, options, "card, table or run directory");
  add_overlaps(*eval, options, "--to");
  add_law_choices(*eval, options);
  add_neighbours(*eval, options);
  CLI::App* converted = add(LawAction::export_law, "A pair table of LAMMPS, CSV or JSON");
  add_files(*converted, options, "card, table or run directory");
  add_overlaps(*converted, options, "--to-delta");
  add_law_choices(*converted, options);
  add_neighbours(*converted, options);
  add_export(*converted, options);
  CLI::App* plan = add(LawAction::plan,
                       "What to measure next: which neighbours, overlap and packings would narrow "
                       "the error bars of a macro scene most per second");
  add_files(*plan, options, "law table or run directory, with its refits (.h5)");
  add_plan(*plan, options);
  CLI::App* library = add(LawAction::library,
                          "Collects law tables of many materials in a library, and says how well the others predict "
                          "each of them");
  add_files(*library, options, "directories with law_table.toml at any depth, or a library");
  library->add_option("--out", options.out, "Library to write; default: what is found, on the terminal")
      ->option_text("FILE.toml");
  library
      ->add_option("--next", options.next, "Says which N materials would narrow the answers most, were they measured")
      ->option_text("N");
  add_get(*add(LawAction::get, "The law table of a material that was not measured, from a library, in a second"),
          options);
}

}  // namespace softgrain
