#include "cache/client/signature.h"

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>

#include <fstream>
#include <iterator>

#include "cache/client/private_file.h"

namespace kiln {

namespace {

constexpr size_t most_key_file = 64 * 1024;

EVP_PKEY* as_key(void* key) { return static_cast<EVP_PKEY*>(key); }

// No key file of ours has a password; without this, OpenSSL would ask for one on the terminal.
int no_password(char*, int, int, void*) { return 0; }

}  // namespace

Result<std::unique_ptr<Signer>> Signer::open(const std::string& private_key_file) {
    const auto text = read_private_file(private_key_file, "signing key", most_key_file);
    KILN_TRY(text);
    BIO* in = ::BIO_new_mem_buf(text->data(), static_cast<int>(text->size()));
    EVP_PKEY* key = ::PEM_read_bio_PrivateKey(in, nullptr, no_password, nullptr);
    ::BIO_free(in);
    if (key == nullptr || ::EVP_PKEY_id(key) != EVP_PKEY_ED25519) {
        ::EVP_PKEY_free(key);
        return environment_error("signing key " + private_key_file + ": not a PEM file with an Ed25519 private key");
    }
    return std::unique_ptr<Signer>(new Signer(key));
}

Signer::~Signer() { ::EVP_PKEY_free(as_key(key_)); }

Bytes Signer::sign(ByteView message) const {
    Bytes signature(64);
    size_t size = signature.size();
    EVP_MD_CTX* context = ::EVP_MD_CTX_new();
    const bool done = ::EVP_DigestSignInit(context, nullptr, nullptr, nullptr, as_key(key_)) == 1 &&
                      ::EVP_DigestSign(context, signature.data(), &size, message.data(), message.size()) == 1;
    ::EVP_MD_CTX_free(context);
    return done && size == 64 ? signature : Bytes();
}

Result<std::unique_ptr<Verifier>> Verifier::open(const std::string& public_key_file) {
    std::ifstream file(public_key_file, std::ios::binary);
    std::string text(most_key_file, '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(file.gcount()));
    BIO* in = ::BIO_new_mem_buf(text.data(), static_cast<int>(text.size()));
    std::vector<void*> keys;
    bool right = true;
    while (EVP_PKEY* key = ::PEM_read_bio_PUBKEY(in, nullptr, no_password, nullptr)) {
        right = right && ::EVP_PKEY_id(key) == EVP_PKEY_ED25519;
        keys.push_back(key);
    }
    ::BIO_free(in);
    std::unique_ptr<Verifier> verifier(new Verifier(std::move(keys)));
    if (!right || verifier->keys_.empty())
        return environment_error("public key " + public_key_file + ": not a PEM file with Ed25519 public keys");
    return verifier;
}

Verifier::~Verifier() {
    for (void* key : keys_) ::EVP_PKEY_free(as_key(key));
}

bool Verifier::verify(ByteView message, ByteView signature) const {
    if (signature.size() != 64) return false;
    for (void* key : keys_) {
        EVP_MD_CTX* context = ::EVP_MD_CTX_new();
        const bool good = ::EVP_DigestVerifyInit(context, nullptr, nullptr, nullptr, as_key(key)) == 1 &&
                          ::EVP_DigestVerify(context, signature.data(), signature.size(), message.data(), message.size()) == 1;
        ::EVP_MD_CTX_free(context);
        if (good) return true;
    }
    return false;
}

}  // namespace kiln
