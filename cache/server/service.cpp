// Every operation: enter the instance with the role it takes, ask the store, count. What is refused is counted in refuse() or
// failure() and nowhere else.
#include "cache/server/service.h"

#include <cerrno>
#include <cstring>
#include <ctime>

namespace kiln {

namespace {

// The store's errors are for a person; this asks the one thing that a client's next step depends on.
bool is_full(const Error& error) {
    for (const int code : {ENOSPC, EDQUOT})
        if (error.message.find(std::strerror(code)) != std::string::npos) return true;
    return error.message.find("does not fit") != std::string::npos;
}

// One change of one counter.
template <class Member>
Counts one(Member member, uint64_t amount = 1) {
    Counts counts;
    counts.*member = amount;
    return counts;
}

bool same_bytes(ByteView a, ByteView b) { return as_text(a) == as_text(b); }

Digest file_name(std::string_view instance, std::string_view path) {
    return KeyHasher("kiln.cached.file.v1").field("instance", instance).field("path", path).finish();
}

}  // namespace

Service::Service(DiskStore& store, Instances instances, ServiceLimits limits, ActionReader reader, int64_t verify_again_after)
    : store_(store),
      instances_(std::move(instances)),
      limits_(limits),
      reader_(std::move(reader)),
      reader_of_blobs_(store, verify_again_after) {
    store_.on_damage = [this](const DiskStore::Damage& damage) {
        const std::string where = damage.kept.empty() ? "it could not be moved" : "it is now " + damage.kept;
        tell({std::time(nullptr), "damage", "", "", damage.path + ": " + damage.reason + "; " + where});
    };
}

void Service::tell(Event event) {
    if (on_event) on_event(event);
    counters_.event(std::move(event));
}

void Service::hurt(const Chaos& chaos, std::string_view as_text) {
    mishaps_.begin(chaos);
    tell({std::time(nullptr), "chaos", "", "",
          "this server loses, fails, delays and alters what it is asked, on purpose: " + std::string(as_text)});
}

Refused Service::mishap(const Instance& instance, const Caller& caller) {
    return refuse(instance.name, caller, Refusal::failed, "chaos: this call was to fail");
}

Refused Service::refuse(std::string_view instance, const Caller& caller, Refusal why, std::string message) {
    Counts counts;
    counts.refused[static_cast<size_t>(why)] = 1;
    // A name that is no instance's is not counted under itself.
    counters_.add(why == Refusal::unknown_instance || why == Refusal::unauthenticated ? std::string() : std::string(instance),
                  counts);
    if (why == Refusal::failed || why == Refusal::full)
        tell({std::time(nullptr), name_of(why), std::string(instance), caller.name(), message});
    return {why, std::move(message)};
}

Refused Service::failure(const Instance& instance, const Caller& caller, const Error& error) {
    // The store's message names paths of the server: it goes to the operator, not to the client.
    const Refusal why = is_full(error) ? Refusal::full : Refusal::failed;
    const Refused told = refuse(instance.name, caller, why, error.message);
    return {told.why, why == Refusal::full ? "the cache's disk is full" : "the cache's disk failed"};
}

Answer<Instance> Service::enter(const Caller& caller, std::string_view name, Role role) {
    const Roles roles = caller.roles(name);
    auto instance = instances_.find(name);
    if (roles.has(role)) {
        if (instance) return std::move(*instance);
        return refuse(name, caller, Refusal::unknown_instance, "no such instance");
    }
    const std::string in = instance && !name.empty() ? std::string(name) : std::string();
    if (!caller.known()) return refuse(in, caller, Refusal::unauthenticated, "a token is needed for this");
    return refuse(in, caller, Refusal::forbidden, "the token's roles do not allow this");
}

Service::BlobReads::BlobReads(Service& service, const Caller& caller, Instance instance)
    : service_(&service), caller_(&caller), instance_(std::move(instance)) {}

Service::BlobReads::BlobReads(BlobReads&& other) noexcept
    : service_(std::exchange(other.service_, nullptr)),
      caller_(other.caller_),
      instance_(std::move(other.instance_)),
      counts_(other.counts_) {}

Service::BlobReads::~BlobReads() {
    if (service_ != nullptr && counts_.blob_hits + counts_.blob_misses != 0) service_->counters_.add(instance_.name, counts_);
}

Answer<std::optional<BlobFile>> Service::BlobReads::open(const Digest& key, bool* slow, uint64_t moment) {
    using Fate = Mishaps::Fate;
    constexpr auto call = Mishaps::Call::get_blob;
    Mishaps& mishaps = service_->mishaps_;
    if (mishaps.on() && slow != nullptr) {  // what is delayed holds no I/O thread up
        *slow = true;
        return std::optional<BlobFile>();
    }
    const Fate fate = mishaps.meet(call, key);
    if (fate == Fate::fails) return service_->mishap(instance_, *caller_);
    if (fate == Fate::is_lost) {
        ++counts_.blob_misses;
        return std::optional<BlobFile>();
    }
    if (fate == Fate::flips_on_disk) mishaps.flip_file(call, key, service_->store_.path_of(Keyspace::blob, key));
    auto file = service_->reader_of_blobs_.open(key, slow, moment);
    if (!file.ok()) return service_->failure(instance_, *caller_, file.error());
    if (slow != nullptr && *slow) return std::optional<BlobFile>();
    ++(file->has_value() ? counts_.blob_hits : counts_.blob_misses);
    if (file->has_value()) counts_.blob_bytes_out += (*file)->size();
    if (fate == Fate::flips_answer && file->has_value()) {
        auto bytes = (*file)->all();
        if (!bytes.ok()) return service_->failure(instance_, *caller_, bytes.error());
        mishaps.flip_answer(call, key, *bytes);
        return std::optional(BlobFile::of(std::move(*bytes)));
    }
    return std::move(*file);
}

Answer<Service::BlobReads> Service::reads(const Caller& caller, std::string_view name) {
    auto instance = enter(caller, name, Role::read);
    if (!instance.ok()) return instance.refused();
    return BlobReads(*this, caller, std::move(*instance));
}

Answer<std::optional<BlobFile>> Service::blob(const Caller& caller, std::string_view name, const Digest& key, bool* slow) {
    auto some = reads(caller, name);
    if (!some.ok()) return some.refused();
    return some->open(key, slow);
}

Answer<bool> Service::has_blob(const Caller& caller, std::string_view name, const BlobName& blob) {
    auto instance = enter(caller, name, Role::read);
    if (!instance.ok()) return instance.refused();
    const Mishaps::Fate fate = mishaps_.meet(Mishaps::Call::find_blob, blob.digest);
    if (fate == Mishaps::Fate::fails) return mishap(*instance, caller);
    if (fate == Mishaps::Fate::is_lost) return false;
    const auto found = reader_of_blobs_.has(blob.digest, blob.size);
    if (!found.ok()) return failure(*instance, caller, found.error());
    return *found;
}

Answer<bool> Service::has_whole_blob(const Caller& caller, std::string_view name, const BlobName& blob) {
    auto instance = enter(caller, name, Role::read);
    if (!instance.ok()) return instance.refused();
    const auto found = reader_of_blobs_.open(blob.digest);
    if (!found.ok()) return failure(*instance, caller, found.error());
    return found->has_value() && (*found)->size() == blob.size;
}

Answer<Written> Service::put_blob(const Caller& caller, std::string_view name, const BlobName& blob, ByteView bytes) {
    auto instance = enter(caller, name, Role::cas_write);
    if (!instance.ok()) return instance.refused();
    if (bytes.size() > limits_.blob) return refuse(name, caller, Refusal::too_large, "the blob is larger than the server takes");
    const auto hashed = bytes.size() == blob.size ? HashedBlob::of(blob.digest, bytes) : std::nullopt;
    if (!hashed) {
        counters_.add(instance->name, one(&Counts::mismatches));
        return refuse(name, caller, Refusal::bad_request, "the bytes do not match the digest");
    }
    const Mishaps::Fate fate = mishaps_.meet(Mishaps::Call::put_blob, blob.digest);
    if (fate == Mishaps::Fate::fails) return mishap(*instance, caller);
    if (fate == Mishaps::Fate::is_lost) return Written::now;
    const auto present = reader_of_blobs_.open(blob.digest);
    if (!present.ok()) return failure(*instance, caller, present.error());
    const bool there = present->has_value();
    if (!there) {
        const Status kept = store_.put(*hashed);
        if (!kept.ok()) return failure(*instance, caller, kept.error());
    }
    Counts counts = one(there ? &Counts::blobs_already_there : &Counts::blobs_written);
    counts.blob_bytes_in = bytes.size();
    counters_.add(instance->name, counts);
    return there ? Written::already_there : Written::now;
}

Result<bool> Service::complete(ByteView action) {
    const auto needs = reader_.action(action);
    if (!needs) return false;
    for (const BlobName& blob : needs->blobs) {
        const auto found = reader_of_blobs_.has(blob.digest, blob.size);
        if (!found.ok() || !*found) return found;
    }
    for (const BlobName& blob : needs->trees) {
        const auto file = reader_of_blobs_.open(blob.digest);
        if (!file.ok()) return file.error();
        if (!file->has_value() || (*file)->size() != blob.size) return false;
        const auto bytes = (*file)->all();
        KILN_TRY(bytes);
        const auto below = reader_.tree(*bytes);
        if (!below) return false;
        for (const BlobName& inner : *below) {
            const auto found = reader_of_blobs_.has(inner.digest, inner.size);
            if (!found.ok() || !*found) return found;
        }
    }
    return true;
}

// The record under `name`'s own key, no parent asked; nothing when it is there and of no use.
Result<Service::Found> Service::own_action(const Instance& instance, const std::string& name, const Digest& key) {
    auto got = store_.get(Keyspace::action, action_name(name, key));
    if (!got.ok()) return got.error();
    Found found{std::move(*got), false};
    if (!found.bytes || instance.opaque || !reader_.action) return found;
    const auto whole = complete(*found.bytes);
    KILN_TRY(whole);
    if (*whole) return found;
    return Found{std::nullopt, true};
}

Answer<std::optional<Bytes>> Service::action(const Caller& caller, std::string_view name, const Digest& key) {
    auto instance = enter(caller, name, Role::read);
    if (!instance.ok()) return instance.refused();
    constexpr auto call = Mishaps::Call::get_action;
    const Mishaps::Fate fate = mishaps_.meet(call, key);
    if (fate == Mishaps::Fate::fails) return mishap(*instance, caller);
    if (fate == Mishaps::Fate::is_lost) return std::optional<Bytes>();
    if (fate == Mishaps::Fate::flips_on_disk)
        mishaps_.flip_file(call, key, store_.path_of(Keyspace::action, action_name(instance->name, key)));
    Counts counts;
    // The most trusted first: what a pull request has written can then not hide what main has.
    std::vector<std::string> order(instance->parents.rbegin(), instance->parents.rend());
    order.push_back(instance->name);
    std::optional<Bytes> hit;
    for (const std::string& from : order) {
        auto found = own_action(*instance, from, key);
        if (!found.ok()) return failure(*instance, caller, found.error());
        counts.actions_incomplete |= found->incomplete ? 1u : 0u;
        if (!found->bytes) continue;
        hit = std::move(found->bytes);
        counts.actions_incomplete = 0;
        break;
    }
    (hit ? counts.action_hits : counts.action_misses) = 1;
    counters_.add(instance->name, counts);
    if (fate == Mishaps::Fate::flips_answer && hit) mishaps_.flip_answer(call, key, *hit);
    return hit;
}

Answer<Written> Service::put_action(const Caller& caller, std::string_view name, const Digest& key, ByteView bytes) {
    auto instance = enter(caller, name, Role::ac_write);
    if (!instance.ok()) return instance.refused();
    if (bytes.size() > (instance->opaque ? limits_.opaque_action : limits_.action))
        return refuse(name, caller, Refusal::too_large, "the action record is larger than the server takes");
    if (!instance->opaque && reader_.action && (bytes.empty() || !reader_.action(bytes)))
        return refuse(name, caller, Refusal::bad_request, "the body is not an ActionResult that the server takes");
    const Mishaps::Fate fate = mishaps_.meet(Mishaps::Call::put_action, key);
    if (fate == Mishaps::Fate::fails) return mishap(*instance, caller);
    if (fate == Mishaps::Fate::is_lost) return Written::now;
    const Digest own = action_name(instance->name, key);
    const std::lock_guard lock(stripe(own));
    std::optional<Bytes> there;
    std::vector<std::string> order(instance->parents.rbegin(), instance->parents.rend());
    order.push_back(instance->name);
    for (const std::string& from : order) {
        auto found = own_action(*instance, from, key);
        if (!found.ok()) return failure(*instance, caller, found.error());
        if (!found->bytes) continue;
        there = std::move(found->bytes);
        break;
    }
    const bool replace = instance->replace || caller.may(Role::admin, instance->name);
    return store_action(caller, *instance, own, bytes, there, replace);
}

Answer<Written> Service::store_action(const Caller& caller, const Instance& instance, const Digest& name, ByteView bytes,
                                      const std::optional<Bytes>& there, bool replace) {
    if (there && same_bytes(*there, bytes)) {
        counters_.add(instance.name, one(&Counts::actions_already_there));
        return Written::already_there;
    }
    if (there && !replace) {
        counters_.add(instance.name, one(&Counts::conflicts));
        tell({std::time(nullptr), "conflict", instance.name, caller.name(),
              "another value for an action that has one; the first stays"});
        return Written::kept_first;
    }
    const Status kept = store_.put(Keyspace::action, name, bytes);
    if (!kept.ok()) return failure(instance, caller, kept.error());
    counters_.add(instance.name, one(there ? &Counts::actions_replaced : &Counts::actions_written));
    return there ? Written::replaced : Written::now;
}

Answer<std::optional<Bytes>> Service::file(const Caller& caller, std::string_view name, std::string_view path) {
    auto instance = enter(caller, name, Role::read);
    if (!instance.ok()) return instance.refused();
    std::vector<std::string> order(instance->parents.rbegin(), instance->parents.rend());
    order.push_back(instance->name);
    std::optional<Bytes> hit;
    for (const std::string& from : order) {
        auto got = store_.get(Keyspace::action, file_name(from, path));
        if (!got.ok()) return failure(*instance, caller, got.error());
        if (!got->has_value()) continue;
        hit = std::move(*got);
        break;
    }
    counters_.add(instance->name, one(hit ? &Counts::action_hits : &Counts::action_misses));
    return hit;
}

Answer<Written> Service::put_file(const Caller& caller, std::string_view name, std::string_view path, ByteView bytes) {
    auto instance = enter(caller, name, Role::ac_write);
    if (!instance.ok()) return instance.refused();
    if (bytes.size() > limits_.opaque_action)
        return refuse(name, caller, Refusal::too_large, "the file is larger than the server takes");
    const Digest own = file_name(instance->name, path);
    const std::lock_guard lock(stripe(own));
    auto there = store_.get(Keyspace::action, own);
    if (!there.ok()) return failure(*instance, caller, there.error());
    return store_action(caller, *instance, own, bytes, *there, true);
}

Answer<Service::Lease> Service::lease(uint64_t bytes, std::atomic<uint64_t>& of) {
    if (bytes > limits_.in_flight) return Refused{Refusal::too_large, "the body is larger than the server takes"};
    uint64_t held = of.load();
    do {
        if (held + bytes > limits_.in_flight) return Refused{Refusal::busy, "too many bodies in flight"};
    } while (!of.compare_exchange_weak(held, held + bytes));
    Lease lease;
    lease.held_ = &of;
    lease.bytes_ = bytes;
    return lease;
}

}  // namespace kiln
