#include "common/contact/law_set.h"

namespace softgrain {

namespace {

template <Tangential kTangential>
AnyLaw with_damping(const HertzCoefficients& k) {
  if (k.damping > 0.0) return HertzMindlin<kTangential, true>{k};
  return HertzMindlin<kTangential, false>{k};
}

}  // namespace

AnyLaw hertz_law(const HertzCoefficients& coefficients, bool rescaled) {
  if (coefficients.friction == 0.0) return with_damping<Tangential::none>(coefficients);
  return rescaled ? with_damping<Tangential::rescaled>(coefficients) : with_damping<Tangential::mindlin>(coefficients);
}

}  // namespace softgrain
