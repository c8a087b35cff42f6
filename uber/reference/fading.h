#pragma once
// exp of what is never above 0.

#include "uber/reference/numbers.h"

namespace kiln::reference {

// exp(x) for x <= 0 by its making, such as -y^2. The clamp changes no value: it tells Bounded, which sees only how far off x
// may be, that the result stays in [0, 1].
template <class T>
T fading(const T& x) {
    return clamp(exp(x), T(0), T(1));
}

}  // namespace kiln::reference
