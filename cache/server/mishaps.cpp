#include "cache/server/mishaps.h"

#include <chrono>
#include <thread>

#include "compiler/base/wire.h"

namespace kiln {

uint64_t Mishaps::draw(Draw what, Call call, const Digest& key) const {
    WireWriter w;
    w.text("server");
    w.u64(chaos_->seed);
    w.u8(static_cast<uint8_t>(what));
    w.u8(static_cast<uint8_t>(call));
    w.raw(key.bytes);
    return xxh3(w.view()).low;
}

Mishaps::Fate Mishaps::meet(Call call, const Digest& key) {
    if (!chaos_) return Fate::none;
    const auto happens = [&](double chance, Draw what) {
        return static_cast<double>(draw(what, call, key) >> 11) * 0x1p-53 < chance;
    };
    if (chaos_->delay != 0) {
        ++delayed_;
        std::this_thread::sleep_for(std::chrono::milliseconds(draw(Draw::delay, call, key) % (chaos_->delay + 1)));
    }
    if (happens(chaos_->error, Draw::error)) {
        ++failed_;
        return Fate::fails;
    }
    if (happens(chaos_->loss, Draw::loss)) {
        ++lost_;
        return Fate::is_lost;
    }
    const bool reads = call == Call::get_blob || call == Call::get_action;
    if (!reads || !happens(chaos_->flip, Draw::flip)) return Fate::none;
    return draw(Draw::where, call, key) % 2 == 0 ? Fate::flips_on_disk : Fate::flips_answer;
}

void Mishaps::flip_file(Call call, const Digest& key, const std::string& path) {
    if (flip_bit(path, draw(Draw::bit, call, key))) ++flipped_;
}

void Mishaps::flip_answer(Call call, const Digest& key, std::span<uint8_t> bytes) {
    if (bytes.empty()) return;
    const uint64_t dice = draw(Draw::bit, call, key);
    uint8_t& byte = bytes[dice / 8 % bytes.size()];
    byte = static_cast<uint8_t>(byte ^ (1u << (dice % 8)));
    ++flipped_;
}

}  // namespace kiln
