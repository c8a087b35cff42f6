#pragma once
// What the server does, whatever the protocol: both fronts (HTTP, gRPC) turn a request into one call of this class and its
// Answer into a response. Thread-safe; calls block on the disk.
//
// Promises: a blob is stored and returned only when its bytes hash to its name. An action of an instance that is not opaque
// is a hit only when it is an ActionResult and every blob that it names is there (which renews them). A caller reads and
// writes only what its roles allow, in the instance that it names; writes never reach a parent. The first whole value of an
// action stays: other bytes written later are dropped and counted as a conflict, unless the instance says `replace` or the
// caller is its admin. An action that is no hit any more (damaged, or a blob gone) may be written anew by anyone who may
// write.

#include <array>
#include <functional>
#include <mutex>
#include <optional>

#include "cache/protocol/blob_name.h"
#include "cache/server/access.h"
#include "cache/server/answer.h"
#include "cache/server/blob_file.h"
#include "cache/server/counters.h"
#include "cache/server/instances.h"
#include "cache/server/mishaps.h"

namespace kiln {

// What an ActionResult needs to be of use.
struct ActionNeeds {
    std::vector<BlobName> blobs;
    std::vector<BlobName> trees;  // blobs that are Trees, whose files are needed as well
};

// How the service reads protocol messages without knowing protobuf; nullopt: not such a message. Without a reader every
// action is taken as opaque.
struct ActionReader {
    std::function<std::optional<ActionNeeds>(ByteView)> action;
    std::function<std::optional<std::vector<BlobName>>(ByteView)> tree;
};

struct ServiceLimits {
    uint64_t blob = uint64_t{256} << 20;          // bytes of one blob
    uint64_t action = uint64_t{4} << 20;          // bytes of one action record
    uint64_t opaque_action = uint64_t{64} << 20;  // of an instance whose actions are opaque
    uint64_t in_flight = uint64_t{512} << 20;     // bytes of request bodies held at once, and as many of responses
};

enum class Written {
    now,            // it was not there
    already_there,  // with the same bytes
    replaced,       // other bytes were there
    kept_first,     // other bytes are there and stay
};

class Service {
public:
    // `store` outlives the service, which hears of its damage; one service a store.
    Service(DiskStore& store, Instances instances, ServiceLimits limits, ActionReader reader, int64_t verify_again_after = 600);

    ~Service() { store_.on_damage = nullptr; }
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    const ServiceLimits& limits() const { return limits_; }
    const Instances& instances() const { return instances_; }
    DiskStore& store() { return store_; }
    Counters& counters() { return counters_; }
    // Called for what an operator should see: conflicts, damage, failures of the disk. Set before the first request.
    std::function<void(const Event&)> on_event;

    // From here on this service hurts its callers. Before the first request, after on_event.
    void hurt(const Chaos& chaos, std::string_view as_text);
    const Mishaps& mishaps() const { return mishaps_; }

    // The instance, or unknown_instance; `role` is checked as well: forbidden for a known caller, else unauthenticated. A
    // caller without any role in an instance is not told whether it exists.
    Answer<Instance> enter(const Caller& caller, std::string_view instance, Role role);

    // nullopt: absent. With `slow`: sets it, answers nullopt and counts nothing where a large file must be hashed first.
    Answer<std::optional<BlobFile>> blob(const Caller& caller, std::string_view instance, const Digest& key,
                                         bool* slow = nullptr);
    // Reads of many blobs by one caller: checked once, counted once, when this object ends.
    class BlobReads {
    public:
        BlobReads(BlobReads&& other) noexcept;
        ~BlobReads();
        // As blob(); `moment` as BlobReader::open() has it.
        Answer<std::optional<BlobFile>> open(const Digest& key, bool* slow = nullptr, uint64_t moment = BlobReader::moment);

