// What a game sees: the wrapper, misses in words, buffers that are too small, and the decoder.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "compiler/runtime/kiln.hpp"
#include "compiler/runtime/table_format.h"
#include "compiler/table/table_text.h"
#include "sample.h"

namespace kiln::test {
namespace {

struct Fixture {
    Sample sample = small_sample();
    Bytes bytes;
    kiln_runtime::Table table;
    Fixture() {
        auto files = write_table(sample.input());
        bytes = files->table;
        EXPECT_EQ(table.open(bytes.data(), bytes.size()), KILN_OK);
    }
};

TEST(Runtime, WrapperPicksByName) {
    Fixture f;
    const kiln_runtime::Shader shader = f.table.shader("surface");
    ASSERT_TRUE(shader);
    EXPECT_FALSE(f.table.shader("surfac"));
    uint64_t key[1] = {};
    EXPECT_TRUE(shader.set(key, "light", "point"));
    EXPECT_TRUE(shader.set(key, "pass", "depth"));
    EXPECT_FALSE(shader.set(key, "pass", "dept"));
    EXPECT_FALSE(shader.set(key, "lite", "point"));
    uint32_t modules[KILN_MAX_STAGES], fragment = KILN_NONE;
    ASSERT_EQ(shader.find(key, modules), KILN_OK);
    EXPECT_EQ(shader.find(key, KILN_FRAGMENT, fragment), KILN_OK);
    EXPECT_EQ(fragment, modules[1]);
    EXPECT_EQ(shader.find(key, KILN_COMPUTE, fragment), KILN_ABSENT);
    const auto words = f.table.words(modules[1]);
    EXPECT_EQ(Words(words.begin(), words.end()), f.sample.modules().list[modules[1]].words);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(words.data()) % 4, 0u);
    EXPECT_GE(reinterpret_cast<const uint8_t*>(words.data()), f.bytes.data());
    EXPECT_TRUE(f.table.words(12345).empty());

