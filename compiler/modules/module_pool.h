#pragma once
// Keeps each distinct sequence of words once.

#include <memory>
#include <mutex>
#include <unordered_map>

#include "compiler/base/bytes.h"
#include "compiler/base/digest.h"

namespace kiln {

using SharedWords = std::shared_ptr<const Words>;

// Equal words give the same pointer, so that comparing two modules afterwards is comparing pointers. XXH3 finds candidates;
// their words decide. Safe to use from several threads; the result never depends on their order.
class WordPool {
public:
    SharedWords keep(Words words) {
        const Fast hash = xxh3(as_bytes(WordView(words)));
        const std::lock_guard lock(mutex_);
        const auto [first, last] = known_.equal_range(hash);
        for (auto at = first; at != last; ++at) {
            if (*at->second == words) return at->second;
        }
        return known_.emplace(hash, std::make_shared<const Words>(std::move(words)))->second;
    }

private:
    std::mutex mutex_;
    std::unordered_multimap<Fast, SharedWords> known_;
};

}  // namespace kiln
