#include "cache/server/stream_hash.h"

#include <openssl/evp.h>

#include <cassert>

namespace kiln {

StreamHash::StreamHash() : state_(EVP_MD_CTX_new()) {
    const int ok = EVP_DigestInit_ex(static_cast<EVP_MD_CTX*>(state_), EVP_sha256(), nullptr);
    assert(ok == 1);
    static_cast<void>(ok);
}

StreamHash::~StreamHash() { EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(state_)); }

void StreamHash::update(ByteView bytes) {
    const int ok = EVP_DigestUpdate(static_cast<EVP_MD_CTX*>(state_), bytes.data(), bytes.size());
    assert(ok == 1);
    static_cast<void>(ok);
}

Digest StreamHash::finish() {
    Digest digest;
    const int ok = EVP_DigestFinal_ex(static_cast<EVP_MD_CTX*>(state_), digest.bytes.data(), nullptr);
    assert(ok == 1);
    static_cast<void>(ok);
    return digest;
}

}  // namespace kiln
