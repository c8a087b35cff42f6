// The only file that includes OpenSSL's libcrypto.
#include <openssl/evp.h>

#include <cassert>

#include "compiler/base/digest.h"

namespace kiln {

namespace {

const EVP_MD* algorithm() {
    static EVP_MD* const md = EVP_MD_fetch(nullptr, "SHA256", nullptr);
    return md;
}

void update(void* state, const void* data, size_t size) {
    const int ok = EVP_DigestUpdate(static_cast<EVP_MD_CTX*>(state), data, size);
    assert(ok == 1);
    static_cast<void>(ok);
}

void update_number(void* state, uint64_t value) {
    uint8_t le[8];
    for (size_t i = 0; i < 8; ++i) le[i] = static_cast<uint8_t>(value >> (8 * i));
    update(state, le, sizeof le);
}

}  // namespace

Digest sha256(ByteView bytes) {
    Digest digest;
    unsigned int length = 0;
    const int ok = EVP_Digest(bytes.data(), bytes.size(), digest.bytes.data(), &length, algorithm(), nullptr);
    assert(ok == 1 && length == digest.bytes.size());
    static_cast<void>(ok);
    return digest;
}

KeyHasher::KeyHasher(std::string_view domain) : state_(EVP_MD_CTX_new()) {
    const int ok = EVP_DigestInit_ex2(static_cast<EVP_MD_CTX*>(state_), algorithm(), nullptr);
    assert(ok == 1);
    static_cast<void>(ok);
    update_number(state_, domain.size());
    update(state_, domain.data(), domain.size());
}

KeyHasher::~KeyHasher() { EVP_MD_CTX_free(static_cast<EVP_MD_CTX*>(state_)); }

KeyHasher& KeyHasher::field(std::string_view name, ByteView value) {
    update_number(state_, name.size());
    update(state_, name.data(), name.size());
    update_number(state_, value.size());
    update(state_, value.data(), value.size());
    return *this;
}

KeyHasher& KeyHasher::field(std::string_view name, uint64_t value) {
    uint8_t le[8];
    for (size_t i = 0; i < 8; ++i) le[i] = static_cast<uint8_t>(value >> (8 * i));
    return field(name, ByteView(le));
}

Digest KeyHasher::finish() {
    Digest digest;
    const int ok = EVP_DigestFinal_ex(static_cast<EVP_MD_CTX*>(state_), digest.bytes.data(), nullptr);
    assert(ok == 1);
    static_cast<void>(ok);
    return digest;
}

}  // namespace kiln
