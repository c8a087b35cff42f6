#pragma once
// Reads the items of a stage's files in order with the set of variants that reaches each, and emits guarded text.

#include <string>
#include <vector>

#include "compiler/split/emitted.h"
#include "compiler/split/expand.h"
#include "compiler/split/include.h"
#include "compiler/split/pp_expr.h"

namespace kiln {

class Preprocessor {
public:
    Preprocessor(Preprocessing& pp, Sources& sources, Emitted& emitted, const Options& options, uint64_t max_states);

    // Defines what stands before the first line. `body` is text.
    void predefine(std::string_view name, std::string_view body, Set set);
    void predefine_axis(uint32_t axis, Set start);
    // Reads the whole stage.
    void run(uint16_t root, Set start);
    const Emitted::Sequence& text() const { return sequences_.front(); }

    uint64_t states() const { return states_; }
    bool over_limit() const { return over_limit_; }
    // The sets that conditions split off, for naming the axes that split most.
    const std::vector<Set>& split_sets() const { return split_sets_; }

private:
    struct Frame {
        Set outer;
        Set rest;                 // no branch taken yet
        Set branch;               // of the open branch
        bool transparent = true;  // the open branch writes straight into what is outside
        std::vector<std::pair<Set, Emitted::Sequence>> done;
        Set covered = Diagram::none();
    };
    void read_file(uint16_t index, size_t depth);
    void text_run(const LexedFile& file, const Item& item, bool root_end);
    const Token* invocation(const Token* at, const Token* end, Expander::Ends ends);
    bool step(Set set, const Token*& at, const Token* end, Expander::Ends ends, std::vector<Token>& out, Disagreement& why);
    size_t conditional(const LexedFile& file, uint16_t index, size_t i);
    Set condition(const Item& item, const LexedFile& file, uint16_t index, Set set);
    void open_branch(Frame& frame, Set set);
    void close_branch(Frame& frame);
    void count_states(uint64_t more, Set split_off);

    void define(const Token& at, const Token* begin, const Token* end);
    void undefine(const Token& at, const Token* begin, const Token* end);
    void include(const Token& at, const Token* begin, const Token* end, uint16_t index, size_t depth);
    void set_line(const Token& at, const Token* begin, const Token* end);
    void error_directive(const Token& at, std::string_view message);
    void extension(const Token& at, const Token* begin, const Token* end);
    void pragma(const Token& at, const Token* begin, const Token* end, uint16_t index);
    void put_line(const Token& at, const std::string& text);
    bool reserved(const Token& name, const char* directive);
    void kill(Set set) {
        dead_ = pp_.diagram.either(dead_, set);
        here_ = pp_.diagram.minus(here_, set);
    }
    std::string spelled(const Token* begin, const Token* end) const;
    std::string chain(uint16_t next) const;
    Emitted::Sequence& out() { return sequences_.back(); }

    Preprocessing& pp_;
    Sources& sources_;
    Emitted& emitted_;
    Evaluator evaluator_;
    uint64_t max_states_;
    uint64_t states_ = 1;
    size_t included_ = 0;  // tokens read by #include, over all of them
    bool over_limit_ = false;
    std::vector<Set> split_sets_;
    Set here_ = Diagram::none();
    Set dead_ = Diagram::none();         // variants that met a mistake nothing can follow
    Set named_lines_ = Diagram::none();  // where __FILE__ is a name
    Set pack420_ = Diagram::none();      // where line continuation is allowed before version 420
    std::vector<Frame> frames_;
    std::vector<Emitted::Sequence> sequences_;  // the innermost last
    std::vector<uint16_t> stack_;               // files being read
    std::vector<Set> read_once_;                // by file: variants that saw #pragma once
    const Item* version_ = nullptr;             // of the root file
};

}  // namespace kiln
