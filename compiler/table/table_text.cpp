// Texts of one target and stage differ from their neighbours by a few lines, and LZ4 looks back 64 KiB: a block of that size
// lets every text after the first be little more than references, and bounds what decoding one text can cost. The level is
// the highest, since a table is written once and decoding does not get slower.

#include "compiler/table/table_text.h"

#include <lz4hc.h>

namespace kiln {

namespace {

Status close_block(PackedTexts& out, Bytes& plain) {
    if (plain.empty()) return {};
    kf_block_record block{};
    block.at = out.bytes.size();
    block.unpacked = static_cast<uint32_t>(plain.size());
    Bytes packed(static_cast<size_t>(LZ4_compressBound(static_cast<int>(plain.size()))));
    const int size = LZ4_compress_HC(reinterpret_cast<const char*>(plain.data()), reinterpret_cast<char*>(packed.data()),
                                     static_cast<int>(plain.size()), static_cast<int>(packed.size()), LZ4HC_CLEVEL_DEFAULT);
    if (size <= 0) return environment_error("a text could not be compressed");
    packed.resize(static_cast<size_t>(size));
    block.codec = packed.size() < plain.size() ? kf_codec_lz4 : kf_codec_raw;
    const Bytes& kept = block.codec == kf_codec_lz4 ? packed : plain;
    block.packed = static_cast<uint32_t>(kept.size());
    out.bytes.insert(out.bytes.end(), kept.begin(), kept.end());
    out.blocks.push_back(block);
    plain.clear();
    return {};
}

}  // namespace

Result<PackedTexts> pack_texts(const std::vector<const std::string*>& texts, const std::vector<bool>& breaks) {
    PackedTexts out;
    Bytes plain;
    for (size_t i = 0; i < texts.size(); ++i) {
        const std::string& text = *texts[i];
        if (text.size() > LZ4_MAX_INPUT_SIZE) return environment_error("a text is too large for a table");
        if (breaks[i] || plain.size() + text.size() > KF_BLOCK_BYTES) KILN_TRY(close_block(out, plain));
        kf_artifact_record place{};
        place.block = static_cast<uint32_t>(out.blocks.size());
        place.at = static_cast<uint32_t>(plain.size());
        place.size = static_cast<uint32_t>(text.size());
        out.places.push_back(place);
        plain.insert(plain.end(), text.begin(), text.end());
    }
    KILN_TRY(close_block(out, plain));
    return out;
}

}  // namespace kiln
