#include "cache/client/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "cache/disk_folder.h"
#include "compiler/base/files.h"

namespace kiln {

Result<std::string> read_private_file(const std::string& path, const std::string& what, size_t most) {
    const auto wrong = [&](const std::string& why) { return environment_error(what + " " + path + ": " + why); };
    const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat info {};
    if (fd.get() < 0 || ::fstat(fd.get(), &info) != 0) return wrong(std::strerror(errno));
    if (!S_ISREG(info.st_mode)) return wrong("it is not a file");
    if ((info.st_mode & 077) != 0) return wrong("others than its owner may read it; run chmod 600");
    std::string text(most + 1, '\0');
    size_t size = 0;
    for (;;) {
        const ssize_t got = ::read(fd.get(), text.data() + size, text.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return wrong(std::strerror(errno));
        if (got == 0) break;
        size += static_cast<size_t>(got);
        if (size > most) return wrong("it is longer than " + std::to_string(most) + " bytes");
    }
    text.resize(size);
    return text;
}

Result<std::string> token_of(const std::string& text, const std::string& where) {
    const size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return environment_error(where + " holds no token");
    const std::string token = text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
    const bool visible = std::all_of(token.begin(), token.end(), [](char c) { return c > ' ' && c < 0x7f; });
    if (!visible || token.size() > 4096) return environment_error(where + " does not hold one token of visible ASCII");
    return token;
}

Result<std::string> read_authorities(const std::string& path, const std::string& what) {
    const auto pem = DiskFiles().read(path);
    KILN_TRY(pem);
    if (!pem->has_value()) return input_error(what + ": no file '" + path + "'");
    if ((*pem)->find("-----BEGIN CERTIFICATE-----") == std::string::npos)
        return input_error(what + ": '" + path + "' holds no certificates (PEM)");
    return **pem;
}

}  // namespace kiln
