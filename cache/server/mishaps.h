#pragma once
// A server that hurts its clients (--chaos), whatever the protocol: calls fail, take long, find nothing or keep nothing, a bit of
// an entry flips on the disk, below the server's check, or in the answer, behind it. Every decision follows from the seed, the
// call and the key. Without --chaos nothing here does anything.

#include <atomic>
#include <optional>

#include "cache/chaos_store.h"

namespace kiln {

class Mishaps {
public:
    enum class Call : uint8_t { get_blob, find_blob, put_blob, get_action, put_action };
    enum class Fate { none, fails, is_lost, flips_on_disk, flips_answer };

    // Before the first call.
    void begin(const Chaos& chaos) { chaos_ = chaos; }
    bool on() const { return chaos_.has_value(); }
    // Waits as long as this call is to take. Writes and questions whether a blob is there do not flip.
    Fate meet(Call call, const Digest& key);
    // Flips a bit of the file or of the answer, and counts it where there was one.
    void flip_file(Call call, const Digest& key, const std::string& path);
    void flip_answer(Call call, const Digest& key, std::span<uint8_t> bytes);
    ChaosStore::Counters counters() const { return {lost_.load(), failed_.load(), flipped_.load(), delayed_.load()}; }

private:
    enum class Draw : uint8_t { delay, error, loss, flip, where, bit };
    uint64_t draw(Draw what, Call call, const Digest& key) const;

    std::optional<Chaos> chaos_;
    std::atomic<uint64_t> lost_{0}, failed_{0}, flipped_{0}, delayed_{0};
};

}  // namespace kiln
