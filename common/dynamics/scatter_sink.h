// What the scalar pair loop does with a contact: to its bodies at once, or put down for later.
#pragma once

#include "common/dynamics/hertz_block.h"
#include "common/dynamics/pair_loop.h"

namespace softgrain {

/// Adds each contact to its two bodies at once, in list order.
template <int D>
struct ScatterSink {
  Particles<D>& p;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    if constexpr (kTorque) {
      const Vec<D> f = g.normal * r.normal_force + r.tangential_force;
      p.force[i] += f;
      p.force[j] -= f;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      p.torque[i] -= moment * g.arm_i;
      p.torque[j] -= moment * g.arm_j;
    } else {
      const Vec<D> f = g.normal * r.normal_force;
      p.force[i] += f;
      p.force[j] -= f;
    }
  }
  void roll(std::size_t i, std::size_t j, const Rot<D>& moment) {
    p.torque[i] += moment;
    p.torque[j] -= moment;
  }
};

/// Puts the loads down one after the other.
template <int D>
struct PutDownSink {
  ContactLoad* load;
  std::uint8_t* touches;

  void apart(std::size_t) {
    *touches++ = 0;
    ++load;
  }
  template <bool kTorque>
  void touch(std::size_t, std::size_t, std::size_t, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    *load = {};
    Vec<D> f = g.normal * r.normal_force;
    if constexpr (kTorque) {
      f = g.normal * r.normal_force + r.tangential_force;
      const Rot<D> moment = cross(g.normal, r.tangential_force);
      for (std::size_t k = 0; k < moment.v.size(); ++k) load->moment[k] = moment.v[k];
    }
    for (std::size_t k = 0; k < f.v.size(); ++k) load->force[k] = f.v[k];
    load->arm_i = g.arm_i;
    load->arm_j = g.arm_j;
    *touches++ = 1;
    ++load;
  }
  /// In two dimensions, where a moment is one number and leaves room beside it.
  void roll(std::size_t, std::size_t, const Rot<D>& moment) requires(D == 2) { (load - 1)->moment[1] = moment[0]; }
};

}  // namespace softgrain
