// kiln-worker BATCH ANSWERS: what an engine runs. A program of its own, since a node need not have what kiln itself links.
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>

#include "compiler/batch/batch.h"

namespace {

int fail(const char* what, int code) {
    std::fprintf(stderr, "kiln-worker: %s\n", what);
    return code;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace kiln;
    if (argc == 2 && std::strcmp(argv[1], "--help") == 0)
        return std::puts(
                   "usage: kiln-worker BATCH ANSWERS\n\nCompiles and translates a batch of work that 'kiln build --execute' "
                   "sent.") < 0
                   ? 3
                   : 0;
    if (argc != 3) return fail("usage: kiln-worker BATCH ANSWERS", 2);
    std::ifstream in(argv[1], std::ios::binary);
    if (!in) return fail("the batch cannot be read", 3);
    const Bytes batch{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    const auto tools = make_toolchain();
    // A job is one processor's worth: the engine runs as many as it has processors.
    const Result<Bytes> answers = answer_batch(batch, *tools, Jobs(1));
    if (!answers.ok()) return fail(answers.error().message.c_str(), static_cast<int>(answers.error().fault));
    std::ofstream out(argv[2], std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(answers->data()), static_cast<std::streamsize>(answers->size()));
    out.close();
    return out ? 0 : fail("the answers cannot be written", 3);
}
