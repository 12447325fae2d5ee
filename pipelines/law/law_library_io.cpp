// A library of law tables as text, written and read.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/card_text.h"
#include "common/io/child_process.h"
#include "common/io/scene.h"
#include "pipelines/law/law_library.h"
#include "pipelines/law/law_library_numbers.h"
#include "pipelines/law/law_library_predict.h"
#include "pipelines/law/law_library_press.h"

namespace softgrain {

namespace {

constexpr const char* kMeaning =
    "ln force: ln F(1 - nu^2)/(E Rs^2) of one plane at D = 0.35; b, delta: as in law tables; of each kind of neighbour "
    "ln nu at v = 0.02 by size, then m; rolling: over E/(1 - nu^2); correlations: of the numbers of the law, lower "
    "triangle without the diagonal; press: ln F(1 - nu^2)/(E Rs^2) of one plane at D = 0.3 and 0.2 with the shell "
    "held; leave_one_out: of every number, see leave_one_out.csv";

/// Numbers in brackets; those that are not known as 0.
std::string list_text(const std::vector<double>& numbers) {
  return "[" + join_text(numbers, ", ", [](double x) { return fmt::format("{:.7g}", std::isfinite(x) ? x : 0.0); }) +
         "]";
}

std::string quoted_list(const std::vector<std::string>& texts) {
  return "[" + join_text(texts, ", ", [](const std::string& t) { return quoted(t); }) + "]";
}

std::string material_text(const LibraryMaterial& m, const std::vector<std::string>& names, std::size_t law_numbers) {
  std::vector<double> lower;
  for (std::size_t a = 1; a < law_numbers; ++a)
    for (std::size_t b = 0; b < a; ++b) lower.push_back(m.correlations[a * law_numbers + b]);
  std::vector<std::string> unknown;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!std::isfinite(m.numbers[k]) || !std::isfinite(m.errors[k])) unknown.push_back(names[k]);
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\n[[material]]\nsource = {}\nmu = {}\nexponent = {}\nratio = {}\nsolid_fraction = {}\n",
                 quoted(m.source), real(m.at.friction), real(m.at.exponent), real(m.at.polydispersity),
                 real(m.at.solid_fraction));
  fmt::format_to(out, "packings = {}\nvolume_max = {:.7g}\noverlap_max = {:.7g}\ngrain_overlap_max = {:.7g}\n",
                 m.packings, m.volume_max, m.overlap_max, m.grain_overlap_max);
  fmt::format_to(out, "partner_overlap_max = {}\nunknown = {}\nnumbers = {}\nerrors = {}\ncorrelations = {}\n",
                 list_text(m.partner_overlap_max), quoted_list(unknown), list_text(m.numbers), list_text(m.errors),
                 list_text(lower));
  if (m.press) fmt::format_to(out, "press = {}\n", list_text({m.press->ln_deep, m.press->ln_shallow}));
  return text;
}

/// A list of a known length.
std::vector<double> read_list(const SceneTable& t, const char* key, std::size_t count, const Range& range) {
  std::vector<double> out = t.numbers(key, Unit::none, range);
  if (out.size() != count) t.throw_error(key, fmt::format("has {} numbers, {} are needed", out.size(), count));
  return out;
}

/// Tables with the checks of all numbers.
constexpr const char* kChecks = "leave_one_out";
constexpr const char* kPressChecks = "leave_one_out_press_test";

std::string checks_text(const char* table, const std::vector<LibraryCheck>& checks) {
  if (checks.empty()) return "";
  const auto column = [&](const char* name, auto of) {
    std::vector<double> values;
    for (const LibraryCheck& c : checks) values.push_back(of(c));
    return fmt::format("{} = {}\n", name, list_text(values));
  };
  return fmt::format("\n[{}]\n", table) +
         column("materials", [](const LibraryCheck& c) { return static_cast<double>(c.materials); }) +
         column("error", [](const LibraryCheck& c) { return c.error; }) +
         column("error_of_mean", [](const LibraryCheck& c) { return c.error_of_mean; }) +
         column("factor", [](const LibraryCheck& c) { return c.factor; }) +
         column("coverage", [](const LibraryCheck& c) { return c.coverage; });
}

