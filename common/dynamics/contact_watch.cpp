#include "common/dynamics/contact_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/parallel_tasks.h"
#include "common/dynamics/pair_loop.h"

namespace softgrain {

namespace {

/// Sections one after another; sums of multi-contact laws are made anew, because those of the last pass are scratch.
template <int D>
class Watcher {
 public:
  explicit Watcher(const System<D>& system) : s_(system) {}

  ContactWatch<D> watch() {
    for (const ContactSection& section : s_.contacts.sections)
      with_pairs<D>(s_, section, [&]<class Law>(const Law& law, const auto& source) {
        visit_pairs(
            source, reach_of(law), {section.begin, section.end},
            [&](std::size_t c, const auto& pair, const ContactGeometry<D>& g) {
              note_overlap(c, g, section.geometry);
              const ContactState<D> state = source.template state<Law::traits>(pair, c, g);
              note_energy(law, state);
              note_use(law, state, pair.i, pair.j);
            },
            [](std::size_t) {});
      });
    for (std::size_t u = 0; u < sums_.size(); ++u)
      if (sums_[u].square != 0.0) add_volume(form_[u]->equivalent_volume(sums_[u]), *form_[u]);
    auto& behind = out_.behind_planes;
    std::sort(behind.begin(), behind.end());
    behind.erase(std::unique(behind.begin(), behind.end()), behind.end());
    return out_;
  }

 private:
  void note_overlap(std::size_t c, const ContactGeometry<D>& g, Geometry geometry) {
    const auto& sphere = s_.particles.sphere;
    const double ri = sphere[static_cast<std::size_t>(s_.contacts.i[c])].r;
    const double rj = sphere[static_cast<std::size_t>(s_.contacts.j[c])].r;
    const double smaller = geometry == Geometry::sphere_sphere ? std::min(ri, rj) : ri;
    if (geometry == Geometry::sphere_plane && g.overlap > ri) out_.behind_planes.push_back(s_.contacts.i[c]);
    const double depth = g.overlap / smaller;
    if (depth <= out_.overlap || std::isnan(out_.overlap)) return;
    out_.overlap = depth;
    out_.i = s_.contacts.i[c];
    out_.j = s_.contacts.j[c];
  }

  /// The state carries no motion: what the law answers is elastic.
  template <class Law>
  void note_energy(const Law& law, const ContactState<D>& state) {
    if constexpr (Law::traits.stores_energy) {
      out_.stored += law.stored_energy(state.overlap, state.constants);
      if constexpr (Law::traits.has_tangential) {
        const ContactResponse<D> r = law.evaluate(state);
        if (r.tangential_stiffness > 0.0) out_.stored += 0.5 * norm2(r.tangential_force) / r.tangential_stiffness;
        if constexpr (Law::traits.has_rolling)
          if (r.rolling_stiffness > 0.0) out_.stored += 0.5 * norm2(r.rolling_moment) / r.rolling_stiffness;
      }
    } else {
      out_.energy_known = false;
    }
  }

  template <class Law>
  void note_use(const Law& law, const ContactState<D>& state, std::size_t i, std::size_t j) {
    if constexpr (Law::traits.is_multi_contact) {
      note_multi_contact(law, state, true, i);
      note_multi_contact(law, state, false, j);
    } else if constexpr (Law::traits.is_fitted) {
      out_.laws.add(state.overlap / (state.constants.a * law.range.end), law.range.beyond);
    }
  }

  template <class Law>
  void note_multi_contact(const Law& law, const ContactState<D>& state, bool of_i, std::size_t body) {
    if constexpr (!Law::traits.needs_particle_pass) {
      MultiContactSum<D> own;
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
  void add_volume(double volume, const MultiContactForm& form) {
    out_.laws.add(volume / form.pressure.range.end, form.pressure.range.beyond);
  }

  const System<D>& s_;
  ContactWatch<D> out_;
  std::vector<MultiContactSum<D>> sums_;       ///< per body; empty without multi-contact laws
  std::vector<const MultiContactForm*> form_;  ///< form of the law that serves each body
};

}  // namespace

std::string law_use_text(const LawUse& use) {
  if (use.beyond == 0) return "";
  const char* done = use.rejected > 0 ? "which the law does not allow" : use.clamped > 0 ? "clamped" : "extrapolated";
  return fmt::format(
      "{} of {} uses of fitted laws beyond what was measured, up to {:.2f} times the end of the range: {}", use.beyond,
      use.evaluations, use.max_range_ratio, done);
}

template <int D>
ContactWatch<D> watch_contacts(const System<D>& system) {
  return Watcher<D>(system).watch();
}

template ContactWatch<2> watch_contacts<2>(const System<2>&);
template ContactWatch<3> watch_contacts<3>(const System<3>&);

template <int D>
void ContactVirial<D>::find_across(const System<D>& s) {
  across_.clear();
  std::size_t most = 0;
  for (std::size_t k = 0; k < s.contacts.sections.size(); ++k) {
    Across across{k, {}};
    for (std::int32_t c = s.contacts.sections[k].begin; c < s.contacts.sections[k].end; ++c)
      if (s.contacts.image[static_cast<std::size_t>(c)] != home_image<D>()) across.pairs.add(s.contacts, c);
    most = std::max(most, across.pairs.place.size());
    if (!across.pairs.place.empty()) across_.push_back(std::move(across));
  }
  forces_.resize(most);
  build_ = s.contacts.build;
}

template <int D>
Vec<D> ContactVirial<D>::of(System<D>& s) {
  const auto& p = s.particles;
  Vec<D> sum{};
  for (std::size_t u = 0; u < p.sphere.size(); ++u)
    for (int k = 0; k < D; ++k) sum[k] += p.force[u][k] * p.sphere[u].x[k];
  if (!s.cell.any_periodic()) return sum;
  if (build_ != s.contacts.build) find_across(s);
  for (Across& a : across_) {
    const std::size_t many = a.pairs.place.size();
    a.pairs.copy_histories(s.contacts);
    std::fill_n(forces_.begin(), many, Stored<D>{});
    in_pieces(many, [&](std::size_t begin, std::size_t end) {
      block_loop<D>(s, s.contacts.sections[a.section],
                    {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)},
                    {.dt = 0.0, .history = History::none, .foreign = &a.pairs, .forces = forces_.data()});
    });
    for (std::size_t n = 0; n < many; ++n) {
      const Vec<D> shift = s.cell.image_shift(a.pairs.image[n]);
      for (int k = 0; k < D; ++k) sum[k] -= forces_[n][k] * shift[k];
    }
    s.cost.contact_evaluations += static_cast<std::int64_t>(many);
  }
  return sum;
}

template class ContactVirial<2>;
template class ContactVirial<3>;

}  // namespace softgrain
