#include "tools/table_file.h"

namespace kiln {

bool is_table(Files& files, const std::string& path) {
    const auto bytes = files.read(path);
    if (bytes.ok() && bytes->has_value() && (*bytes)->compare(0, 4, "KILN") == 0) return true;
    const size_t dot = path.rfind('.');
    return dot != std::string::npos && path.substr(dot) == ".kiln";
}

Result<std::unique_ptr<TableView>> open_table(Files& files, const std::string& path) {
    const auto bytes = files.read(path);
    if (!bytes.ok()) return input_error(bytes.error().message);  // a folder, no permission: the name is wrong, not the machine
    if (!bytes->has_value()) return input_error(path + ": no such file");
    auto view = TableView::open(as_bytes(**bytes));
    if (!view.ok()) return Error{view.error().fault, path + ": " + view.error().message};
    return view;
}

}  // namespace kiln
