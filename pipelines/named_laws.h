// Laws of soft particles by the name under which a macro run uses them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/io/scene.h"
#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"

namespace softgrain {

struct NamedLaws {
  std::string name;  ///< engine of the curves: "law" or "pair", "bag", "directional"
  SoftLaws laws;
  /// What to say about the end of a run (left the range of the fit); empty text when nothing.
  std::function<std::string(const System3&)> note;
};

/// The pair law of a card. Throws BadInput when the card has no usable law.
NamedLaws pair_law_of(const LawCard& card, const MacroSpec& spec, const std::string& name);

/// Where a comparison takes its laws from: table [law] of the scene.
struct LawSources {
  LawCard card;
};

/// Reads [law]; paths are relative to the scene. Throws BadInput, FileTrouble.
LawSources read_law_sources(const Scene& scene, const SceneTable& law);

/// Every law that a comparison runs with, in the order of its tables and figures. The one place to add laws.
std::vector<NamedLaws> laws_for(const LawSources& sources, const MacroSpec& spec);

}  // namespace softgrain
