// Damaged and hostile tables. Every read goes to an exactly sized heap copy, so that the address sanitizer sees an overread.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>

#include "compiler/runtime/kiln.h"
#include "compiler/runtime/table_format.h"
#include "exercise.h"
#include "sample.h"

namespace kiln::test {
namespace {

Bytes small_bytes() {
    Sample sample = small_sample();
    auto files = write_table(sample.input());
    EXPECT_TRUE(files.ok());
    return files->table;
}

struct Opened {
    kiln_status opened = KILN_OK, verified = KILN_OK;
};

Opened open_and_use(const Bytes& bytes) {
    const std::unique_ptr<uint8_t[]> exact(new uint8_t[bytes.size()]);
    if (!bytes.empty()) std::memcpy(exact.get(), bytes.data(), bytes.size());
    Opened out;
    kiln_table table;
    out.opened = kiln_open(&table, exact.get(), bytes.size());
    if (out.opened != KILN_OK) return out;
    out.verified = kiln_verify(&table, nullptr);
    exercise_table(table);
    return out;
}

TEST(Hostile, EveryTruncationIsRefused) {
    const Bytes whole = small_bytes();
    EXPECT_EQ(open_and_use(whole).verified, KILN_OK);
    for (size_t n = 0; n < whole.size(); ++n) {
        const kiln_status status = open_and_use(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n))).opened;
        EXPECT_EQ(status, n < 8 ? KILN_NOT_A_TABLE : KILN_TRUNCATED) << n;
    }
}

