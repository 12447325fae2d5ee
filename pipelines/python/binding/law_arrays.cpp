#include "pipelines/python/binding/law_arrays.h"

#include "pipelines/python/binding/wide.h"

namespace softgrain::python {

namespace {

/// Overlaps of neighbour k in the states from `begin` on; 0 in states that are not there.
Wide column(std::span<const double> overlap, std::size_t neighbours, std::size_t k, std::size_t begin,
            std::size_t states) {
  return Wide([&](auto lane) {
    const std::size_t state = begin + lane;
    return state < states ? overlap[state * neighbours + k] : 0.0;
  });
}

template <class Law>
class MultiContactPass {
 public:
  MultiContactPass(const law::MultiContactContacts<Law>& contacts,
                   const std::vector<law::MultiContactNeighbour>& around, LawOutput what, std::size_t first,
                   std::size_t last)
      : contacts_(contacts), around_(around), what_(what), first_(first), last_(last) {}

  /// States begin .. end - 1.
  void run(std::span<const double> overlap, std::span<double> out, std::size_t begin, std::size_t end) const {
    const std::size_t states = overlap.size() / around_.size();
    const std::size_t columns = last_ - first_;
    std::vector<Wide> deep(around_.size());
    for (std::size_t at = begin; at < end; at += kWide) {
      for (std::size_t k = 0; k < around_.size(); ++k) deep[k] = column(overlap, around_.size(), k, at, states);
      const law::MultiContactMiddle<Law, Wide> middle(contacts_, around_, deep);
      for (std::size_t k = first_; k < last_; ++k) {
        const Wide y = answer(middle, k);
        for (std::size_t lane = 0; lane < kWide && at + lane < end; ++lane)
          out[(at + lane) * columns + (k - first_)] = y[lane];
      }
    }
  }

 private:
  [[nodiscard]] Wide answer(const law::MultiContactMiddle<Law, Wide>& middle, std::size_t k) const {
    if (what_ == LawOutput::volume) return middle.volume();
    const ContactResponse<3, Wide> response = middle.response(k);
    if (what_ == LawOutput::tangential) return contacts_.with(around_[k].kind).kt_ratio * response.normal_stiffness;
    return what_ == LawOutput::force ? response.elastic_force : response.normal_stiffness;
  }

  const law::MultiContactContacts<Law>& contacts_;
  const std::vector<law::MultiContactNeighbour>& around_;
  LawOutput what_;
  std::size_t first_;
  std::size_t last_;
};

}  // namespace

void card_array(const SoftContact& contact, LawOutput what, std::span<const double> delta, std::span<double> out) {
  const Wide one(1.0);
  const auto fill = [&](const auto& answer) {
    in_stretches(delta.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t at = begin; at < end; at += kWide) store(answer(load(delta, at)), out, at);
    });
  };
  // What is not asked for is not worked out.
  if (what == LawOutput::force)
    return fill([&](const Wide& overlap) {
      const Wide ratio = contact.taken_ratio<Wide>(overlap, one);
      return choose<Wide>(contact.idle_at(ratio), 0.0, contact.elastic_at<Wide>(ratio, one).force);
    });
  if (what == LawOutput::stiffness)
    return fill([&](const Wide& overlap) {
      const Wide ratio = contact.taken_ratio<Wide>(overlap, one);
      return choose<Wide>(contact.idle_at(ratio) || contact.is_clamped(overlap, one), 0.0,
                          contact.elastic_at<Wide>(ratio, one).stiffness);
    });
  fill([&](const Wide& overlap) {
    ContactState<3, Wide> state;
    state.normal[0] = one;
    state.constants.a = one;
    state.overlap = overlap;
    return contact.evaluate(state).tangential_stiffness;
  });
}

void multi_contact_array(const MultiContactLaws& laws, const std::vector<law::MultiContactNeighbour>& around,
                         LawOutput what, int which, std::span<const double> overlap, std::span<double> out) {
  const std::size_t first = which < 0 ? 0 : static_cast<std::size_t>(which);
  const std::size_t last = which < 0 ? around.size() : first + 1;
  law::with_multi_contact_contacts(laws, [&]<class Law>(const law::MultiContactContacts<Law>& contacts) {
    if constexpr (!Law::traits.memory_in_sums &&
                  !Law::traits.has_rolling) {  // as make_multi_contact_laws() was asked for
      const MultiContactPass<Law> pass(contacts, around, what, first, last);
      in_stretches(overlap.size() / around.size(),
                   [&](std::size_t begin, std::size_t end) { pass.run(overlap, out, begin, end); });
    }
  });
}

}  // namespace softgrain::python
