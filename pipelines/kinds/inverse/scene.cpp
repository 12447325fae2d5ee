// Reads scenes of kind "inverse", and says what follows from them: softgrain check.
#include "pipelines/kinds/inverse/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/experiment_fit.h"
#include "calibrate/response_surface.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/force_curves.h"
#include "common/data/soft_particle_schema.h"
#include "common/io/csv_file.h"
#include "pipelines/kinds/soft_particle/check.h"

namespace softgrain {

namespace {

/// What may be searched: key in [search], its meaning, allowed values, how it is spread, and where it goes.
struct KnownParameter {
  const char* name;
  const char* asked;
  Range range;
  bool logarithmic;
  double SoftParticleSpec::*member;  ///< null: trials
};

const std::array<KnownParameter, 7>& known_parameters() {
  using S = SoftParticleSpec;
  const auto drawn = [](double S::*value, bool logarithmic) {
    const SoftParticleNumber& number = soft_particle_number(value);
    return KnownParameter{number.scene_key, number.asked, number.drawn, logarithmic, value};
  };
  static const std::array<KnownParameter, 7> known{
      {drawn(&S::beta, true),
       {"trials", "random positions tried per grain", Range::closed(1.0, 1e9), true, nullptr},
       drawn(&S::friction, false),
       drawn(&S::poisson_ratio, false),
       drawn(&S::rmax_over_shell, false),
       drawn(&S::exponent, false),
       drawn(&S::polydispersity, true)}};
  return known;
}

std::vector<SearchParameter> read_search(const SceneTable& t) {
  std::vector<SearchParameter> out;
  for (const KnownParameter& k : known_parameters()) {
    if (!t.has(k.name)) continue;
    const std::vector<double> ends =
        t.numbers({k.name, std::string("searched range [low, high]: ") + k.asked}, Unit::none, k.range);
    if (ends.size() != 2 || !(ends[0] < ends[1]))
      t.add_error(k.name, "must be a range of two rising values [low, high]");
    else
      out.push_back({k.name, ends[0], ends[1], k.logarithmic && ends[0] > 0.0});
  }
  if (out.empty())
    t.add_error("beta",
                "nothing is searched: give the range of at least one of beta, trials, mu, nu, rmax_over_shell, "
                "exponent, polydispersity, e.g. mu = [0.1, 0.6]");
  return out;
}

/// What is searched has no value of its own.
void refuse_searched(const SceneTable& root, const std::vector<SearchParameter>& search) {
  const SceneTable material = root.table_or_empty("material");
  const SceneTable packing = root.table_or_empty("packing");
  for (const SearchParameter& p : search)
    for (const SceneTable& t : {material, packing}) {
      const std::vector<std::string> keys = t.keys();
      if (std::find(keys.begin(), keys.end(), p.name) != keys.end())
        t.add_error(p.name, "is searched: its range is in [search]");
    }
  const bool ratio =
      std::any_of(search.begin(), search.end(), [](const auto& p) { return p.name == "rmax_over_shell"; });
  if (ratio) packing.refuse({"rmax"}, "rmax_over_shell is searched: its range is in [search]");
}

/// The largest packings of the box must be drawable too.
void require_box(const SceneTable& t, const InverseSetup& setup) {
  const std::size_t d = setup.search.size();
  for (std::size_t corner = 0; corner < (std::size_t{1} << d); ++corner) {
    std::vector<double> u;
    for (std::size_t a = 0; a < d; ++a) u.push_back((corner >> a & 1U) != 0 ? 1.0 : 0.0);
    require_drawable(t, spec_at(setup, u));
  }
}

void read_budget(const SceneTable& t, InverseSetup& s) {
  const auto surface = static_cast<std::int64_t>(ResponseSurface::coefficients(s.search.size()));
  s.budget = t.count({"budget", "number of evaluations", "40 or more"}, surface + 2, 100000,
                     std::max<std::int64_t>(40, 2 * surface + 10));
  s.design = t.count({"design", "evaluations that are first spread over all ranges", "half of `budget`"}, surface,
                     s.budget, std::max(surface + 2, s.budget / 2));
  s.batch = t.count({"batch", "evaluations between two fits of the surface"}, 1, 1000, 6);
  s.confirm = t.count(
      {"confirm", "packings of the last evaluation at the answer; the search has not seen them", "as `packing.count`"},
      2, 100000, s.packings);
  s.replicates = static_cast<int>(t.count({"replicates", "draws for the intervals"}, 20, 100000, s.replicates));
}

/// Points given in the scene itself.
void read_points(const SceneTable& t, InverseSetup& s) {
  s.target.delta = t.numbers({"delta", "overlaps Delta of the target, ascending, instead of `file`"}, Unit::none,
                             Range{0.0, 0.9, true, false});
  s.target.force = t.numbers({"force", "forces at `delta`, instead of `file`"}, Unit::force);
  const std::size_t n = s.target.delta.size();
  if (s.target.force.size() != n) t.throw_error("force", fmt::format("must have as many values as delta ({})", n));
  for (std::size_t k = 1; k < n; ++k)
    if (s.target.delta[k] <= s.target.delta[k - 1]) t.add_error("delta", "values must ascend");
  s.target.error.assign(n, 0.0);
  if (!t.has("error")) return;
  s.target.error = t.numbers({"error", "standard errors of `force`", "0"}, Unit::force, Range::not_negative());
  if (s.target.error.size() != n) t.throw_error("error", fmt::format("must have as many values as delta ({})", n));
}

/// What the file says of the grains is what the scene says, where it is not what is searched.
void require_same_grains(const SceneTable& t, const SoftParticleSpec& file, const InverseSetup& s) {
  for (double SoftParticleSpec::*member :
       {&SoftParticleSpec::poisson_ratio, &SoftParticleSpec::friction, &SoftParticleSpec::density}) {
    const char* name = soft_particle_number(member).scene_key;
    const bool searched = std::any_of(s.search.begin(), s.search.end(),
                                      [name = std::string(name)](const SearchParameter& p) { return p.name == name; });
    const double said = file.*member;
    const double scene = s.measure.spec.*member;
    if (!searched && is_known(said) && std::abs(said - scene) > 1e-9 * std::abs(said))
      t.add_error("file", fmt::format("says {} = {:g}, the scene {:g}: leave one of them out", name, said, scene));
  }
}

/// Mean curve of a file, at evenly spread overlaps within its range.
void read_file(const Scene& scene, const SceneTable& t, InverseSetup& s) {
  const std::string path = scene.resolve(t.filled_text(
      {"file",
       "table of a force-displacement curve; offsets of the force are subtracted. `Rs`, `E`, `nu`, `mu` and "
       "`density` in its comments must agree with the scene, unless they are searched"}));
  ForceCurveOptions options;
  if (t.has("contact") || !said_by_comments(CsvFile::read(path)).kind) options.kind = s.kind;
  options.shell_radius = s.measure.spec.shell_radius;
  options.youngs_modulus = s.measure.spec.youngs_modulus;
  options.by_options = false;
  options.kind_from = "contact of [target],";
  options.radius_from = "shell_radius of [packing],";
  options.modulus_from = "E of [material],";
  options.unloading = *parse_enum<Unloading>(t.choice(
      {"unloading", "points whose overlap does not rise: `refuse` them or `drop` them"}, {"refuse", "drop"}, "refuse"));
  ForceCurves curves = read_force_curves(path, options);
  (void)subtract_offsets(curves);  // its remarks say it
  s.kind = curves.kind;
  s.remarks = curves.remarks;
  require_same_grains(t, curves.spec, s);
  const CurveMeans means = mean_curve(curves);
  const auto points =
      static_cast<std::size_t>(t.count({"points", "number of points of the file that are used"}, 3, 1000, 8));
  const double low =
      t.number({"delta_low", "lower end of the range of Delta that points of the file are taken from", "all"},
               Unit::none, Range{0.0, 0.9, true, false}, std::max(means.delta.front(), 1e-3));
  const double high =
      t.number({"delta_high", "upper end of the range of Delta that points of the file are taken from", "all"},
               Unit::none, Range{0.0, 0.9, true, false}, means.delta.back());
  if (!(high > low) || low > means.delta.back() || high < means.delta.front())
    t.throw_error("delta_high",
                  fmt::format("the file has Delta from {:.4g} to {:.4g}", means.delta.front(), means.delta.back()));
  s.target.delta.clear();
  std::size_t last = means.delta.size();
  for (std::size_t k = 0; k < points; ++k) {
    const double wanted = low + (high - low) * static_cast<double>(k) / static_cast<double>(points - 1);
    std::size_t near = 0;  // measured overlaps are taken as they are: nothing is interpolated twice
    for (std::size_t i = 0; i < means.delta.size(); ++i)
      if (std::abs(means.delta[i] - wanted) < std::abs(means.delta[near] - wanted)) near = i;
    if (near == last || !(means.delta[near] > 0.0)) continue;
    last = near;
    s.target.delta.push_back(means.delta[near]);
    s.target.force.push_back(means.mean[near]);
    s.target.error.push_back(means.deviation[near]);
  }
}

void read_target(const Scene& scene, const SceneTable& t, InverseSetup& s) {
  s.kind = t.choice<PairKind>({"contact", "kind of contact of the target curve", "as in the file, else soft-solid"},
                              PairKind::soft_solid);
  s.target.discrepancy =
      t.number({"discrepancy", "error of a simulation with the right parameters, as a share of the force"}, Unit::none,
               Range::closed(0.0, 1.0), s.target.discrepancy);
  if (t.has("file") && t.has("delta")) t.throw_error("delta", "give the target as a file or as points, not both");
  if (t.has("file"))
    read_file(scene, t, s);
  else
    read_points(t, s);
  const char* key = t.has("file") ? "file" : "force";
  if (s.target.delta.size() < 3) t.throw_error(key, "at least three points are needed");
  if (!(*std::max_element(s.target.force.begin(), s.target.force.end()) > 0.0))
    t.throw_error(key, "no force of the target is above zero");
  if (s.target.discrepancy <= 0.0 && *std::min_element(s.target.error.begin(), s.target.error.end()) <= 0.0)
    t.throw_error("discrepancy", "must be above 0 where the target has no errors");
}

}  // namespace

double SearchParameter::value(double u) const {
  if (u <= 0.0) return low;
  if (u >= 1.0) return high;
  return logarithmic ? low * std::pow(high / low, u) : low + (high - low) * u;
}

double SearchParameter::coordinate(double x) const {
  return logarithmic ? std::log(x / low) / std::log(high / low) : (x - low) / (high - low);
}

void SearchParameter::set(SoftParticleSpec& spec, double x) const {
  for (const KnownParameter& k : known_parameters()) {
    if (name != k.name) continue;
    if (k.member != nullptr)
      spec.*k.member = x;
    else
      spec.trials = std::llround(x);
  }
}

SoftParticleSpec spec_at(const InverseSetup& setup, const std::vector<double>& u) {
  SoftParticleSpec spec = setup.measure.spec;
  for (std::size_t a = 0; a < setup.search.size(); ++a) setup.search[a].set(spec, setup.search[a].value(u[a]));
  return spec;
}

InverseSetup read_inverse(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    (void)root.choice(kKindKey, {"inverse"});
    InverseSetup s;
    s.title = root.title();
    s.measure = read_measure_protocols(root, s.relaxation, s.plan);
    s.packings = root.table_or_empty("packing").count({"count", "number of packings of each evaluation"}, 2, 100000, 8);
    const SceneTable search = root.table(
        {"search", "quantities that are searched, at least one; they are left out of `material` and `packing`"});
    s.search = read_search(search);
    for (const char* key : {"exponent", "polydispersity", "rmax_over_shell"})
      if (s.measure.spec.sizes && search.has(key))
        search.add_error(key, "cannot be searched beside packing.sizes, which says all sizes");
    search.section([&] {
      if (!root.has_errors()) require_box(search, s);
    });
    refuse_searched(root, s.search);
    const SceneTable measure = root.table_or_empty("measure");
    if (!measure.has_errors()) refuse_idle_protocols(measure, {s.relaxation}, false);
    read_budget(search, s);
    const SceneTable target = root.table({"target", "curve that the soft particle must give"});
    target.section([&] { read_target(scene, target, s); });
    s.plan.deltas = s.target.delta;
    return s;
  });
}