TEST(Hostile, EveryBitFlipIsFound) {
    Bytes bytes = small_bytes();
    for (size_t bit = 0; bit < bytes.size() * 8; ++bit) {
        bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
        kiln_table table;
        const kiln_status opened = kiln_open(&table, bytes.data(), bytes.size());
        EXPECT_TRUE(opened != KILN_OK || kiln_verify(&table, nullptr) == KILN_DAMAGED) << bit;
        bytes[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    }
}

TEST(Hostile, MoreBytesThanTheFileAreRefused) {
    Bytes bytes = small_bytes();
    bytes.resize(bytes.size() + 8);
    EXPECT_EQ(open_and_use(bytes).opened, KILN_DAMAGED);
}

// Puts the checksums right, so that only the structure can give a change away.
void reseal(Bytes& bytes) {
    kf_header header;
    std::memcpy(&header, bytes.data(), sizeof header);
    for (uint32_t i = 0; i < header.sections; ++i) {
        kf_entry e;
        uint8_t* at = bytes.data() + sizeof header + i * sizeof e;
        std::memcpy(&e, at, sizeof e);
        if (e.offset > bytes.size() || e.bytes > bytes.size() - e.offset) continue;
        e.checksum = kf_checksum(bytes.data() + e.offset, e.bytes / 8, KF_NO_SKIP);
        std::memcpy(at, &e, sizeof e);
    }
    const uint64_t words = (sizeof header + header.sections * sizeof(kf_entry)) / 8;
    if (words * 8 <= bytes.size()) header.checksum = kf_checksum(bytes.data(), words, KF_HEADER_SKIP);
    std::memcpy(bytes.data(), &header, sizeof header);
}

TEST(Hostile, ForgedBytesNeverLeaveTheTable) {
    const Bytes whole = small_bytes();
    uint64_t random = 20261122;
    const auto next = [&] {
        random ^= random << 13;
        random ^= random >> 7;
        return random ^= random << 17;
    };
    size_t opened = 0, verified = 0;
    for (int round = 0; round < 8000; ++round) {
        Bytes bytes = whole;
        for (uint64_t edits = 1 + next() % 3; edits > 0; --edits) {
            const size_t at = 32 + 40 * kf_section_last + next() % (bytes.size() - 32 - 40 * kf_section_last);
            const uint32_t odd[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0xffff, static_cast<uint32_t>(next())};
            if (next() % 2 == 0) {
                bytes[at] = static_cast<uint8_t>(next());
            } else {
                std::memcpy(bytes.data() + (at & ~size_t{3}), &odd[next() % 7], 4);
            }
        }
        reseal(bytes);
        const Opened out = open_and_use(bytes);
        opened += out.opened == KILN_OK;
        verified += out.opened == KILN_OK && out.verified == KILN_OK;
    }
    EXPECT_EQ(opened, 8000u);
    EXPECT_GT(verified, 0u);  // a changed name or word of SPIR-V is not a broken structure
    EXPECT_LT(verified, opened);
}

TEST(Hostile, ForgedSectionTablesAreRefusedOrHarmless) {
    const Bytes whole = small_bytes();
    for (uint32_t section = 0; section < kf_section_last; ++section)
        for (size_t byte = 0; byte < sizeof(kf_entry) - 8; ++byte)
            for (const int add : {1, 8, 0x80}) {
                Bytes bytes = whole;
                uint8_t& b = bytes[sizeof(kf_header) + section * sizeof(kf_entry) + byte];
                b = static_cast<uint8_t>(b + add);
                reseal(bytes);
                const Opened out = open_and_use(bytes);
                // Counting a byte of zero padding as used is all that a plain section of bytes can get away with.
                const bool padding = (section + 1 == kf_strings || section + 1 == kf_packed) && byte == offsetof(kf_entry, used);
                EXPECT_TRUE(padding || out.opened != KILN_OK || out.verified != KILN_OK) << section << " " << byte << " " << add;
            }
}

TEST(Hostile, OddHeadersSayWhatIsWrong) {
    const Bytes whole = small_bytes();
    Bytes newer = whole;
    newer[8] = 2;
    EXPECT_EQ(open_and_use(newer).opened, KILN_NEWER);
    Bytes older = whole;
    older[8] = 0;
    EXPECT_EQ(open_and_use(older).opened, KILN_DAMAGED);
    EXPECT_EQ(open_and_use(Bytes(100, 'x')).opened, KILN_NOT_A_TABLE);
    EXPECT_EQ(open_and_use({}).opened, KILN_NOT_A_TABLE);
    kiln_table table;
    EXPECT_EQ(kiln_open(&table, nullptr, 0), KILN_NOT_A_TABLE);
    Bytes shifted(whole.size() + 4);
    std::memcpy(shifted.data() + 4, whole.data(), whole.size());
    EXPECT_EQ(kiln_open(&table, shifted.data() + 4, whole.size()), KILN_MISALIGNED);
    for (int s = KILN_OK; s <= KILN_BIG_ENDIAN; ++s) {
        EXPECT_STRNE(kiln_status_text(static_cast<kiln_status>(s)), "unknown status");
        EXPECT_STRNE(kiln_status_text(static_cast<kiln_status>(s)), "");
    }
}

TEST(Hostile, LaterVersionOneTablesWithMoreSectionsAreRead) {
    // A section that this reader does not know, and a record that has grown by 8 bytes.
    const Bytes whole = small_bytes();
    kf_header header;
    std::memcpy(&header, whole.data(), sizeof header);
    std::vector<kf_entry> entries(header.sections);
    std::memcpy(entries.data(), whole.data() + sizeof header, entries.size() * sizeof(kf_entry));
    std::vector<Bytes> parts;
    for (const kf_entry& e : entries) {
        Bytes part(whole.begin() + static_cast<std::ptrdiff_t>(e.offset),
                   whole.begin() + static_cast<std::ptrdiff_t>(e.offset + e.used));
        if (e.kind == kf_values) {
            Bytes grown;
            for (size_t at = 0; at < part.size(); at += e.stride) {
                grown.insert(grown.end(), part.begin() + static_cast<std::ptrdiff_t>(at),
                             part.begin() + static_cast<std::ptrdiff_t>(at + e.stride));
                grown.insert(grown.end(), 8, 0xab);
            }
            part = grown;
        }
        parts.push_back(part);
    }
    for (kf_entry& e : entries)
        if (e.kind == kf_values) e.stride += 8;
    kf_entry later{};
    later.kind = kf_section_last + 1;
    later.stride = 5;
    entries.push_back(later);
    parts.push_back(Bytes(15, 7));
    Bytes out(sizeof header + entries.size() * sizeof(kf_entry));
    for (size_t i = 0; i < entries.size(); ++i) {
        entries[i].offset = out.size();
        entries[i].used = parts[i].size();
        entries[i].bytes = (parts[i].size() + 7) / 8 * 8;
        out.insert(out.end(), parts[i].begin(), parts[i].end());
        out.resize(static_cast<size_t>(entries[i].offset + entries[i].bytes));
    }
    header.sections = static_cast<uint32_t>(entries.size());
    header.file_bytes = out.size();
    std::memcpy(out.data(), &header, sizeof header);
    std::memcpy(out.data() + sizeof header, entries.data(), entries.size() * sizeof(kf_entry));
    reseal(out);
    const Opened got = open_and_use(out);
    EXPECT_EQ(got.opened, KILN_OK);
    EXPECT_EQ(got.verified, KILN_OK);
    kiln_table table;
    ASSERT_EQ(kiln_open(&table, out.data(), out.size()), KILN_OK);
    kiln_shader shader;
    ASSERT_EQ(kiln_find_shader(&table, "surface", &shader), KILN_OK);
    EXPECT_EQ(kiln_find_value(&shader, 0, "spot"), 3u);
}

}  // namespace
}  // namespace kiln::test
