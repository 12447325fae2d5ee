// Any text as a sieve analysis, and as a table of an experiment; what is read of that goes on to what calibrate does
// before it fits, and (second byte 0) to the fit. The first byte says what is given beside the file.
#include <array>
#include <cstddef>
#include <cstdint>

#include "calibrate/experiment_fit.h"
#include "common/core/error.h"
#include "common/data/force_curves.h"
#include "common/packing/sieve_table.h"
#include "tests/fuzz/input_file.h"

namespace {

softgrain::SieveOptions sieve_options(std::uint8_t given) {
  softgrain::SieveOptions options;
  constexpr std::array kColumns{"", "passing", "retained", "cumulative retained"};
  options.column = kColumns[given / 4 % 4];
  if (given / 16 % 2 == 1) options.unit = "mm";
  if (given / 32 % 2 == 1) options.smallest = 1e-7;
  if (given / 64 % 2 == 1) options.largest = 1.0;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace softgrain;
  if (size < 3) return 0;
  ForceCurveOptions options;
  if (data[0] % 2 == 1) {
    options.kind = PairKind::soft_soft;
    options.shell_radius = 0.016;
    options.youngs_modulus = 5e5;
  }
  options.unloading = data[0] % 4 > 1 ? Unloading::drop : Unloading::refuse;
  const fuzz::InputFile file(data + 2, size - 2, "input.csv");
  try {
    (void)read_sieve_file(file.path(), sieve_options(data[0]), data[0] / 128 == 1 ? 2 : 3);
  } catch (const Error&) {
  }
  try {
    const std::vector<ForceCurves> curves = read_force_curve_files({file.path()}, options);
    for (const ForceCurves& one : curves) (void)mean_curve(one);
    FitOptions fit;
    fit.replicates = 3;
    if (data[1] == 0) (void)fit_experiment(curves, fit, true);
  } catch (const Error&) {
  }
  return 0;
}
