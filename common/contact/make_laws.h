// From law cards and law tables to laws of the contact loop; and a law table as files, with the forces that these laws
// give.
#pragma once

#include <optional>
#include <string>

#include "common/contact/law_set.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/contact/soft_contact.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"

namespace softgrain {

/// The fitted law of `kind` for a material of Young's modulus `modulus` [Pa], Coulomb coefficient `friction` and
/// viscous damping `damping` (fraction of critical). Tangential stiffness from the initial slope, or from the secant at
/// 1 degree with `use_secant`; when only one of them was fitted, that one; when none was, the share of the normal
/// stiffness that assumed_kt_ratio() says. Throws InputError when the card has no usable
/// law of this kind
/// ("no threshold crossing", "not run") - an underdetermined law is accepted: it reproduces its data within its range.
/// `beyond` is what the law does above the range it was fitted in; empty: what the card says.
SoftContact make_soft_contact(const LawCard& card, PairKind kind, double modulus, double friction, double damping,
                              bool use_secant, std::optional<Extrapolation> beyond = std::nullopt);

/// The same with the unloading branch of the card, where it has one and `unloading` says so. The exponent of a branch
/// is no smaller than least_unloading_exponent(), which that of a drawn law may be.
CardLaw make_card_law(const LawCard& card, PairKind kind, double modulus, double friction, double damping,
                      bool use_secant, std::optional<Extrapolation> beyond, bool unloading);

/// A law of the table as the model that predicts with it.
MultiContactModel multi_contact_model(const MultiContactLaw& law);

/// What is not in the table.
struct MultiContactChoices {
  LawForm form = LawForm::directional;
  double modulus = 0.0;                   ///< E of what the soft particles hold [Pa]
  double friction = -1.0;                 ///< mu_soft; negative: as measured
  double wall_friction = -1.0;            ///< friction of grains with planes; negative: as among themselves
  bool unloading = false;                 ///< use the measured unloading branch
  double unloading_ratio = 1.0;           ///< slope of p(S) in unloading over that in loading: isotropic form alone
  bool rolling = true;                    ///< use rolling resistance, where it was measured
  std::optional<Extrapolation> beyond{};  ///< instead of what the table says
};

/// The laws of soft particles against solid grains in either order, against planes and shells, and among themselves.
struct MultiContactLaws {
  AnyLaw soft_plane;  ///< body i is the soft one: planes and the inside of a parent's shell
  AnyLaw soft_solid;  ///< body i is the soft one
  AnyLaw solid_soft;  ///< body j is the soft one
  AnyLaw soft_soft;
};

/// Throws InputError when the entry has no usable law of this form, or none for soft neighbours, and when an
/// unloading_ratio above 1 meets another form or the unloading branch.
MultiContactLaws make_multi_contact_laws(const LawTableEntry& entry, const MultiContactChoices& choices);

// A law table as files: a card for people (TOML) and, for programs, the forces it stands for on a grid (HDF5).

/// Writes `table.toml` and, beside it with extension .h5, parameters and forces on a grid of overlaps. Atomic. Throws
/// IoError.
void save_law_table(const LawTable& table, const std::string& toml_path,
                    const Provenance& provenance = build_provenance());

}  // namespace softgrain
