// The neighbour list: which pairs the loop looks at, when the list must be made anew, and how histories survive that.
#pragma once

#include "common/neighbours/skin.h"
#include "common/system.h"

namespace softgrain {

/// Makes the list valid for the positions as they are: rebuilds it when some body has moved its whole skin since the
/// last build. Called before every pass, so no pair is ever missed. Returns whether it was rebuilt. Throws
/// UnusableResult naming the body when a position is not finite or a grain is outside its shell.
template <int D>
bool update_neighbours(System<D>& system);

/// Rebuilds unconditionally: wraps periodic positions, searches pairs, sorts them by geometry, law and bodies, carries
/// histories.
template <int D>
void rebuild_neighbours(System<D>& system);

/// Completes a list of which pairs, images and sections have been restored from a file: constants of the laws, empty
/// histories, a new build number.
template <int D>
void adopt_list(System<D>& system);

}  // namespace softgrain
