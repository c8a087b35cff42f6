#pragma once
// Collects the records of a table's sections and puts the file together (grammar: runtime/table_format.h). Equal lists of
// records are stored once.

#include <array>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"
#include "compiler/runtime/table_format.h"

namespace kiln {

class TableSections {
public:
    kf_text text(std::string_view text);
    // Appends the records and returns where they are; an equal list that was added before is reused.
    template <class Record>
    kf_range list(uint32_t kind, const std::vector<Record>& records) {
        static_assert(std::is_trivially_copyable_v<Record> && std::has_unique_object_representations_v<Record>);
        return add(kind, sizeof(Record), {reinterpret_cast<const uint8_t*>(records.data()), records.size() * sizeof(Record)},
                   true);
    }
    template <class Record>
    uint32_t one(uint32_t kind, const Record& record) {
        return list(kind, std::vector<Record>{record}).first;
    }
    // As list, but never shares: for records that are named by their place.
    template <class Record>
    kf_range append(uint32_t kind, const std::vector<Record>& records) {
        static_assert(std::is_trivially_copyable_v<Record> && std::has_unique_object_representations_v<Record>);
        return add(kind, sizeof(Record), {reinterpret_cast<const uint8_t*>(records.data()), records.size() * sizeof(Record)},
                   false);
    }
    // The whole file, or an Error when a section passed what its offsets can say.
    Result<Bytes> file() const;

private:
    kf_range add(uint32_t kind, size_t stride, ByteView bytes, bool share);
    struct Section {
        Bytes bytes;
        size_t stride = 1;
        std::map<std::string, kf_range, std::less<>> known;
    };
    std::array<Section, kf_section_last + 1> sections_;
    std::map<std::string, kf_text, std::less<>> texts_;
    bool overflow_ = false;
};

}  // namespace kiln
