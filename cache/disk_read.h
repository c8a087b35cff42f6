#pragma once
// One entry as it was found on disk.

#include "cache/disk_store.h"

namespace kiln {

struct DiskStore::Reading {
    enum class Is { whole, absent, damaged, failed } is = Is::absent;
    Bytes file;          // of a whole one, frame and all
    std::string reason;  // damaged
    Error error;         // failed
};

}  // namespace kiln
