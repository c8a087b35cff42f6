// glslang's parser bounds what nests to the right (parentheses, blocks, assignments) by its own stack of 10,000 entries, but
// a + b + c + ... nests to the left, is not bounded at all, and every later walk of the tree takes some 800 bytes of
// stack a level. The number of operators in an expression is an upper bound of its depth; commas that only separate arguments or
// array elements do not nest, so long tables of constants stay legal.

#include "compiler/toolchain/text_depth.h"

#include <algorithm>
#include <vector>

namespace kiln {
namespace {

struct Level {
    char open = 0;         // '(' or '{' or '[', 0: the statement
    bool list = false;     // commas separate elements
    uint32_t now = 0;      // operators of the element being read
    uint32_t deepest = 0;  // of the elements before
};

bool is_word(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; }

class Scan {
public:
    std::optional<ToolMessage> run(std::string_view text) {
        for (size_t i = 0; i < text.size(); ++i) {
            const char c = text[i];
            if (c == '\n') {
                ++line_;
            } else if (c == '#' && (i == 0 || text[i - 1] == '\n')) {
                i = std::min(text.find('\n', i), text.size()) - 1;  // a directive
            } else if (is_word(c)) {
                const size_t start = i;
                while (i + 1 < text.size() && (is_word(text[i + 1]) || text[i + 1] == '.')) ++i;
                const std::string_view word = text.substr(start, i + 1 - start);
                if (word == "struct" && ++structures_ > max_structures) {
                    return problem("over " + std::to_string(max_structures) + " structures are more than the compiler can nest");
                }
                const bool number = word.front() >= '0' && word.front() <= '9';
                if (!number) levels_.back().now += static_cast<uint32_t>(std::count(word.begin(), word.end(), '.'));
                before_ = 'w';
            } else if (c != ' ' && c != '\t' && c != '\r') {
                mark(c);
                before_ = c;
            }
            if (levels_.back().now > max_operators) {
                return problem("an expression of over " + std::to_string(max_operators) + " operators is too deep to compile");
            }
        }
        return std::nullopt;
    }

private:
    void mark(char c) {
        switch (c) {
            case ';':
                levels_.assign(1, {});
                break;
            case '(':
                open(c, before_ == 'w' || before_ == ']');
                break;
            case '[':
                open(c, false);
                break;
            case '{':
                if (before_ == '=' || before_ == ',' || before_ == '{' || before_ == '(')
                    open(c, true);
                else
                    levels_.assign(1, {});
                break;
            case ')':
                close('(');
                break;
            case ']':
                close('[');
                break;
            case '}':
                close('{');
                break;
            case ',': {
                Level& top = levels_.back();
                if (top.list) {
                    top.deepest = std::max(top.deepest, top.now);
                    top.now = 0;
                } else {
                    ++top.now;
                }
                break;
            }
            default:
                ++levels_.back().now;
        }
    }

    void open(char c, bool list) { levels_.push_back({c, list, 0, 0}); }

    void close(char open) {
        if (levels_.size() == 1 || levels_.back().open != open) {  // the end of a block, or nonsense
            levels_.assign(1, {});
            return;
        }
        const uint32_t inner = std::max(levels_.back().now, levels_.back().deepest);
        levels_.pop_back();
        levels_.back().now += inner + 1;
    }

    ToolMessage problem(std::string text) const { return {Severity::error, line_, std::move(text)}; }

    std::vector<Level> levels_ = {Level()};
    uint32_t line_ = 1, structures_ = 0;
    char before_ = 0;  // the last character that is no space; 'w' after a word
};

}  // namespace

std::optional<ToolMessage> too_deep(std::string_view text) { return Scan().run(text); }

}  // namespace kiln
