#include "cache/client/grpc_module.h"
#include "cache/execute/reapi_engine.h"

namespace kiln {

Result<std::unique_ptr<Engine>> open_reapi_engine(std::span<const RemoteUrl> nodes, const ReapiOptions& options) {
    if (nodes.empty()) return Error{Fault::usage, "no node to execute on"};
    const auto symbol = grpc_module_symbol_named(reapi_module_symbol);
    if (!symbol.ok()) return environment_error("execution on '" + nodes[0].text() + "': " + symbol.error().message);
    return reinterpret_cast<OpenReapiEngine*>(*symbol)(nodes, options);
}

}  // namespace kiln
