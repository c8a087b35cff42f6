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

}  // namespace

Digest sha256(ByteView bytes) {
    Digest digest;
    unsigned int length = 0;
    const int ok = EVP_Digest(bytes.data(), bytes.size(), digest.bytes.data(), &length, algorithm(), nullptr);
    assert(ok == 1 && length == digest.bytes.size());
    static_cast<void>(ok);
    return digest;
}

StreamHash::StreamHash() : state_(EVP_MD_CTX_new()) {
    const int ok = EVP_DigestInit_ex2(static_cast<EVP_MD_CTX*>(state_), algorithm(), nullptr);
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

void KeyHasher::number(uint64_t value) {
    uint8_t le[8];
    for (size_t i = 0; i < 8; ++i) le[i] = static_cast<uint8_t>(value >> (8 * i));
    hash_.update(le);
}

KeyHasher::KeyHasher(std::string_view domain) {
    number(domain.size());
    hash_.update(as_bytes(domain));
}

KeyHasher& KeyHasher::field(std::string_view name, ByteView value) {
    number(name.size());
    hash_.update(as_bytes(name));
    number(value.size());
    hash_.update(value);
    return *this;
}

KeyHasher& KeyHasher::field(std::string_view name, uint64_t value) {
    uint8_t le[8];
    for (size_t i = 0; i < 8; ++i) le[i] = static_cast<uint8_t>(value >> (8 * i));
    return field(name, ByteView(le));
}

}  // namespace kiln
