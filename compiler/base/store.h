#pragma once
// The seam to the cache. Two keyspaces: an *action* is a small record named by the hash of what was asked; a *blob* is
// named by the SHA-256 of its own bytes and verified by whoever keeps it. Found, absent and failed are three outcomes.

#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "compiler/base/bytes.h"
#include "compiler/base/digest.h"
#include "compiler/base/result.h"

namespace kiln {

enum class Keyspace : uint8_t { action = 0, blob = 1 };  // names folders on disk: append only

// Safe to call from several threads.
class Store {
public:
    virtual ~Store() = default;
    // An Error is a failure of the store (disk, network); a corrupt entry counts as absent.
    virtual Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) = 0;
    // A blob whose bytes do not hash to `key` is refused with an Error.
    virtual Status put(Keyspace space, const Digest& key, ByteView bytes) = 0;
    // An action record that is of use only together with `blobs`, each of which was put or found before.
    virtual Status put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) {
        static_cast<void>(blobs);
        return put(Keyspace::action, key, record);
    }
    // These actions will be asked for next, and then the blobs that they name: a store far away fetches them in one go.
    virtual void expect(std::span<const Digest> actions) { static_cast<void>(actions); }
    // False: nothing that is put here is ever found, so naming and packing it is work for nothing.
    virtual bool keeps() const { return true; }
};

// The store of a build that was told to use none.
class NoStore final : public Store {
public:
    Result<std::optional<Bytes>> get(Keyspace, const Digest&) override { return std::optional<Bytes>(); }
    Status put(Keyspace, const Digest&, ByteView) override { return {}; }
    bool keeps() const override { return false; }
};

// Keeps everything in memory: the fake for tests.
class MemoryStore final : public Store {
public:
    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override;
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;
    size_t size() const;

private:
    mutable std::mutex mutex_;
    std::map<std::pair<Keyspace, Digest>, Bytes> entries_;
};

}  // namespace kiln
