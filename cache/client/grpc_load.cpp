#include <dlfcn.h>
#include <unistd.h>

#include "cache/client/grpc_module.h"
#include "cache/client/grpc_remote.h"

namespace kiln {

namespace {

// The folder of this program, and no other place that a name could be looked up in.
std::string program_folder() {
    char self[4096];
    const ssize_t length = ::readlink("/proc/self/exe", self, sizeof self);
    if (length <= 0 || static_cast<size_t>(length) == sizeof self) return {};
    const std::string whole(self, static_cast<size_t>(length));
    return whole.substr(0, whole.rfind('/'));
}

struct Module {
    void* library = nullptr;
    std::string path, problem = "the program's own folder is not known";

    Module() {
        const std::string folder = program_folder();
        if (folder.empty()) return;
        for (const char* place : {"/kiln-grpc.so", "/../lib/kiln/kiln-grpc.so"}) {
            path = folder + place;
            problem = "kiln-grpc.so is not installed beside this program";
            if (::access(path.c_str(), R_OK) != 0) continue;
            // Never unloaded: gRPC's threads outlive its last channel.
            library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
            if (library != nullptr) return;
            const char* why = ::dlerror();
            problem = why != nullptr ? why : "kiln-grpc.so cannot be loaded";
            return;
        }
    }
};

}  // namespace

Result<void*> grpc_module_symbol_named(const char* symbol) {
    static const Module module;
    if (module.library == nullptr) return environment_error(module.problem);
    void* found = ::dlsym(module.library, symbol);
    if (found == nullptr) return environment_error(module.path + " is of another version");
    return found;
}

Result<std::unique_ptr<RemoteStore>> open_grpc_remote(const RemoteUrl& url, const GrpcRemoteOptions& options,
                                                      const RemoteLimits& limits) {
    const auto symbol = grpc_module_symbol_named(grpc_module_symbol);
    if (!symbol.ok()) return environment_error("cache '" + url.text() + "': " + symbol.error().message);
    return reinterpret_cast<OpenGrpcRemote*>(*symbol)(url, options, limits);
}

}  // namespace kiln
