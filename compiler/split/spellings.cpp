#include "compiler/split/spellings.h"

#include <cassert>
#include <iterator>

namespace kiln {

namespace {

constexpr std::string_view fixed_texts[] = {
    "",        "(",         ")",       ",",    "#",        "##",       "+",           "-",    "~",      "!",
    "*",       "/",         "%",       "<<",   ">>",       "<",        ">",           "<=",   ">=",     "==",
    "!=",      "&",         "^",       "|",    "&&",       "||",       "^^",          ":",    "define", "undef",
    "if",      "ifdef",     "ifndef",  "elif", "else",     "endif",    "include",     "line", "pragma", "error",
    "version", "extension", "defined", "once", "__LINE__", "__FILE__", "__VERSION__", "0",    "1",
};

uint64_t hash_text(std::string_view text) {
    uint64_t h = 0x9E3779B97F4A7C15u ^ text.size();
    for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
    return h ^ (h >> 29);
}

}  // namespace

Spellings::Spellings() {
    static_assert(std::size(fixed_texts) == spelling::first_free);
    slots_.assign(1024, 0);
    texts_.reserve(512);
    hashes_.reserve(512);
    texts_.push_back({});
    hashes_.push_back(0);
    for (uint32_t id = 1; id < spelling::first_free; ++id) {
        [[maybe_unused]] const uint32_t given = intern(fixed_texts[id]);
        assert(given == id);
    }
}

uint32_t Spellings::intern(std::string_view text) {
    if (text.empty()) return 0;
    const uint64_t hash = hash_text(text);
    const size_t mask = slots_.size() - 1;
    size_t slot = static_cast<size_t>(hash) & mask;
    for (; slots_[slot] != 0; slot = (slot + 1) & mask) {
        const uint32_t id = slots_[slot];
        if (hashes_[id] == hash && texts_[id] == text) return id;
    }
    const uint32_t id = size();
    owned_.emplace_back(text);
    texts_.push_back(owned_.back());
    hashes_.push_back(hash);
    slots_[slot] = id;
    if (texts_.size() * 2 > slots_.size()) grow();
    return id;
}

void Spellings::grow() {
    slots_.assign(slots_.size() * 2, 0);
    const size_t mask = slots_.size() - 1;
    for (uint32_t id = 1; id < size(); ++id) {
        size_t slot = static_cast<size_t>(hashes_[id]) & mask;
        while (slots_[slot] != 0) slot = (slot + 1) & mask;
        slots_[slot] = id;
    }
}

}  // namespace kiln
