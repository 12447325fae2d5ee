#include "common/dynamics/contact_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "common/dynamics/pair_loop.h"

namespace softgrain {

namespace {

template <class Law>
constexpr bool is_cohesive() {
  return requires(const Law& law) { law.adhesion; };
}

template <class Law>
constexpr bool stores_energy() {
  return is_cohesive<Law>() || requires(const Law& law) { law.stored_energy(0.0, PairConstants{}); };
}

/// Work of the elastic force from the end of the reach of a cohesive disk to this overlap (negative: a gap); below 0
/// where disks are bound.
template <class Law>
double cohesive_energy(const Law& law, double overlap) {
  if (overlap > 0.0) return 0.5 * law.normal * overlap * overlap - law.adhesion * (overlap + 0.5 * law.reach());
  const double left = law.reach() + overlap;
  return left > 0.0 ? -0.5 * law.adhesion * left * left / law.range : 0.0;
}

template <class Law>
constexpr bool is_crowd() {
  return requires(const Law& law) { law.form; };
}

/// Sections one after another; sums of crowd laws are made anew, because those of the last pass are scratch.
template <int D>
class Watcher {
 public:
  explicit Watcher(const System<D>& system) : s_(system) {}

  ContactWatch<D> watch() {
    for (const ContactSection& section : s_.contacts.sections)
      detail::with_types(s_, section,
                         [&](const auto& law, auto geometry, auto) { look<decltype(geometry)::value>(section, law); });
    for (std::size_t u = 0; u < sums_.size(); ++u)
      if (sums_[u].square != 0.0) add_volume(form_[u]->equivalent_volume(sums_[u]), *form_[u]);
    return out_;
  }

 private:
  template <Geometry kGeometry, class Law>
  void look(const ContactSection& section, const Law& law) {
    for (std::int32_t k = section.begin; k < section.end; ++k) {
      const auto c = static_cast<std::size_t>(k);
      const auto i = static_cast<std::size_t>(s_.contacts.i[c]);
      const auto j = static_cast<std::size_t>(s_.contacts.j[c]);
      const Vec<D> shift = s_.cell.any_periodic() ? s_.cell.image_shift(s_.contacts.image[c]) : Vec<D>{};
      ContactGeometry<D> g;
      if (!detail::meet<D, kGeometry>(s_.particles, i, j, shift, g, reach_of(law))) continue;
      note_overlap(c, g, kGeometry);
      ContactState<D> state = detail::contact_state<D, kGeometry>(s_, c, g);
      if constexpr (Law::has_tangential) state.spring = s_.contacts.spring[c];
      if constexpr (Law::has_memory) state.memory = s_.contacts.memory[c];
      note_energy(law, state);
      note_use(law, state, i, j);
    }
  }

  void note_overlap(std::size_t c, const ContactGeometry<D>& g, Geometry geometry) {
    const auto& sphere = s_.particles.sphere;
    const double ri = sphere[static_cast<std::size_t>(s_.contacts.i[c])].r;
    const double rj = sphere[static_cast<std::size_t>(s_.contacts.j[c])].r;
    const double smaller = geometry == Geometry::sphere_sphere ? std::min(ri, rj) : ri;
    if (geometry == Geometry::sphere_plane && g.overlap > ri) {
      ++out_.behind_planes;
      out_.behind = s_.contacts.i[c];
    }
    const double depth = g.overlap / smaller;
    if (depth <= out_.overlap || std::isnan(out_.overlap)) return;
    out_.overlap = depth;
    out_.i = s_.contacts.i[c];
    out_.j = s_.contacts.j[c];
  }

  /// The state carries no motion: what the law answers is elastic.
  template <class Law>
  void note_energy(const Law& law, const ContactState<D>& state) {
    if constexpr (stores_energy<Law>()) {
      if constexpr (is_cohesive<Law>())
        out_.stored += cohesive_energy(law, state.overlap);
      else
        out_.stored += law.stored_energy(state.overlap, state.constants);
      if constexpr (Law::has_tangential) {
        const ContactResponse<D> r = law.evaluate(state);
        if (r.tangential_stiffness > 0.0) out_.stored += 0.5 * norm2(r.tangential_force) / r.tangential_stiffness;
        if constexpr (resists_rolling<Law>()) out_.stored += 0.5 * norm2(r.rolling_moment) / law.rolling;
      }
    } else {
      out_.energy_known = false;
    }
  }

  template <class Law>
  void note_use(const Law& law, const ContactState<D>& state, std::size_t i, std::size_t j) {
    if constexpr (std::is_same_v<Law, SoftContact>) {
      out_.laws.add(state.overlap / (state.constants.a * law.range.end), law.range.beyond);
    } else if constexpr (is_crowd<Law>()) {
      note_crowd(law, state, true, i);
      note_crowd(law, state, false, j);
    }
  }

  template <class Law>
  void note_crowd(const Law& law, const ContactState<D>& state, bool of_i, std::size_t body) {
    if constexpr (!Law::needs_particle_pass) {
      CrowdSum<D> own;
      law.share(state, of_i, own);
      if (own.square != 0.0) add_volume(own.volume, law.form);
    } else {
      if (sums_.empty()) {
        sums_.resize(s_.particles.sphere.size());
        form_.resize(sums_.size());
      }
      law.share(state, of_i, sums_[body]);
      form_[body] = &law.form;
    }
  }
  void add_volume(double volume, const CrowdForm& form) {
    out_.laws.add(volume / form.pressure.range.end, form.pressure.range.beyond);
  }

  const System<D>& s_;
  ContactWatch<D> out_;
  std::vector<CrowdSum<D>> sums_;       ///< per body; empty without laws of crowds
  std::vector<const CrowdForm*> form_;  ///< of the law that serves it
};

}  // namespace

std::string law_use_text(const LawUse& use) {
  if (use.beyond == 0) return "";
  const char* done = use.refused > 0 ? "which the law does not allow" : use.clamped > 0 ? "clamped" : "extrapolated";
  return fmt::format(
      "{} of {} uses of fitted laws beyond what was measured, up to {:.2f} times the end of the range: {}", use.beyond,
      use.asked, use.largest, done);
}

template <int D>
ContactWatch<D> watch_contacts(const System<D>& system) {
  return Watcher<D>(system).watch();
}

template ContactWatch<2> watch_contacts<2>(const System<2>&);
template ContactWatch<3> watch_contacts<3>(const System<3>&);

}  // namespace softgrain
