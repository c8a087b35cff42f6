// Arbitrary bytes as a proof. The digests of table and content are put right first, so that mutations reach the structure.
#include <algorithm>
#include <cstdint>

#include "compiler/table/proof.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr size_t head = 12, digest = 32;
    kiln::Bytes bytes(data, data + size);
    const kiln::Bytes table(8, 7);
    if (size >= head + 2 * digest) {
        const kiln::Digest of_table = kiln::sha256(table);
        std::copy(of_table.bytes.begin(), of_table.bytes.end(), bytes.begin() + head);
        const kiln::Digest sum = kiln::sha256(kiln::ByteView(bytes).first(size - digest));
        std::copy(sum.bytes.begin(), sum.bytes.end(), bytes.end() - digest);
    }
    (void)kiln::read_proof(bytes, table).ok();
    return 0;
}
