// Decoding is by stream, so that memory grows with bytes really produced and not with what a header says.
#include "cache/zstd.h"

#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <memory>

namespace kiln {

namespace {

constexpr int window_log = 23;

struct FreeDecoder {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

}  // namespace

Bytes zstd_compress(ByteView bytes, int level) {
    Bytes out(ZSTD_compressBound(bytes.size()));
    const size_t size = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), level);
    out.resize(ZSTD_isError(size) != 0 ? 0 : size);
    return out;
}

Unpacked zstd_unpack(ByteView bytes, uint64_t most, Bytes& out, const std::function<bool(uint64_t)>& grow) {
    const std::unique_ptr<ZSTD_DCtx, FreeDecoder> context(ZSTD_createDCtx());
    if (context == nullptr) return Unpacked::no_room;
    ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, window_log);
    const unsigned long long claimed = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
    if (claimed == ZSTD_CONTENTSIZE_ERROR) return Unpacked::damaged;
    if (claimed != ZSTD_CONTENTSIZE_UNKNOWN && claimed > most) return Unpacked::too_large;
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    size_t filled = 0;
    size_t more = 1;  // what the decoder still expects of the frame; 0 at its end
    while (true) {
        if (filled == out.size()) {
            // One byte past the bound tells a body that is too large from one that just fits.
            const uint64_t wanted = std::min<uint64_t>(std::max<uint64_t>(uint64_t{64} * 1024, uint64_t{2} * filled), most + 1);
            if (wanted <= filled) return Unpacked::too_large;
            if (grow && !grow(wanted)) return Unpacked::no_room;
            out.resize(static_cast<size_t>(wanted));
        }
        ZSTD_outBuffer to{out.data(), out.size(), filled};
        const size_t before = in.pos;
        more = ZSTD_decompressStream(context.get(), &to, &in);
        if (ZSTD_isError(more) != 0) {
            const bool window = ZSTD_getErrorCode(more) == ZSTD_error_frameParameter_windowTooLarge;
            return window ? Unpacked::too_large : Unpacked::damaged;
        }
        const bool progress = in.pos != before || to.pos != filled;
        filled = to.pos;
        if (filled > most) return Unpacked::too_large;
        if (more == 0 && in.pos == in.size) break;
        if (!progress && filled < out.size()) return Unpacked::damaged;  // it wants bytes that are not there
    }
    out.resize(filled);
    return Unpacked::ok;
}

}  // namespace kiln
