// The seed corpora of the fuzzers `table` and `proof` are tables that this writer makes: they must stay readable, which also
// guards the format against a silent change. KILN_BLESS=1 in the environment writes them again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "compiler/table/proof.h"
#include "compiler/table/table_read.h"
#include "sample.h"

namespace kiln::test {
namespace {

std::string corpus(const std::string& path) { return std::string(KILN_SOURCE_DIR) + "/tests/fuzz/corpus/" + path; }

Bytes read(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return Bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
}

void bless(const std::string& path, Bytes bytes, bool mark) {
    if (mark) bytes.push_back(1);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

TEST(Corpus, SeedsAreWhatTheWriterMakes) {
    Sample small = small_sample();
    SampleShader shader;
    shader.name = "wide";
    for (int i = 0; i < 20; ++i) shader.axes.push_back(boolean("b" + std::to_string(i)));
    for (int i = 0; i + 1 < 20; ++i) shader.forbid.push_back("b" + std::to_string(i) + " && !b" + std::to_string(i + 1));
    shader.stages = {{Stage::compute, {3, 9}, {}, {"b3", "!b3 && b9", "!b3 && !b9"}}};
    Sample wide({shader});
    const std::pair<const char*, Sample*> samples[] = {{"small", &small}, {"wide", &wide}};
    for (const auto& [name, sample] : samples) {
        const auto files = write_table(sample->input());
        ASSERT_TRUE(files.ok());
        const std::string table = corpus(std::string("table/") + name + ".kiln"),
                          sealed = corpus(std::string("table/") + name + "_resealed.kiln"),
                          proof = corpus(std::string("proof/") + name + ".proof");
        if (std::getenv("KILN_BLESS") != nullptr) {
            bless(table, files->table, false);
            bless(sealed, files->table, true);
            bless(proof, files->proof, false);
        }
        const Bytes on_disk = read(table);
        EXPECT_EQ(on_disk, files->table) << "the format changed: raise its version, or bless a version that was never released";
        EXPECT_TRUE(TableView::open(on_disk).ok());
        EXPECT_TRUE(read_proof(read(proof), on_disk).ok());
    }
}

}  // namespace
}  // namespace kiln::test
