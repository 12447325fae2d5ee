// What the two sides of `softgrain compare` hold, what they do not have in common, and everything that can be compared
// between them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/compare_measurements.h"

namespace softgrain {

struct Differences {
  std::vector<std::string> said;       ///< remarks: what a comparison may be about, or what drops out of it
  std::vector<std::string> obstacles;  ///< differences that make an error norm of such runs meaningless

  void add(const Differences& more);  ///< adds what is not there already
};

/// Differences of two curves, as "what: candidate against reference". Bodies, radii, materials, tests are obstacles; a
/// law with another law is what is compared, a law with a twin that starts elsewhere is not. Where a file does not say
/// it all, a remark tells it.
Differences differences(const MacroCurve& candidate, const MacroCurve& reference);

/// Differences of two kinds of soft particle. E and Rs drop out of dimensionless forces; nu, mu and the way of packing
/// do not.
Differences differences(const SoftParticleSpec& candidate, const SoftParticleSpec& reference);

/// A run directory or one of its files.
struct CompareSide {
  std::string name;
  std::vector<MacroCurve> macro;
  std::optional<Measurements> measurements;
  std::optional<LawCard> card;
};

/// Whether a file of results of this kind ("macro", "material"), named so without its ending, holds packings before
/// their tests: KIND_initial or KIND_initial_NAME. KIND_initially-loose holds the results of a variant of that name.
bool holds_packings(const std::string& name, const std::string& kind);

/// `path` is a run directory, or a file named like macro*.h5, material*.h5, law*.toml or another .h5 with measurements.
/// Throws IoError when it does not exist or is damaged, InputError when it is none of these or holds nothing to
/// compare.
CompareSide load_side(const std::string& path);

struct MacroPart {
  std::string candidate_engine;
  std::string reference_engine;
  Comparison result;
};

struct LawPartComparison {
  PairKind kind = PairKind::soft_solid;
  std::vector<LawRow> rows;
};

/// All comparisons that the data allow.
struct CompareResult {
  std::vector<MacroPart> macro;
  std::vector<RelaxationComparison> relaxations;
  std::vector<MeasurementComparison> measurements;
  std::vector<LawPartComparison> laws;
  std::vector<std::string> differences;  ///< what the sides do not have in common, beside what is compared
  std::vector<std::string> remarks;      ///< what could not be compared, and why
  std::vector<std::string> undefined;    ///< what is relative to a stress of zero: such a comparison is not usable
};

/// Candidate against reference: engines and relaxations of the same name; when the sides share none, the first of each.
/// Sides that differ in what makes a comparison mean something (Differences) are refused unless `different`; then a
/// test stands against another test by its sample. Throws InputError for these, and when nothing can be compared.
CompareResult compare_sides(const CompareSide& candidate, const CompareSide& reference, bool different = false);

/// Inside one run: engine "law" against "shelled", and every other relaxation against "published".
/// Throws InputError when nothing can be compared.
CompareResult compare_within(const CompareSide& side);

nlohmann::json to_json(const CompareResult& result);

/// A table for people.
std::string to_text(const CompareResult& result);

}  // namespace softgrain
