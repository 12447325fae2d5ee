// Commands whose files do not exist yet. Weak: the real function wins as soon as it is there; then its entry here goes.
#include "pipelines/run_context.h"

namespace softgrain {

__attribute__((weak)) ExitStatus command_check(const CommonOptions&) { throw BadInput("check: not available yet"); }

}  // namespace softgrain