    std::vector<char> buffer(70000);
    std::string_view text;
    ASSERT_EQ(f.table.text(shader, modules[1], KILN_GLSL450, buffer.data(), buffer.size(), text), KILN_OK);
    EXPECT_EQ(text, f.sample.artifacts().list[f.sample.artifacts().of[0][1][modules[1]]].text);
    EXPECT_EQ(std::strlen(buffer.data()), text.size());
    EXPECT_EQ(f.table.text(shader, modules[1], KILN_MSL21, buffer.data(), buffer.size(), text), KILN_ABSENT);
    EXPECT_EQ(f.table.text(shader, 12345, KILN_GLSL450, buffer.data(), buffer.size(), text), KILN_ABSENT);
}

TEST(Runtime, ShortBuffersAreLeftAlone) {
    Fixture f;
    for (uint32_t i = 0; i < f.sample.artifacts().list.size(); ++i) {
        kiln_artifact a;
        ASSERT_EQ(kiln_get_artifact(f.table.raw(), i, &a), KILN_OK);
        EXPECT_EQ(a.size, f.sample.artifacts().list[i].text.size());
        EXPECT_LE(a.buffer, a.size + KF_BLOCK_BYTES + 1);
        std::vector<char> small(a.buffer - 1, 'x');
        EXPECT_EQ(kiln_decode(f.table.raw(), i, small.data(), small.size()), KILN_SHORT_BUFFER);
        EXPECT_EQ(std::count(small.begin(), small.end(), 'x'), static_cast<std::ptrdiff_t>(small.size()));
        std::vector<char> exact(a.buffer);
        ASSERT_EQ(kiln_decode(f.table.raw(), i, exact.data(), exact.size()), KILN_OK);
        EXPECT_EQ(std::string(exact.data()), f.sample.artifacts().list[i].text);
    }
    kiln_artifact none;
    EXPECT_EQ(kiln_get_artifact(f.table.raw(), 100000, &none), KILN_ABSENT);
}

TEST(Runtime, MissesSayWhy) {
    Fixture f;
    const kiln_runtime::Shader shader = f.table.shader("surface");
    uint64_t key[1] = {};
    char buffer[256];
    EXPECT_EQ(shader.why(key, buffer, sizeof buffer),
              "surface light=none pass=forward skinned=false is forbidden: forbid: light == none && pass == forward (a test)");
    shader.set(key, "light", "spot");
    EXPECT_EQ(shader.why(key, buffer, sizeof buffer),
              "surface light=spot pass=forward skinned=false is not needed by corridor, yard");
    shader.set(key, "light", "point");
    EXPECT_EQ(shader.why(key, buffer, sizeof buffer), "surface light=point pass=forward skinned=false is in the table");
    key[0] |= 3u << 2;
    EXPECT_EQ(shader.why(key, buffer, sizeof buffer),
              "surface light=point pass=? skinned=false: axis pass has no value number 3, only 0 to 2");
    key[0] = uint64_t{1} << 40;
    EXPECT_EQ(shader.why(key, buffer, sizeof buffer),
              "surface light=none pass=forward skinned=false: the key has a bit that no axis owns");
    key[0] = 0;
    const size_t whole = kiln_why(shader.raw(), key, nullptr, 0);
    char exact[10];
    std::memset(exact, 'x', sizeof exact);
    EXPECT_EQ(kiln_why(shader.raw(), key, exact, 9), whole);
    EXPECT_STREQ(exact, "surface ");
    EXPECT_EQ(exact[9], 'x');
    f.sample.scenes.clear();
    const auto files = write_table(f.sample.input());
    kiln_runtime::Table again;
    ASSERT_EQ(again.open(files->table.data(), files->table.size()), KILN_OK);
    const kiln_runtime::Shader other = again.shader("surface");
    other.set(key, "light", "spot");
    EXPECT_EQ(other.why(key, buffer, sizeof buffer), "surface light=spot pass=forward skinned=false is not needed");
}

extern "C" int64_t kiln_lz4(const uint8_t* in, uint32_t size, uint8_t* out, uint32_t wanted, uint32_t limit);

TEST(Decoder, GivesBackWhatWasPacked) {
    uint64_t random = 42;
    const auto next = [&] {
        random ^= random << 13;
        random ^= random >> 7;
        return random ^= random << 17;
    };
    std::vector<std::string> texts;
    for (int i = 0; i < 200; ++i) {
        std::string text;
        const size_t size = next() % (i % 20 == 0 ? 200000 : 3000);
        const uint64_t letters = 1 + next() % 30;
        while (text.size() < size) text.append(next() % (i % 7 == 0 ? 400 : 4) + 1, static_cast<char>('!' + next() % letters));
        texts.push_back(text);
    }
    std::string noise;
    for (int i = 0; i < 5000; ++i) noise += static_cast<char>(next());
    texts.push_back(noise);
    texts.push_back("");
    std::vector<const std::string*> list;
    for (const std::string& t : texts) list.push_back(&t);
    std::vector<bool> breaks(list.size());
    breaks[100] = breaks[200] = true;
    const auto packed = pack_texts(list, breaks, Jobs(2));
    ASSERT_TRUE(packed.ok());
    bool raw = false;
    for (size_t i = 0; i < texts.size(); ++i) {
        const kf_artifact_record& place = packed->places[i];
        if (texts[i].empty()) continue;
        const kf_block_record& block = packed->blocks[place.block];
        EXPECT_TRUE(block.unpacked <= KF_BLOCK_BYTES || (place.at == 0 && place.size == block.unpacked));
        if (block.codec == kf_codec_raw) {
            raw = true;
            continue;
        }
        std::vector<uint8_t> out(place.at + place.size);
        ASSERT_EQ(kiln_lz4(packed->bytes.data() + block.at, block.packed, out.data(), place.at + place.size, block.unpacked),
                  static_cast<int64_t>(out.size()));
        EXPECT_EQ(std::memcmp(out.data() + place.at, texts[i].data(), texts[i].size()), 0) << i;
        EXPECT_EQ(kiln_lz4(packed->bytes.data() + block.at, block.packed, nullptr, block.unpacked, block.unpacked),
                  block.unpacked);
        // Cut anywhere: less comes out, or the block is refused; nothing is read behind its end.
        for (uint32_t cut = 0; cut < block.packed && i < 3; cut += 97) {
            const std::vector<uint8_t> exact(packed->bytes.begin() + static_cast<std::ptrdiff_t>(block.at),
                                             packed->bytes.begin() + static_cast<std::ptrdiff_t>(block.at + cut));
            EXPECT_LT(kiln_lz4(exact.data(), cut, out.data(), static_cast<uint32_t>(out.size()), block.unpacked),
                      static_cast<int64_t>(block.unpacked));
        }
    }
    EXPECT_TRUE(raw);
}

TEST(Decoder, RefusesMalformedBlocks) {
    const struct {
        std::vector<uint8_t> in;
        const char* what;
    } bad[] = {
        {{0x10}, "a literal that is not there"},
        {{0xf0}, "a length that is not there"},
        {{0xf0, 0xff, 0xff}, "a length that does not end"},
        {{0x10, 'a', 0x01}, "half an offset"},
        {{0x10, 'a', 0x00, 0x00}, "an offset of zero"},
        {{0x10, 'a', 0x02, 0x00}, "an offset before the start"},
        {{0x1f, 'a', 0x01, 0x00, 0xff}, "a match length that does not end"},
        {{0x1f, 'a', 0x01, 0x00, 0xff, 0xff, 0x00}, "more than the limit"},
    };
    for (const auto& b : bad) {
        uint8_t out[64];
        EXPECT_EQ(kiln_lz4(b.in.data(), static_cast<uint32_t>(b.in.size()), out, 64, 64), -1) << b.what;
        EXPECT_EQ(kiln_lz4(b.in.data(), static_cast<uint32_t>(b.in.size()), nullptr, 64, 64), -1) << b.what;
    }
    uint8_t out[8];
    const uint8_t good[] = {0x10, 'a', 0x01, 0x00};
    EXPECT_EQ(kiln_lz4(good, 4, out, 5, 8), 5);
    EXPECT_EQ(std::memcmp(out, "aaaaa", 5), 0);
}

}  // namespace
}  // namespace kiln::test
