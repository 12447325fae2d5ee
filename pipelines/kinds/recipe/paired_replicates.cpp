#include "pipelines/kinds/recipe/paired_replicates.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/statistics.h"
#include "pipelines/kinds/recipe/onset.h"

namespace softgrain {

namespace {

constexpr RandomPurpose kRecipeDifference{80};

using GslMatrix = std::unique_ptr<gsl_matrix, void (*)(gsl_matrix*)>;
using GslVector = std::unique_ptr<gsl_vector, void (*)(gsl_vector*)>;
GslVector vector_of(std::size_t size) { return {gsl_vector_calloc(size), gsl_vector_free}; }

/// Changes of the solid fractions by sample and point.
using PhiChanges = std::vector<std::vector<double>>;

/// A fit that is linear about its numbers ln K, n and phi_J of the groups.
class LinearFit {
 public:
  LinearFit(const FittedCurves& side, StateForm form)
      : data_(read_state_curves(side.curves)),
        matrix_(gsl_matrix_calloc(data_.points, 2 + data_.groups.size()), gsl_matrix_free),
        scale_(vector_of(2 + data_.groups.size())) {
    [[maybe_unused]] static const auto previous = gsl_set_error_handler_off();  // told by status
    numbers_ = {std::log(side.fit.modulus.value), side.fit.exponent.value};
    for (const StateGroup& g : side.fit.groups) numbers_.push_back(g.onset.value);
    between_ = side.fit.one_modulus ? 0.0 : side.fit.modulus_scatter;
    std::size_t row = 0;
    for (const StateSample& s : data_.samples) {
      slopes_.emplace_back();
      for (std::size_t i = 0; i < s.phi.size(); ++i, ++row) {
        const PhiSlopes d = phi_slopes(form, numbers_[0], numbers_[1], numbers_[2 + s.group], s.pressure[i]);
        gsl_matrix_set(matrix_.get(), row, 0, s.root_weight[i] * d.by_log_modulus);
        gsl_matrix_set(matrix_.get(), row, 1, s.root_weight[i] * d.by_exponent);
        gsl_matrix_set(matrix_.get(), row, 2 + s.group, s.root_weight[i] * d.by_onset);
        slopes_.back().push_back(d);
      }
    }
    if (gsl_linalg_QR_decomp(matrix_.get(), scale_.get()) != GSL_SUCCESS) throw_undetermined();
    find_residuals();
  }

  [[nodiscard]] const StateSamples& data() const { return data_; }
  [[nodiscard]] const std::vector<double>& residual(std::size_t sample) const { return residual_[sample]; }
  /// Deviation of ln K between packings; 0 where one K serves all.
  [[nodiscard]] double between() const { return between_; }
  [[nodiscard]] double by_log_modulus(std::size_t sample, std::size_t point) const {
    return slopes_[sample][point].by_log_modulus;
  }

  /// The numbers of a fit to changed solid fractions.
  [[nodiscard]] std::vector<double> numbers(const PhiChanges& changes) const {
    const GslVector right = vector_of(data_.points);
    const GslVector left = vector_of(data_.points);
    const GslVector step = vector_of(numbers_.size());
    std::size_t row = 0;
    for (std::size_t s = 0; s < changes.size(); ++s)
      for (std::size_t i = 0; i < changes[s].size(); ++i, ++row)
        gsl_vector_set(right.get(), row, data_.samples[s].root_weight[i] * changes[s][i]);
    if (gsl_linalg_QR_lssolve(matrix_.get(), scale_.get(), right.get(), step.get(), left.get()) != GSL_SUCCESS)
      throw_undetermined();
    std::vector<double> out = numbers_;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += gsl_vector_get(step.get(), k);
    // As far as fit_equation_of_state() goes.
    out[1] = std::clamp(out[1], 0.2, 20.0);
    for (std::size_t k = 2; k < out.size(); ++k) out[k] = std::clamp(out[k], 0.01, 0.999);
    return out;
  }

 private:
  [[noreturn]] static void throw_undetermined() {
    throw UnusableResult("the curves of the packings do not determine K, n and the onsets");
  }

  /// Curves of the samples less the mean of their group, all about the fit.
  void find_residuals() {
    std::vector<std::vector<double>> about;
    for (std::size_t s = 0; s < data_.samples.size(); ++s) {
      about.emplace_back();
      for (std::size_t i = 0; i < data_.samples[s].phi.size(); ++i)
        about.back().push_back(data_.samples[s].phi[i] - slopes_[s][i].value);
    }
    for (std::size_t s = 0; s < data_.samples.size(); ++s) {
      residual_.emplace_back();
      for (std::size_t i = 0; i < about[s].size(); ++i) {
        Tally group;
        for (std::size_t other = 0; other < data_.samples.size(); ++other)
          if (data_.samples[other].group == data_.samples[s].group)
            group.add(straight(data_.samples[other].log_pressure, about[other], data_.samples[s].log_pressure[i]));
        residual_.back().push_back(about[s][i] - group.mean());
      }
    }
  }

