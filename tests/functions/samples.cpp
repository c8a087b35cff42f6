#include "tests/functions/samples.h"

#include <random>

namespace kiln::test {

namespace {

class Maker {
public:
    explicit Maker(const FunctionTest& function) : function_(function) {
        for (const FunctionTest::Slot& a : function.arguments) dimensions_ += a.domain.dimensions;
        point_.resize(dimensions_);
    }

    void lattice() {
        if (dimensions_ == 0) return;
        uint64_t side = 2;
        const auto points = [this](uint64_t n) {
            double all = 1;
            for (uint32_t d = 0; d < dimensions_; ++d) all *= static_cast<double>(n);
            return all;
        };
        if (points(side) > lattice_samples) return;  // too many dimensions: random points serve better
        while (points(side + 1) <= lattice_samples) ++side;
        for (uint64_t i = 0, all = static_cast<uint64_t>(points(side)); i < all; ++i) {
            uint64_t rest = i;
            for (double& p : point_) {
                p = static_cast<double>(rest % side) / static_cast<double>(side - 1);
                rest /= side;
            }
            add([](size_t) { return inside; });
        }
    }

    void random() {
        for (uint32_t i = 0; i < random_samples; ++i) {
            fill_point();
            add([](size_t) { return inside; });
        }
    }

    // Every combination where there are few enough; else random ones, with now and then an argument from the inside.
    void extremes() {
        double all = 1;
        for (const FunctionTest::Slot& a : function_.arguments) all *= a.domain.extremes;
        std::vector<uint32_t> chosen(function_.arguments.size());
        const bool every = all <= extreme_samples;
        for (uint64_t i = 0, n = every ? static_cast<uint64_t>(all) : extreme_samples; i < n; ++i) {
            uint64_t rest = i;
            fill_point();
            for (size_t a = 0; a < chosen.size(); ++a) {
                const uint32_t count = function_.arguments[a].domain.extremes;
                chosen[a] = every ? static_cast<uint32_t>(rest % count) : (random_() & 3) == 0 ? inside : below(count);
                rest /= count;
            }
            add([&](size_t a) { return chosen[a]; });
        }
    }

    std::vector<uint32_t> take() { return std::move(words_); }

private:
    static constexpr uint32_t inside = ~0u;

    uint32_t below(uint32_t n) { return static_cast<uint32_t>(random_() % n); }
    void fill_point() {
        for (double& p : point_) p = static_cast<double>(random_() >> 11) * 0x1p-53;
    }

    // One sample: argument `a` is its extreme which(a), or lies inside, at its place in point_.
    template <class Which>
    void add(Which which) {
        const size_t start = words_.size();
        words_.resize(start + function_.words);
        std::map<std::string, uint32_t> places;
        const double* p = point_.data();
        for (size_t a = 0; a < function_.arguments.size(); ++a) {
            const FunctionTest::Slot& slot = function_.arguments[a];
            uint32_t* out = words_.data() + start + slot.first;
            const Known known(places, words_.data() + start);
            const uint32_t extreme = which(a);
            if (extreme == inside)
                slot.domain.inside(p, known, out);
            else
                slot.domain.extreme(extreme, known, out);
            places[slot.name] = slot.first;
            p += slot.domain.dimensions;
        }
        if (function_.skip && function_.skip(words_.data() + start)) words_.resize(start);
    }

    const FunctionTest& function_;
    uint32_t dimensions_ = 0;
    std::vector<double> point_;
    std::vector<uint32_t> words_;
    std::mt19937_64 random_{sample_seed};
};

}  // namespace

std::vector<uint32_t> make_samples(const FunctionTest& function) {
    Maker maker(function);
    maker.lattice();
    maker.random();
    maker.extremes();
    return maker.take();
}

std::vector<uint32_t> random_arguments(const FunctionTest& function) {
    Maker maker(function);
    maker.random();
    return maker.take();
}

}  // namespace kiln::test
