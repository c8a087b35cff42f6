// The encoder exists as C++ sources and as WebAssembly; only the latter comes by a package registry, ready to run and pinned
// to a version. So it is a child process with files for input and output; an atlas takes seconds, the start 0.4 s.

#include "compiler/bake/bc_encoder.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "compiler/base/files.h"

extern char** environ;

namespace kiln {
namespace {

const char* name_of(BcFormat format) {
    switch (format) {
        case BcFormat::bc1:
            return "bc1";
        case BcFormat::bc7:
            return "bc7";
        case BcFormat::bc6h:
            return "bc6h";
    }
    return "";
}

// A folder that is gone when this is.
class ScratchFolder {
public:
    ScratchFolder() {
        std::error_code ignored;
        path_ = (std::filesystem::temp_directory_path(ignored) / "kiln-bc-XXXXXX").string();
        if (mkdtemp(path_.data()) == nullptr) path_.clear();
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    ~ScratchFolder() {
        std::error_code ignored;
        if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
    }
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

// Runs a program found in PATH, its two outputs into `log`. Returns its exit code, or -1 when it could not be started or died.
int run(std::vector<std::string> arguments, const std::string& log) {
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t child = 0;
    const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return -1;
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
        if (errno != EINTR) return -1;
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

FloatImage padded(const FloatImage& image) {
    FloatImage out{(image.width + 3) / 4 * 4, (image.height + 3) / 4 * 4, {}};
    out.rgba.reserve(size_t{4} * out.width * out.height);
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            const size_t from = 4 * (size_t{std::min(y, image.height - 1)} * image.width + std::min(x, image.width - 1));
            out.rgba.insert(out.rgba.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(from),
                            image.rgba.begin() + static_cast<std::ptrdiff_t>(from + 4));
        }
    }
    return out;
}

}  // namespace

uint32_t bc_block_bytes(BcFormat format) { return format == BcFormat::bc1 ? 8 : 16; }

std::vector<std::string> sanitise(FloatImage& image, BcFormat format, const std::string& name) {
    const float largest = format == BcFormat::bc6h ? 65504.0f : 1.0f;
    const std::string largest_text = format == BcFormat::bc6h ? "65504" : "1";
    struct Kind {
        std::string what;
        size_t count = 0, first = 0;
    } kinds[3] = {
        {"not a number: stored as 0"}, {"negative: stored as 0"}, {"above " + largest_text + ": stored as " + largest_text}};
    for (size_t i = 0; i < image.rgba.size(); ++i) {
        float& x = image.rgba[i];
        const int kind = std::isnan(x) ? 0 : x < 0.0f ? 1 : x > largest ? 2 : -1;
        if (kind < 0) continue;
        x = kind == 2 ? largest : 0.0f;
        if (kinds[kind].count++ == 0) kinds[kind].first = i;
    }
    std::vector<std::string> warnings;
    for (const Kind& kind : kinds) {
        if (kind.count == 0) continue;
        static constexpr const char* channels[4] = {"red", "green", "blue", "alpha"};
        const size_t texel = kind.first / 4;
        warnings.push_back(name + ": " + channels[kind.first % 4] + " of texel (" + std::to_string(texel % image.width) + ", " +
                           std::to_string(texel / image.width) + ") is " + kind.what +
                           (kind.count == 1 ? "" : "; so are " + std::to_string(kind.count - 1) + " more values"));
    }
    return warnings;
}

Result<BcImage> encode_bc(BcFormat format, FloatImage image, const std::string& name, const std::string& scripts) {
    constexpr uint32_t limit = 16384;
    const std::string size = std::to_string(image.width) + " x " + std::to_string(image.height);
    if (image.width == 0 || image.height == 0) return input_error(name + ": a size of " + size + " holds no texel");
    if (image.width > limit || image.height > limit) return input_error(name + ": " + size + " is above 16384 a side");
    if (image.rgba.size() != size_t{4} * image.width * image.height)
        return input_error(name + ": " + std::to_string(image.rgba.size()) + " values do not make " + size + " texels of four");

    BcImage out{format, image.width, image.height, {}, sanitise(image, format, name)};
    const FloatImage whole = padded(image);
    const ScratchFolder folder;
    if (folder.path().empty()) return environment_error(name + ": no folder for temporary files");
    const std::string in = folder.path() + "/in", blocks = folder.path() + "/out", log = folder.path() + "/log";
    DiskFiles files;
    KILN_TRY(files.write(in, {reinterpret_cast<const uint8_t*>(whole.rgba.data()), whole.rgba.size() * sizeof(float)}));
    const int code = run({"node", scripts + "/encode_bc.mjs", name_of(format), std::to_string(whole.width),
                          std::to_string(whole.height), in, blocks},
                         log);
    if (code != 0) {
        const Result<std::optional<std::string>> said = files.read(log);
        std::string why = said.ok() && *said ? (*said)->substr(0, 400) : "";
        if (code == -1 || code == 127) why = "node could not be run";
        return environment_error(name + ": the BC encoder failed (tools/setup.sh installs it): " + why);
    }
    const Result<std::optional<std::string>> got = files.read(blocks);
    const size_t expected = size_t{whole.width / 4} * (whole.height / 4) * bc_block_bytes(format);
    if (!got.ok() || !*got || (*got)->size() != expected) return environment_error(name + ": the BC encoder wrote no blocks");
    out.blocks.assign((*got)->begin(), (*got)->end());
    return out;
}

}  // namespace kiln
