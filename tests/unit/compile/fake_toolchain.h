#pragma once
// A Toolchain without tools. A module is its text in words, behind a SPIR-V header whose generator word is the stage; each line
// of the text may ask for something:
//   fail MESSAGE      compile: an error at this line        warn MESSAGE   compile: a warning at this line
//   dead ...          dropped by prune                      slow ...       dropped by optimise
//   invalid ...       validate refuses the module           in N | out N   reflect: an input or output at location N
//   block NAME S B    reflect: a uniform block              refuse TARGET  translate: this target cannot say it
// Calls are counted.

#include <atomic>
#include <cstring>
#include <functional>
#include <sstream>
#include <string>

#include "compiler/toolchain/toolchain.h"

namespace kiln {

class FakeToolchain final : public Toolchain {
public:
    std::atomic<uint64_t> compiles{0}, prunes{0}, optimises{0}, validates{0}, reflects{0}, translates{0};
    std::string version = "fake 1";

    std::string versions() const override { return version; }

    Compiled compile(Stage stage, std::string_view text, const Options&) override {
        ++compiles;
        Compiled out;
        bool failed = false;
        each_line(text, [&](const std::string& line, uint32_t number) {
            if (line.starts_with("fail ")) out.messages.push_back({Severity::error, number, line.substr(5)});
            if (line.starts_with("warn ")) out.messages.push_back({Severity::warning, number, line.substr(5)});
            failed = failed || line.starts_with("fail ");
        });
        if (!failed) out.words = encode(stage, std::string(text));
        return out;
    }
    Result<Words> prune(WordView words, const Options&) override {
        ++prunes;
        return without(words, "dead");
    }
    Result<Words> optimise(WordView words, const Options& options) override {
        ++optimises;
        if (options.optimise == Optimise::none) return Words(words.begin(), words.end());
        return without(words, "slow");
    }
    std::vector<ToolMessage> validate(WordView words, const Options&) override {
        ++validates;
        std::vector<ToolMessage> messages;
        each_line(decode(words), [&](const std::string& line, uint32_t) {
            if (line.starts_with("invalid")) messages.push_back({Severity::error, 0, line});
        });
        return messages;
    }
    Result<Reflection> reflect(WordView words) override {
        ++reflects;
        Reflection r;
        r.stage = static_cast<Stage>(words[2]);
        each_line(decode(words), [&](const std::string& line, uint32_t) {
            std::istringstream in(line);
            std::string word;
            in >> word;
            Varying varying;
            if (word == "in" && in >> varying.location) r.inputs.push_back(named(varying));
            if (word == "out" && in >> varying.location) r.outputs.push_back(named(varying));
            Resource block;
            if (word == "block" && in >> block.name >> block.set >> block.binding) r.resources.push_back(block);
        });
        return r;
    }
    std::vector<Translated> translate(WordView words, const std::vector<Target>& targets, const SlotLayout&) override {
        ++translates;
        std::vector<Translated> out;
        const std::string text = decode(words);
        for (const Target target : targets) {
            Translated t;
            if (text.find(std::string("refuse ") + name_of(target)) != std::string::npos)
                t.refusal = "refused on request";
            else
                t.text = std::string("// ") + name_of(target) + "\n" + text;
            out.push_back(std::move(t));
        }
        return out;
    }
    std::vector<ToolMessage> parse_back(Target, Stage, std::string_view) override { return {}; }
    std::vector<ToolMessage> link_back(Target, std::string_view, std::string_view) override { return {}; }

    static Words encode(Stage stage, const std::string& text) {
        Words words{0x07230203, 0x00010300, static_cast<uint32_t>(stage), 1, 0, static_cast<uint32_t>(text.size())};
        words.resize(6 + (text.size() + 3) / 4);
        if (!text.empty()) std::memcpy(words.data() + 6, text.data(), text.size());
        return words;
    }
    static std::string decode(WordView words) {
        if (words.size() < 6 || (words[5] + size_t{3}) / 4 != words.size() - 6) return {};
        return std::string(reinterpret_cast<const char*>(words.data() + 6), words[5]);
    }

private:
    static void each_line(std::string_view text, const std::function<void(const std::string&, uint32_t)>& visit) {
        std::istringstream in{std::string(text)};
        std::string line;
        for (uint32_t number = 1; std::getline(in, line); ++number) visit(line, number);
    }
    static Words without(WordView words, const char* prefix) {
        std::string kept;
        each_line(decode(words), [&](const std::string& line, uint32_t) {
            if (!line.starts_with(prefix)) kept += line + "\n";
        });
        return encode(static_cast<Stage>(words[2]), kept);
    }
    static Varying named(Varying varying) {
        varying.name = "v" + std::to_string(varying.location);
        return varying;
    }
};

}  // namespace kiln
