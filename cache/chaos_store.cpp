#include "cache/chaos_store.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "cache/disk_folder.h"
#include "compiler/base/wire.h"

namespace kiln {

namespace {

enum class Draw : uint8_t { delay, error, loss, flip, bit };

uint64_t draw(const Chaos& chaos, bool writes, Draw what, Keyspace space, const Digest& key) {
    WireWriter w;
    w.u64(chaos.seed);
    w.u8(writes);
    w.u8(static_cast<uint8_t>(what));
    w.u8(static_cast<uint8_t>(space));
    w.raw(key.bytes);
    return xxh3(w.view()).low;
}

bool happens(double chance, uint64_t dice) { return static_cast<double>(dice >> 11) * 0x1p-53 < chance; }

Error mishap(const char* what) { return environment_error(std::string("cache: chaos: this ") + what + " was to fail"); }

}  // namespace

Result<Chaos> Chaos::parse(std::string_view text) {
    const Error wrong{Fault::usage,
                      "chaos '" + std::string(text) + "': say seed=N,loss=P,error=P,flip=P,delay=MS with chances P from 0 to 1"};
    Chaos chaos;
    while (!text.empty()) {
        const std::string_view part = text.substr(0, text.find(','));
        text.remove_prefix(std::min(text.size(), part.size() + 1));
        const size_t equals = part.find('=');
        if (equals == std::string_view::npos) return wrong;
        const std::string_view name = part.substr(0, equals);
        const std::string value(part.substr(equals + 1));
        const bool whole = !value.empty() && value.size() < 19 && value.find_first_not_of("0123456789") == std::string::npos;
        const bool decimal = !value.empty() && value.size() < 19 && value.find_first_not_of("0123456789.") == std::string::npos;
        char* end = nullptr;
        const double chance = std::strtod(value.c_str(), &end);
        if (name == "seed" && whole) {
            chaos.seed = std::stoull(value);
        } else if (name == "delay" && whole && std::stoull(value) <= 60'000) {
            chaos.delay = std::stoull(value);
        } else if (decimal && *end == '\0' && chance <= 1 && (name == "loss" || name == "error" || name == "flip")) {
            (name == "loss" ? chaos.loss : name == "error" ? chaos.error : chaos.flip) = chance;
        } else {
            return wrong;
        }
    }
    return chaos;
}

Result<std::optional<Bytes>> ChaosStore::get(Keyspace space, const Digest& key) {
    const auto roll = [&](Draw what) { return draw(chaos_, false, what, space, key); };
    if (chaos_.delay != 0) {
        ++delayed_;
        std::this_thread::sleep_for(std::chrono::milliseconds(roll(Draw::delay) % (chaos_.delay + 1)));
    }
    if (happens(chaos_.error, roll(Draw::error))) {
        ++failed_;
        return mishap("read");
    }
    if (happens(chaos_.loss, roll(Draw::loss))) {
        ++lost_;
        return std::optional<Bytes>();
    }
    if (flip_ && happens(chaos_.flip, roll(Draw::flip)) && flip_(space, key, roll(Draw::bit))) ++flipped_;
    return inner_.get(space, key);
}

Status ChaosStore::put(Keyspace space, const Digest& key, ByteView bytes) {
    if (const auto done = meddle(space, key)) return *done;
    return inner_.put(space, key, bytes);
}

Status ChaosStore::put_record(const Digest& key, ByteView record, std::span<const Digest> blobs) {
    if (const auto done = meddle(Keyspace::action, key)) return *done;
    return inner_.put_record(key, record, blobs);
}

// What a write that is not to reach the store returns instead.
std::optional<Status> ChaosStore::meddle(Keyspace space, const Digest& key) {
    const auto roll = [&](Draw what) { return draw(chaos_, true, what, space, key); };
    if (chaos_.delay != 0) {
        ++delayed_;
        std::this_thread::sleep_for(std::chrono::milliseconds(roll(Draw::delay) % (chaos_.delay + 1)));
    }
    if (happens(chaos_.error, roll(Draw::error))) {
        ++failed_;
        return mishap("write");
    }
    if (happens(chaos_.loss, roll(Draw::loss))) {
        ++lost_;
        return Status();
    }
    return std::nullopt;
}

bool flip_bit(const std::string& path, uint64_t dice) {
    const Descriptor fd(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK));
    struct stat info {};
    if (fd.get() < 0 || ::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode) || info.st_size == 0) return false;
    const auto at = static_cast<off_t>(dice / 8 % static_cast<uint64_t>(info.st_size));
    uint8_t byte = 0;
    if (::pread(fd.get(), &byte, 1, at) != 1) return false;
    byte = static_cast<uint8_t>(byte ^ (1u << (dice % 8)));
    return ::pwrite(fd.get(), &byte, 1, at) == 1;
}

}  // namespace kiln
