// test_functions [--costs] [gtest's options]: tests, or measures what the functions cost (costs.h).

#include <cstdio>
#include <string_view>

#include "tests/functions/costs.h"

int main(int argc, char** argv) {
    bool costs = false;
    int kept = 1;
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]) == "--costs")
            costs = true;
        else
            argv[kept++] = argv[i];
    argc = kept;
    if (costs) ::testing::GTEST_FLAG(filter) = "Functions.*";
    ::testing::InitGoogleTest(&argc, argv);
    if (argc > 1) {
        std::fprintf(stderr, "test_functions: unknown argument '%s'\n", argv[1]);
        return 2;
    }
    kiln::test::costs_wanted() = costs;
    return RUN_ALL_TESTS();
}
