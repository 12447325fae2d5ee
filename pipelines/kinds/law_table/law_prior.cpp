#include "pipelines/kinds/law_table/law_prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/multi_contact_replicates.h"

namespace softgrain {

namespace {

constexpr const char* kShippedLibrary = "shipped";

/// The file that `written` names: of the program, of a folder, or itself.
std::string library_file(const SceneTable& t, const std::string& written) {
  if (written == kShippedLibrary) return shipped_library();
  const std::string path = t.resolve(written);
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? (std::filesystem::path(path) / "library.toml").string() : path;
}

/// A library whose file is not there is a mistake of the scene. It is not read before the other errors are mended.
LawLibrary library_at(const SceneTable& t, const SceneTable& root, const std::string& written) {
  try {
    const std::string path = library_file(t, written);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
      throw InputError(
          fmt::format("{}: there is no such file; \"{}\" is the library of the program", path, kShippedLibrary));
    return root.has_errors() ? LawLibrary{} : load_library(path);
  } catch (const Error& e) {
    t.throw_error("library", e.what());
  }
}

/// The library asked for a soft particle. Throws InputError where it does not reach it.
LibraryAnswer ask_for(const LawLibrary& library, const SoftParticleSpec& spec, double solid_fraction) {
  if (const std::string other = other_shell_text(library, spec); !other.empty())
    throw InputError("law library: it holds no such soft particles: " + other);
  return ask_library(library, {spec.friction, spec.exponent, spec.polydispersity, solid_fraction});
}

/// Own packings of an entry and the library. Throws InputError where the library does not reach them.
LawTableEntry combined_with(const LawLibrary& library, const LawTableEntry& own, CorrectedAnswer& both) {
  constexpr int kDraws = 64;  // as many as a macro scene may want
  const MultiContactLaw* law = own.find(LawForm::isotropic);
  if (law == nullptr || !(has_numbers(law->status) || law->status == LawStatus::inaccurate))
    throw InputError("the packings gave no isotropic law" + (law == nullptr ? std::string() : ": " + law->reason));
  both = corrected(library, ask_for(library, own.spec, own.solid_fraction), own);
  return combined_entry(both, own, std::max(kDraws, static_cast<int>(law->replicates.size())));
}

/// "ln force 62 %, b 40 %": weights of own packings in the numbers of planes.
std::string weights_text(const LawPrior& prior) {
  constexpr std::size_t kPlanes = 3;
  const std::vector<PriorNumber> planes(
      prior.numbers.begin(),
      prior.numbers.begin() + static_cast<std::ptrdiff_t>(std::min(kPlanes, prior.numbers.size())));
  return join_text(planes, ", ",
                   [](const PriorNumber& n) { return fmt::format("{} {:.0f} %", n.name, 100.0 * n.own_weight); });
}

/// The first few contradictions, and how many more there are.
std::string contradiction_warning(const CorrectedAnswer& both) {
  constexpr std::size_t kNamed = 3;
  CorrectedAnswer few;
  few.contradicted.assign(
      both.contradicted.begin(),
      both.contradicted.begin() + static_cast<std::ptrdiff_t>(std::min(kNamed, both.contradicted.size())));
  std::string text = contradictions_text(few);
  if (both.contradicted.size() > kNamed) text += fmt::format("; and {} more", both.contradicted.size() - kNamed);
  return text + ": measure more packings, or leave [prior] out";
}

}  // namespace

std::optional<LawLibrary> read_law_prior(const SceneTable& root, const SceneTable& calibrate,
                                         const MultiContactFitOptions& fit) {
  if (!root.has("prior")) return std::nullopt;
  const SceneTable t = root.table({"prior", "library whose prediction the packings of the scene correct"});
  LawLibrary out = library_at(t, root,
                              t.text({"library",
                                      "library of law tables: `shipped` is that of the program; else its file, or its "
                                      "folder (path relative to the scene)"},
                                     kShippedLibrary));
  if (fit.best && *fit.best != LawForm::isotropic)
    calibrate.add_error("best", "a library holds isotropic laws alone: \"isotropic\", or leave [prior] out");
  if (fit.replicates < static_cast<int>(kEnoughReplicates))
    calibrate.add_error(
        "replicates", fmt::format("[prior] needs {} at least, which say how sure the packings are", kEnoughReplicates));
  return out;
}

void check_law_prior(const std::optional<LawLibrary>& prior, const SoftParticleSpec& spec, double solid_fraction,
                     Findings& out) {
  if (!prior) return;
  try {
    const LibraryAnswer answer = ask_for(*prior, spec, solid_fraction);
    out.add("prior", {{"library", prior->path}, {"distance", answer.distance}},
            fmt::format("the packings correct a library of {} materials; {}", prior->materials.size(),
                        nearest_text(*prior, answer)));
  } catch (const InputError& e) {
    out.warn(fmt::format("[prior] will have no part: {}", e.what()));
  }
}

void combine_with_prior(MultiContactLawFit& fit, const std::optional<LawLibrary>& prior,
                        const std::vector<EntryMeasurements>& measured, const MultiContactFitOptions& options) {
  if (!prior) return;
  LawTable out = fit.table;
  std::vector<std::string> remarks;
  std::vector<std::string> warnings;
  for (LawTableEntry& entry : out.entries) {
    CorrectedAnswer both;
    try {
      entry = combined_with(*prior, entry, both);
    } catch (const InputError& e) {
      fit.warnings.push_back(
          fmt::format("[prior] has no part, the law is that of the packings alone: at solid "
                      "fraction {:.3f}: {}",
                      entry.solid_fraction, e.what()));
      return;
    }
    for (const EntryMeasurements& m : measured)
      for (MultiContactLaw& law : entry.laws)
        if (m.solid_fraction == entry.solid_fraction && law.form == LawForm::isotropic)
          judge_again(law, m.data, options.discrepancy);
    const std::string at = fmt::format("solid fraction {:.3f}: ", entry.solid_fraction);
    remarks.push_back(at + fmt::format("{} packings correct a library of {} materials, {}; own weight: {} "
                                       "([entry.prior] of law_table.toml has all)",
                                       entry.packings, prior->materials.size(), nearest_text(*prior, both.answer),
                                       weights_text(both.prior)));
    if (!both.contradicted.empty()) warnings.push_back(at + contradiction_warning(both));
  }
  fit.table = std::move(out);
  fit.remarks.insert(fit.remarks.end(), remarks.begin(), remarks.end());
  fit.warnings.insert(fit.warnings.end(), warnings.begin(), warnings.end());
}

}  // namespace softgrain
