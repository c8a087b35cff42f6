#include "cache/server/action_reader.h"

#include "cache/protocol/action_result.h"

namespace kiln {

ActionReader reapi_reader() {
    const auto action = [](ByteView bytes) -> std::optional<ActionNeeds> {
        const auto result = parse_action_result(bytes);
        if (!result.ok()) return std::nullopt;
        ActionNeeds needs;
        for (const auto& file : result->files) needs.blobs.push_back(file.blob);
        for (const auto& directory : result->directories) {
            needs.trees.push_back(directory.tree);
            if (directory.root) needs.blobs.push_back(*directory.root);
        }
        for (const auto& digest : {result->stdout_digest, result->stderr_digest})
            if (digest) needs.blobs.push_back(*digest);
        return needs;
    };
    const auto tree = [](ByteView bytes) -> std::optional<std::vector<BlobName>> {
        auto files = parse_tree_files(bytes);
        if (!files.ok()) return std::nullopt;
        return std::move(*files);
    };
    return {action, tree};
}

}  // namespace kiln
