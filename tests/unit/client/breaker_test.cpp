#include "cache/client/breaker.h"

#include <gtest/gtest.h>

namespace kiln {
namespace {

using std::chrono::seconds;

struct Clocked {
    Breaker::Clock::time_point time{};
    Breaker breaker;
    Clocked()
        : breaker([this] {
              Breaker::Rules rules;
              rules.failures = 3;
              rules.pause = seconds(10);
              rules.longest_pause = seconds(25);
              rules.now = [this] { return time; };
              return rules;
          }()) {}
};

TEST(Breaker, OpensAfterFailuresInARow) {
    Clocked c;
    c.breaker.failed(false);
    c.breaker.failed(false);
    c.breaker.succeeded();
    c.breaker.failed(false);
    c.breaker.failed(false);
    EXPECT_TRUE(c.breaker.may_ask());
    c.breaker.failed(false);
    EXPECT_FALSE(c.breaker.may_ask());
    EXPECT_EQ(c.breaker.times(), 1u);
}

TEST(Breaker, ADeadlineCountsTwice) {
    Clocked c;
    c.breaker.failed(true);
    EXPECT_TRUE(c.breaker.may_ask());
    c.breaker.failed(true);
    EXPECT_FALSE(c.breaker.may_ask());
}

TEST(Breaker, OneTriesAfterAWhileAndTheWhileGrows) {
    Clocked c;
    for (int i = 0; i < 3; ++i) c.breaker.failed(false);
    for (const int pause : {10, 20, 25, 25}) {
        c.time += seconds(pause) - std::chrono::milliseconds(1);
        EXPECT_FALSE(c.breaker.may_ask()) << pause;
        c.time += std::chrono::milliseconds(1);
        EXPECT_TRUE(c.breaker.may_ask()) << pause;
        EXPECT_FALSE(c.breaker.may_ask()) << "two try at once";
        for (int i = 0; i < 20; ++i) c.breaker.failed(false);  // one batch
    }
    c.time += seconds(25);
    EXPECT_TRUE(c.breaker.may_ask());
    c.breaker.succeeded();
    EXPECT_TRUE(c.breaker.may_ask());
    for (int i = 0; i < 3; ++i) c.breaker.failed(false);
    c.time += seconds(10);
    EXPECT_TRUE(c.breaker.may_ask()) << "the while did not begin anew";
}

}  // namespace
}  // namespace kiln