  StateSamples data_;
  GslMatrix matrix_;
  GslVector scale_;
  std::vector<double> numbers_;
  std::vector<std::vector<PhiSlopes>> slopes_;
  std::vector<std::vector<double>> residual_;
  double between_ = 0.0;
};

/// Which samples and packings of both runs are one.
class CommonSamples {
 public:
  CommonSamples(const LinearFit& a, const LinearFit& b, const std::map<std::string, std::string>& shared) {
    const auto& of_a = a.data();
    const auto& of_b = b.data();
    for (std::size_t s = 0; s < of_a.samples.size(); ++s) add(a, s, unit_[0]);
    for (std::size_t g = 0; g < of_a.groups.size(); ++g) group_[0].push_back(g);
    groups_ = of_a.groups.size();
    for (const StateSamples::Group& g : of_b.groups) {
      const auto same = place_of(of_a, shared, g.name);
      group_[1].push_back(same ? *same : groups_++);
    }
    std::map<std::size_t, std::size_t> seen;  // samples of a group of B so far
    for (std::size_t s = 0; s < of_b.samples.size(); ++s) {
      const std::size_t g = group_[1][of_b.samples[s].group];
      const auto partner = g < of_a.groups.size() ? nth_sample(of_a, g, seen[g]++) : std::nullopt;
      if (partner)
        unit_[1].push_back(*partner);
      else
        add(b, s, unit_[1]);
    }
  }

  struct Source {
    const LinearFit* fit;
    std::size_t sample;
  };
  [[nodiscard]] const std::vector<Source>& sources() const { return sources_; }
  [[nodiscard]] std::size_t groups() const { return groups_; }
  /// Place among the sources of a sample of A (side 0) or B.
  [[nodiscard]] std::size_t unit(std::size_t side, std::size_t sample) const { return unit_[side][sample]; }
  /// Number of a packing of A (side 0) or B among those of both.
  [[nodiscard]] std::size_t group(std::size_t side, std::size_t group) const { return group_[side][group]; }

 private:
  void add(const LinearFit& fit, std::size_t sample, std::vector<std::size_t>& units) {
    units.push_back(sources_.size());
    sources_.push_back({&fit, sample});
  }

  static std::optional<std::size_t> place_of(const StateSamples& a, const std::map<std::string, std::string>& shared,
                                             const std::string& name_in_b) {
    const auto name = shared.find(name_in_b);
    if (name == shared.end()) return std::nullopt;
    const auto at = std::ranges::find(a.groups, name->second, &StateSamples::Group::name);
    if (at == a.groups.end()) return std::nullopt;
    return static_cast<std::size_t>(at - a.groups.begin());
  }

  static std::optional<std::size_t> nth_sample(const StateSamples& data, std::size_t group, std::size_t n) {
    for (std::size_t s = 0; s < data.samples.size(); ++s)
      if (data.samples[s].group == group && n-- == 0) return s;
    return std::nullopt;
  }

  std::vector<Source> sources_;
  std::size_t groups_ = 0;
  std::array<std::vector<std::size_t>, 2> unit_;
  std::array<std::vector<std::size_t>, 2> group_;
};

/// Draws of one replicate, for the samples and packings of both runs.
struct CommonDraws {
  std::vector<std::size_t> from;  ///< source of the residual, by source
  std::vector<double> modulus;    ///< normal numbers, by packing

  CommonDraws(const CommonSamples& samples, RandomStream& random) {
    const std::size_t n = samples.sources().size();
    for (std::size_t k = 0; k < n; ++k) from.push_back(static_cast<std::size_t>(random.below(n)));
    for (std::size_t g = 0; g < samples.groups(); ++g) modulus.push_back(random.normal());
  }
};

std::vector<double> replicate_of_side(const LinearFit& fit, std::size_t side, const CommonSamples& samples,
                                      const CommonDraws& draws, double widen) {
  PhiChanges changes;
  for (std::size_t s = 0; s < fit.data().samples.size(); ++s) {
    const StateSample& sample = fit.data().samples[s];
    const CommonSamples::Source& from = samples.sources()[draws.from[samples.unit(side, s)]];
    const double modulus = fit.between() * draws.modulus[samples.group(side, sample.group)];
    changes.emplace_back();
    for (std::size_t i = 0; i < sample.phi.size(); ++i)
      changes.back().push_back(widen * straight(from.fit->data().samples[from.sample].log_pressure,
                                                from.fit->residual(from.sample), sample.log_pressure[i]) +
                               modulus * fit.by_log_modulus(s, i));
  }
  return fit.numbers(changes);
}

}  // namespace

PairedFits replicates_together(const FittedCurves& a, const FittedCurves& b,
                               const std::map<std::string, std::string>& shared, const StateFitOptions& options) {
  const LinearFit of_a(a, options.form);
  const LinearFit of_b(b, options.form);
  const CommonSamples samples(of_a, of_b, shared);
  const auto n = static_cast<double>(samples.sources().size());
  const auto groups = static_cast<double>(samples.groups());
  PairedFits out{a.fit, b.fit, n - groups};
  if (!a.fit.one_modulus || !b.fit.one_modulus) out.degrees = std::min(out.degrees, groups - 1.0);
  if (a.fit.degrees < 1 || b.fit.degrees < 1) out.degrees = 0.0;
  const double widen = n > groups ? std::sqrt(n / (n - groups)) : 1.0;
  out.a.replicates.clear();
  out.b.replicates.clear();
  for (int r = 0; r < options.replicates; ++r) {
    RandomStream random(options.seed, kRecipeDifference, static_cast<std::uint64_t>(r));
    const CommonDraws draws(samples, random);
    out.a.replicates.push_back(replicate_of_side(of_a, 0, samples, draws, widen));
    out.b.replicates.push_back(replicate_of_side(of_b, 1, samples, draws, widen));
  }
  return out;
}

}  // namespace softgrain
