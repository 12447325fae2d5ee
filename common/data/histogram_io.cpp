#include "common/data/histogram_io.h"

namespace softgrain {

void write_histogram(const h5::Group& group, const Histogram& h) {
  group.attribute("low", h.low);
  group.attribute("high", h.high);
  group.attribute("below", h.below);
  group.attribute("above", h.above);
  group.write("counts", h.counts);
}

void add_counts(Histogram& sum, const Histogram& more) {
  for (std::size_t k = 0; k < sum.counts.size(); ++k) sum.counts[k] += more.counts[k];
  sum.below += more.below;
  sum.above += more.above;
}

}  // namespace softgrain
