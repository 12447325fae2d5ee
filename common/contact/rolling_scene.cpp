#include "common/contact/rolling_scene.h"

#include <fmt/format.h>

namespace softgrain {

void read_rolling_resistance(const SceneTable& t, double friction, RollingResistance& rolling) {
  rolling.friction = t.number({"mu_r",
                               "rolling friction: the rolling moment is at most `mu_r` R12 Fn, R12 = R1 R2/(R1 + R2); "
                               "0: no rolling resistance"},
                              Unit::none, Range::friction(), rolling.friction);
  rolling.stiffness = t.number({"kr_ratio", "with `mu_r`: rolling stiffness over tangential stiffness times R12^2"},
                               Unit::none, Range{0.0, 1000.0, true, false}, rolling.stiffness);
  if (!(rolling.friction > 0.0) && !t.has("mu_r")) t.refuse({"kr_ratio"}, "goes with mu_r: nothing resists rolling");
  if (rolling.friction > 0.0 && !(friction > 0.0))
    t.add_error(t.has("mu_r") || !t.has("mu") ? "mu_r" : "mu",
                "rolling resistance (mu_r) needs friction, mu above 0: spheres that slide freely do not roll");
}

std::string rolling_text(const RollingResistance& rolling) {
  if (!(rolling.friction > 0.0)) return "";
  return fmt::format(", mu_r = {:g}, kr_ratio = {:g}", rolling.friction, rolling.stiffness);
}

}  // namespace softgrain
