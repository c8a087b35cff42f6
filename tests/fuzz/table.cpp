// Arbitrary bytes as a table: opened, verified, and everything that the reader offers called, verified or not. The header's
// checksums are put right first on half of the inputs (the last byte says which), so that mutations reach the structure.
#include <cstdint>
#include <cstring>
#include <memory>

#include "compiler/runtime/table_format.h"
#include "compiler/table/table_read.h"
#include "tests/unit/table/exercise.h"

namespace {

void reseal(uint8_t* bytes, size_t size) {
    kf_header header;
    if (size < sizeof header) return;
    std::memcpy(&header, bytes, sizeof header);
    std::memcpy(header.magic, KF_MAGIC, 8);
    header.version = KF_VERSION;
    header.file_bytes = size;
    const size_t room = (size - sizeof header) / sizeof(kf_entry);
    if (header.sections > room) return;
    for (uint32_t i = 0; i < header.sections; ++i) {
        kf_entry e;
        std::memcpy(&e, bytes + sizeof header + i * sizeof e, sizeof e);
        if (e.offset > size || e.bytes > size - e.offset) continue;
        e.checksum = kf_checksum(bytes + e.offset, e.bytes / 8, KF_NO_SKIP);
        std::memcpy(bytes + sizeof header + i * sizeof e, &e, sizeof e);
    }
    std::memcpy(bytes, &header, sizeof header);
    header.checksum = kf_checksum(bytes, (sizeof header + header.sections * sizeof(kf_entry)) / 8, KF_HEADER_SKIP);
    std::memcpy(bytes, &header, sizeof header);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const bool mend = size > 0 && data[size - 1] % 2 == 1;
    if (mend) --size;
    const std::unique_ptr<uint8_t[]> exact(new uint8_t[size]);
    if (size > 0) std::memcpy(exact.get(), data, size);
    if (mend) reseal(exact.get(), size);
    kiln_table table;
    if (kiln_open(&table, exact.get(), size) != KILN_OK) return 0;
    const bool sound = kiln_verify(&table, nullptr) == KILN_OK;
    kiln::test::exercise_table(table);
    if (sound) (void)kiln::TableView::open({exact.get(), size}).ok();
    return 0;
}
