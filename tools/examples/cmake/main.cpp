// Opens the table named on the command line and picks a variant: game TABLE [stripes]
#include <kiln/kiln.hpp>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "paint_keys.h"

namespace keys = kiln_keys::paint::paint;

int main(int argc, char** argv) {
    if (argc < 2) return 2;
    std::ifstream file(argv[1], std::ios::binary);
    const std::string read((std::istreambuf_iterator<char>(file)), {});
    std::vector<std::uint64_t> bytes((read.size() + 7) / 8);  // a table starts at a multiple of 8; a mapping does
    read.copy(reinterpret_cast<char*>(bytes.data()), read.size());

    kiln_runtime::Table table;
    if (const kiln_status status = table.open(bytes.data(), read.size()); status != KILN_OK) {
        std::printf("%s: %s\n", argv[1], kiln_status_text(status));
        return 1;
    }
    const kiln_runtime::Shader paint = table.shader(keys::shader_name);

    keys::Variant variant;
    variant.quality = keys::quality_axis::high;
    variant.striped = argc > 2 ? keys::striped_axis::true_ : keys::striped_axis::false_;
    const keys::Key key = variant.key();

    std::uint32_t module = 0;
    if (paint.find(key.words, KILN_FRAGMENT, module) != KILN_OK) {
        char why[256];
        const std::string_view text = paint.why(key.words, why, sizeof why);
        std::printf("%.*s\n", static_cast<int>(text.size()), text.data());
        return 1;
    }
    std::printf("module %u, %u words of SPIR-V\n", module, table.words(module).size());
    return 0;
}
