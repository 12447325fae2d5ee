// A law card as text: meant to be read and edited by people, so every number stands with its meaning.
#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "common/core/text.h"
#include "common/data/card_text.h"
#include "common/data/law_card_format.h"

namespace softgrain {

namespace {

using Out = std::back_insert_iterator<std::string>;

std::string row(const double* values, std::size_t n) { return "[" + join_text(std::span(values, n), ", ", real) + "]"; }

/// "73.67 N" or "12.3 N/m = 0.0034 N/degree" for the measured E and Rs, as a comment.
std::string dimensional(double value, bool tangential, const SoftParticleSpec& spec) {
  if (!std::isfinite(value)) return "";
  if (!tangential)
    return fmt::format("  # {:.6g} N", value * spec.youngs_modulus * spec.shell_radius * spec.shell_radius);
  const double stiffness = value * spec.youngs_modulus * spec.shell_radius;
  return fmt::format("  # {:.6g} N/m = {:.6g} N/degree", stiffness,
                     stiffness * std::numbers::pi * spec.shell_radius / 180.0);
}

void write_head(Out out, const LawCard& card, const Provenance& provenance, const std::string& table_id) {
  fmt::format_to(out, "# Contact law of a soft particle: fitted parameters and what they were fitted to.\n");
  fmt::format_to(out, "# The measured curve behind each law is in the .h5 file of the same name.\n");
  fmt::format_to(
      out, "# All parameters are dimensionless, so one card serves every E and Rs; comments give the values for the\n");
  fmt::format_to(out, "# measured E = {} Pa and Rs = {} m.\n", real(card.spec.youngs_modulus),
                 real(card.spec.shell_radius));
  fmt::format_to(out, "schema = {}\n\n[provenance]\n", card.schema);
  fmt::format_to(out, "version = {}\ncommit = {}\n", quoted(provenance.version), quoted(provenance.commit));
  fmt::format_to(out, "compiler = {}\ncommand = {}\n", quoted(provenance.compiler), quoted(provenance.command));
  fmt::format_to(out, "seed = {}\nthreads = {}\n", quoted(fmt::format("{}", provenance.seed)), provenance.threads);
  if (!table_id.empty()) fmt::format_to(out, "table = {}  # the .h5 that belongs to this card\n", quoted(table_id));
  fmt::format_to(out, "\n[definitions]\n");
  fmt::format_to(out, "form = \"F(Delta) = 0 for Delta < delta, a Delta^b + c for Delta >= delta, c = -a delta^b\"\n");
  fmt::format_to(
      out, "Delta = \"total overlap hn over the shell radius Rs; for unequal radii hn/R of the smaller shell\"\n");
  fmt::format_to(out, "normal = \"Fn = E Rs^2 F(Delta), compression positive\"\n");
  fmt::format_to(out, "tangential = \"kt = E Rs F(Delta), force per tangential displacement ht = pi Rs angle/180\"\n");
  fmt::format_to(out, "interval_95 = {}\n", quoted(card.intervals));
}

void write_measurement(Out out, const LawCard& card) {
  fmt::format_to(out, "\n# The soft particle that was measured.\n");
  if (card.from_experiment())
    fmt::format_to(
        out,
        "# An experiment: shell_radius and youngs_modulus make the law dimensionless. What the data did not\n"
        "# say is not known and not here: friction, and what is inside (exponent, polydispersity,\n"
        "# rmax_over_shell, beta, trials), without which no resolved twin can be made.\n");
  fmt::format_to(out, "[measurement]\nrelaxation = {}\n", quoted(card.relaxation));
  if (!card.from_experiment())
    fmt::format_to(out, "turn = {}  # how the soft particle was turned for kt: grains moving on, or frozen\n",
                   quoted(to_string(card.turn)));
  fmt::format_to(out, "{}", spec_text(card.spec));
}

void write_estimate(Out out, const std::string& table, const Estimate& e, const std::string& comment) {
  fmt::format_to(out, "[{}]\nvalue = {}{}\nunit = \"1\"\nstandard_error = {}\n", table, real(e.value), comment,
                 real(e.standard_error));
  fmt::format_to(out, "interval_95 = {{ low = {}, high = {} }}\n", real(e.low), real(e.high));
}

void write_part(Out out, const PairLaw& pair, const LawPartName& part, const SoftParticleSpec& spec) {
  const bool initial = part.law == &PairLaw::tangential_initial;
  fmt::format_to(out, "\n[pair.{}]\n", part.key);
  if (part.tangential) {
    const char* meaning = initial ? "slope at ht = 0, from angles up to this one" : "secant at this angle";
    fmt::format_to(out, "fitted = {}\n", initial ? pair.has_tangential_initial : pair.has_tangential_secant);
    fmt::format_to(out, "angle_deg = {}  # {}\n", real(initial ? pair.initial_angle_deg : pair.secant_angle_deg),
                   meaning);
  }
  for (const LawParameterName& p : kLawParameters) {
    const Estimate& estimate = pair.*part.law.*p.estimate;
    write_estimate(out, fmt::format("pair.{}.{}", part.key, p.key), estimate,
                   p.has_dimension ? dimensional(estimate.value, part.tangential, spec) : "");
  }
}

void write_covariance(Out out, const PairLaw& pair) {
  constexpr std::size_t n = kLawParameterNames.size();
  bool finite = pair.covariance.size() == n * n;
  for (const double x : pair.covariance) finite = finite && std::isfinite(x);
  if (!finite) return;
  fmt::format_to(
      out,
      "\n# Rows and columns in the order of the rows; zero where a parameter was not fitted.\n[pair.covariance]\n");
  for (std::size_t k = 0; k < n; ++k)
    fmt::format_to(out, "{} = {}\n", kLawParameterNames[k], row(&pair.covariance[k * n], n));
}

void write_assumed(Out out, double kt_ratio) {
  fmt::format_to(out,
                 "\n# No tangential stiffness was measured. Assumed: kt = kt_ratio dFn/dhn, up to mu Fn. By default\n"
                 "# Mindlin's 2 (1 - nu)/(2 - nu), nu = 0.3 unless known; 0: no tangential force, whatever mu.\n"
                 "[pair.tangential_assumed]\nkt_ratio = {}\n",
                 real(kt_ratio));
}

void write_unloading(Out out, const UnloadingLaw& u) {
  fmt::format_to(
      out,
      "\n# Unloading from the deepest Delta_max, and back: F = F(Delta_max) [(Delta - Delta_p)/(Delta_max - "
      "Delta_p)]^exponent,\n# 0 below Delta_p = delta + residual (Delta_max - delta). Without this table the "
      "contact gives back what it took.\n[pair.unloading]\nsamples = {}\npoints = {}\ncorrelation = {}  # "
      "of the errors of both numbers\n",
      u.samples, u.points, real(u.correlation));
  if (u.deepest > 0.0)
    fmt::format_to(out,
                   "deepest = {}  # mean Delta_max; the error of the residual holds that of delta with Delta_p from "
                   "there\n",
                   real(u.deepest));
  write_estimate(out, "pair.unloading.residual", u.residual, "");
  write_estimate(out, "pair.unloading.exponent", u.exponent, "");
}

void write_pair(Out out, const PairLaw& pair, const LawCard& card) {
  const SoftParticleSpec& spec = card.spec;
  fmt::format_to(out, "\n[[pair]]\nkind = \"{}\"\nstatus = {}\nreason = {}\n", to_string(pair.kind),
                 quoted(to_string(pair.status)), quoted(pair.reason));
  if (pair.band_origin != card.intervals) fmt::format_to(out, "interval_95 = {}\n", quoted(pair.band_origin));
  fmt::format_to(out, "packings = {}\npoints = {}\n", pair.packings, pair.points);
  fmt::format_to(out, "chi2_per_dof = {}\n", real(pair.chi2_per_dof));
  fmt::format_to(out, "quality = {}  # probability of a larger chi^2\n", real(pair.quality));
  fmt::format_to(
      out, "\n# Range of Delta that was fitted, and the largest grain overlap over the smaller radius inside it.\n");
  fmt::format_to(out, "[pair.validity]\ndelta_min = {}\ndelta_max = {}\n", real(pair.delta_min), real(pair.delta_max));
  fmt::format_to(out, "max_overlap = {}\n", real(pair.max_overlap));
  fmt::format_to(out,
                 "beyond = \"{}\"  # above delta_max: \"error\", \"clamp\" or \"extrapolate\"; counted either way\n",
                 to_string(pair.beyond));
  for (const LawPartName& part : kLawParts) write_part(out, pair, part, spec);
  if (!has_tangential(pair) && has_numbers(pair.status)) write_assumed(out, assumed_kt_ratio(card, pair));
  if (pair.unloading) write_unloading(out, *pair.unloading);
  write_covariance(out, pair);
}

}  // namespace

std::string card_text(const LawCard& card, const Provenance& provenance, const std::string& table_id) {
  std::string text;
  const Out out(text);
  write_head(out, card, provenance, table_id);
  write_measurement(out, card);
  for (const PairLaw& pair : card.pairs) write_pair(out, pair, card);
  return text;
}

}  // namespace softgrain
