// The test program, and with the argument `worker` the worker process of its own tests: a fake device whose first word of the
// first stage says what happens.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "compiler/validate/workers.h"
#include "tests/unit/validate/fake_device.h"

using namespace kiln;

namespace {

Result<std::unique_ptr<Device>> open_fake() {
    if (std::getenv("KILN_TEST_NO_DRIVER") != nullptr) return environment_error("no driver today");
    static int runs = 0;
    return std::unique_ptr<Device>(new test::FakeDevice([](const PipelineRequest& request) {
        ++runs;
        switch (request.stages.front().words.front()) {
            case 1:
                std::abort();
            case 2:
                for (;;) pause();
            case 3:
                if (runs > 1) _exit(9);  // dies in a used process, works in a fresh one
                break;
            default:
                break;
        }
        return test::picture(request);
    }));
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return run_worker(open_fake);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
