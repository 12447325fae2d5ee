#include "pipelines/compare/compare_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <type_traits>
#include <utility>

#include "common/data/soft_particle_schema.h"

namespace softgrain {

namespace {

using List = std::vector<std::string>;

template <class T>
void note(List& out, const char* what, const T& candidate, const T& reference) {
  if (candidate != reference) out.push_back(fmt::format("{}: {} against {}", what, candidate, reference));
}

/// Notes a difference in a property of soft particles that may not be known. What neither side knows is no difference;
/// what one does not know may be one.
void note_known(List& obstacles, List& said, const char* what, double candidate, double reference) {
  if (is_known(candidate) && is_known(reference)) return note(obstacles, what, candidate, reference);
  if (is_known(candidate) || is_known(reference))
    said.push_back(fmt::format("{}: not known of the {}", what, is_known(candidate) ? "reference" : "candidate"));
}

/// Notes different sizes of grains, of which at least one is no power law of an exponent.
void note_sizes(const SoftParticleSpec& candidate, const SoftParticleSpec& reference, Differences& out) {
  if (!packing_known(candidate) || !packing_known(reference)) {
    out.said.push_back(
        fmt::format("sizes of the grains: not known of the {}", packing_known(candidate) ? "reference" : "candidate"));
    return;
  }
  const auto name = [](const SoftParticleSpec& s) {
    return s.sizes ? s.sizes->name() : fmt::format("power law of exponent {}", s.exponent);
  };
  if (!same_sizes(candidate, reference))
    out.obstacles.push_back(
        fmt::format("sizes of the grains: {} against {}, of another curve", name(candidate), name(reference)));
}

std::string radii(const MacroStart& s) { return fmt::format("{:.6g} to {:.6g} m", s.radius_min, s.radius_max); }

/// Properties of grains that are compared, by what they are called.
using Properties = std::vector<std::pair<const char*, double>>;

Properties properties(const auto& each_field) {
  Properties out;
  each_field([&out](const char*, const auto& member, const auto&... options) {
    [[maybe_unused]] const auto take = [&](const auto& option) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(option)>, ComparedAs>)
        out.emplace_back(option.what, member);
    };
    (take(options), ...);
  });
  return out;
}

void note_start(const MacroCurve& candidate, const MacroCurve& reference, Differences& out) {
  const MacroStart& a = candidate.start;
  const MacroStart& b = reference.start;
  if (a.bodies.empty() || b.bodies.empty()) {
    out.said.push_back(
        fmt::format("the {} is of an earlier version, which did not record materials, radii and where "
                    "bodies start: whether these agree is not known",
                    a.bodies.empty() ? "candidate" : "reference"));
    return;
  }
  if (a.bodies != b.bodies) {
    note(out.obstacles, "radii of bodies", radii(a), radii(b));
    (candidate.twin().has_value() == reference.twin().has_value() ? out.said : out.obstacles)
        .emplace_back("bodies start elsewhere: another seed, sample or preparation");
  }
  const auto note_each = [&](const Properties& of_a, const Properties& of_b) {
    for (std::size_t k = 0; k < std::min(of_a.size(), of_b.size()); ++k)
      note(out.obstacles, of_a[k].first, of_a[k].second, of_b[k].second);
  };
  note_each(properties([&](auto&& visit) { fields(visit, a); }), properties([&](auto&& visit) { fields(visit, b); }));
  note_each(properties([&](auto&& visit) { rolling_fields(visit, a.rolling); }),
            properties([&](auto&& visit) { rolling_fields(visit, b.rolling); }));
}

/// The law of one side is compared with the grains that the other side resolves.
void note_law_and_grains(const LawIdentity& law, const MacroStart& grains, Differences& out) {
  if (!law.form || grains.bodies.empty()) return;
  const auto compare = [&](const char* what, const std::optional<double>& measured, double twin) {
    if (!measured)
      out.said.push_back(fmt::format("{} of the grains that the law was measured with is not known", what));
    else if (*measured != twin)
      out.obstacles.push_back(fmt::format(
          "the law was measured with {0} = {1:g}, the grains of the twin have {0} = {2:g}", what, *measured, twin));
  };
  compare("nu", law.poisson_ratio, grains.poisson_ratio);
  compare("mu", law.friction, grains.friction);
}

void note_laws(const MacroCurve& candidate, const MacroCurve& reference, Differences& out) {
  if (candidate.twin().has_value() != reference.twin().has_value()) {
    note_law_and_grains(candidate.twin() ? reference.law : candidate.law,
                        candidate.twin() ? candidate.start : reference.start, out);
    return;
  }
  if (candidate.twin() || candidate.law == reference.law) return;
  out.said.push_back("law: " + identity_text(candidate.law) + "; against " + identity_text(reference.law));
}

}  // namespace

void Differences::add(const Differences& more) {
  const auto append = [](List& to, const List& from) {
    for (const std::string& one : from)
      if (std::find(to.begin(), to.end(), one) == to.end()) to.push_back(one);
  };
  append(said, more.said);
  append(obstacles, more.obstacles);
}

Differences differences(const MacroCurve& candidate, const MacroCurve& reference) {
  Differences out;
  note(out.obstacles, "test", to_string(candidate.test), to_string(reference.test));
  note(out.obstacles, "preload of the test", candidate.preload, reference.preload);
  note(out.obstacles, "boundary", to_string(candidate.boundary), to_string(reference.boundary));
  if (by_stages(candidate.test) && by_stages(reference.test) && candidate.stages != reference.stages)
    out.obstacles.emplace_back("the tests have other stages");
  note(out.obstacles, "bodies", candidate.bodies, reference.bodies);
  note(out.obstacles, "soft particles", candidate.soft, reference.soft);
  note_start(candidate, reference, out);
  note_laws(candidate, reference, out);
  return out;
}

Differences differences(const SoftParticleSpec& candidate, const SoftParticleSpec& reference) {
  Differences out;
  for (const SoftParticleNumber& number : soft_particle_numbers()) {
    const double a = candidate.*number.value;
    const double b = reference.*number.value;
    if (std::string_view(number.compared).empty()) continue;
    if (number.always)
      note(out.said, number.compared, a, b);
    else if (number.value == &SoftParticleSpec::exponent && (candidate.sizes || reference.sizes))
      note_sizes(candidate, reference, out);
    else
      note_known(out.obstacles, out.said, number.compared, a, b);
  }
  if (candidate.trials == 0 || reference.trials == 0) return out;  // how one was packed is not known
  note(out.obstacles, "packing, trials", candidate.trials, reference.trials);
  note(out.said, "packing, placement", to_string(candidate.placement), to_string(reference.placement));
  return out;
}

}  // namespace softgrain
