// Headers of LAMMPS name fmt::make_args_checked, which fmt 9 has no longer. First on the include path of what includes
// those headers; nothing calls it.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include_next <fmt/format.h>
#include <type_traits>

#if FMT_VERSION >= 90000
namespace fmt {

template <typename... Args, typename S>
auto make_args_checked(const S&, const std::remove_reference_t<Args>&... args) {
  return fmt::make_format_args(args...);
}

}  // namespace fmt
#endif
