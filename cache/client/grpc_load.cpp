#include <dlfcn.h>
#include <unistd.h>

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
    OpenGrpcRemote* open = nullptr;
    std::string problem = "the program's own folder is not known";

    Module() {
        const std::string folder = program_folder();
        if (folder.empty()) return;
        for (const char* place : {"/kiln-grpc.so", "/../lib/kiln/kiln-grpc.so"}) {
            const std::string path = folder + place;
            problem = "kiln-grpc.so is not installed beside this program";
            if (::access(path.c_str(), R_OK) != 0) continue;
            // Never unloaded: gRPC's threads outlive its last channel.
            void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
            if (library == nullptr) {
                const char* why = ::dlerror();
                problem = why != nullptr ? why : "kiln-grpc.so cannot be loaded";
                return;
            }
            open = reinterpret_cast<OpenGrpcRemote*>(::dlsym(library, grpc_module_symbol));
            if (open == nullptr) problem = path + " is of another version";
            return;
        }
    }
};

}  // namespace

Result<std::unique_ptr<RemoteStore>> open_grpc_remote(const RemoteUrl& url, const GrpcRemoteOptions& options,
                                                      const RemoteLimits& limits) {
    static const Module module;
    if (module.open == nullptr) return environment_error("cache '" + url.text() + "': " + module.problem);
    return module.open(url, options, limits);
}

}  // namespace kiln
