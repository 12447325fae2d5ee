// What runs leave in their directories, by name, so that a new run begins with none of it.
#pragma once

#include <string>
#include <vector>

namespace softgrain {

/// Removes what an earlier run left in a directory, so that nothing there looks like a result of the new one: results
/// and checkpoints, by the names that runs give them, and never `inputs` of the new run (with law.h5 beside law.toml,
/// and its like). Throws InputError, and removes nothing, where that would cost what somebody may still want: the
/// directory was never one of a run (no log.txt of this program); `command` reads an input from there and would not
/// write anew what lies beside it; or it only compares.
void remove_earlier_run(const std::string& directory, const std::string& command,
                        const std::vector<std::string>& inputs);

}  // namespace softgrain