/// The checks that a file holds, in the order of the names.
std::vector<LibraryCheck> read_checks(const SceneTable& t, const LawLibrary& library) {
  const std::vector<std::string> names = library.names();
  const std::vector<double> materials = read_list(t, "materials", names.size(), Range::not_negative());
  const std::vector<double> error = read_list(t, "error", names.size(), Range::not_negative());
  const std::vector<double> error_of_mean = read_list(t, "error_of_mean", names.size(), Range::not_negative());
  const std::vector<double> factor = read_list(t, "factor", names.size(), Range{1.0, kInfinity, false, true});
  const std::vector<double> coverage = read_list(t, "coverage", names.size(), Range::closed(0.0, 1.0));
  std::vector<LibraryCheck> out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto has = [k](const LibraryMaterial& m) { return std::isfinite(m.numbers[k]); };
    const auto known = static_cast<std::size_t>(std::ranges::count_if(library.materials, has));
    if (static_cast<double>(known < least_materials() ? 0 : known) != materials[k])
      t.throw_error("materials", "are not those of [[material]]: without [leave_one_out] it is computed again");
    out.push_back(
        {names[k], known < least_materials() ? 0 : known, error[k], error_of_mean[k], factor[k], coverage[k]});
  }
  return out;
}

LibraryMaterial read_material_row(const SceneTable& t, const LawLibrary& library,
                                  const std::vector<std::string>& names) {
  LibraryMaterial m;
  m.source = t.text("source");
  t.require_line("source", m.source);
  m.at = {t.number("mu", Unit::none, Range::not_negative()), t.number("exponent", Unit::none),
          t.number("ratio", Unit::none, Range::above(1.0)),
          t.number("solid_fraction", Unit::none, Range{0.0, 1.0, true, true})};
  m.packings = static_cast<int>(t.count("packings", 1, 1000000000));
  m.volume_max = t.number("volume_max", Unit::none, Range::positive());
  m.overlap_max = t.number("overlap_max", Unit::none, Range::positive());
  m.grain_overlap_max = t.number("grain_overlap_max", Unit::none, Range::not_negative());
  m.partner_overlap_max = read_list(t, "partner_overlap_max", library.partners.size(), Range{0.0, 2.0, false, false});
  m.numbers = read_list(t, "numbers", names.size(), Range::any());
  m.errors = read_list(t, "errors", names.size(), Range::not_negative());
  for (const std::string& name : t.texts("unknown")) {
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) t.throw_error("unknown", "\"" + name + "\" is no number of the library");
    const auto k = static_cast<std::size_t>(at - names.begin());
    m.numbers[k] = m.errors[k] = std::nan("");
  }
  const std::size_t n = library.law_numbers();
  const std::vector<double> lower = read_list(t, "correlations", n * (n - 1) / 2, Range::closed(-1.0, 1.0));
  m.correlations.assign(n * n, 0.0);
  auto next = lower.begin();
  for (std::size_t a = 0; a < n; ++a) {
    m.correlations[a * n + a] = 1.0;
    for (std::size_t b = 0; b < a; ++b) m.correlations[a * n + b] = m.correlations[b * n + a] = *next++;
  }
  if (t.has("press")) {
    const std::vector<double> press = read_list(t, "press", 2, Range::any());
    m.press = PressNumbers{press[0], press[1]};
  }
  return m;
}

}  // namespace

std::size_t LawLibrary::law_numbers() const { return names().size() - side_names().size(); }

