// Every instruction is a head, told by one letter a word (SPIR-V specification, section 3.49), and a tail of equal words:
//     t type   r result   i id   n number         tail:  I ids   N numbers   - nothing
// `m` is a mask whose bits may bring further words; only the masks that bring none, or ids alone, are read here.

#include "compiler/toolchain/spirv_operands.h"

#include <array>
#include <string_view>

namespace kiln {
namespace {

constexpr size_t header_words = 5;
constexpr uint32_t magic = 0x07230203;
constexpr uint16_t op_entry_point = 15;
constexpr size_t known_opcodes = 400;
constexpr uint32_t most_ids = 4'194'303;  // SPIR-V specification, section 2.17: what memory is taken for follows from this

struct Range {
    uint16_t first, last;
    const char* form;  // head, then one letter of tail
};

constexpr Range ranges[] = {
    {0, 0, "-"},            // Nop
    {1, 1, "tr-"},          // Undef
    {4, 4, "N"},            // SourceExtension
    {5, 5, "iN"},           // Name
    {6, 6, "inN"},          // MemberName
    {10, 10, "N"},          // Extension
    {11, 11, "rN"},         // ExtInstImport
    {12, 12, "trinI"},      // ExtInst: all sets of instructions for shaders take ids
    {14, 14, "nn-"},        // MemoryModel
    {16, 16, "inN"},        // ExecutionMode
    {17, 17, "n-"},         // Capability
    {19, 20, "r-"},         // TypeVoid, TypeBool
    {21, 22, "rN"},         // TypeInt, TypeFloat
    {23, 24, "rin-"},       // TypeVector, TypeMatrix
    {25, 25, "riN"},        // TypeImage
    {26, 26, "r-"},         // TypeSampler
    {27, 27, "ri-"},        // TypeSampledImage
    {28, 28, "rii-"},       // TypeArray
    {29, 29, "ri-"},        // TypeRuntimeArray
    {30, 30, "rI"},         // TypeStruct
    {32, 32, "rni-"},       // TypePointer
    {33, 33, "riI"},        // TypeFunction
    {41, 42, "tr-"},        // ConstantTrue, ConstantFalse
    {43, 43, "trnN"},       // Constant
    {44, 44, "trI"},        // ConstantComposite
    {46, 46, "tr-"},        // ConstantNull
    {48, 49, "tr-"},        // SpecConstantTrue, SpecConstantFalse
    {50, 50, "trnN"},       // SpecConstant
    {51, 51, "trI"},        // SpecConstantComposite
    {54, 54, "trni-"},      // Function
    {55, 55, "tr-"},        // FunctionParameter
    {56, 56, "-"},          // FunctionEnd
    {57, 57, "triI"},       // FunctionCall
    {59, 59, "trnI"},       // Variable
    {60, 60, "triii-"},     // ImageTexelPointer
    {61, 61, "trimN"},      // Load
    {62, 62, "iimN"},       // Store
    {65, 66, "triI"},       // AccessChain, InBoundsAccessChain
    {68, 68, "trin-"},      // ArrayLength
    {71, 71, "inN"},        // Decorate
    {72, 72, "innN"},       // MemberDecorate
    {77, 77, "trii-"},      // VectorExtractDynamic
    {78, 78, "triii-"},     // VectorInsertDynamic
    {79, 79, "triiN"},      // VectorShuffle
    {80, 80, "trI"},        // CompositeConstruct
    {81, 81, "triN"},       // CompositeExtract
    {82, 82, "triiN"},      // CompositeInsert
    {83, 84, "tri-"},       // CopyObject, Transpose
    {86, 86, "trii-"},      // SampledImage
    {87, 88, "triimI"},     // ImageSampleImplicitLod, ImageSampleExplicitLod
    {89, 90, "triiimI"},    // ... Dref
    {91, 92, "triimI"},     // ... Proj
    {93, 94, "triiimI"},    // ... ProjDref
    {95, 95, "triimI"},     // ImageFetch
    {96, 97, "triiimI"},    // ImageGather, ImageDrefGather
    {98, 98, "triimI"},     // ImageRead
    {99, 99, "iiimI"},      // ImageWrite
    {100, 101, "tri-"},     // Image, ImageQueryFormat
    {103, 103, "trii-"},    // ImageQuerySizeLod
    {104, 104, "tri-"},     // ImageQuerySize
    {105, 105, "trii-"},    // ImageQueryLod
    {106, 107, "tri-"},     // ImageQueryLevels, ImageQuerySamples
    {109, 118, "tri-"},     // conversions
    {124, 124, "tri-"},     // Bitcast
    {126, 127, "tri-"},     // SNegate, FNegate
    {128, 152, "trii-"},    // IAdd ... SMulExtended
    {154, 157, "tri-"},     // Any, All, IsNan, IsInf
    {164, 167, "trii-"},    // LogicalEqual ... LogicalAnd
    {168, 168, "tri-"},     // LogicalNot
    {169, 169, "triii-"},   // Select
    {170, 199, "trii-"},    // comparisons, shifts, bitwise
    {200, 200, "tri-"},     // Not
    {201, 201, "triiii-"},  // BitFieldInsert
    {202, 203, "triii-"},   // BitFieldSExtract, BitFieldUExtract
    {204, 205, "tri-"},     // BitReverse, BitCount
    {207, 215, "tri-"},     // derivatives
    {224, 224, "iii-"},     // ControlBarrier
    {225, 225, "ii-"},      // MemoryBarrier
    {227, 227, "triii-"},   // AtomicLoad
    {228, 228, "iiii-"},    // AtomicStore
    {229, 229, "triiii-"},  // AtomicExchange
    {234, 242, "triiii-"},  // AtomicIAdd ... AtomicXor
    {245, 245, "trI"},      // Phi
    {246, 246, "iiN"},      // LoopMerge
    {247, 247, "in-"},      // SelectionMerge
    {248, 248, "r-"},       // Label
    {249, 249, "i-"},       // Branch
    {250, 250, "iiiN"},     // BranchConditional
    {252, 253, "-"},        // Kill, Return
    {254, 254, "i-"},       // ReturnValue
    {255, 255, "-"},        // Unreachable
    {317, 317, "-"},        // NoLine
};

constexpr std::array<const char*, known_opcodes> forms = [] {
    std::array<const char*, known_opcodes> out{};
    for (const Range& r : ranges)
        for (size_t op = r.first; op <= r.last; ++op) out[op] = r.form;
    return out;
}();

// Memory operands: Volatile, Aligned (a number) and Nontemporal. Image operands: all that existed in SPIR-V 1.0 take ids.
bool reads_mask(char tail, uint32_t mask) { return tail == 'N' ? (mask & ~7u) == 0 : (mask & ~0xffu) == 0; }

class Reader {
public:
    Reader(WordView words, ParsedModule& out) : words_(words), out_(out) {}

