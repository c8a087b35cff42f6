#include "compiler/base/store.h"

namespace kiln {

Result<std::optional<Bytes>> MemoryStore::get(Keyspace space, const Digest& key) {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find({space, key});
    if (found == entries_.end()) return std::optional<Bytes>();
    return std::optional<Bytes>(found->second);
}

Status MemoryStore::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (space == Keyspace::blob && sha256(bytes) != key) return environment_error("blob does not match its name");
    const std::lock_guard lock(mutex_);
    entries_[{space, key}] = Bytes(bytes.begin(), bytes.end());
    return {};
}

size_t MemoryStore::size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
}

}  // namespace kiln
