// Field numbers as in build/bazel/remote/execution/v2/remote_execution.proto.
#include "cache/protocol/action_result.h"

#include <algorithm>

#include "cache/protocol/wire_message.h"

namespace kiln {

namespace {

using Field = WireReader::Field;
using Type = WireReader::Type;

// Calls `known(field)`, which returns false for a field that is not as it should be, for every field of a message.
template <class Known>
bool read_message(ByteView message, Known known) {
    WireReader reader(message);
    while (const auto field = reader.next())
        if (!known(*field)) return false;
    return !reader.bad();
}

// Fills a single field once.
struct Once {
    uint64_t seen = 0;
    bool operator()(const Field& field) {
        const uint64_t bit = field.number < 64 ? uint64_t{1} << field.number : 0;
        if ((seen & bit) != 0) return false;
        seen |= bit;
        return true;
    }
};

bool read_text(const Field& field, std::string& out) {
    if (field.type != Type::bytes || field.bytes.size() > longest_output_path) return false;
    out = as_text(field.bytes);
    return out.find('\0') == std::string::npos;
}

bool read_bytes(const Field& field, Bytes& out) {
    out.assign(field.bytes.begin(), field.bytes.end());
    return field.type == Type::bytes;
}

bool read_flag(const Field& field, bool& out) {
    out = field.value != 0;
    return field.type == Type::varint;
}

// A Digest without a field is what some writers leave in the place of none.
bool read_digest(const Field& digest, std::optional<BlobName>& out) {
    if (digest.type != Type::bytes) return false;
    if (digest.bytes.empty()) return true;
    std::optional<Digest> hash;
    uint64_t size = 0;
    Once once;
    const bool whole = read_message(digest.bytes, [&](const Field& field) {
        if (field.number == 1) {
            hash = field.type == Type::bytes ? Digest::from_hex(as_text(field.bytes)) : std::nullopt;
            return hash && once(field);
        }
        if (field.number == 2) {
            size = field.value;
            return field.type == Type::varint && size <= uint64_t{INT64_MAX} && once(field);
        }
        return true;
    });
    if (!whole || !hash) return false;
    out = BlobName{*hash, size};
    return true;
}

bool read_file(const Field& message, ActionResult::File& file) {
    std::optional<BlobName> blob;
    Once once;
    const bool whole = message.type == Type::bytes && read_message(message.bytes, [&](const Field& field) {
                           switch (field.number) {
                               case 1:
                                   return once(field) && read_text(field, file.path);
                               case 2:
                                   return once(field) && read_digest(field, blob);
                               case 4:
                                   return once(field) && read_flag(field, file.executable);
                               case 5:
                                   return once(field) && read_bytes(field, file.contents);
                               default:
                                   return true;
                           }
                       });
    if (!whole || !blob || file.path.empty()) return false;
    file.blob = *blob;
    return true;
}

bool read_directory(const Field& message, ActionResult::Directory& directory) {
    std::optional<BlobName> tree;
    Once once;
    const bool whole = message.type == Type::bytes && read_message(message.bytes, [&](const Field& field) {
                           switch (field.number) {
                               case 1:
                                   return once(field) && read_text(field, directory.path);
                               case 3:
                                   return once(field) && read_digest(field, tree);
                               case 4:
                                   return once(field) && read_flag(field, directory.sorted);
                               case 5:
                                   return once(field) && read_digest(field, directory.root);
                               default:
                                   return true;
                           }
                       });
    if (!whole || !tree) return false;
    directory.tree = *tree;
    return true;  // its path may be empty: the working folder itself
}

bool read_symlink(const Field& message, ActionResult::Symlink& link) {
    Once once;
    return message.type == Type::bytes && read_message(message.bytes, [&](const Field& field) {
               if (field.number == 1) return once(field) && read_text(field, link.path);
               if (field.number == 2) return once(field) && read_text(field, link.target);
               return true;
           });
}

template <class T>
T& appended(std::vector<T>& list) {
    return list.emplace_back();
}

Bytes digest_message(const BlobName& blob) {
    WireWriter out;
    out.bytes(1, as_bytes(blob.digest.hex()));
    out.number(2, blob.size);
    return out.take();
}

Bytes file_message(const ActionResult::File& file) {
    WireWriter out;
    out.bytes(1, as_bytes(file.path));
    out.message(2, digest_message(file.blob));
    out.number(4, file.executable ? 1 : 0);
    out.bytes(5, file.contents);
    return out.take();
}

Bytes directory_message(const ActionResult::Directory& directory) {
    WireWriter out;
    out.bytes(1, as_bytes(directory.path));
    out.message(3, digest_message(directory.tree));
    out.number(4, directory.sorted ? 1 : 0);
    if (directory.root) out.message(5, digest_message(*directory.root));
    return out.take();
}

Bytes symlink_message(const ActionResult::Symlink& link) {
    WireWriter out;
    out.bytes(1, as_bytes(link.path));
    out.bytes(2, as_bytes(link.target));
    return out.take();
}

}  // namespace

Result<ActionResult> parse_action_result(ByteView message) {
    ActionResult result;
    Once once;
    size_t outputs = 0;
    const bool whole = read_message(message, [&](const Field& field) {
        const bool output = field.number == 2 || field.number == 3 || (field.number >= 10 && field.number <= 12);
        if (output && ++outputs > most_outputs) return false;
        switch (field.number) {
            case 2:
                return read_file(field, appended(result.files));
            case 3:
                return read_directory(field, appended(result.directories));
            case 4:
                result.exit_code = static_cast<int32_t>(field.value);
                return field.type == Type::varint && once(field);
            case 5:
                return once(field) && read_bytes(field, result.stdout_raw);
            case 6:
                return once(field) && read_digest(field, result.stdout_digest);
            case 7:
                return once(field) && read_bytes(field, result.stderr_raw);
            case 8:
                return once(field) && read_digest(field, result.stderr_digest);
            case 9:
                return once(field) && read_bytes(field, result.metadata);
            case 10:
                return read_symlink(field, appended(result.file_symlinks));
            case 11:
                return read_symlink(field, appended(result.directory_symlinks));
            case 12:
                return read_symlink(field, appended(result.symlinks));
            default:
                return true;
        }
    });
    if (!whole) return input_error("not an ActionResult");
    return result;
}

Bytes serialise(const ActionResult& result) {
    WireWriter out;
    for (const auto& file : result.files) out.message(2, file_message(file));
    for (const auto& directory : result.directories) out.message(3, directory_message(directory));
    out.number(4, static_cast<uint64_t>(int64_t{result.exit_code}));  // a negative int32 is written as 64 bits
    out.bytes(5, result.stdout_raw);
    if (result.stdout_digest) out.message(6, digest_message(*result.stdout_digest));
    out.bytes(7, result.stderr_raw);
    if (result.stderr_digest) out.message(8, digest_message(*result.stderr_digest));
    out.bytes(9, result.metadata);
    for (const auto& link : result.file_symlinks) out.message(10, symlink_message(link));
    for (const auto& link : result.directory_symlinks) out.message(11, symlink_message(link));
    for (const auto& link : result.symlinks) out.message(12, symlink_message(link));
    return out.take();
}

Result<std::vector<BlobName>> parse_tree_files(ByteView message) {
    std::vector<BlobName> files;
    const auto read_node = [&](const Field& node) {
        std::optional<BlobName> blob;
        const bool whole = node.type == Type::bytes && read_message(node.bytes, [&](const Field& field) {
                               return field.number != 2 || read_digest(field, blob);
                           });
        if (!whole || !blob || files.size() == most_outputs) return false;
        files.push_back(*blob);
        return true;
    };
    const bool whole = read_message(message, [&](const Field& directory) {
        if (directory.number > 2) return true;
        return directory.type == Type::bytes &&
               read_message(directory.bytes, [&](const Field& field) { return field.number != 1 || read_node(field); });
    });
    if (!whole) return input_error("not a Tree");
    return files;
}

bool stays_below(std::string_view path) {
    if (path.find_first_of(std::string_view("\\\0", 2)) != std::string_view::npos) return false;
    while (true) {
        const size_t slash = std::min(path.find('/'), path.size());
        const std::string_view segment = path.substr(0, slash);
        if (segment.empty() || segment == "." || segment == "..") return false;
        if (slash == path.size()) return true;
        path.remove_prefix(slash + 1);
    }
}

}  // namespace kiln
