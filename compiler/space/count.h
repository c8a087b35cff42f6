#pragma once
// A number of variants: an unsigned integer of any size. 64 bits stay inline; beyond that GMP's limb functions do the work
// (count.cpp is the only file that includes GMP).

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

namespace kiln {

class Count {
public:
    Count() = default;
    Count(uint64_t v) : small_(v) {}
    Count& operator+=(const Count& other);
    Count& operator*=(const Count& other);
    Count& operator-=(const Count& other);  // other must not exceed *this
    friend Count operator+(Count a, const Count& b) { return a += b; }
    friend Count operator*(Count a, const Count& b) { return a *= b; }
    friend Count operator-(Count a, const Count& b) { return a -= b; }
    friend bool operator==(const Count&, const Count&) = default;
    friend std::strong_ordering operator<=>(const Count& a, const Count& b);
    // Quotient; the remainder goes to *remainder unless that is null. Division by zero is a broken invariant.
    Count divide(const Count& by, Count* remainder) const;
    bool is_zero() const { return small_ == 0 && big_.empty(); }
    bool fits_u64() const { return big_.empty(); }
    uint64_t u64() const { return small_; }          // only when fits_u64()
    double approximate() const;                      // infinity past the range of double
    std::string decimal() const;                     // "27179089920"
    std::string grouped() const;                     // "27,179,089,920", for people
    static Count parse(const std::string& decimal);  // digits only, at least one

private:
    void normalise();
    std::vector<uint64_t> limbs() const;  // least first, at least one
    uint64_t small_ = 0;                  // the value when big_ is empty, else 0
    std::vector<uint64_t> big_;           // limbs, least first, at least two, top not zero
};

}  // namespace kiln
