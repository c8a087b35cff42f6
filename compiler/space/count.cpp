// Nearly every count fits 64 bits, so the inline paths below come first and never allocate; only a carry out of them reaches
// GMP's mpn layer, which works on our own limb vectors and never allocates behind our back.

#include "compiler/space/count.h"

#include <gmp.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <type_traits>
#include <utility>

namespace kiln {

static_assert(sizeof(mp_limb_t) == sizeof(uint64_t) && GMP_NAIL_BITS == 0, "limbs are whole 64-bit words");
static_assert(std::is_same_v<mp_limb_t, uint64_t>, "limb vectors are handed to GMP as they are");

namespace {

mp_size_t size_of(const std::vector<uint64_t>& limbs) { return static_cast<mp_size_t>(limbs.size()); }

}  // namespace

void Count::normalise() {
    while (!big_.empty() && big_.back() == 0) big_.pop_back();
    if (big_.size() <= 1) {
        small_ = big_.empty() ? 0 : big_[0];
        big_.clear();
    } else {
        small_ = 0;
    }
}

std::vector<uint64_t> Count::limbs() const { return big_.empty() ? std::vector<uint64_t>{small_} : big_; }

Count& Count::operator+=(const Count& other) {
    if (big_.empty() && other.big_.empty()) {
        if (!__builtin_add_overflow(small_, other.small_, &small_)) return *this;
        big_ = {small_, 1};  // the wrapped sum and the carry
        small_ = 0;
        return *this;
    }
    std::vector<uint64_t> a = limbs(), b = other.limbs();
    if (a.size() < b.size()) a.swap(b);
    const uint64_t carry = mpn_add(a.data(), a.data(), size_of(a), b.data(), size_of(b));
    if (carry != 0) a.push_back(carry);
    big_ = std::move(a);
    normalise();
    return *this;
}

Count& Count::operator-=(const Count& other) {
    assert(other <= *this);
    if (big_.empty()) {
        small_ -= other.small_;
        return *this;
    }
    const std::vector<uint64_t> b = other.limbs();
    mpn_sub(big_.data(), big_.data(), size_of(big_), b.data(), size_of(b));
    normalise();
    return *this;
}

Count& Count::operator*=(const Count& other) {
    if (big_.empty() && other.big_.empty()) {
        uint64_t product = 0;
        if (!__builtin_mul_overflow(small_, other.small_, &product)) {
            small_ = product;
            return *this;
        }
    }
    if (is_zero() || other.is_zero()) return *this = Count();
    std::vector<uint64_t> a = limbs(), b = other.limbs();
    if (a.size() < b.size()) a.swap(b);
    std::vector<uint64_t> product(a.size() + b.size());
    mpn_mul(product.data(), a.data(), size_of(a), b.data(), size_of(b));
    big_ = std::move(product);
    normalise();
    return *this;
}

std::strong_ordering operator<=>(const Count& a, const Count& b) {
    if (a.big_.size() != b.big_.size()) return a.big_.size() <=> b.big_.size();
    if (a.big_.empty()) return a.small_ <=> b.small_;
    return mpn_cmp(a.big_.data(), b.big_.data(), size_of(a.big_)) <=> 0;
}

Count Count::divide(const Count& by, Count* remainder) const {
    assert(!by.is_zero());
    Count quotient, rest;
    if (*this < by) {
        rest = *this;
    } else if (big_.empty()) {
        quotient.small_ = small_ / by.small_;
        rest.small_ = small_ % by.small_;
    } else {
        const std::vector<uint64_t> divisor = by.limbs();
        quotient.big_.resize(big_.size() - divisor.size() + 1);
        rest.big_.resize(divisor.size());
        mpn_tdiv_qr(quotient.big_.data(), rest.big_.data(), 0, big_.data(), size_of(big_), divisor.data(), size_of(divisor));
        quotient.normalise();
        rest.normalise();
    }
    if (remainder != nullptr) *remainder = std::move(rest);
    return quotient;
}

double Count::approximate() const {
    if (big_.empty()) return static_cast<double>(small_);
    double value = 0;
    for (size_t i = big_.size(); i-- > 0;) value = std::ldexp(value, 64) + static_cast<double>(big_[i]);
    return value;
}

std::string Count::decimal() const {
    if (big_.empty()) return std::to_string(small_);
    std::vector<uint64_t> scratch = big_;  // mpn_get_str destroys its operand
    std::vector<unsigned char> digits(big_.size() * 20 + 1);
    const size_t n = mpn_get_str(digits.data(), 10, scratch.data(), size_of(scratch));
    std::string text;
    for (size_t i = 0; i < n; ++i)
        if (!text.empty() || digits[i] != 0) text.push_back(static_cast<char>('0' + digits[i]));
    return text;
}

std::string Count::grouped() const {
    const std::string plain = decimal();
    std::string text;
    for (size_t i = 0; i < plain.size(); ++i) {
        if (i != 0 && (plain.size() - i) % 3 == 0) text.push_back(',');
        text.push_back(plain[i]);
    }
    return text;
}

Count Count::parse(const std::string& decimal) {
    assert(!decimal.empty());
    std::vector<unsigned char> digits;
    for (const char c : decimal) {
        assert(c >= '0' && c <= '9');
        if (!digits.empty() || c != '0') digits.push_back(static_cast<unsigned char>(c - '0'));
    }
    Count value;
    if (digits.empty()) return value;
    value.big_.resize(digits.size() / 19 + 1);
    const mp_size_t used = mpn_set_str(value.big_.data(), digits.data(), digits.size(), 10);
    value.big_.resize(static_cast<size_t>(used));
    value.normalise();
    return value;
}

}  // namespace kiln
