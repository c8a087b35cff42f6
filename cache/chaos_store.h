#pragma once
// A store that hurts its user: entries vanish, calls fail or take long, bits flip. What is built through it must be what is
// built without it.

#include <atomic>
#include <functional>
#include <string>
#include <string_view>

#include "compiler/base/store.h"

namespace kiln {

struct Chaos {
    uint64_t seed = 0;
    double loss = 0;     // of 1: a get finds nothing, a put is not kept
    double error = 0;    // of 1: the call fails
    double flip = 0;     // of 1: a bit of the entry is flipped where it lies before it is read
    uint64_t delay = 0;  // milliseconds at most, a call

    // "seed=7,loss=0.1,error=0.05,flip=0.1,delay=3"; what is not named is 0.
    static Result<Chaos> parse(std::string_view text);
};

// Every decision follows from the seed, the call and the key, so that a run can be repeated whatever the threads do.
class ChaosStore final : public Store {
public:
    struct Counters {
        uint64_t lost = 0, failed = 0, flipped = 0, delayed = 0;
    };
    // Flips one of the entry's bits, chosen by `dice`, below the check of the store that keeps it; false when there was none.
    using Flip = std::function<bool(Keyspace space, const Digest& key, uint64_t dice)>;

    // `inner` outlives this object.
    ChaosStore(Store& inner, const Chaos& chaos, Flip flip) : inner_(inner), chaos_(chaos), flip_(std::move(flip)) {}

    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override;
    Status put(Keyspace space, const Digest& key, ByteView bytes) override;
    Status put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) override;
    void expect(std::span<const Digest> actions) override { inner_.expect(actions); }
    bool keeps() const override { return inner_.keeps(); }
    Counters counters() const { return {lost_.load(), failed_.load(), flipped_.load(), delayed_.load()}; }

private:
    std::optional<Status> meddle(Keyspace space, const Digest& key);

    Store& inner_;
    const Chaos chaos_;
    const Flip flip_;
    std::atomic<uint64_t> lost_{0}, failed_{0}, flipped_{0}, delayed_{0};
};

// Flips a bit of the file at `path` in place.
bool flip_bit(const std::string& path, uint64_t dice);

}  // namespace kiln
