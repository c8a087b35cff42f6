#include "compiler/space/count.h"

#include <gtest/gtest.h>

#include <random>

namespace kiln {
namespace {

__extension__ typedef unsigned __int128 Wide;

Count from(Wide v) {
    return Count(static_cast<uint64_t>(v >> 64)) * Count(uint64_t{1} << 32) * Count(uint64_t{1} << 32) +
           Count(static_cast<uint64_t>(v));
}
std::string text(Wide v) {
    std::string s;
    do s.insert(s.begin(), static_cast<char>('0' + static_cast<int>(v % 10)));
    while ((v /= 10) != 0);
    return s;
}

TEST(Count, CarriesOutOfOneWord) {
    Count c(~uint64_t{0});
    c += Count(1);
    EXPECT_FALSE(c.fits_u64());
    EXPECT_EQ(c.decimal(), "18446744073709551616");
    c -= Count(1);
    EXPECT_TRUE(c.fits_u64());
    EXPECT_EQ(c.u64(), ~uint64_t{0});
    EXPECT_EQ(Count().decimal(), "0");
    EXPECT_EQ(Count(999).grouped(), "999");
    EXPECT_EQ(Count(27179089920u).grouped(), "27,179,089,920");
    EXPECT_EQ(Count::parse("0"), Count());
    EXPECT_EQ(Count::parse("00017"), Count(17));
}

TEST(Count, AgreesWith128Bits) {
    std::mt19937_64 random(20261122);
    for (int i = 0; i < 20000; ++i) {
        const auto draw = [&] { return (Wide(random() >> (random() % 64)) << 64 | random()) >> (random() % 128); };
        const Wide a = draw(), b = draw();
        const Count x = from(a), y = from(b);
        ASSERT_EQ(x.decimal(), text(a));
        ASSERT_EQ(Count::parse(text(a)), x);
        ASSERT_EQ(x < y, a < b);
        ASSERT_EQ(x == y, a == b);
        if (a >= b) {
            ASSERT_EQ((x - y).decimal(), text(a - b));
        }
        if (a + b >= a) {
            ASSERT_EQ((x + y).decimal(), text(a + b));
        }
        ASSERT_EQ((Count(static_cast<uint64_t>(a)) * Count(static_cast<uint64_t>(b))).decimal(),
                  text(Wide(static_cast<uint64_t>(a)) * static_cast<uint64_t>(b)));
        if (b != 0) {
            Count rest;
            const Count quotient = x.divide(y, &rest);
            ASSERT_EQ(quotient.decimal(), text(a / b));
            ASSERT_EQ(rest.decimal(), text(a % b));
        }
    }
}

TEST(Count, ThousandsOfDigits) {
    Count power(1), other(1);
    for (int i = 0; i < 3000; ++i) power *= Count(10);
    for (int i = 0; i < 1500; ++i) other *= Count(10);
    EXPECT_EQ(power.decimal(), "1" + std::string(3000, '0'));
    EXPECT_EQ(Count::parse(power.decimal()), power);
    EXPECT_EQ(other * other, power);
    Count rest;
    EXPECT_EQ((power + Count(7)).divide(other, &rest), other);
    EXPECT_EQ(rest, Count(7));
    EXPECT_GT(power.approximate(), 1e300);
    EXPECT_NEAR(Count::parse("1" + std::string(40, '0')).approximate(), 1e40, 1e26);
}

}  // namespace
}  // namespace kiln
