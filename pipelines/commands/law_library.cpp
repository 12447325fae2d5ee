// softgrain law library and softgrain law get: laws of many materials collected, and that of one in between.
#include "pipelines/law/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "pipelines/commands/law_options.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/law/value_output.h"
#include "pipelines/results/summary.h"

namespace softgrain {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

Provenance provenance_of(const LawOptions& o) {
  Provenance p = build_provenance();
  p.command = o.command_line;
  return p;
}

std::string check_text(const char* title, const std::vector<LibraryCheck>& checks) {
  std::string text = fmt::format("{:<26} {:>9} {:>10} {:>10} {:>8} {:>11}\n", title, "materials", "off by", "mean off",
                                 "widened", "within 95 %");
  for (const LibraryCheck& c : checks)
    if (c.materials > 0)
      text += fmt::format("  {:<24} {:>9} {:>10.3g} {:>10.3g} {:>8.2f} {:>9.0f} %{}\n", c.name, c.materials, c.error,
                          c.error_of_mean, c.factor, 100.0 * c.coverage, c.by_mean() ? " m" : "");
  return text + "m: answers are mean and scatter of the materials, which are off by no more\n";
}

std::string check_csv(const std::vector<LibraryCheck>& checks) {
  std::string text =
      "number,materials,root mean square error of the process,of the mean,answers by,widening factor,share within 95 "
      "%\n";
  for (const LibraryCheck& c : checks)
    if (c.materials > 0)
      text += fmt::format("\"{}\",{},{:.6g},{:.6g},{},{:.6g},{:.6g}\n", c.name, c.materials, c.error, c.error_of_mean,
                          c.by_mean() ? "mean" : "process", c.factor, c.coverage);
  return text;
}

json check_json(const std::vector<LibraryCheck>& checks) {
  json out = json::array();
  for (const LibraryCheck& c : checks)
    if (c.materials > 0)
      out.push_back({{"number", c.name},
                     {"materials", c.materials},
                     {"error", c.error},
                     {"error_of_mean", c.error_of_mean},
                     {"by", c.by_mean() ? "mean" : "process"},
                     {"factor", c.factor},
                     {"coverage", c.coverage}});
  return out;
}

json left_out_json(const std::vector<LeftOutTable>& left_out) {
  json out = json::array();
  for (const LeftOutTable& t : left_out) out.push_back({{"table", t.path}, {"why", t.why}, {"damaged", t.damaged}});
  return out;
}

/// Both of a library; that of press tests where there is one.
std::string checks_text(const LawLibrary& library) {
  std::string text = check_text("each left out in turn", library.checks);
  if (!library.press_checks.empty()) return text + check_text("known by a press test alone", library.press_checks);
  const auto without = std::ranges::find_if(library.materials, [](const LibraryMaterial& m) { return !m.press; });
  if (without == library.materials.end()) return text;
  return text + "no press tests: " + without->source + " has no law of one plane with a force at Delta = 0.2\n";
}

/// Which materials to measure, see next_materials(), and the commands that do.
std::string next_text(const NextMaterials& next) {
  if (next.materials.empty()) return "";
  std::string text = fmt::format(
      "ln force of one plane: uncertain by {:.3g}, the root mean square over all materials that are served.\n"
      "Worth measuring next, each with those above it:\n{:>8} {:>9} {:>7} {:>15} {:>10} {:>14} {:>11}\n",
      next.deviation, "mu", "exponent", "ratio", "solid fraction", "trials", "uncertain now", "then left");
  std::string commands;
  for (std::size_t k = 0; k < next.materials.size(); ++k) {
    const NextMaterial& m = next.materials[k];
    text += fmt::format("{:>8.3f} {:>9.2f} {:>7.2f} {:>15.3f} {:>10.2g} {:>14.3g} {:>11.3g}\n", m.at.friction,
                        m.at.exponent, m.at.polydispersity, m.at.solid_fraction, m.trials, m.deviation, m.left);
    const std::string trials = std::isfinite(m.trials) ? fmt::format("--set packing.trials={:.0f} ", m.trials) : "";
    commands += fmt::format(
        "softgrain run pipelines/law_library.toml --set material.mu={:.3f} --set packing.exponent={:.2f} "
        "--set packing.polydispersity={:.2f} {}--out results/next_{}\n",
        m.at.friction, m.at.exponent, m.at.polydispersity, trials, k + 1);
  }
  return text + commands;
}

json next_json(const NextMaterials& next) {
  json out = json::array();
  for (const NextMaterial& m : next.materials) {
    json one{{"deviation", m.deviation}, {"left", m.left}};
    for (const LibraryVariable& v : kLibraryVariables) one[v.name] = m.at.*v.value;
    if (std::isfinite(m.trials)) one["trials"] = m.trials;
    out.push_back(std::move(one));
  }
  return {{"deviation", next.deviation}, {"materials", std::move(out)}};
}

/// What `law library --out` may write: the library, and tables of leaving one out, that of press tests last.
std::vector<std::string> files_of(const std::string& out) {
  if (out.empty()) return {};
  if (fs::path(out).extension() != ".toml")
    throw InputError("law library: --out " + out + ": a library ends with .toml");
  const auto beside = [&](const char* name) { return fs::path(out).replace_filename(name).string(); };
  return {out, beside("leave_one_out.csv"), beside("leave_one_out_press_test.csv")};
}

/// Writes a library to the files of files_of(), if any, and returns those that it wrote.
std::vector<std::string> write_library(const LawLibrary& library, std::vector<std::string> files,
                                       const Provenance& provenance) {
  if (files.empty()) return files;
  write_text_atomic(files[0], library_text(library, provenance));
  write_text_atomic(files[1], check_csv(library.checks));
  if (library.press_checks.empty())
    files.pop_back();
  else
    write_text_atomic(files[2], check_csv(library.press_checks));
  return files;
}

/// Of directories, after the file of a library where that comes first; checked anew.
LibraryCollection library_of(const std::vector<std::string>& files) {
  if (!fs::is_regular_file(files.front())) return collect_library(files);
  LibraryCollection out{load_library(files.front()), {}};
  if (files.size() > 1) return collect_library({files.begin() + 1, files.end()}, out.library);
  out.library.checks = check_library(out.library);
  out.library.press_checks = check_press_tests(out.library);
  return out;
}

double given(const LawOptions& o, const char* name, double value, double low, double high) {
  if (std::ranges::find(o.given, name) == o.given.end())
    throw InputError(
        fmt::format("law get: {} is needed: --mu, --exponent, --ratio and --solid-fraction say which material", name));
  if (std::isfinite(value) && value >= low && value <= high) return value;
  throw InputError(fmt::format("law get: {} {}: must be from {} to {}", name, value, low, high));
}

double si_quantity(const char* name, const std::string& text, Unit unit, double fallback) {
  if (text.empty()) return fallback;
  try {
    const double value = parse_quantity(text, unit);
    if (std::isfinite(value) && value > 0.0) return value;
  } catch (const InputError& e) {
    throw InputError(fmt::format("law get: {} \"{}\": {}", name, text, e.what()));
  }
  throw InputError(fmt::format("law get: {} \"{}\": must be above 0", name, text));
}

LibraryMatter matter_of(const LawOptions& o) {
  LibraryMatter out;
  if (!(o.poisson_ratio > kPoissonAbove && o.poisson_ratio <= kPoissonHighest))
    throw InputError(fmt::format("law get: --nu {}: must be {}", o.poisson_ratio, range_text(kPoissonRange)));
  out.poisson_ratio = o.poisson_ratio;
  out.youngs_modulus = si_quantity("--E", o.modulus, Unit::pressure, out.youngs_modulus);
  out.shell_radius = si_quantity("--radius", o.radius, Unit::length, out.shell_radius);
  return out;
}

/// What the library says of a material, corrected by own packings where there are some.
struct MaterialLaw {
  LibraryAnswer answer;
  LawTable table;
};

MaterialLaw material_law(const LawOptions& o, const LawLibrary& library, const LibraryMatter& matter,
                         std::vector<std::string>& remarks) {
  const LibraryPoint at{given(o, "--mu", o.friction, 0.0, 10.0), given(o, "--exponent", o.exponent, 0.0, 50.0),
                        given(o, "--ratio", o.ratio, 1.0, 1e6),
                        given(o, "--solid-fraction", o.solid_fraction, 0.0, 1.0)};
  LibraryAnswer answer = ask_library(library, at);
  remarks.push_back(nearest_text(library, answer));
  const auto draws = static_cast<int>(o.draws);
  if (o.own.empty()) return {answer, table_of(library, answer, matter, draws)};
  FittedLaw own = load_law(o.own);
  if (own.table() == nullptr) throw InputError("law get: --own " + o.own + " is no law table");
  read_refits(own);
  CorrectedAnswer both = corrected(library, answer, own_entry(library, at, *own.table(), "law get: --own " + o.own));
  remarks.push_back(both.remark);
  if (const std::string text = contradictions_text(both); !text.empty()) remarks.push_back(text);
  LawTable table = table_of(both, matter, draws);
  return {std::move(both.answer), std::move(table)};
}

/// The law of all neighbours that goes with a press test, and what was said of it.
PressTestLaw press_test_law(const LawOptions& o, const LawLibrary& library) {
  for (const char* name : {"--exponent", "--ratio", "--solid-fraction", "--nu", "--E", "--radius", "--own"})
    if (std::ranges::find(o.given, name) != o.given.end())
      throw InputError(fmt::format("law get: {} does not go with --press-test, whose table says all but mu", name));
  std::optional<double> friction;
  if (std::ranges::find(o.given, "--mu") != o.given.end()) friction = given(o, "--mu", o.friction, 0.0, 10.0);
  return law_of_press_test(library, o.press_test, friction, static_cast<int>(o.draws));
}

/// The answer must not take the place of what it is made from: own measurements, a card, the library.
void refuse_to_replace_input(const LawOptions& o) {
  std::error_code ignored;
  for (const auto& [option, input] :
       {std::pair{"--own", &o.own}, {"--press-test", &o.press_test}, {"--library", &o.library}})
    for (const fs::path& file : {fs::path(*input), fs::path(*input) / "law_table.toml", fs::path(*input) / "law.toml"})
      if (!o.out.empty() && !input->empty() && fs::equivalent(file, o.out, ignored))
        throw InputError(fmt::format(
            "law get: --out {}: is what {} names and would be overwritten; choose another name", o.out, option));
}

/// What `law get` has written may be written again. Anything else may be measured, or written by hand.
bool is_own_answer(const std::string& path) {
  try {
    const FittedLaw law = load_law(path);
    return law.table() != nullptr && law.origin.command.find(" law get") != std::string::npos;
  } catch (const Error&) {
    return false;
  }
}

void refuse_to_replace_foreign_files(const LawOptions& o) {
  std::error_code ignored;
  if (o.out.empty()) return;
  const std::string beside = fs::path(o.out).replace_extension(".h5").string();
  const bool there = fs::exists(o.out, ignored);
  if (there ? is_own_answer(o.out) : !fs::exists(beside, ignored)) return;
  const std::string taken = there ? o.out : beside;
  throw InputError(fmt::format(
      "law get: --out {}: {} is there already, is no table that law get wrote, and would be overwritten; choose "
      "another name",
      o.out, taken));
}

json answer_json(const LibraryAnswer& answer, const std::vector<std::string>& remarks, const std::string& written) {
  json out{{"command", "law get"},
           {"status", "good"},
           {"distance", answer.distance},
           {"by_mean", answer.by_mean},
           {"remarks", remarks}};
  for (const LibraryVariable& v : kLibraryVariables)
    if (is_known(answer.at.*v.value)) out["material"][v.name] = answer.at.*v.value;
  for (const LibraryNumber& n : answer.numbers)
    if (std::isfinite(n.value)) out["numbers"][n.name] = {n.value, n.deviation};
  if (!written.empty()) out["written"] = written;
  return out;
}

std::string answer_text(const LibraryAnswer& answer, const std::vector<std::string>& remarks) {
  std::string text = of_press_test(answer) ? "" : point_text(answer.at) + "\n";
  for (const LibraryNumber& n : answer.numbers)
    if (std::isfinite(n.value))
      text += fmt::format("  {:<24} {:>9.4g} +- {:.2g}{}\n", n.name, n.value, n.deviation,
                          std::ranges::find(answer.by_mean, n.name) == answer.by_mean.end() ? "" : "  mean");
  for (const std::string& r : remarks) text += r + "\n";
  return text;
}

}  // namespace

