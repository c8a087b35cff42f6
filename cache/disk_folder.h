#pragma once
// What the store asks of the disk: whole reads and writes, names that belong to it, walks over its files.

#include <sys/stat.h>

#include <functional>
#include <string>

#include "compiler/base/store.h"

namespace kiln {

Error io_error(const std::string& path, const char* doing, int code);

const char* folder_name(Keyspace space);
std::string entry_path(const std::string& folder, Keyspace space, const Digest& key);

// Nanoseconds since 1970: the clock's, a file's time of last use.
int64_t system_time();
int64_t time_of(const struct stat& info);
bool set_time(int fd, int64_t time);

// Unique among threads, processes and machines that share the folder: 16 hex digits.
std::string unique_name();
std::string temporary_name();  // that and ".part"

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() { close(); }
    int get() const { return fd_; }
    bool close();

private:
    int fd_;
};

// False with errno set.
bool write_all(int fd, ByteView bytes);
// Fills `out`, whose size is what the file had when it was opened; shrinks it where the file ends earlier.
bool read_all(int fd, Bytes& out);

// Called for each regular file; returns 0 or the errno that ends the walk with an Error.
using Visit = std::function<int(const std::string& path, const struct stat& info)>;

// Folders that do not exist hold nothing. Files that the store would not have named so are passed over; links are not
// followed.
Status each_entry(const std::string& folder, Keyspace space, const Visit& visit);
Status each_temporary(const std::string& folder, const Visit& visit);
// Entries that were found damaged and set aside: quarantine/<keyspace>-<key>-<unique name>.
Status each_quarantined(const std::string& folder, const Visit& visit);
std::string quarantine_name(Keyspace space, const Digest& key);

}  // namespace kiln
