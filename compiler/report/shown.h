#pragma once
// Pictures for people: PNG of a picture as its reference is exposed, and of where it is wrong.

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"
#include "compiler/report/picture.h"

namespace kiln::report {

// sRGB, exposed so that 98 % of the reference's numbers fit; magenta where a number is not finite.
Result<Bytes> shown(const Picture& x, const Picture& reference);

// log10 of the relative error of a pixel (as maxRel) from 1e-7 (dark) to 1 (bright); magenta where not finite.
Result<Bytes> error_map(const Picture& x, const Picture& reference);

}  // namespace kiln::report
