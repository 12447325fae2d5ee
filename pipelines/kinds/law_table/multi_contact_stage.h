// The measuring part of a law table: packings, pilot, and runs of every configuration in parallel until the means are
// known well enough. What is finished is kept, for --resume and for --law-cache.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/data/multi_contact_measurements.h"
#include "pipelines/kinds/law_table/multi_contact_scene.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// A level of a hierarchy whose soft particles hold soft particles; or another series of the same run, with a file of
/// its own.
struct MultiContactLevel {
  std::function<SoftContent(const ShellPacking&, std::int64_t packing)>
      fill;  ///< the content that is made of a packing of grains alone; empty: that packing
  InnerLaws laws;
  std::string tag;                       ///< all that decides `fill` and `laws`, for the cache
  std::string file = kMultiContactFile;  ///< name of the file in the run directory
};

/// Measures and saves DIR/multi_contact.h5 (or the file of the level). All configurations use the packings 0, 1, ... of
/// one pool of setup.packings_max; soft neighbour number k of packing p holds packing (p + 1 + k) mod packings_max.
/// Recorded overlaps follow from a pilot of three packings and are the same for all of them. Batches of packings are
/// added to a configuration until its target is met. Results do not depend on the number of threads. `left_out` gets a
/// sentence for each run that broke off (a grain was squeezed out of its shell...). `known`: packings 0, 1, ... that
/// are there already, of the same soft particle and seed, and in the end the whole pool. Throws UnusableResult when
/// more than half of a configuration's packings broke off, Interrupted.
MultiContactMeasurements run_multi_contact_stage(const MultiContactSetup& setup, const Run& run,
                                                 std::vector<std::string>& left_out, std::vector<ShellPacking>& known,
                                                 const MultiContactLevel* level = nullptr);

}  // namespace softgrain
