// Which body of a contact is a soft particle under a law.
#pragma once

#include <variant>

#include "common/contact/law_set.h"

namespace softgrain {

struct SoftSides {
  bool i = false;
  bool j = false;
};

/// Of laws between grains neither is.
inline SoftSides soft_sides(const AnyLaw& any) {
  return std::visit(
      [](const auto& law) -> SoftSides {
        if constexpr (requires { law.partner_is_soft; })
          return {law.partner_is_soft || law.i_is_soft, law.partner_is_soft || !law.i_is_soft};
        else if constexpr (requires { law.j_is_soft; })
          return {law.i_is_soft, law.j_is_soft};
        else
          return {};
      },
      any);
}

/// Whether a law knows of the other contacts of a soft particle, or is of a table whose other forms do.
inline bool is_table_law(const AnyLaw& any) {
  return std::visit(
      [](const auto& law) {
        return requires { law.form; };
      },
      any);
}

}  // namespace softgrain
