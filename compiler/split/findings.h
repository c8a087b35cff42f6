#pragma once
// Mistakes found while preprocessing, each with the set of variants that meets it. The same mistake at the same place is one
// finding, whichever way it was reached.

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "compiler/base/diag.h"
#include "compiler/space/space.h"
#include "compiler/split/lex.h"

namespace kiln {

struct Finding {
    Severity severity = Severity::error;
    uint16_t file = 0;
    uint32_t line = 0, column = 0;
    std::string message;
    std::vector<std::string> notes;  // beside the condition
    Set set;
    bool forbid = false;  // stands for a rule: say which
};

class Findings {
public:
    explicit Findings(Diagram& diagram) : diagram_(diagram) {}

    void error(const Token& at, const std::string& message, Set set, std::vector<std::string> notes = {}, bool forbid = false) {
        add(Severity::error, at.file, at.line, at.column, message, set, std::move(notes), forbid);
    }
    void warning(const Token& at, const std::string& message, Set set, std::vector<std::string> notes = {}) {
        add(Severity::warning, at.file, at.line, at.column, message, set, std::move(notes), false);
    }
    const std::vector<Finding>& list() const { return list_; }
    Set failed() const { return failed_; }

private:
    void add(Severity severity, uint16_t file, uint32_t line, uint32_t column, const std::string& message, Set set,
             std::vector<std::string> notes, bool forbid) {
        if (set == Diagram::none()) return;
        if (severity == Severity::error) failed_ = diagram_.either(failed_, set);
        const auto [at, fresh] = known_.emplace(std::tuple(file, line, column, message), list_.size());
        if (fresh) {
            if (list_.size() < limit)
                list_.push_back({severity, file, line, column, message, std::move(notes), set, forbid});
            else
                at->second = limit;
        } else if (at->second < limit) {
            list_[at->second].set = diagram_.either(list_[at->second].set, set);
        }
    }

    static constexpr size_t limit = 200;
    Diagram& diagram_;
    Set failed_ = Diagram::none();
    std::vector<Finding> list_;
    std::map<std::tuple<uint16_t, uint32_t, uint32_t, std::string>, size_t> known_;
};

}  // namespace kiln
