#include "common/neighbours/list_watch.h"

#include "common/neighbours/skin.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

template <int D>
void ListWatch<D>::require_list(System<D>& s) {
  constexpr double kTrusted = 0.999;  // the rest covers rounding of the sums of bounds
  if (build_ != 0 && build_ == s.contacts.build && used_ < kTrusted) return;
  used_ = skin_used(s);
  if (!(used_ <= 1.0)) {
    rebuild_neighbours(s);
    used_ = 0.0;
  }
  build_ = s.contacts.build;
}

template class ListWatch<2>;
template class ListWatch<3>;

}  // namespace softgrain
