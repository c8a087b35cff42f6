// The only file that includes yaml-cpp in the server: its event interface, since its Node interface hides anchors, repeated
// keys and further documents. The library throws; nothing of that leaves this file.
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "cache/server/config.h"

namespace kiln {

namespace {

constexpr size_t largest = 64 * 1024, deepest = 8;

class Collector final : public YAML::EventHandler {
public:
    std::vector<Setting> settings;
    std::string problem;  // the first one
    int line = 0;

    void OnDocumentStart(const YAML::Mark& mark) override {
        if (documents_++ != 0) refuse(mark, "the file holds a second document");
    }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { scalar(mark, "?", anchor, ""); }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuse(mark, "anchors and aliases are not taken"); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
        scalar(mark, tag, anchor, value);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, false);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        open(mark, tag, anchor, true);
    }
    void OnMapEnd() override { close(); }

private:
    struct Level {
        bool map = false;
        bool key_next = true;
        size_t items = 0;
        std::string name;  // of this collection, with a '.' behind it unless it is the root's
        std::string key;
    };

    void refuse(const YAML::Mark& mark, const std::string& what) {
        if (!problem.empty()) return;
        problem = what;
        line = mark.line + 1;
    }
    bool plain(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
        if (anchor != 0) refuse(mark, "anchors and aliases are not taken");
        if (!tag.empty() && tag != "?" && tag != "!") refuse(mark, "tags are not taken");
        return problem.empty();
    }
    // The name of the value that comes now.
    std::string next_name() {
        Level& level = levels_.back();
        const std::string name = level.name + (level.map ? level.key : std::to_string(level.items));
        ++level.items;
        level.key_next = true;
        return name;
    }
    void scalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) {
        if (!plain(mark, tag, anchor)) return;
        if (levels_.empty()) return value.empty() ? void() : refuse(mark, "the file is not a map");
        Level& level = levels_.back();
        if (level.map && level.key_next) {
            if (value.empty() || value.find('.') != std::string::npos) return refuse(mark, "there is no such setting");
            level.key = value;
            level.key_next = false;
            if (!seen_.insert(level.name + value).second) refuse(mark, value + " is there twice");
            return;
        }
        settings.push_back({next_name(), value, mark.line + 1});
    }
    void open(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, bool map) {
        if (!plain(mark, tag, anchor)) return;
        if (levels_.size() == deepest) return refuse(mark, "the file is nested too deeply");
        Level level;
        level.map = map;
        if (levels_.empty() && !map) return refuse(mark, "the file is not a map");
        if (!levels_.empty()) {
            if (levels_.back().map && levels_.back().key_next) return refuse(mark, "a key is a word");
            level.name = next_name() + ".";
        }
        levels_.push_back(std::move(level));
    }
    void close() {
        if (problem.empty()) levels_.pop_back();
    }

    size_t documents_ = 0;
    std::vector<Level> levels_;
    std::set<std::string> seen_;
};

}  // namespace

Result<std::vector<Setting>> settings_of(std::string_view yaml) {
    if (yaml.size() > largest) return input_error("the file is larger than 64 KiB");
    // It takes the byte 4 for the end of input and text with zero bytes for UTF-16.
    const auto control = [](char c) {
        return (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\r' && c != '\t') || c == 0x7f;
    };
    if (std::any_of(yaml.begin(), yaml.end(), control)) return input_error("the file holds control characters");
    Collector collector;
    const auto problem = [&](int line, const std::string& what) {
        return input_error("line " + std::to_string(line) + ": " + what);
    };
    try {
        std::istringstream in{std::string(yaml)};
        YAML::Parser parser(in);
        while (collector.problem.empty() && parser.HandleNextDocument(collector)) {
        }
    } catch (const YAML::ParserException& thrown) {
        if (collector.problem.empty()) return problem(thrown.mark.line + 1, thrown.msg);
    } catch (const std::exception& thrown) {
        return input_error(thrown.what());
    }
    if (!collector.problem.empty()) return problem(collector.line, collector.problem);
    return std::move(collector.settings);
}

}  // namespace kiln
