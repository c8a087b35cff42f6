/* Decodes one LZ4 block: token (literals:4, match:4), more length bytes while 255, literals, a 2-byte offset back, more
 * length bytes; the last sequence has literals only. Written for hostile input: every length is checked against what is left
 * on both sides before a byte moves. Without `out` it only follows the structure, which is how a table is verified without
 * memory. */
#include "compiler/runtime/internal.h"

/* Adds the 255-continued bytes of a length; 0 when the input ends first or the sum passes 2^31. */
static int more(const uint8_t* in, uint32_t size, uint32_t* at, uint32_t* length) {
    uint8_t byte;
    do {
        if (*at == size || *length > 0x7fffff00u) return 0;
        byte = in[(*at)++];
        *length += byte;
    } while (byte == 255);
    return 1;
}

int64_t kiln_lz4(const uint8_t* in, uint32_t size, uint8_t* out, uint32_t wanted, uint32_t limit) {
    uint32_t at = 0, made = 0;
    if (wanted > limit) return -1;
    while (at < size && made < wanted) {
        const uint8_t token = in[at++];
        uint32_t literals = token >> 4, match = token & 15u, back, take;
        if (literals == 15 && !more(in, size, &at, &literals)) return -1;
        if (literals > size - at || literals > limit - made) return -1;
        take = literals < wanted - made ? literals : wanted - made;
        if (out != NULL) memcpy(out + made, in + at, take);
        at += literals;
        made += take;
        if (take < literals || at == size || made == wanted) break;
        if (size - at < 2) return -1;
        back = (uint32_t)in[at] | (uint32_t)in[at + 1] << 8;
        at += 2;
        if (match == 15 && !more(in, size, &at, &match)) return -1;
        match += 4;
        if (back == 0 || back > made || match > limit - made) return -1;
        take = match < wanted - made ? match : wanted - made;
        if (out != NULL) {
            if (back >= take)
                memcpy(out + made, out + made - back, take);
            else
                for (uint32_t i = 0; i < take; ++i) out[made + i] = out[made + i - back];
        }
        made += take;
    }
    return made;
}