namespace {

/// Core seconds of one run, the mean over points along the diagonal of the box; so few of them are enough, as cost
/// changes evenly from one corner to the other. Points where no grain finds a place cost nothing.
double seconds_per_run(const InverseSetup& setup) {
  constexpr std::array kPlaces{0.15, 0.5, 0.85};
  constexpr double kBudget = 0.1;
  double sum = 0.0;
  for (const double place : kPlaces) {
    try {
      const SoftParticleSpec spec = spec_at(setup, std::vector<double>(setup.search.size(), place));
      const MeasureTrial trial = try_soft_particle(spec, setup.measure.seed, kBudget);
      const double packings = setup.kind == PairKind::soft_soft ? 2.0 : 1.0;
      sum += packings * trial.packing_seconds +
             measuring_seconds(setup.measure, setup.relaxation, setup.plan, setup.kind, trial.pass_seconds);
    } catch (const InputError&) {
    }
  }
  return sum / static_cast<double>(kPlaces.size());
}

}  // namespace

void check_inverse(const InverseSetup& setup, Findings& out) {
  const std::int64_t runs = setup.budget * setup.packings + setup.confirm;
  out.facts["evaluations"] = setup.budget;
  out.facts["points_per_run"] = setup.target.delta.size();
  out.add("runs", runs,
          fmt::format("{} of {} and {} to confirm: {} of {} {} states", counted(setup.budget, "evaluation"),
                      counted(setup.packings, "packing"), setup.confirm, counted(runs, "run"),
                      setup.target.delta.size(), to_string(setup.kind)));
  for (const SearchParameter& p : setup.search)
    out.lines += fmt::format("  {} from {:.4g} to {:.4g}{}\n", p.name, p.low, p.high,
                             p.logarithmic ? ", evenly in its logarithm" : "");
  out.lines +=
      fmt::format("  target: Delta from {:.4g} to {:.4g}, force up to {:.4g} N\n", setup.target.delta.front(),
                  setup.target.delta.back(), *std::max_element(setup.target.force.begin(), setup.target.force.end()));
  const SoftParticleSpec& spec = setup.measure.spec;
  out.warn_of_metres("shell_radius", spec.shell_radius);
  out.warn_of_grains(spec.youngs_modulus, spec.density);
  for (const std::string& one :
       implausible_forces(setup.target.delta, setup.target.force, spec.shell_radius, spec.youngs_modulus))
    out.warn(one);
  for (const std::string& remark : setup.remarks) out.warn(remark);
  for (const std::string& warning : speed_warnings(setup.measure)) out.warn(warning);
  out.spend("runs", seconds_per_run(setup) * static_cast<double>(runs));
}

}  // namespace softgrain
