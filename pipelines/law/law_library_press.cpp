#include "pipelines/law/law_library_press.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/experiment_fit.h"
#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"
#include "pipelines/law/law_draws.h"
#include "pipelines/law/law_library_numbers.h"
#include "pipelines/law/law_library_predict.h"

namespace softgrain {

namespace {

constexpr double kDeep = 0.3;  ///< D of PressNumbers
constexpr double kShallow = 0.2;
/// How far beyond the convex hull of the materials a press test may lie, over the ranges of its numbers. They are
/// measured with errors, and leaving one out reaches as far.
constexpr double kReachOfPressHull = 0.25;
constexpr std::size_t kDraws = 32;

std::vector<double> coordinates(const PressNumbers& n, double friction) {
  return {n.ln_deep, n.ln_shallow - n.ln_deep, on_friction_axis(friction)};
}

bool has_press_numbers(const LawLibrary& library) {
  return std::ranges::all_of(library.materials, [](const LibraryMaterial& m) { return m.press.has_value(); });
}

UnitBox press_box(const LawLibrary& library) {
  std::vector<std::vector<double>> rows;
  for (const LibraryMaterial& m : library.materials) rows.push_back(coordinates(*m.press, m.at.friction));
  return UnitBox(rows);
}

std::string press_text(const PressQuestion& q) {
  return fmt::format("F (1 - nu^2)/(E Rs^2) = {:.3g} at Delta = {} and {:.3g} at {}, mu = {:.3g}",
                     std::exp(q.numbers.ln_deep), kDeep, std::exp(q.numbers.ln_shallow), kShallow, q.friction);
}

std::vector<double> of_materials(const LawLibrary& library, double LibraryPoint::*value) {
  std::vector<double> out;
  for (const LibraryMaterial& m : library.materials) out.push_back(m.at.*value);
  return out;
}

/// What serves where the library does not: a press test is a law by itself, if only of one neighbour.
constexpr const char* kWithoutLibrary =
    "without the library: law = \"TABLE.csv\", the table itself, is the law of one neighbour "
    "(pipelines/press_test_macro.toml)";

/// What in a press test that no material gave is to be looked at: forces go with E Rs^2, their ratio with the overlap.
std::string look_at(const UnitBox& box, const PressNumbers& n) {
  const double share = coordinates(n, 0.0)[1];  // whatever the friction
  if (n.ln_deep < box.low(0) || n.ln_deep > box.high(0))
    return "look at E and Rs in the comments and at the unit of the forces";
  if (share < box.low(1)) return "the force rises too late: look at where the overlap begins (# touch = ...)";
  if (share > box.high(1))
    return "the force rises too evenly: look at where the overlap begins (# touch = ...) and at an offset of the force";
  return "look at mu, E and Rs in the comments";
}

/// The friction is given and has no error, so it must lie in its range as that of a material; forces are measured.
void require_inside(const LawLibrary& library, const UnitBox& box, const std::vector<double>& u,
                    const PressQuestion& q) {
  const auto [low, high] = std::ranges::minmax(of_materials(library, &LibraryPoint::friction));
  const std::string wrong =
      outside_text(kLibraryVariables.front(), low, high, q.friction, (q.friction - low) / (high - low));
  if (!wrong.empty())
    throw InputError(fmt::format(
        "law library: {}; give mu of the grains from that range, measure materials with yours (softgrain law library "
        "-h), or do {}",
        wrong, kWithoutLibrary));
  if (distance_from_hull(box.points(), u) <= kReachOfPressHull) return;
  throw InputError(
      fmt::format("law library: no measured material gave such a press test: {}; measured: {:.3g} to {:.3g} at Delta = "
                  "{}, {:.2g} to {:.2g} of that at {}, and not in every combination with mu; {}, or do {}",
                  press_text(q), std::exp(box.low(0)), std::exp(box.high(0)), kDeep, std::exp(box.low(1)),
                  std::exp(box.high(1)), kShallow, look_at(box, q.numbers), kWithoutLibrary));
}

/// Draws of a, b and delta; those that have no force at D = 0.2 are no curve of a soft particle.
std::vector<PressNumbers> drawn_numbers(const PairLaw& law, double poisson_ratio) {
  std::vector<PressNumbers> out;
  if (!has_draws(law)) return out;
  for (const std::vector<double>& draw : pair_draws(law, kDraws, 1))
    if (draw[1] > 0.0)
      if (const auto one = press_numbers(std::exp(draw[0]), draw[1], std::max(draw[2], 0.0), poisson_ratio))
        out.push_back(*one);
  return out;
}

const PairLaw& pressed_law(const LawCard& card, const std::string& source) {
  const auto law = std::ranges::find_if(
      card.pairs, [](const PairLaw& p) { return p.kind == PairKind::soft_solid && has_numbers(p.status); });
  if (law == card.pairs.end() || law->points == 0)
    throw InputError(source +
                     ": the library takes a press test on a plane, # kind = soft-solid; press one particle against "
                     "a plate, or do " +
                     kWithoutLibrary);
  return *law;
}

/// What the test itself leaves open beyond the errors of the answer.
std::vector<std::string> doubts_of(const PairLaw& law, const PressQuestion& q) {
  std::vector<std::string> out;
  constexpr double kNearly = 0.99;
  if (law.status != LawStatus::good)
    out.push_back(fmt::format("law of the press test: {} ({})", to_string(law.status), law.reason));
  if (law.delta_max < kNearly * kDeep)
    out.push_back(
        fmt::format("the press test ends at Delta = {:.3g}: its force at {} is extrapolated", law.delta_max, kDeep));
  if (q.draws.empty())
    out.emplace_back("the press test has no errors: those of the answer are of the library alone");
  else if (q.draws.size() < kDraws)
    out.push_back(
        fmt::format("{} of {} draws of the press test have no force at Delta = {}: the answer is less sure "
                    "than its errors say",
                    kDraws - q.draws.size(), kDraws, kShallow));
  return out;
}

/// Throws InputError where a material has no press numbers.
void require_press_numbers(const LawLibrary& library) {
  if (has_press_numbers(library) && library.press_checks.size() == library.names().size()) return;
  const auto lacks = [](const LibraryMaterial& m) { return !m.press; };
  const auto first = std::ranges::find_if(library.materials, lacks);
  const std::string of =
      first == library.materials.end() ? "" : fmt::format(" of all its materials (none of {})", first->source);
  throw InputError(
      fmt::format("law library: {}: has no press tests{}: collect it again (softgrain law library) from "
                  "tables whose law of pairs bears at Delta = {}",
                  library.path, of, kShallow));
}

}  // namespace

std::optional<PressNumbers> press_numbers(double a, double b, double delta, double poisson_ratio) {
  const auto force = [&](double at) {
    return a * (std::pow(at, b) - std::pow(delta, b)) * (1.0 - poisson_ratio * poisson_ratio);
  };
  if (!(delta < kShallow && force(kShallow) > 0.0 && force(kDeep) > 0.0)) return std::nullopt;
  return PressNumbers{std::log(force(kDeep)), std::log(force(kShallow))};
}

PressQuestion press_question(const LawCard& card, double friction, const std::string& source) {
  const PairLaw& law = pressed_law(card, source);
  const double nu = is_known(card.spec.poisson_ratio) ? card.spec.poisson_ratio : LibraryMatter{}.poisson_ratio;
  const ThresholdPowerLaw& n = law.normal;
  const std::optional<PressNumbers> numbers = press_numbers(n.a.value, n.b.value, n.delta.value, nu);
  if (!numbers)
    throw InputError(
        fmt::format("{}: the library compares forces at Delta = {}, and this law begins at {:.3g}; where the "
                    "overlap counts from another zero, give its value at touch (# touch = ...), else do "
                    "{}",
                    source, kShallow, n.delta.value, kWithoutLibrary));
  return {*numbers, drawn_numbers(law, nu), friction};
}

LibraryAnswer ask_by_press_test(const LawLibrary& library, const PressQuestion& q) {
  require_press_numbers(library);
  const UnitBox box = press_box(library);
  const std::vector<double> u = box(coordinates(q.numbers, q.friction));
  require_inside(library, box, u, q);
  std::vector<std::vector<double>> scatter;
  for (const PressNumbers& draw : q.draws) scatter.push_back(box(coordinates(draw, q.friction)));
  LibraryAnswer out = answer_at(library, library.press_checks, box, u, scatter);
  const double unknown = std::nan("");
  const auto trials = std::ranges::find(out.numbers, std::string(kTrialsNumber), &LibraryNumber::name);
  if (trials != out.numbers.end()) trials->value = unknown;
  std::erase(out.by_mean, kTrialsNumber);
  out.at = {q.friction, unknown, unknown, unknown};
  const std::vector<double> fractions = of_materials(library, &LibraryPoint::solid_fraction);
  const KnownNumber known{box.points(), fractions, std::vector<double>(fractions.size(), 0.0)};
  std::vector<std::vector<double>> points{u};
  points.insert(points.end(), scatter.begin(), scatter.end());
  const ProcessValue fraction = predicted_value(checked_number("solid fraction", known), known, points);
  out.at.solid_fraction = std::clamp(fraction.mean, std::ranges::min(fractions), std::ranges::max(fractions));
  out.solid_fraction_error = fraction.deviation;
  return out;
}

std::vector<LibraryCheck> check_press_tests(const LawLibrary& library) {
  if (!has_press_numbers(library)) return {};
  return check_numbers(library, press_box(library));
}

PressTestLaw law_of_press_test(const LawLibrary& library, const std::string& path, std::optional<double> friction,
                               int draws) {
  const FittedLaw law = load_or_fit_law(path);
  if (law.card() == nullptr)
    throw InputError(path +
                     ": is no press test, and no law card of one; give the table of the test, or the law.toml that "
                     "softgrain calibrate made of it");
  const LawCard& card = *law.card();
  PressTestLaw out;
  if (friction && is_known(card.spec.friction) && *friction != card.spec.friction)
    throw InputError(fmt::format("{}: says mu = {:g}, but {:g} was given: leave one of them out", path,
                                 card.spec.friction, *friction));
  if (!friction && !is_known(card.spec.friction))
    throw InputError(path +
                     ": the library needs the friction of the grains: write a comment \"# mu = 0.3\" into the table, "
                     "or give --mu 0.3 (law get), or mu = 0.3 in [library] of a scene");
  out.question = press_question(card, friction.value_or(card.spec.friction), path);
  out.answer = ask_by_press_test(library, out.question);
  LibraryMatter matter;
  matter.youngs_modulus = card.spec.youngs_modulus;
  matter.shell_radius = card.spec.shell_radius;
  matter.density = card.spec.density;
  matter.restitution = card.spec.restitution;
  if (is_known(card.spec.poisson_ratio))
    matter.poisson_ratio = card.spec.poisson_ratio;
  else
    out.remarks.push_back(fmt::format("{} does not say nu: {:g} is assumed", path, matter.poisson_ratio));
  out.table = table_of(library, out.answer, matter, draws);
  out.remarks.insert(out.remarks.begin(), {"press test: " + press_text(out.question),
                                           fmt::format("solid fraction {:.3f} +- {:.2g}", out.answer.at.solid_fraction,
                                                       out.answer.solid_fraction_error),
                                           nearest_text(library, out.answer)});
  for (std::string& doubt : doubts_of(pressed_law(card, path), out.question)) out.remarks.push_back(std::move(doubt));
  if (std::string means = means_text(out.answer); !means.empty()) out.remarks.push_back(std::move(means));
  return out;
}

namespace {

/// What the file must say and does not is told with an example.
std::vector<ForceCurves> curves_with_comments(const std::string& path, const ForceCurveOptions& options) {
  try {
    return read_force_curve_files({path}, options);
  } catch (const InputError& e) {
    const std::string what = e.what();
    if (what.find("write a comment") == std::string::npos) throw;
    throw InputError(what + "; press_test.csv, beside the scenes that softgrain examples lists, is an example");
  }
}

}  // namespace

LawCard card_of_press_test(const std::string& path) {
  ForceCurveOptions options;
  options.unloading = Unloading::fit;
  options.by_options = false;
  ExperimentFit fit = fit_experiment(curves_with_comments(path, options), {}, true);
  const auto unusable =
      std::ranges::find_if(fit.card.pairs, [](const PairLaw& law) { return !has_numbers(law.status); });
  if (unusable != fit.card.pairs.end())
    throw InputError(path + ": no law can be fitted: " + to_string(unusable->status) + " (" + unusable->reason +
                     "); forces of compression are above 0: look at sign and unit of the force, at E and Rs, and at "
                     "where the overlap begins (# touch = ...)");
  fit.card.notes = std::move(fit.remarks);
  for (const ForceCurves& kind : fit.curves)
    if (const std::string doubt = touch_doubt(kind); !doubt.empty()) fit.card.notes.push_back(doubt);
  return std::move(fit.card);
}

FittedLaw load_or_fit_law(const std::string& path) {
  if (is_curve_file(path)) return {card_of_press_test(path), path, read_text(path)};
  return load_law(path);
}

}  // namespace softgrain
