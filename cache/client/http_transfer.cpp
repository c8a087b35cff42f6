// One thread owns all of libcurl's state. It starts as many transfers as there are connections, so that a request's deadline
// does not run while it waits for one.
#include "cache/client/http_transfer.h"

#define CURL_DISABLE_TYPECHECK
#include <curl/curl.h>
#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string_view>
#include <thread>

#include "compiler/base/jobs.h"

namespace kiln {

namespace {

using Clock = std::chrono::steady_clock;

constexpr uint64_t most_headers = 64 * 1024;
constexpr uint64_t most_unwanted = 64 * 1024;             // of a body that nobody will read
constexpr uint64_t most_in_flight = uint64_t{512} << 20;  // of all responses together
constexpr long least_speed = 16 * 1024;                   // bytes a second, over the time of a deadline
constexpr uint64_t whole_speed = 1024 * 1024;  // what a whole transfer may take: the deadline and its bytes at this speed

struct Curl {
    decltype(&curl_global_init) global_init = nullptr;
    decltype(&curl_easy_init) easy_init = nullptr;
    decltype(&curl_easy_reset) easy_reset = nullptr;
    decltype(&curl_easy_cleanup) easy_cleanup = nullptr;
    decltype(&curl_easy_setopt) easy_setopt = nullptr;
    decltype(&curl_easy_getinfo) easy_getinfo = nullptr;
    decltype(&curl_easy_strerror) easy_strerror = nullptr;
    decltype(&curl_slist_append) slist_append = nullptr;
    decltype(&curl_slist_free_all) slist_free_all = nullptr;
    decltype(&curl_multi_init) multi_init = nullptr;
    decltype(&curl_multi_cleanup) multi_cleanup = nullptr;
    decltype(&curl_multi_setopt) multi_setopt = nullptr;
    decltype(&curl_multi_add_handle) multi_add_handle = nullptr;
    decltype(&curl_multi_remove_handle) multi_remove_handle = nullptr;
    decltype(&curl_multi_perform) multi_perform = nullptr;
    decltype(&curl_multi_info_read) multi_info_read = nullptr;
    decltype(&curl_multi_poll) multi_poll = nullptr;
    decltype(&curl_multi_wakeup) multi_wakeup = nullptr;
    std::string problem;

    Curl() {
        void* library = ::dlopen("libcurl.so.4", RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) {
            const char* why = ::dlerror();
            problem = std::string("libcurl cannot be loaded: ") + (why != nullptr ? why : "no reason given");
            return;
        }
        const auto find = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
            if (function == nullptr) problem = std::string("libcurl lacks ") + name;
        };
        find(global_init, "curl_global_init");
        find(easy_init, "curl_easy_init");
        find(easy_reset, "curl_easy_reset");
        find(easy_cleanup, "curl_easy_cleanup");
        find(easy_setopt, "curl_easy_setopt");
        find(easy_getinfo, "curl_easy_getinfo");
        find(easy_strerror, "curl_easy_strerror");
        find(slist_append, "curl_slist_append");
        find(slist_free_all, "curl_slist_free_all");
        find(multi_init, "curl_multi_init");
        find(multi_cleanup, "curl_multi_cleanup");
        find(multi_setopt, "curl_multi_setopt");
        find(multi_add_handle, "curl_multi_add_handle");
        find(multi_remove_handle, "curl_multi_remove_handle");
        find(multi_perform, "curl_multi_perform");
        find(multi_info_read, "curl_multi_info_read");
        find(multi_poll, "curl_multi_poll");
        find(multi_wakeup, "curl_multi_wakeup");
        if (problem.empty() && global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) problem = "libcurl cannot be initialised";
    }
};

const Curl& curl() {
    static const Curl loaded;
    return loaded;
}

}  // namespace

struct HttpTransfer::Engine {
    struct Batch {
        std::span<const HttpRequest> requests;
        std::vector<HttpReply> replies;
        size_t next = 0, done = 0;
        uint64_t held = 0;  // bytes of its bodies
        unsigned patience = 0, unanswered = 0;
        bool abandoned() const { return patience != 0 && unanswered >= patience; }
    };
    struct Slot {
        CURL* easy = nullptr;
        Batch* batch = nullptr;  // null: free
        size_t index = 0;
        uint64_t headers = 0, received = 0, sent = 0;
        std::string own_problem;
        Engine* engine = nullptr;
        char reason[CURL_ERROR_SIZE] = {};
    };

