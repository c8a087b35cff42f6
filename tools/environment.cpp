#include "tools/environment.h"

#include <algorithm>

namespace kiln {

namespace {

struct Variable {
    const char* name;
    const char* help;
};

constexpr Variable variables[] = {
    {"KILN_CACHE", "what --cache takes: a folder or 'none', and a cache server; several with commas"},
    {"KILN_CACHE_SIZE", "bound of the cache folder, as 300M or 5G; 0 for none"},
    {"KILN_CACHE_SYNC", "what an entry waits for: none (default), file or folder"},
    {"KILN_CACHE_TIMEOUT", "seconds to wait for an answer of a cache server"},
    {"KILN_CACHE_DRAIN", "seconds that a finished build waits for its last uploads"},
    {"KILN_CACHE_READ_ONLY", "1: send nothing to the cache server"},
    {"KILN_CACHE_TOKEN", "bearer token of the cache server; better is"},
    {"KILN_CACHE_TOKEN_FILE", "a file that holds it"},
    {"KILN_CACHE_PLAIN_TOKEN", "1: a token may go over a network without TLS"},
    {"KILN_CACHE_CA", "PEM file of the authorities to trust for a cache server"},
    {"KILN_CACHE_SIGN", "private Ed25519 key (PEM) that signs what is uploaded"},
    {"KILN_CACHE_TRUST", "public Ed25519 keys (PEM); records signed by none of them are not used"},
    {"KILN_EXECUTE_TOKEN_FILE", "a file with the bearer token of an execution engine"},
    {"KILN_EXECUTE_CA", "PEM file of the authorities to trust for an execution engine"},
    {"KILN_EXECUTE_PLATFORM", "platform properties that a worker must have, as name=value,name=value"},
    {"KILN_WORKER", "the worker's program, if it is not beside kiln"},
    {"KILN_ICD", "Vulkan driver manifest, if it is not to be lavapipe"},
    {"KILN_PROGRESS", "seconds between lines of progress where standard error is no terminal (30), or 'off'"},
    {"NO_COLOR", "set: no colour on a terminal"},
};

}  // namespace

std::string help_of_environment() {
    size_t width = 0;
    for (const Variable& v : variables) width = std::max(width, std::string(v.name).size());
    std::string out = "environment variables; an option goes before a variable\n\n";
    for (const Variable& v : variables) {
        const std::string name = v.name;
        out += "  " + name + std::string(width - name.size() + 2, ' ') + v.help + "\n";
    }
    return out + "\nexample:\n  KILN_CACHE=https://cache.example:8443/main kiln build manifests/surface.yaml -o surface.kiln\n";
}

}  // namespace kiln
