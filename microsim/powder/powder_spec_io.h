// What a powder is made of, to and from a group of a result file: a stored state needs its laws to be measured again.
#pragma once

#include "common/io/hdf5_file.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {

/// Every member of the specification as an attribute of `group`, by its name.
void write_powder_spec(const h5::Group& group, const PowderSpec& spec);

/// Throws FileTrouble when an attribute is missing.
PowderSpec read_powder_spec(const h5::Group& group);

}  // namespace softgrain
