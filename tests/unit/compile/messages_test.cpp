#include "compiler/toolchain/messages.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

TEST(Messages, Reads) {
    const struct {
        const char* log;
        std::vector<ToolMessage> messages;
    } cases[] = {
        {"", {}},
        {"\n\n", {}},
        {"ERROR: 0:12: 'x' : undeclared identifier \n", {{Severity::error, 12, "'x' : undeclared identifier"}}},
        {"ERROR: 0:12: '' :  syntax error, unexpected COMMA\n", {{Severity::error, 12, "syntax error, unexpected COMMA"}}},
        {"WARNING: lib/a.glsl:7: old\n", {{Severity::warning, 7, "old"}}},
        {"ERROR: Linking vertex stage: bad\n", {{Severity::error, 0, "Linking vertex stage: bad"}}},
        {"ERROR: 0:1: a \nERROR: 0:1: '' : compilation terminated \nERROR: 2 compilation errors.  No code generated.\n\n",
         {{Severity::error, 1, "a"}}},
        {"ERROR: 0:3: first\n    second part\nWARNING: 0:4: other\n",
         {{Severity::error, 3, "first second part"}, {Severity::warning, 4, "other"}}},
        {"chatter\nERROR: 0:3: x", {{Severity::error, 3, "x"}}},
        {"ERROR: 0:99999999999: big", {{Severity::error, 0, "0:99999999999: big"}}},
        {"ERROR: 0:", {{Severity::error, 0, "0:"}}},
        {"INTERNAL ERROR: oops\nNOTE: hint\n", {{Severity::error, 0, "oops"}, {Severity::note, 0, "hint"}}},
    };
    for (const auto& c : cases) {
        const std::vector<ToolMessage> got = read_messages(c.log);
        ASSERT_EQ(c.messages.size(), got.size()) << c.log;
        for (size_t i = 0; i < got.size(); ++i) {
            EXPECT_EQ(c.messages[i].severity, got[i].severity) << c.log;
            EXPECT_EQ(c.messages[i].line, got[i].line) << c.log;
            EXPECT_EQ(c.messages[i].text, got[i].text) << c.log;
        }
    }
}

}  // namespace
}  // namespace kiln
