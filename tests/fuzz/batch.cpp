// A batch of work and its answers from arbitrary bytes behind a right checksum: no crash, and nothing in the store that was not
// asked for.
#include "compiler/batch/batch.h"

#include <cstdlib>

#include "compiler/base/wire.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace kiln;
    const auto sealed = [&](const char* mark) {
        WireWriter out;
        out.text(mark);
        out.raw({data, size});
        const Fast sum = xxh3(out.view());
        out.u64(sum.low);
        out.u64(sum.high);
        return out.take();
    };
    MemoryStore store;
    const Digest asked{};
    const auto taken = take_answers(sealed("kiln.answers.v1"), {&asked, 1}, store);
    if (store.size() != 0 && (!taken.ok() || *taken == 0)) std::abort();
    class NoTools final : public Toolchain {
    public:
        std::string versions() const override { return "v"; }
        Compiled compile(Stage, std::string_view, const Options&) override { return {{}, {{Severity::error, 0, "no"}}}; }
        Result<Words> prune(WordView, const Options&) override { return input_error("no"); }
        Result<Words> optimise(WordView, const Options&) override { return input_error("no"); }
        std::vector<ToolMessage> validate(WordView, const Options&) override { return {}; }
        Result<Reflection> reflect(WordView) override { return input_error("no"); }
        std::vector<Translated> translate(WordView, const std::vector<Target>&, const SlotLayout&) override { return {}; }
        std::vector<ToolMessage> parse_back(Target, Stage, std::string_view) override { return {}; }
        std::vector<ToolMessage> link_back(Target, std::string_view, std::string_view) override { return {}; }
    } tools;
    static_cast<void>(answer_batch(sealed("kiln.batch.v1"), tools, Jobs(1)));
    return 0;
}