    explicit Engine(const HttpOptions& given) : options(given), slots(std::max<size_t>(1, given.connections)) {}

    ~Engine() {
        {
            const std::lock_guard lock(mutex);
            stop = true;
        }
        if (multi != nullptr) curl().multi_wakeup(multi);
        if (thread.joinable()) thread.join();
        for (Slot& slot : slots)
            if (slot.easy != nullptr) curl().easy_cleanup(slot.easy);
        if (multi != nullptr) curl().multi_cleanup(multi);
        curl().slist_free_all(get_headers);
        curl().slist_free_all(put_headers);
    }

    Status start() {
        multi = curl().multi_init();
        if (multi == nullptr) return environment_error("libcurl has no memory");
        curl().multi_setopt(multi, CURLMOPT_MAXCONNECTS, static_cast<long>(slots.size()));
        for (Slot& slot : slots) {
            slot.engine = this;
            slot.easy = curl().easy_init();
            if (slot.easy == nullptr) return environment_error("libcurl has no memory");
        }
        // No waiting for "100 Continue"; a body's type is plain bytes.
        put_headers = curl().slist_append(put_headers, "Expect:");
        put_headers = curl().slist_append(put_headers, "Content-Type: application/octet-stream");
        if (!options.token.empty()) {
            const std::string line = "Authorization: Bearer " + options.token;
            get_headers = curl().slist_append(get_headers, line.c_str());
            put_headers = curl().slist_append(put_headers, line.c_str());
        }
        thread = std::thread([this] { loop(); });
        return {};
    }

    static size_t on_header(const char* line, size_t size, size_t count, void* user) {
        Slot& slot = *static_cast<Slot*>(user);
        slot.headers += size * count;
        if (std::string_view(line, size * count).starts_with("X-Kiln-Kept: first"))
            slot.batch->replies[slot.index].kept_first = true;
        if (slot.headers <= most_headers) return size * count;
        slot.own_problem = "headers longer than 64 KiB";
        return 0;
    }

    static size_t on_body(const char* data, size_t size, size_t count, void* user) {
        Slot& slot = *static_cast<Slot*>(user);
        const size_t bytes = size * count;
        long status = 0;
        curl().easy_getinfo(slot.easy, CURLINFO_RESPONSE_CODE, &status);
        const HttpRequest& request = slot.batch->requests[slot.index];
        const bool wanted = status == 200 && request.method == HttpRequest::Method::get;
        slot.received += bytes;
        if (slot.received > (wanted ? request.limit : most_unwanted)) {
            slot.own_problem = "a body longer than " + std::to_string(wanted ? request.limit : most_unwanted) + " bytes";
            return 0;
        }
        if (!wanted) return bytes;
        if (slot.engine->in_flight + bytes > most_in_flight) {
            slot.own_problem = "too much at once";
            return 0;
        }
        slot.engine->in_flight += bytes;
        slot.batch->held += bytes;
        Bytes& body = slot.batch->replies[slot.index].body;
        body.insert(body.end(), data, data + bytes);
        return bytes;
    }

    static size_t on_send(char* into, size_t size, size_t count, void* user) {
        Slot& slot = *static_cast<Slot*>(user);
        const ByteView body = slot.batch->requests[slot.index].body;
        const size_t bytes = std::min<uint64_t>(size * count, body.size() - slot.sent);
        std::copy_n(body.begin() + static_cast<std::ptrdiff_t>(slot.sent), bytes, into);
        slot.sent += bytes;
        return bytes;
    }

    static int on_seek(void* user, curl_off_t offset, int origin) {
        Slot& slot = *static_cast<Slot*>(user);
        if (origin != SEEK_SET || offset < 0) return CURL_SEEKFUNC_FAIL;
        slot.sent = static_cast<uint64_t>(offset);
        return CURL_SEEKFUNC_OK;
    }

