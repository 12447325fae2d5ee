// What the measurement of a cell law came to: summary.json of its run, which the report reads back.
#pragma once

#include "common/data/law_card.h"
#include "pipelines/kinds/material/summary.h"

namespace softgrain {

/// A number of the law under its name in the card.
struct LawNumber {
  std::string name;
  Estimate estimate;
};

void fields(auto&& visit, Of<LawNumber> auto& s) {
  visit("name", s.name);
  fields(visit, s.estimate);
}

/// W/V_c of a mixture.
struct MixtureSummary {
  std::string name;
  double ratio = 0.0;  ///< V_f/V_c
  std::int64_t coarse = 0;
  std::int64_t fines = 0;
  Estimate pores;
  double fitted = 0.0;
};

void fields(auto&& visit, Of<MixtureSummary> auto& s) {
  visit("name", s.name);
  visit("fines_over_coarse", s.ratio);
  visit("coarse_grains", s.coarse);
  visit("fine_grains", s.fines);
  visit("excess_pores", s.pores.value);
  visit("standard_error", s.pores.standard_error);
  range_field(visit, "interval", s.pores.low, s.pores.high);
  visit("fitted", s.fitted);
}

/// The form of the excess pores over V_f/V_c.
struct BandSummary {
  std::vector<double> ratio;
  std::vector<double> value;
  std::vector<double> low;
  std::vector<double> high;
};

void fields(auto&& visit, Of<BandSummary> auto& s) {
  visit("fines_over_coarse", s.ratio);
  visit("value", s.value);
  visit("low", s.low);
  visit("high", s.high);
}

/// A test of the fines and the cell law with the fitted friction.
struct FrictionCurve {
  std::string variant;
  std::string measure;           ///< "lateral/axial", "q/p", "p/E", "(sigma_z - sigma_x)/p"
  std::vector<double> strain;    ///< strain of z since the stage began
  std::vector<double> measured;  ///< mean of the samples
  std::vector<double> error;     ///< standard error of it
  std::vector<double> fitted;
};

void fields(auto&& visit, Of<FrictionCurve> auto& s) {
  visit("variant", s.variant);
  visit("measure", s.measure);
  visit("strain", s.strain);
  visit("measured", s.measured);
  visit("standard_error", s.error);
  visit("fitted", s.fitted);
}

struct CellLawSummary {
  bool usable = false;
  StateForm form = StateForm::porosity;
  double split = 0.0;
  std::vector<LawNumber> numbers;  ///< numbers that were determined; those of the card where one was written
  std::vector<LawNumber> of_pair;  ///< numbers of the two coarsest levels of a recipe alone, before all finer ones
  std::vector<LawNumber> void_ratio_factors;  ///< by the names of other preparations
  std::vector<MixtureSummary> mixtures;
  std::optional<BandSummary> band;
  double excess_deviation = 0.0;  ///< root mean square of W/V_c about its form
  double excess_widening = 1.0;   ///< factor on the intervals of w_inf and xi, as the form misses the mixtures
  std::vector<FrictionCurve> curves;
  double friction_deviation = 0.0;        ///< root mean square of the ratios about those of the law
  std::vector<std::string> undetermined;  ///< numbers of the memory that lean on each other
};

void fields(auto&& visit, Of<CellLawSummary> auto& s) {
  visit("usable", s.usable);
  visit("form", s.form);
  visit("split", s.split);
  visit("numbers", s.numbers);
  visit("numbers_of_two_coarsest_levels", s.of_pair, kLeftOut);
  visit("void_ratio_factors", s.void_ratio_factors, kLeftOut);
  visit("mixtures", s.mixtures);
  visit("band", s.band, kLeftOut);
  visit("excess_deviation", s.excess_deviation);
  visit("excess_widening", s.excess_widening);
  visit("curves", s.curves);
  visit("friction_deviation", s.friction_deviation);
  visit("undetermined", s.undetermined, kLeftOut);
}

struct MaterialLawSummary {
  MaterialSummary material;
  CellLawSummary law;
};

void fields(auto&& visit, Of<MaterialLawSummary> auto& s) {
  fields(visit, s.material);
  visit("cell_law", s.law);
}

}  // namespace softgrain
