#include "compiler/split/include.h"

#include <algorithm>

namespace kiln {

namespace {

std::vector<std::string_view> parts_of(std::string_view path) {
    std::vector<std::string_view> parts;
    while (!path.empty()) {
        const size_t slash = path.find('/');
        const std::string_view part = path.substr(0, slash);
        if (!part.empty() && part != ".") parts.push_back(part);
        path.remove_prefix(slash == std::string_view::npos ? path.size() : slash + 1);
    }
    return parts;
}

bool is_absolute(std::string_view path) { return !path.empty() && path.front() == '/'; }

}  // namespace

Sources::Sources(const Manifest& manifest, Files& files, Spellings& spellings)
    : disk_(files), spellings_(spellings), folder_(normal_path(manifest.folder)) {
    roots_.push_back(folder_);
    for (const std::string& entry : manifest.include) roots_.push_back(join_path(folder_, entry));
}

bool Sources::inside(const std::string& path) const {
    const auto parts = parts_of(path);
    return std::any_of(roots_.begin(), roots_.end(), [&](const std::string& root) {
        if (is_absolute(root) != is_absolute(path)) return false;
        const auto base = parts_of(root);
        if (parts.size() <= base.size()) return false;
        if (!std::equal(base.begin(), base.end(), parts.begin())) return false;
        return parts[base.size()] != "..";
    });
}

std::string Sources::relative(const std::string& path) const {
    if (is_absolute(path) != is_absolute(folder_)) return path;
    const auto parts = parts_of(path), base = parts_of(folder_);
    size_t same = 0;
    while (same < base.size() && same + 1 < parts.size() && base[same] == parts[same]) ++same;
    std::string out;
    for (size_t i = same; i < base.size(); ++i) {
        if (base[i] == "..") return path;  // what ".." stands for is not known here
        out += "../";
    }
    for (size_t i = same; i < parts.size(); ++i) {
        if (i != same) out += '/';
        out += parts[i];
    }
    return out;
}

Found Sources::find(std::string_view name, std::optional<uint16_t> includer) {
    Found none;
    if (name.empty()) {
        none.problem = "empty file name";
        return none;
    }
    if (name.find('\0') != std::string_view::npos || name.find('\\') != std::string_view::npos) {
        none.problem = "file name '" + std::string(name) + "': use '/' between folders";
        return none;
    }
    if (is_absolute(name)) {
        none.problem = "'" + std::string(name) + "' is an absolute path: name it relative to the search path";
        return none;
    }
    std::vector<std::string> candidates;
    if (includer) candidates.push_back(join_path(file(*includer).folder, name));
    for (const std::string& root : roots_) candidates.push_back(join_path(root, name));
    bool left = false;
    std::vector<std::string> tried;
    for (const std::string& path : candidates) {
        if (std::find(tried.begin(), tried.end(), path) != tried.end()) continue;
        tried.push_back(path);
        if (!inside(path)) {
            left = true;
            tried.pop_back();
            continue;
        }
        if (const auto known = known_.find(path); known != known_.end()) {
            if (known->second.file || !known->second.problem.empty()) return known->second;
            continue;
        }
        Result<std::optional<std::string>> content = disk_.read(path);
        SourceRead read;
        read.path = path;
        Found& found = known_[path];
        if (!content.ok()) {
            // A folder of that name, say: not the file we look for, but not silence either.
            found.problem = content.error().message;
            reads_.push_back(std::move(read));
            return found;
        }
        if (!content->has_value()) {
            reads_.push_back(std::move(read));
            continue;
        }
        read.present = true;
        read.digest = sha256(as_bytes(**content));
        reads_.push_back(std::move(read));
        const std::string_view head = std::string_view(**content).substr(0, 2);
        if ((*content)->size() > max_file)
            found.problem = path + ": larger than " + std::to_string(max_file >> 20) + " MiB, which no shader is";
        else if (head == "\xFF\xFE" || head == "\xFE\xFF")
            found.problem = path + ": is UTF-16; save it as UTF-8";
        else if (files_.size() >= max_files)
            found.problem = "more than " + std::to_string(max_files) + " source files in one stage";
        if (!found.problem.empty()) return found;
        auto source = std::make_unique<SourceFile>();
        source->path = path;
        source->name = relative(path);
        source->folder = folder_of(path);
        source->content = std::move(**content);
        const auto index = static_cast<uint16_t>(files_.size());
        source->lexed = lex_file(source->content, index, spellings_);
        files_.push_back(std::move(source));
        found.file = index;
        return found;
    }
    none.problem = "cannot find '" + std::string(name) + "'";
    if (tried.empty() && left) {
        none.problem = "'" + std::string(name) + "' leaves the search path";
    } else {
        none.problem += "; looked at ";
        for (size_t i = 0; i < tried.size(); ++i) none.problem += (i == 0 ? "" : ", ") + tried[i];
        if (left) none.problem += " (other places are outside the search path)";
    }
    return none;
}

}  // namespace kiln
