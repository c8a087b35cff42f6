// Opens a variant table and picks a variant by name:
//
//     pick surface.kiln surface light=point pass=forward
//
// A game maps the file, fetches the shader's handle once, keeps keys as numbers (see `kiln build --header`) and calls find.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "kiln.hpp"

int main(int argc, char** argv) {
    if (argc < 3) return std::fprintf(stderr, "usage: pick T.kiln SHADER [axis=value]...\n"), 2;
    std::ifstream file(argv[1], std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    kiln_runtime::Table table;
    if (const kiln_status status = table.open(bytes.data(), bytes.size()); status != KILN_OK)
        return std::fprintf(stderr, "%s: %s\n", argv[1], kiln_status_text(status)), 1;
    const kiln_runtime::Shader shader = table.shader(argv[2]);
    if (!shader) return std::fprintf(stderr, "no shader %s\n", argv[2]), 1;

    std::vector<std::uint64_t> key(shader.key_words());
    for (int i = 3; i < argc; ++i) {
        char* value = std::strchr(argv[i], '=');
        if (value != nullptr) *value++ = '\0';
        if (value == nullptr || !shader.set(key.data(), argv[i], value))
            return std::fprintf(stderr, "no such axis or value: %s\n", argv[i]), 1;
    }
    std::uint32_t modules[KILN_MAX_STAGES];
    if (shader.find(key.data(), modules) != KILN_OK) {
        char why[512];
        std::fprintf(stderr, "%s\n", std::string(shader.why(key.data(), why, sizeof why)).c_str());
        return 1;
    }
    for (std::uint32_t i = 0; i < shader.stages(); ++i)
        std::printf("stage %u: module %u, %u words of SPIR-V\n", shader.raw()->stage[i], modules[i],
                    table.words(modules[i]).size());
    return 0;
}
