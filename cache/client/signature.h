#pragma once
// Ed25519 over action records: who may sign has a private key (main's CI), everybody else its public half. Keys are PEM files as
// `openssl genpkey -algorithm ed25519` and `openssl pkey -pubout` write them.

#include <memory>
#include <string>
#include <vector>

#include "compiler/base/bytes.h"
#include "compiler/base/result.h"

namespace kiln {

class Signer {
public:
    // Refuses a file that others than its owner may read.
    static Result<std::unique_ptr<Signer>> open(const std::string& private_key_file);
    ~Signer();
    Bytes sign(ByteView message) const;

private:
    explicit Signer(void* key) : key_(key) {}
    void* key_;
};

class Verifier {
public:
    // One or several public keys, one after another in the file: a signature of any of them is good.
    static Result<std::unique_ptr<Verifier>> open(const std::string& public_key_file);
    ~Verifier();
    bool verify(ByteView message, ByteView signature) const;

private:
    explicit Verifier(std::vector<void*> keys) : keys_(std::move(keys)) {}
    std::vector<void*> keys_;
};

}  // namespace kiln
