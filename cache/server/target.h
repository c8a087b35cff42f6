#pragma once
// What a request's target names.
//
//     target := "/" (instance "/")? ("ac" | "cas") "/" 64 lower-case hex digits
//             | "/" (instance "/")? "dav" ("/" path)?
//             | "/status" | "/metrics" | "/healthz" | "/"
//     path   := segments of [A-Za-z0-9._-] joined by "/", none of them "." or "..", 512 characters in all; one "/" may end it
//
// Nothing is decoded, joined or normalised: a target with '%', a query, an empty segment or any other character is nothing. A
// key leaves here as 32 bytes and a path is only ever hashed, so that no text from the network becomes part of a file name.

#include <optional>
#include <string>
#include <string_view>

#include "compiler/base/digest.h"

namespace kiln {

struct Target {
    enum class What { action, blob, dav, status, metrics, health, root } what = What::root;
    std::string instance;
    Digest key;               // action, blob
    std::string path;         // dav, without slashes at its ends
    bool collection = false;  // dav: the root, or it ended in "/"
};

std::optional<Target> parse_target(std::string_view text);
const char* name_of(Target::What what);

}  // namespace kiln