std::vector<std::string> LawLibrary::names() const {
  std::vector<std::string> out{"ln force", "b", "delta"};
  for (std::size_t k = 0; k < partners.size(); ++k) {
    const std::string kind = partners[k].kind == PartnerKind::plane ? "smooth plane" : to_string(partners[k].kind);
    out.push_back(partners[k].kind == PartnerKind::plane ? "ln nu, " + kind
                                                         : fmt::format("ln nu, {} {:g}", kind, partners[k].ratio));
    if (k + 1 == partners.size() || partners[k + 1].kind != partners[k].kind) out.push_back("m, " + kind);
  }
  const std::vector<std::string> side = side_names();
  out.insert(out.end(), side.begin(), side.end());
  return out;
}

std::string library_text(const LawLibrary& library, const Provenance& provenance) {
  const std::vector<std::string> names = library.names();
  std::string text = "# Laws of soft particles of many materials, for interpolation (softgrain law get).\nschema = 1\n";
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "\n[provenance]\nversion = {}\ncommit = {}\ncompiler = {}\ncommand = {}\nseed = {}\nthreads = {}\n",
                 quoted(provenance.version), quoted(provenance.commit), quoted(provenance.compiler),
                 quoted(provenance.command), quoted(fmt::format("{}", provenance.seed)), provenance.threads);
  fmt::format_to(out, "\n[definitions]\nnumbers = {}\n", quoted(kMeaning));
  fmt::format_to(out, "\n[library]\nrmax_over_shell = {}\nbeta = {}\nnames = {}\n", real(library.rmax_over_shell),
                 real(library.beta), quoted_list(names));
  for (const LibraryPartner& p : library.partners)
    fmt::format_to(out, "\n[[library.partner]]\nkind = \"{}\"\nratio = {}\n", to_string(p.kind), real(p.ratio));
  text += checks_text(kChecks, library.checks);
  text += checks_text(kPressChecks, library.press_checks);
  for (const LibraryMaterial& m : library.materials) text += material_text(m, names, library.law_numbers());
  return text;
}

LawLibrary read_library(const Scene& file) {
  const SceneTable root = file.root();
  LawLibrary out;
  out.path = file.path();
  out.text = file.text();
  (void)root.count("schema", 1, 1);
  (void)read_words(root, {"numbers"});
  const SceneTable head = root.table("library");
  out.rmax_over_shell = head.number("rmax_over_shell", Unit::none, Range::positive());
  out.beta = head.number("beta", Unit::none, Range::positive());
  for (const SceneTable& p : head.tables("partner"))
    out.partners.push_back({p.choice<PartnerKind>("kind"), p.number("ratio", Unit::none, Range::not_negative())});
  const std::vector<std::string> names = out.names();
  if (head.texts("names") != names)
    head.throw_error("names", "are not those of this program: collect the library again (softgrain law library)");
  for (const SceneTable& m : root.tables("material")) out.materials.push_back(read_material_row(m, out, names));
  if (out.materials.empty()) root.throw_error("material", "a library needs [[material]]s");
  if (root.has(kChecks)) out.checks = read_checks(root.table(kChecks), out);
  if (root.has(kPressChecks)) out.press_checks = read_checks(root.table(kPressChecks), out);
  root.finish();
  return out;
}

LawLibrary load_library(const std::string& path) {
  const Scene file = Scene::load(path);
  if (!is_library(file)) throw InputError(path + ": is no library of law tables (it has no [library])");
  LawLibrary out = read_library(file);
  if (out.checks.empty()) out.checks = check_library(out);
  if (out.press_checks.empty()) out.press_checks = check_press_tests(out);
  return out;
}

bool is_library(const Scene& file) { return file.root().has("library"); }

std::string shipped_library() {
  namespace fs = std::filesystem;
  std::error_code error;
  for (fs::path at = own_directory(); at.has_relative_path(); at = at.parent_path())
    for (const char* place : {"share/softgrain", "."}) {
      const fs::path file = at / place / "results/law_library/library.toml";
      if (fs::exists(file, error)) return file.lexically_normal().string();
    }
  throw InputError(
      "law library: none is installed beside this program (results/law_library/library.toml); name one (--library, or "
      "law = \"FILE\" in a scene), or make one: softgrain law library");
}

}  // namespace softgrain