ExitStatus make_library(const LawOptions& o) {
  if (o.files.empty()) throw InputError("law library: give directories with law tables (see softgrain law library -h)");
  constexpr std::int64_t kMostNext = 50;
  if (o.next < 0 || o.next > kMostNext)
    throw InputError(fmt::format("law library: --next {}: must be a whole number from 0 to {}", o.next, kMostNext));
  const std::vector<std::string> files = files_of(o.out);
  if (!o.out.empty()) require_folder_of(o.out);  // before the checks, which take their time
  for (const std::string& path : files) refuse_to_overwrite(path, "choose another directory, or move it away");
  const LibraryCollection all = library_of(o.files);
  const NextMaterials next = o.next > 0 ? next_materials(all.library, static_cast<int>(o.next)) : NextMaterials{};
  const std::vector<std::string> written = write_library(all.library, files, provenance_of(o));
  const bool good = std::ranges::none_of(all.left_out, &LeftOutTable::damaged);
  if (o.json) {
    json out{{"command", "law library"},
             {"status", to_string(good ? RunStatus::good : RunStatus::not_usable)},
             {"materials", all.library.materials.size()},
             {"left_out", left_out_json(all.left_out)},
             {"leave_one_out", check_json(all.library.checks)},
             {"leave_one_out_press_test", check_json(all.library.press_checks)}};
    if (o.next > 0) out["next"] = next_json(next);
    if (!written.empty()) out["written"] = written;
    write_standard_output(out.dump(2) + "\n");
  } else {
    write_standard_output(left_out_text(all.left_out) + counted(all.library.materials.size(), "material") + "\n" +
                          checks_text(all.library) + next_text(next) +
                          (written.empty() ? "" : "written: " + join_text(written) + "\n"));
  }
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

ExitStatus get_law(const LawOptions& o) {
  constexpr std::int64_t kMostDraws = 10000;
  if (o.draws < 10 || o.draws > kMostDraws)
    throw InputError(fmt::format("law get: --draws {}: must be a whole number from 10 to {}", o.draws, kMostDraws));
  if (!o.out.empty() && fs::path(o.out).extension() != ".toml")
    throw InputError("law get: --out " + o.out + ": a law table ends with .toml");
  refuse_to_replace_input(o);
  refuse_to_replace_foreign_files(o);
  const LibraryMatter matter = matter_of(o);
  const LawLibrary library = load_library(o.library.empty() ? shipped_library() : o.library);
  std::vector<std::string> remarks;
  LibraryAnswer answer;
  LawTable table;
  if (std::ranges::find(o.given, "--press-test") != o.given.end()) {
    PressTestLaw law = press_test_law(o, library);
    answer = std::move(law.answer);
    table = std::move(law.table);
    remarks = std::move(law.remarks);
  } else {
    MaterialLaw law = material_law(o, library, matter, remarks);
    answer = std::move(law.answer);
    table = std::move(law.table);
    if (const std::string means = means_text(answer); !means.empty()) remarks.push_back(means);
    if (o.modulus.empty())
      remarks.push_back(
          fmt::format("the table is for E = {} MPa, and macro scenes take it from there; forces go with E "
                      "(--E gives that of your grains)",
                      matter.youngs_modulus / 1e6));
  }
  if (!o.out.empty()) save_law_table(table, o.out, provenance_of(o));
  if (o.json)
    write_standard_output(answer_json(answer, remarks, o.out).dump(2) + "\n");
  else
    write_standard_output(answer_text(answer, remarks) + (o.out.empty() ? "" : "written: " + o.out + "\n"));
  return ExitStatus::good;
}

}  // namespace softgrain
