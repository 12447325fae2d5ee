#include "common/dynamics/contact_virial.h"

#include <algorithm>
#include <utility>

namespace softgrain {

template <int D>
void ContactVirial<D>::find_across(const System<D>& s) {
  across_.clear();
  std::size_t most = 0;
  for (std::size_t k = 0; k < s.contacts.sections.size(); ++k) {
    Across across{k, {}};
    for (std::int32_t c = s.contacts.sections[k].begin; c < s.contacts.sections[k].end; ++c)
      if (s.contacts.image[static_cast<std::size_t>(c)] != home_image<D>()) across.places.push_back(c);
    most = std::max(most, across.places.size());
    if (!across.places.empty()) across_.push_back(std::move(across));
  }
  loads_.resize(most);
  rolls_.resize(most);
  touches_.resize(most);
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
  for (const Across& a : across_) {
    const PairRange range{0, static_cast<std::int32_t>(a.places.size()), a.places.data()};
    block_loop<D>(s, s.contacts.sections[a.section], range,
                  {.dt = 0.0,
                   .history = History::none,
                   .loads = loads_.data(),
                   .rolls = rolls_.data(),
                   .touches = touches_.data()});
    for (std::size_t n = 0; n < a.places.size(); ++n) {
      if (touches_[n] == 0) continue;
      const Vec<D> shift = s.cell.image_shift(s.contacts.image[static_cast<std::size_t>(a.places[n])]);
      for (int k = 0; k < D; ++k) sum[k] -= loads_[n].force[k] * shift[k];
    }
    s.cost.contact_evaluations += static_cast<std::int64_t>(a.places.size());
  }
  return sum;
}

template class ContactVirial<2>;
template class ContactVirial<3>;

}  // namespace softgrain
