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
  visit("name", s.name, Means{"name of the number in the card"});
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
  visit("name", s.name, Means{"name of the variant"});
  visit("fines_over_coarse", s.ratio, Means{"volume of fines over that of coarse grains", "1"});
  visit("coarse_grains", s.coarse, Means{"number of coarse grains", "1"});
  visit("fine_grains", s.fines, Means{"number of fine grains", "1"});
  visit("excess_pores", s.pores.value, Means{"excess pores over the volume of coarse grains, W/V_c", "1"});
  visit("standard_error", s.pores.standard_error, Means{"standard error of it", "1"});
  range_field(visit, "interval", s.pores.low, s.pores.high, Means{"95 % interval of it", "1"});
  visit("fitted", s.fitted, Means{"fitted form there", "1"});
}

/// The form of the excess pores over V_f/V_c.
struct BandSummary {
  std::vector<double> ratio;
  std::vector<double> value;
  std::vector<double> low;
  std::vector<double> high;
};

void fields(auto&& visit, Of<BandSummary> auto& s) {
  visit("fines_over_coarse", s.ratio, Means{"volume of fines over that of coarse grains", "1"});
  visit("value", s.value, Means{"fitted form of the excess pores over the volume of coarse grains", "1"});
  visit("low", s.low, Means{"lower end of the 95 % band", "1"});
  visit("high", s.high, Means{"upper end of the 95 % band", "1"});
}

/// A test of the fines and the cell law with the fitted friction.
struct FrictionCurve {
  std::string variant;
  std::string measure;
  std::vector<double> strain;
  std::vector<double> measured;
  std::vector<double> error;
  std::vector<double> fitted;
};

void fields(auto&& visit, Of<FrictionCurve> auto& s) {
  visit("variant", s.variant, Means{"name of the variant"});
  visit("measure", s.measure, Means{"quantity: \"lateral/axial\", \"q/p\", \"p/E\" or \"(sigma_z - sigma_x)/p\""});
  visit("strain", s.strain, Means{"strain of z since the stage began", "1"});
  visit("measured", s.measured, Means{"mean of the samples", "1"});
  visit("standard_error", s.error, Means{"standard error of it", "1"});
  visit("fitted", s.fitted, Means{"the cell law with the fitted numbers", "1"});
}

struct CellLawSummary {
  bool usable = false;
  StateForm form = StateForm::porosity;
  double split = 0.0;
  std::vector<LawNumber> numbers;
  std::vector<LawNumber> of_pair;
  std::vector<LawNumber> void_ratio_factors;
  std::vector<MixtureSummary> mixtures;
  std::optional<BandSummary> band;
  double excess_deviation = 0.0;
  double excess_widening = 1.0;
  std::vector<FrictionCurve> curves;
  double friction_deviation = 0.0;
  std::vector<std::string> undetermined;
};

void fields(auto&& visit, Of<CellLawSummary> auto& s) {
  visit("usable", s.usable, Means{"whether the law is usable"});
  visit("form", s.form, Means{"form of the equation of state"});
  visit("split", s.split, Means{"radius that parts fines from coarse grains, over the largest radius", "1"});
  visit("numbers", s.numbers, Means{"numbers that were determined; those of the card where one was written"});
  visit("numbers_of_two_coarsest_levels", s.of_pair, kLeftOut,
        Means{"numbers of the two coarsest levels of a recipe alone"});
  visit("void_ratio_factors", s.void_ratio_factors, kLeftOut,
        Means{"void ratio of other preparations over that of the card's, by their names", "1"});
  visit("mixtures", s.mixtures, Means{"excess pores of each mixture"});
  visit("band", s.band, kLeftOut, Means{"form of the excess pores"});
  visit("excess_deviation", s.excess_deviation, Means{"root mean square deviation of W/V_c from its form", "1"});
  visit("excess_widening", s.excess_widening,
        Means{"factor on the intervals of w_inf and xi, as the form misses the mixtures", "1"});
  visit("curves", s.curves, Means{"tests of the fines, measured and by the law"});
  visit("friction_deviation", s.friction_deviation,
        Means{"root mean square deviation of the ratios from those of the law", "1"});
  visit("undetermined", s.undetermined, kLeftOut, Means{"numbers of the shear memory that cannot be told apart"});
}

struct MaterialLawSummary {
  MaterialSummary material;
  CellLawSummary law;
};

void fields(auto&& visit, Of<MaterialLawSummary> auto& s) {
  fields(visit, s.material);
  visit("cell_law", s.law, Means{"the law of cells"});
}

}  // namespace softgrain
