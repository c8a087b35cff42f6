#pragma once
// The service's view of the Remote Execution API's ActionResult and Tree.

#include "cache/server/service.h"

namespace kiln {

ActionReader reapi_reader();

}  // namespace kiln
