#include "cache/disk_clean.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string_view>

#include "cache/disk_folder.h"
#include "compiler/base/wire.h"

namespace kiln {

namespace {

constexpr std::string_view magic = "kilnidx1";
constexpr size_t mark_size = 8 + 8 + 16 + 16;
constexpr size_t chunk = size_t{1} << 20;

void write_sum(WireWriter& out, const Fast& sum) {
    out.u64(sum.low);
    out.u64(sum.high);
}

std::optional<CleanMark> mark_of(const std::string& data) {
    const Descriptor fd(::open(data.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat info {};
    if (fd.get() < 0 || ::fstat(fd.get(), &info) != 0 || !S_ISREG(info.st_mode)) return std::nullopt;
    CleanMark mark;
    WireWriter sums;
    Bytes part;
    do {
        part.resize(chunk);
        if (!read_all(fd.get(), part)) return std::nullopt;
        write_sum(sums, xxh3(part));
        mark.size += part.size();
    } while (part.size() == chunk);
    mark.sum = xxh3(sums.view());
    return mark;
}

}  // namespace

Bytes write_mark(const CleanMark& mark) {
    WireWriter out;
    out.raw(as_bytes(magic));
    out.u64(mark.size);
    write_sum(out, mark.sum);
    write_sum(out, xxh3(out.view()));
    return out.take();
}

std::optional<CleanMark> read_mark(ByteView bytes) {
    if (bytes.size() != mark_size) return std::nullopt;
    WireReader in(bytes.subspan(magic.size()));
    CleanMark mark;
    mark.size = in.u64();
    mark.sum.low = in.u64();
    mark.sum.high = in.u64();
    const Bytes again = write_mark(mark);
    if (as_text(again) != as_text(bytes)) return std::nullopt;
    return mark;
}

std::string clean_file(const std::string& folder) { return folder + "/clean"; }

bool is_clean(const std::string& folder, const std::string& data) {
    const Descriptor fd(::open(clean_file(folder).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    Bytes bytes(mark_size + 1);
    if (fd.get() < 0 || !read_all(fd.get(), bytes)) return false;
    const auto mark = read_mark(bytes);
    return mark && mark == mark_of(data);
}

void mark_clean(const std::string& folder, const std::string& data) {
    const auto mark = mark_of(data);
    if (!mark) return;
    const std::string path = clean_file(folder);
    const Descriptor fd(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (fd.get() < 0 || !write_all(fd.get(), write_mark(*mark))) ::unlink(path.c_str());
}

}  // namespace kiln
