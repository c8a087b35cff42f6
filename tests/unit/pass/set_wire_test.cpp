#include "compiler/space/set_wire.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln {
namespace {

std::vector<Set> random_sets(Diagram& diagram, std::mt19937& random) {
    std::vector<Set> sets;
    for (int s = 0; s < 6; ++s) {
        Set set = Diagram::none();
        for (int t = 0; t < 4; ++t) {
            Set term = Diagram::all();
            for (uint32_t a = 0; a < diagram.radices().size(); ++a) {
                std::vector<bool> digits(diagram.radices()[a]);
                for (size_t d = 0; d < digits.size(); ++d) digits[d] = random() % 3 != 0;
                term = diagram.both(term, diagram.where(a, digits));
            }
            set = diagram.either(set, term);
        }
        sets.push_back(set);
    }
    sets.push_back(Diagram::none());
    sets.push_back(Diagram::all());
    return sets;
}

TEST(SetWire, RoundTripsIntoTheSameNodes) {
    std::mt19937 random(11);
    for (int round = 0; round < 200; ++round) {
        const std::vector<uint32_t> radices{2, 3, 5, 2};
        const std::vector<uint32_t> order{2, 0, 3, 1};
        Diagram diagram(radices, order);
        const std::vector<Set> sets = random_sets(diagram, random);
        WireWriter out;
        write_sets(out, diagram, sets);
        std::vector<Set> back;
        WireReader in(out.view());
        ASSERT_TRUE(read_sets(in, diagram, back));
        EXPECT_TRUE(in.at_end());
        EXPECT_EQ(back, sets);
    }
}

TEST(SetWire, RefusesTruncationAndForeignDiagrams) {
    std::mt19937 random(12);
    Diagram diagram({2, 3, 5}, {0, 1, 2});
    WireWriter out;
    write_sets(out, diagram, random_sets(diagram, random));
    std::vector<Set> back;
    for (size_t n = 0; n < out.size(); ++n) {
        const Bytes cut(out.view().begin(), out.view().begin() + static_cast<std::ptrdiff_t>(n));
        WireReader in(cut);
        EXPECT_FALSE(read_sets(in, diagram, back)) << n;
    }
    Diagram other({2, 3, 5}, {1, 0, 2});
    WireReader in(out.view());
    EXPECT_FALSE(read_sets(in, other, back));
}

TEST(SetWire, SurvivesFlippedBits) {
    std::mt19937 random(13);
    Diagram diagram({2, 3, 5}, {0, 1, 2});
    WireWriter out;
    write_sets(out, diagram, random_sets(diagram, random));
    for (size_t i = 0; i < out.size(); ++i) {
        for (int bit = 0; bit < 8; ++bit) {
            Bytes bytes = out.view();
            bytes[i] = static_cast<uint8_t>(bytes[i] ^ (1u << bit));
            Diagram fresh({2, 3, 5}, {0, 1, 2});
            WireReader in(bytes);
            std::vector<Set> back;
            read_sets(in, fresh, back);  // any answer, but no crash and no overread
        }
    }
}

}  // namespace
}  // namespace kiln
