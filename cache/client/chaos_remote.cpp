#include "cache/client/chaos_remote.h"

#include <algorithm>
#include <thread>

#include "compiler/base/wire.h"

namespace kiln {

bool ChaosRemote::hurt(Call call, const Digest& key, RemoteAnswer& answer) {
    const auto roll = [&](uint8_t what) {
        WireWriter w;
        w.text("remote");
        w.u64(chaos_.seed);
        w.u8(static_cast<uint8_t>(call));
        w.u8(what);
        w.raw(key.bytes);
        return xxh3(w.view()).low;
    };
    const auto happens = [&](double chance, uint8_t what) { return static_cast<double>(roll(what) >> 11) * 0x1p-53 < chance; };
    if (chaos_.delay != 0) {
        ++delayed_;
        std::this_thread::sleep_for(std::chrono::milliseconds(roll(5) % (chaos_.delay + 1)));
    }
    if (happens(chaos_.error, 1)) {
        ++failed_;
        answer = {RemoteAnswer::Kind::failed, {}, "chaos: this request was to fail", false};
        return true;
    }
    if (happens(chaos_.loss, 2)) {
        ++lost_;
        const bool writes = call == Call::put_blob || call == Call::put_action;
        answer = {writes ? RemoteAnswer::Kind::found : RemoteAnswer::Kind::absent, {}, {}, false};
        return true;
    }
    if (answer.bytes.empty() || !happens(chaos_.flip, 3)) return false;
    ++flipped_;
    const uint64_t dice = roll(4);
    uint8_t& byte = answer.bytes[dice / 8 % answer.bytes.size()];
    byte = static_cast<uint8_t>(byte ^ (1u << (dice % 8)));
    return true;
}

std::vector<RemoteAnswer> ChaosRemote::get_actions(std::span<const Digest> keys) {
    auto answers = inner_->get_actions(keys);
    for (size_t i = 0; i < keys.size(); ++i) hurt(Call::get_action, keys[i], answers[i]);
    return answers;
}

std::vector<RemoteAnswer> ChaosRemote::get_blobs(std::span<const RemoteBlob> blobs) {
    auto answers = inner_->get_blobs(blobs);
    for (size_t i = 0; i < blobs.size(); ++i) hurt(Call::get_blob, blobs[i].digest, answers[i]);
    return answers;
}

std::vector<RemoteAnswer> ChaosRemote::find_blobs(std::span<const RemoteBlob> blobs) {
    auto answers = inner_->find_blobs(blobs);
    for (size_t i = 0; i < blobs.size(); ++i) hurt(Call::find, blobs[i].digest, answers[i]);
    return answers;
}

// A write that is lost never reaches the server, which is then said to have it.
std::vector<RemoteAnswer> ChaosRemote::put_blobs(std::span<const RemoteUpload> blobs) {
    std::vector<RemoteAnswer> answers(blobs.size());
    for (size_t i = 0; i < blobs.size(); ++i)
        if (!hurt(Call::put_blob, blobs[i].key, answers[i])) answers[i] = std::move(inner_->put_blobs({&blobs[i], 1}).front());
    return answers;
}

std::vector<RemoteAnswer> ChaosRemote::put_actions(std::span<const RemoteUpload> actions) {
    std::vector<RemoteAnswer> answers(actions.size());
    for (size_t i = 0; i < actions.size(); ++i)
        if (!hurt(Call::put_action, actions[i].key, answers[i]))
            answers[i] = std::move(inner_->put_actions({&actions[i], 1}).front());
    return answers;
}

}  // namespace kiln
