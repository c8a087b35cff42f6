#include "cache/zstd.h"

#include <gtest/gtest.h>

#include <numeric>

namespace kiln {
namespace {

TEST(Zstd, ThereAndBack) {
    for (const size_t size : {0u, 1u, 1000u, 70'000u, 1'000'000u}) {
        Bytes bytes(size);
        for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(i * i >> 7);
        const Bytes packed = zstd_compress(bytes, 1);
        Bytes back;
        ASSERT_EQ(zstd_unpack(packed, size, back), Unpacked::ok) << size;
        EXPECT_EQ(back, bytes);
        if (size == 0) continue;
        Bytes less;
        EXPECT_EQ(zstd_unpack(packed, size - 1, less), Unpacked::too_large) << size;
    }
}

TEST(Zstd, BombsStopAtTheBound) {
    const Bytes packed = zstd_compress(Bytes(size_t{64} << 20, 0), 1);
    ASSERT_LT(packed.size(), 10'000u);
    Bytes out;
    EXPECT_EQ(zstd_unpack(packed, 1'000'000, out), Unpacked::too_large);
    EXPECT_LE(out.capacity(), 1'000'001u);
    // A frame that does not say its size: one that does, with a second and a third behind it.
    Bytes many;
    for (int i = 0; i < 100; ++i) {
        const Bytes one = zstd_compress(Bytes(900'000, 0), 1);
        many.insert(many.end(), one.begin(), one.end());
    }
    uint64_t most_asked = 0;
    const auto grow = [&](uint64_t capacity) {
        most_asked = std::max(most_asked, capacity);
        return true;
    };
    Bytes second;
    EXPECT_EQ(zstd_unpack(many, 1'000'000, second, grow), Unpacked::too_large);
    EXPECT_LE(most_asked, 1'000'001u);
    // The control: with room, all of it comes out.
    Bytes all;
    EXPECT_EQ(zstd_unpack(many, 100'000'000, all), Unpacked::ok);
    EXPECT_EQ(all.size(), 90'000'000u);
    Bytes none;
    EXPECT_EQ(zstd_unpack(packed, uint64_t{1} << 30, none, [](uint64_t capacity) { return capacity < 5'000'000; }),
              Unpacked::no_room);
}

TEST(Zstd, AWindowLargerThanTheBoundIsRefused) {
    // magic, descriptor (no single segment, no checksum, no size), window 2^27, one empty last block
    const Bytes frame{0x28, 0xb5, 0x2f, 0xfd, 0x00, (27 - 10) << 3, 0x01, 0x00, 0x00};
    Bytes out;
    EXPECT_EQ(zstd_unpack(frame, 1'000'000, out), Unpacked::too_large);
    Bytes fits = frame;
    fits[5] = (20 - 10) << 3;
    EXPECT_EQ(zstd_unpack(fits, 1'000'000, out), Unpacked::ok);
}

TEST(Zstd, DamageAtEveryLength) {
    Bytes bytes(3000);
    std::iota(bytes.begin(), bytes.end(), uint8_t{0});
    const Bytes packed = zstd_compress(bytes, 3);
    for (size_t n = 0; n < packed.size(); ++n) {
        Bytes out;
        EXPECT_EQ(zstd_unpack(ByteView(packed).first(n), 10'000, out), Unpacked::damaged) << n;
    }
    Bytes longer = packed, out;
    longer.push_back(0);
    EXPECT_EQ(zstd_unpack(longer, 10'000, out), Unpacked::damaged);
    const Bytes plain{'h', 'e', 'l', 'l', 'o'};
    EXPECT_EQ(zstd_unpack(plain, 10'000, out), Unpacked::damaged);
}

}  // namespace
}  // namespace kiln