    void begin(Slot& slot, Batch& batch) {
        slot.batch = &batch;
        slot.index = batch.next++;
        slot.headers = slot.received = slot.sent = 0;
        slot.own_problem.clear();
        slot.reason[0] = '\0';
        const HttpRequest& request = batch.requests[slot.index];
        const auto set = [&](CURLoption option, auto value) { curl().easy_setopt(slot.easy, option, value); };
        curl().easy_reset(slot.easy);
        set(CURLOPT_URL, request.url.c_str());
        set(CURLOPT_PROTOCOLS_STR, "http,https");
        set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});
        set(CURLOPT_FOLLOWLOCATION, 0L);
        if (options.no_proxy) set(CURLOPT_PROXY, "");
        set(CURLOPT_SSLVERSION, long{CURL_SSLVERSION_TLSv1_2});
        if (!options.ca_file.empty()) set(CURLOPT_CAINFO, options.ca_file.c_str());
        set(CURLOPT_NOSIGNAL, 1L);
        set(CURLOPT_TCP_NODELAY, 1L);
        set(CURLOPT_USERAGENT, "kiln");
        set(CURLOPT_ERRORBUFFER, slot.reason);
        set(CURLOPT_PRIVATE, &slot);
        set(CURLOPT_HEADERFUNCTION, &on_header);
        set(CURLOPT_HEADERDATA, &slot);
        set(CURLOPT_WRITEFUNCTION, &on_body);
        set(CURLOPT_WRITEDATA, &slot);
        const long deadline = static_cast<long>(options.timeout.count());
        const uint64_t bytes = request.method == HttpRequest::Method::put ? request.body.size() : request.limit;
        set(CURLOPT_CONNECTTIMEOUT_MS, std::max(1L, std::min(deadline, 2000L)));
        set(CURLOPT_TIMEOUT_MS, deadline + static_cast<long>(bytes * 1000 / whole_speed));
        set(CURLOPT_LOW_SPEED_LIMIT, least_speed);
        set(CURLOPT_LOW_SPEED_TIME, std::max(1L, (deadline + 999) / 1000));
        switch (request.method) {
            case HttpRequest::Method::get:
                set(CURLOPT_HTTPHEADER, get_headers);
                break;
            case HttpRequest::Method::head:
                set(CURLOPT_NOBODY, 1L);
                set(CURLOPT_HTTPHEADER, get_headers);
                break;
            case HttpRequest::Method::put:
                set(CURLOPT_UPLOAD, 1L);
                set(CURLOPT_INFILESIZE_LARGE, static_cast<curl_off_t>(request.body.size()));
                set(CURLOPT_READFUNCTION, &on_send);
                set(CURLOPT_READDATA, &slot);
                set(CURLOPT_SEEKFUNCTION, &on_seek);
                set(CURLOPT_SEEKDATA, &slot);
                set(CURLOPT_HTTPHEADER, put_headers);
                break;
        }
        curl().multi_add_handle(multi, slot.easy);
    }

    void finish(Slot& slot, CURLcode code) {
        HttpReply& reply = slot.batch->replies[slot.index];
        long status = 0;
        curl().easy_getinfo(slot.easy, CURLINFO_RESPONSE_CODE, &status);
        if (code == CURLE_OK && status != 0) {
            reply.status = static_cast<int>(status);
        } else {
            reply.timed_out = code == CURLE_OPERATION_TIMEDOUT;
            reply.problem = !slot.own_problem.empty() ? slot.own_problem
                            : slot.reason[0] != '\0'  ? std::string(slot.reason)
                                                      : std::string(curl().easy_strerror(code));
        }
        if (reply.status != 200) reply.body = Bytes();
        close(slot, reply.status == 0);
    }

    void close(Slot& slot, bool unanswered) {
        Batch& batch = *slot.batch;
        curl().multi_remove_handle(multi, slot.easy);
        slot.batch = nullptr;
        ++batch.done;
        batch.unanswered = unanswered ? batch.unanswered + 1 : 0;
    }

    // What is not to be answered any more gets a reason instead.
    void abandon(Batch& batch, const char* why) {
        for (Slot& slot : slots)
            if (slot.batch == &batch) {
                HttpReply& reply = batch.replies[slot.index];
                reply.body = Bytes();
                reply.problem = why;
                close(slot, true);
            }
        for (; batch.next < batch.requests.size(); ++batch.next, ++batch.done) batch.replies[batch.next].problem = why;
    }

    void loop() {
        std::vector<Batch*> under_way;
        for (;;) {
            const char* ending = nullptr;
            {
                const std::lock_guard lock(mutex);
                for (Batch* batch : waiting) under_way.push_back(batch);
                waiting.clear();
                if (stop && under_way.empty()) return;
                if (stop || interrupted.load()) ending = "interrupted";
                if (Clock::now() >= end) ending = "out of time";
            }
            for (Batch* batch : under_way)
                if (ending != nullptr || batch->abandoned())
                    abandon(*batch, ending != nullptr ? ending : "given up after others had failed");
            // The oldest batch first; a later one fills the connections that are left.
            for (Batch* batch : under_way)
                for (Slot& slot : slots)
                    if (slot.batch == nullptr && batch->next < batch->requests.size()) begin(slot, *batch);
            int running = 0;
            curl().multi_perform(multi, &running);
            int left = 0;
            while (const CURLMsg* message = curl().multi_info_read(multi, &left)) {
                if (message->msg != CURLMSG_DONE) continue;
                const CURLcode code = message->data.result;
                char* slot = nullptr;
                curl().easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &slot);
                finish(*reinterpret_cast<Slot*>(slot), code);
            }
            bool ended = false, more = false;
            {
                const std::lock_guard lock(mutex);
                std::erase_if(under_way, [&](Batch* batch) {
                    if (batch->done < batch->requests.size()) return false;
                    finished.push_back(batch);
                    in_flight -= batch->held;  // from here on they are the caller's
                    return ended = true;
                });
                more = !waiting.empty();
            }
            if (ended) wake.notify_all();
            const bool room =
                std::any_of(slots.begin(), slots.end(), [](const Slot& s) { return s.batch == nullptr; }) &&
                std::any_of(under_way.begin(), under_way.end(), [](const Batch* b) { return b->next < b->requests.size(); });
            // Woken by new batches; the time is for what else may end a transfer.
            if (!more && !room) curl().multi_poll(multi, nullptr, 0, under_way.empty() ? 1000 : 100, nullptr);
        }
    }

    std::vector<HttpReply> run(std::span<const HttpRequest> requests, unsigned patience) {
        Batch batch;
        batch.requests = requests;
        batch.replies.resize(requests.size());
        batch.patience = patience;
        if (requests.empty()) return {};
        std::unique_lock lock(mutex);
        waiting.push_back(&batch);
        curl().multi_wakeup(multi);
        wake.wait(lock, [&] { return std::find(finished.begin(), finished.end(), &batch) != finished.end(); });
        std::erase(finished, &batch);
        return std::move(batch.replies);
    }

    const HttpOptions options;
    CURLM* multi = nullptr;
    curl_slist* get_headers = nullptr;
    curl_slist* put_headers = nullptr;
    std::vector<Slot> slots;  // the thread's own, as is in_flight
    uint64_t in_flight = 0;
    std::thread thread;

    std::mutex mutex;
    std::condition_variable wake;
    std::vector<Batch*> waiting, finished;
    bool stop = false;
    Clock::time_point end = Clock::time_point::max();
};

HttpTransfer::HttpTransfer(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}
HttpTransfer::~HttpTransfer() = default;

Result<std::unique_ptr<HttpTransfer>> HttpTransfer::open(const HttpOptions& options) {
    if (!curl().problem.empty()) return environment_error(curl().problem);
    auto engine = std::make_unique<Engine>(options);
    KILN_TRY(engine->start());
    return std::unique_ptr<HttpTransfer>(new HttpTransfer(std::move(engine)));
}

std::vector<HttpReply> HttpTransfer::run(std::span<const HttpRequest> requests, unsigned patience) {
    return engine_->run(requests, patience);
}

void HttpTransfer::end_at(Clock::time_point when) {
    const std::lock_guard lock(engine_->mutex);
    engine_->end = when;
}

}  // namespace kiln
