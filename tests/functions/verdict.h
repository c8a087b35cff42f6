#pragma once
// Judges what the device returned for one function.

#include "tests/functions/function.h"

namespace kiln::test {

class Verdict {
public:
    // samples: as make_samples makes them.
    Verdict(const FunctionTest& function, const std::vector<uint32_t>& samples);
    // One compilation's results, result.picks.size() words a sample. `how` names it in breaches.
    void judge(const std::vector<uint32_t>& results, const std::string& how, std::vector<std::string>& breaches);
    // After all compilations: the shares that apply to the whole, the model.
    Figures finish(std::vector<std::string>& breaches);

private:
    struct Expected {  // one component of one sample
        double exact = 0;
        float single = 0;
        float bound = 0;  // with the margin
    };
    // Whether relative figures mean something: the bound is under 1 % of the result.
    static bool conditioned(const Expected& e, double scale);
    std::string describe(size_t sample) const;

    const FunctionTest& function_;
    const std::vector<uint32_t>& samples_;
    uint32_t components_;
    std::vector<Expected> expected_;
    std::vector<double> scale_;  // a sample's largest component
    std::vector<bool> close_;    // a sample's decision was too close to call
    std::vector<bool> undecided_;
    std::vector<std::string> reference_breaches_;
    Figures figures_;
};

}  // namespace kiln::test
