#pragma once
// Plain byte containers shared by every layer.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kiln {

using Bytes = std::vector<uint8_t>;
using ByteView = std::span<const uint8_t>;
using Words = std::vector<uint32_t>;  // SPIR-V
using WordView = std::span<const uint32_t>;

inline ByteView as_bytes(std::string_view text) { return {reinterpret_cast<const uint8_t*>(text.data()), text.size()}; }
inline ByteView as_bytes(WordView words) { return {reinterpret_cast<const uint8_t*>(words.data()), words.size_bytes()}; }
inline std::string_view as_text(ByteView bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

}  // namespace kiln
