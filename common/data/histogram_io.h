// Histograms in HDF5 files.
#pragma once

#include "common/core/histogram.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// Attributes `low`, `high` (ends of the range), `below`, `above` (numbers of values outside) and the data set
/// `counts`.
void write_histogram(const h5::Group& group, const Histogram& histogram);

/// Adds the counts of `more`, which has the same bins.
void add_counts(Histogram& sum, const Histogram& more);

}  // namespace softgrain
