// Texts of one target and stage differ from their neighbours by a few lines, and LZ4 looks back 64 KiB: a block of that size
// lets every text after the first be little more than references, and bounds what decoding one text can cost. Level 6
// costs half of level 9's time for 0.1 % more bytes.

#include "compiler/table/table_text.h"

#include <lz4hc.h>

namespace kiln {

namespace {

constexpr int level = 6;

struct Block {
    Bytes plain, packed;
    bool failed = false;
};

void compress(Block& block) {
    block.packed.resize(static_cast<size_t>(LZ4_compressBound(static_cast<int>(block.plain.size()))));
    const int size =
        LZ4_compress_HC(reinterpret_cast<const char*>(block.plain.data()), reinterpret_cast<char*>(block.packed.data()),
                        static_cast<int>(block.plain.size()), static_cast<int>(block.packed.size()), level);
    block.failed = size <= 0;
    block.packed.resize(block.failed ? 0 : static_cast<size_t>(size));
}

}  // namespace

Result<PackedTexts> pack_texts(const std::vector<const std::string*>& texts, const std::vector<bool>& breaks, const Jobs& jobs) {
    PackedTexts out;
    std::vector<Block> blocks;
    for (size_t i = 0; i < texts.size(); ++i) {
        const std::string& text = *texts[i];
        if (text.size() > LZ4_MAX_INPUT_SIZE) return environment_error("a text is too large for a table");
        if (blocks.empty() || breaks[i] || blocks.back().plain.size() + text.size() > KF_BLOCK_BYTES) blocks.emplace_back();
        Bytes& plain = blocks.back().plain;
        kf_artifact_record place{};
        place.block = static_cast<uint32_t>(blocks.size() - 1);
        place.at = static_cast<uint32_t>(plain.size());
        place.size = static_cast<uint32_t>(text.size());
        out.places.push_back(place);
        plain.insert(plain.end(), text.begin(), text.end());
    }
    if (!jobs.each(blocks.size(), [&](size_t i) { compress(blocks[i]); })) return environment_error("interrupted");
    for (const Block& b : blocks) {
        if (b.failed) return environment_error("a text could not be compressed");
        kf_block_record record{};
        record.at = out.bytes.size();
        record.unpacked = static_cast<uint32_t>(b.plain.size());
        record.codec = b.packed.size() < b.plain.size() ? kf_codec_lz4 : kf_codec_raw;
        const Bytes& kept = record.codec == kf_codec_lz4 ? b.packed : b.plain;
        record.packed = static_cast<uint32_t>(kept.size());
        out.bytes.insert(out.bytes.end(), kept.begin(), kept.end());
        out.blocks.push_back(record);
    }
    return out;
}

}  // namespace kiln
