#include "compiler/device/driver.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace kiln {

namespace {

namespace fs = std::filesystem;

std::string from_environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
}

void split_into(std::vector<std::string>& out, const std::string& list, const std::string& suffix) {
    for (size_t begin = 0; begin <= list.size();) {
        const size_t end = std::min(list.find(':', begin), list.size());
        if (end > begin) out.push_back(list.substr(begin, end - begin) + suffix);
        begin = end + 1;
    }
}

// Files and folders, in the order in which the loader looks.
std::vector<std::string> places() {
    std::vector<std::string> out;
    for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES"})
        split_into(out, from_environment(name), "");
    const std::string home = from_environment("HOME");
    const auto folders = [&](const char* name, const std::string& fallback) {
        const std::string value = from_environment(name);
        split_into(out, value.empty() ? fallback : value, "/vulkan/icd.d");
    };
    folders("XDG_CONFIG_HOME", home.empty() ? "" : home + "/.config");
    folders("XDG_CONFIG_DIRS", "/etc/xdg");
    split_into(out, "/usr/local/etc:/etc", "/vulkan/icd.d");
    folders("XDG_DATA_HOME", home.empty() ? "" : home + "/.local/share");
    folders("XDG_DATA_DIRS", "/usr/local/share:/usr/share");
    return out;
}

bool is_lavapipe(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.rfind("lvp_icd", 0) == 0 && file.extension() == ".json";
}

}  // namespace

Result<std::string> find_driver(const DriverChoice& choice) {
    const std::string wanted = choice.icd.empty() ? from_environment("KILN_ICD") : choice.icd;
    std::error_code ignored;
    if (!wanted.empty()) {
        if (fs::is_regular_file(wanted, ignored)) return fs::absolute(wanted, ignored).string();
        return environment_error("no Vulkan driver manifest at '" + wanted + "'");
    }
    for (const std::string& place : places()) {
        if (fs::is_regular_file(place, ignored)) {
            if (is_lavapipe(place)) return place;
            continue;
        }
        std::vector<fs::path> found;
        for (fs::directory_iterator it(place, ignored), end; !ignored && it != end; it.increment(ignored))
            if (is_lavapipe(it->path())) found.push_back(it->path());
        if (!found.empty()) return std::min_element(found.begin(), found.end())->string();
    }
    return environment_error(
        "no lavapipe driver (lvp_icd*.json) where the Vulkan loader looks; install the package mesa-vulkan-drivers, or name a "
        "driver's manifest in KILN_ICD");
}

Status apply_driver(const std::string& icd, const DriverChoice& choice) {
    setenv("VK_DRIVER_FILES", icd.c_str(), 1);
    setenv("VK_ICD_FILENAMES", icd.c_str(), 1);  // the same for loaders before 1.3.207
    unsetenv("VK_ADD_DRIVER_FILES");
    setenv("NODEVICE_SELECT", "1", 1);  // Mesa's implicit layer that reorders devices
    setenv("GALLIVM_PERF", choice.optimise ? "no_aos_sampling" : "no_aos_sampling,nopt", 0);
    setenv("LP_NUM_THREADS", "0", 0);
    if (!choice.cache_dir.empty()) setenv("MESA_SHADER_CACHE_DIR", choice.cache_dir.c_str(), 1);
    if (!choice.shader_cache) setenv("MESA_SHADER_CACHE_DISABLE", "1", 1);
    if (choice.optimise && from_environment("GALLIVM_PERF").find("nopt") != std::string::npos)
        return environment_error("GALLIVM_PERF is '" + from_environment("GALLIVM_PERF") +
                                 "', by the user or by a device opened before: times of unoptimised code mean nothing");
    return {};
}

std::string driver_settings() {
    const std::string no_cache = from_environment("MESA_SHADER_CACHE_DISABLE");
    return "GALLIVM_PERF=" + from_environment("GALLIVM_PERF") + " LP_NUM_THREADS=" + from_environment("LP_NUM_THREADS") +
           (no_cache.empty() ? "" : " MESA_SHADER_CACHE_DISABLE=" + no_cache);
}

}  // namespace kiln