    private:
        friend class Service;
        BlobReads(Service& service, const Caller& caller, Instance instance);
        Service* service_;
        const Caller* caller_;
        Instance instance_;
        Counts counts_;
    };
    // `caller` outlives it.
    Answer<BlobReads> reads(const Caller& caller, std::string_view instance);
    Answer<bool> has_blob(const Caller& caller, std::string_view instance, const BlobName& blob);
    // The same of its bytes: a blob that was damaged on the disk is not there.
    Answer<bool> has_whole_blob(const Caller& caller, std::string_view instance, const BlobName& blob);
    // `size`: what the client says it is, checked against the bytes.
    Answer<Written> put_blob(const Caller& caller, std::string_view instance, const BlobName& blob, ByteView bytes);

    Answer<std::optional<Bytes>> action(const Caller& caller, std::string_view instance, const Digest& key);
    Answer<Written> put_action(const Caller& caller, std::string_view instance, const Digest& key, ByteView bytes);

    // Files of the WebDAV surface: opaque, last write wins, an instance's own, under a name that only hashing ever sees.
    Answer<std::optional<Bytes>> file(const Caller& caller, std::string_view instance, std::string_view path);
    Answer<Written> put_file(const Caller& caller, std::string_view instance, std::string_view path, ByteView bytes);

    // A share of the memory for bodies, given back when it is destroyed.
    class Lease {
    public:
        Lease() = default;
        Lease(Lease&& other) noexcept : held_(std::exchange(other.held_, nullptr)), bytes_(other.bytes_) {}
        Lease& operator=(Lease&& other) noexcept {
            std::swap(held_, other.held_);
            std::swap(bytes_, other.bytes_);
            return *this;
        }
        ~Lease() {
            if (held_ != nullptr) *held_ -= bytes_;
        }

        // Both shares as one; they are of the same kind.
        void join(Lease&& other) {
            if (held_ == nullptr) held_ = other.held_;
            bytes_ += std::exchange(other.bytes_, 0);
            other.held_ = nullptr;
        }

    private:
        friend class Service;
        std::atomic<uint64_t>* held_ = nullptr;
        uint64_t bytes_ = 0;
    };
    // `busy` when there is no room for so much at present, `too_large` when there never is.
    Answer<Lease> lease(uint64_t bytes) { return lease(bytes, in_flight_); }
    // The same for a response, whose reader may be slow: out of a share of its own, so that readers do not keep writers out.
    Answer<Lease> lease_response(uint64_t bytes) { return lease(bytes, answering_); }
    uint64_t in_flight() const { return in_flight_; }
    uint64_t answering() const { return answering_; }
    uint64_t hashed() const { return reader_of_blobs_.hashed(); }

    // A refusal that a front made by itself (a malformed request, a failed TLS handshake), counted with the others.
    Refused refuse(std::string_view instance, const Caller& caller, Refusal why, std::string message);

private:
    struct Found {
        std::optional<Bytes> bytes;
        bool incomplete = false;
    };
    Answer<Lease> lease(uint64_t bytes, std::atomic<uint64_t>& of);
    void tell(Event event);
    Refused mishap(const Instance& instance, const Caller& caller);
    Refused failure(const Instance& instance, const Caller& caller, const Error& error);
    Result<Found> own_action(const Instance& instance, const std::string& name, const Digest& key);
    Result<bool> complete(ByteView action);
    Answer<Written> store_action(const Caller& caller, const Instance& instance, const Digest& name, ByteView bytes,
                                 const std::optional<Bytes>& there, bool replace);
    std::mutex& stripe(const Digest& name) { return stripes_[name.bytes[0] % stripes_.size()]; }

    DiskStore& store_;
    const Instances instances_;
    const ServiceLimits limits_;
    const ActionReader reader_;
    BlobReader reader_of_blobs_;
    Counters counters_;
    Mishaps mishaps_;
    std::atomic<uint64_t> in_flight_{0}, answering_{0};
    std::array<std::mutex, 64> stripes_;  // one writer of an action at a time: the first is the first
};

}  // namespace kiln
