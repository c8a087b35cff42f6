#include "cache/execute/reapi_action.h"

#include <algorithm>

#include "cache/protocol/action_result.h"

namespace kiln {

namespace {

struct Folder {
    std::map<std::string, const JobFile*> files;
    std::map<std::string, Folder> folders;
};

template <class Message>
BlobName add(ReapiAction& action, const Message& message) {
    auto bytes = std::make_shared<Bytes>(message.ByteSizeLong());
    message.SerializeToArray(bytes->data(), static_cast<int>(bytes->size()));
    const BlobName name{sha256(*bytes), bytes->size()};
    if (action.blobs.emplace(name.digest, *bytes).second) action.owned.push_back(std::move(bytes));
    return name;
}

// The maps hand out names in the order of their bytes, which is the order that the API wants.
BlobName add_folder(ReapiAction& action, const Folder& folder) {
    reapi::Directory message;
    for (const auto& [name, file] : folder.files) {
        auto& node = *message.add_files();
        node.set_name(name);
        node.set_is_executable(file->executable);
        set_digest(node.mutable_digest(), {file->digest, file->bytes->size()});
        action.blobs.emplace(file->digest, *file->bytes);
    }
    for (const auto& [name, below] : folder.folders) {
        auto& node = *message.add_directories();
        node.set_name(name);
        set_digest(node.mutable_digest(), add_folder(action, below));
    }
    return add(action, message);
}

Status place(Folder& root, const JobFile& file) {
    if (!stays_below(file.path)) return input_error("a job's file lies outside its folder: " + file.path);
    Folder* folder = &root;
    std::string_view rest = file.path;
    for (size_t slash = rest.find('/'); slash != std::string_view::npos; slash = rest.find('/')) {
        const std::string name(rest.substr(0, slash));
        if (folder->files.count(name) != 0) return input_error("a job's " + file.path + " lies below a file");
        folder = &folder->folders[name];
        rest.remove_prefix(slash + 1);
    }
    const std::string name(rest);
    if (folder->folders.count(name) != 0 || !folder->files.emplace(name, &file).second)
        return input_error("a job has " + file.path + " twice");
    return {};
}

}  // namespace

void set_digest(reapi::Digest* out, const BlobName& name) {
    out->set_hash(name.digest.hex());
    out->set_size_bytes(static_cast<int64_t>(name.size));
}

Result<ReapiAction> reapi_action(const Job& job, const std::vector<std::pair<std::string, std::string>>& platform) {
    ReapiAction action;
    Folder root;
    for (const JobFile& file : job.inputs) KILN_TRY(place(root, file));
    reapi::Command command;
    for (const std::string& argument : job.arguments) command.add_arguments(argument);
    std::vector<std::string> outputs = job.outputs;
    std::sort(outputs.begin(), outputs.end());
    for (const std::string& path : outputs) {
        if (!stays_below(path)) return input_error("a job's output lies outside its folder: " + path);
        command.add_output_paths(path);
        command.add_output_files(path);  // to an engine of API 2.0, which does not know the former
    }
    reapi::Action message;
    auto properties = platform;
    std::sort(properties.begin(), properties.end());
    for (const auto& [name, value] : properties) {
        for (reapi::Platform* one : {command.mutable_platform(), message.mutable_platform()}) {  // before and since API 2.2
            auto& property = *one->add_properties();
            property.set_name(name);
            property.set_value(value);
        }
    }
    set_digest(message.mutable_command_digest(), add(action, command));
    set_digest(message.mutable_input_root_digest(), add_folder(action, root));
    action.name = add(action, message);
    return action;
}

}  // namespace kiln