    bool run() {
        if (words_.size() < header_words || words_[0] != magic) return false;
        bound_ = words_[3];
        if (bound_ > most_ids) return false;
        out_.instructions.clear();
        out_.id_words.clear();
        out_.instructions.reserve(words_.size() / 4);
        out_.id_words.reserve(words_.size() / 2);
        for (size_t at = header_words; at < words_.size();) {
            const size_t length = words_[at] >> 16;
            if (length == 0 || length > words_.size() - at) return false;
            const uint16_t op = static_cast<uint16_t>(words_[at] & 0xffff);
            ParsedInstruction in{
                static_cast<uint32_t>(at), op, static_cast<uint16_t>(length), 0, static_cast<uint32_t>(out_.id_words.size()), 0};
            if (op == op_entry_point ? !entry_point(in) : !by_form(in)) return false;
            in.ids = static_cast<uint32_t>(out_.id_words.size()) - in.first_id;
            out_.instructions.push_back(in);
            at += length;
        }
        return true;
    }

private:
    void id_at(uint32_t word) { out_.id_words.push_back(word); }

    bool by_form(ParsedInstruction& in) {
        if (in.op >= known_opcodes || !forms[in.op]) return false;
        const uint32_t end = in.at + in.length;
        uint32_t word = in.at + 1;
        const char* form = forms[in.op];
        for (; form[1] != 0; ++form) {
            if (word == end) return *form == 'm';
            if (*form == 'r') in.result = words_[word];
            if (in.result >= bound_) return false;
            if (*form == 'm' && !reads_mask(form[1], words_[word])) return false;
            if (*form == 't' || *form == 'r' || *form == 'i') id_at(word);
            ++word;
        }
        if (*form == '-') return word == end;
        for (; *form == 'I' && word < end; ++word) id_at(word);
        return true;
    }

    // Model, function, a name that ends in a zero byte, interface.
    bool entry_point(const ParsedInstruction& in) {
        const uint32_t end = in.at + in.length;
        if (in.length < 4) return false;
        id_at(in.at + 2);
        uint32_t word = in.at + 3;
        while (word < end && words_[word] >> 24 != 0) ++word;
        for (++word; word < end; ++word) id_at(word);
        return true;
    }

    WordView words_;
    ParsedModule& out_;
    uint32_t bound_ = 0;
};

}  // namespace

bool read_operands(WordView words, ParsedModule& out) { return Reader(words, out).run(); }

}  // namespace kiln
