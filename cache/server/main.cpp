// kiln-cached: opens the store, starts the fronts, then waits for signals. SIGTERM and SIGINT drain, SIGHUP reads tokens and
// certificates again.
#include <malloc.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <thread>

#include "cache/disk_folder.h"
#include "cache/server/action_reader.h"
#include "cache/server/config.h"
#include "cache/server/facts.h"
#include "cache/server/grpc_server.h"
#include "compiler/base/files.h"

namespace kiln {

namespace {

constexpr const char* usage =
    R"(usage: kiln-cached [--config FILE] [--SETTING VALUE]...

A cache server for CI: Bazel's HTTP cache (/ac/, /cas/), WebDAV for sccache (/dav/), /status, /metrics, /healthz.
Settings come from FILE (YAML) and from flags of the same names, which win:

  --folder DIR            the store; made where it is missing
  --limit SIZE            its bound, evicting the least recently used (5GiB)
  --listen ADDR:PORT      HTTP; port 0 lets the kernel choose (127.0.0.1:8080)
  --grpc ADDR:PORT|off    gRPC, the remote execution API's cache (off)
  --tokens FILE           who may do what; the file's mode must be 0600. Needed to listen beyond loopback
  --anonymous ROLES|none  what callers without a token may do, beside tokens (none)
  --tls.certificate FILE  and --tls.key FILE, in PEM: TLS 1.2 or newer
  --plain_text true       listen beyond loopback without TLS: something in front does it
  --sync none|file|folder what a stored entry survives besides the server's death (file)
  --log off|events|requests   JSON lines on standard error (requests)
  --limits.blob SIZE  --limits.action SIZE  --limits.opaque_action SIZE  --limits.in_flight SIZE
  --limits.connections N  --limits.header BYTES  --threads.io N  --threads.work N (0: none)
  --timeouts.head S  --timeouts.body S  --timeouts.write S  --timeouts.idle S  --timeouts.drain S
  --timeouts.patience S  --limits.slowest SIZE   a body or a reply may take S seconds and its bytes at SIZE a second (60, 64KiB)
  --verify_again S        a blob read again within S seconds and unchanged on disk is not hashed anew (600)
  --chaos seed=N,loss=P,error=P,flip=P,delay=MS   hurt whoever calls, for tests: chances P from 0 to 1
  --check                 read the settings and the token file, say what is wrong, and end
  --help  --version

Instances are set in the file. An example:

  folder: /var/cache/kiln-cached
  limit: 50GiB
  listen: 0.0.0.0:8443
  tokens: /etc/kiln-cached/tokens     # "ci SECRET main:read,cas-write,ac-write", one a line
  tls: {certificate: /etc/kiln-cached/cert.pem, key: /etc/kiln-cached/key.pem}
  instances:
    - {name: main}
    - {name: pr/*, parent: main}      # reads main, never writes it
    - {name: ccache, opaque: true}    # its action values are not ActionResults

Exit codes: 0 ended as asked, 1 a file is wrong, 2 usage, 3 the environment failed.
)";

struct Tokens {  // of now
    mutable std::mutex mutex;
    std::shared_ptr<const Access> access;
    std::shared_ptr<const Access> get() const {
        const std::lock_guard lock(mutex);
        return access;
    }
    void set(Access fresh) {
        const std::lock_guard lock(mutex);
        access = std::make_shared<const Access>(std::move(fresh));
    }
};

Result<Access> load_access(const Config& config) {
    if (config.tokens.empty()) return Access::open();
    return Access::load(config.tokens, config.anonymous);
}

// Looks through the store's folder now and then, since that takes a walk over it.
class DiskWatch {
public:
    explicit DiskWatch(const DiskStore& store) : store_(store), thread_([this] { watch(); }) {}
    ~DiskWatch() {
        {
            const std::lock_guard lock(mutex_);
            stop_ = true;
        }
        changed_.notify_all();
        thread_.join();
    }
    void fill(ServerFacts& facts) const {
        const std::lock_guard lock(mutex_);
        facts.disk = stats_;
        facts.disk_seen = seen_;
    }

private:
    void watch() {
        std::unique_lock lock(mutex_);
        while (!stop_) {
            lock.unlock();
            const auto stats = store_.stats();
            lock.lock();
            if (stats.ok()) {
                stats_ = *stats;
                seen_ = std::time(nullptr);
            }
            changed_.wait_for(lock, std::chrono::seconds(30), [this] { return stop_; });
        }
    }
    const DiskStore& store_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    DiskStore::Stats stats_;
    int64_t seen_ = 0;
    std::thread thread_;  // last: it uses the others
};

// Raises the soft limit of descriptors as far as needed and allowed, and says how many HTTP connections fit: each may have a file
// open beside its socket, and the store, the index and gRPC need theirs whatever these do.
size_t connections_that_fit(size_t wanted) {
    constexpr rlim_t for_grpc = 4096, reserve = 256;
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return wanted;
    const rlim_t need = rlim_t{2} * wanted + for_grpc + reserve;
    if (files.rlim_cur < need) {
        files.rlim_cur = std::min(need, files.rlim_max);
        (void)::setrlimit(RLIMIT_NOFILE, &files);
        (void)::getrlimit(RLIMIT_NOFILE, &files);
    }
    const rlim_t kept = std::min(reserve, files.rlim_cur / 2);
    return static_cast<size_t>(std::clamp<rlim_t>((files.rlim_cur - kept) / 2, 1, wanted));
}

int fail(const Error& error) {
    std::fprintf(stderr, "kiln-cached: %s\n", error.message.c_str());
    return static_cast<int>(error.fault);
}

struct Arguments {
    std::string config_file;
    std::vector<Setting> settings;
    bool help = false, version = false, check = false;
};

Result<Arguments> parse(int argc, char** argv) {
    Arguments arguments;
    for (int i = 1; i < argc; ++i) {
        std::string_view word = argv[i];
        if (word == "--help" || word == "-h") {
            arguments.help = true;
        } else if (word == "--version") {
            arguments.version = true;
        } else if (word == "--check") {
            arguments.check = true;
        } else if (word.size() > 2 && word.substr(0, 2) == "--") {
            word.remove_prefix(2);
            const size_t equals = word.find('=');
            if (equals == std::string_view::npos && i + 1 == argc)
                return Error{Fault::usage, "--" + std::string(word) + " wants a value"};
            const std::string value(equals == std::string_view::npos ? argv[++i] : word.substr(equals + 1));
            const std::string name(word.substr(0, equals));
            if (name == "config")
                arguments.config_file = value;
            else
                arguments.settings.push_back({name, value, 0});
        } else {
            return Error{Fault::usage, "unknown argument '" + std::string(word) + "' (--help)"};
        }
    }
    return arguments;
}

Result<Config> configure(const Arguments& arguments) {
    Config config;
    config.http.port = 8080;
    if (!arguments.config_file.empty()) {
        const auto file = [&](const std::string& what) { return input_error(arguments.config_file + ": " + what); };
        const auto text = DiskFiles().read(arguments.config_file);
        if (!text.ok()) return file(text.error().message);
        if (!text->has_value()) return file("no such file");
        const auto settings = settings_of(**text);
        if (!settings.ok()) return file(settings.error().message);
        const Status applied = apply(*settings, config);
        if (!applied.ok()) return file(applied.error().message);
    }
    KILN_TRY(apply(arguments.settings, config));
    KILN_TRY(check(config));
    return config;
}

int serve(const Config& config) {
    auto access = load_access(config);
    if (!access.ok()) return fail(access.error());
    Tokens tokens;
    tokens.set(std::move(*access));
    auto store = DiskStore::open(config.folder, config.disk);
    if (!store.ok()) return fail(store.error());
    auto instances = Instances::make(config.instances);
    if (!instances.ok()) return fail(instances.error());
    Log log(STDERR_FILENO, config.log);
    const int64_t started = std::time(nullptr);

    Service service(**store, std::move(*instances), config.limits, reapi_reader(), config.verify_again_after);
    service.on_event = [&](const Event& event) {
        log.event(std::move(
            LogLine(event.kind).text("instance", event.instance).text("caller", event.caller).text("message", event.message)));
    };
    if (config.chaos) {
        std::fprintf(stderr, "{\"kind\":\"warning\",\"message\":\"--chaos: whatever this server is asked may fail\"}\n");
        service.hurt(*config.chaos, config.chaos_text);
    }
    const DiskWatch watch(**store);
    std::atomic<HttpServer*> http_now{nullptr};  // pages may be asked for from the moment that it listens
    const auto facts = [&] {
        ServerFacts f;
        f.version = KILN_VERSION;
        f.now = std::time(nullptr);
        f.started = started;
        watch.fill(f);
        f.limit = config.disk.limit;
        f.store = (*store)->counters();
        f.counts = service.counters().total();
        f.instances = service.counters().by_instance();
        f.events = service.counters().recent();
        if (config.chaos) f.chaos = service.mishaps().counters();
        f.in_flight = service.in_flight();
        f.answering = service.answering();
        f.hashed = service.hashed();
        if (const HttpServer* server = http_now) f.http = server->stats();
        return f;
    };
    HttpFace face(service, [&] { return tokens.get(); },
                  {[&] { return status_page(facts()); }, [&] { return metrics_page(facts()); }});

    // --- the fronts: each listens from here on; whoever waits for the lines below may connect ---
    HttpOptions http_options = config.http;
    http_options.connections = connections_that_fit(config.http.connections);
    auto http = HttpServer::start(face, log, http_options);
    if (!http.ok()) return fail(http.error());
    http_now = http->get();
    std::printf("http %s:%u\n", config.http.address.c_str(), (*http)->port());
    std::unique_ptr<GrpcServer> grpc;
    if (config.grpc_port >= 0) {
        GrpcOptions options;
        options.address = config.grpc_address;
        options.port = static_cast<uint16_t>(config.grpc_port);
        options.certificate = config.http.certificate;
        options.key = config.http.key;
        options.work_threads = config.http.work_threads;
        options.patience = std::chrono::ceil<std::chrono::seconds>(config.http.patience);
        options.slowest = config.http.slowest;
        auto started_grpc = GrpcServer::start(
            service, log, [&] { return tokens.get(); }, options);
        if (!started_grpc.ok()) return fail(started_grpc.error());
        grpc = std::move(*started_grpc);
        std::printf("grpc %s:%u\n", config.grpc_address.c_str(), grpc->port());
    }
    std::fflush(stdout);
    log.event(std::move(LogLine("started")
                            .text("version", KILN_VERSION)
                            .text("address", config.http.address)
                            .number("port", (*http)->port())
                            .number("connections", http_options.connections)
                            .text("tls", config.http.certificate.empty() ? "no" : "yes")
                            .number("tokens", tokens.get()->tokens())));

    sigset_t wanted;
    sigemptyset(&wanted);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&wanted, signal);
    while (true) {
        const timespec soon{0, 200'000'000};
        const int signal = ::sigtimedwait(&wanted, nullptr, &soon);
        if (signal < 0) {
            log.flush();
            continue;
        }
        if (signal != SIGHUP) break;
        auto fresh = load_access(config);
        const Status tls = (*http)->reload_tls();
        if (fresh.ok()) tokens.set(std::move(*fresh));
        LogLine line("reloaded");
        line.number("tokens", tokens.get()->tokens());
        if (!fresh.ok()) line.text("tokens_kept", fresh.error().message);
        if (!tls.ok()) line.text("tls_kept", tls.error().message);
        log.event(std::move(line));
    }
    // Both at once: neither takes anything new from here on, and the whole lasts no longer than one of them may.
    std::thread grpc_drain([&] {
        if (grpc) grpc->drain(std::chrono::ceil<std::chrono::seconds>(config.drain));
    });
    const bool all = (*http)->drain(config.drain);
    grpc_drain.join();
    log.event(std::move(LogLine("stopped").text("drained", all ? "yes" : "no")));
    return 0;
}

}  // namespace

}  // namespace kiln

int main(int argc, char** argv) {
    using namespace kiln;
    const auto arguments = parse(argc, argv);
    if (!arguments.ok()) return fail(arguments.error());
    if (arguments->help) return std::fputs(usage, stdout) < 0 ? 3 : 0;
    if (arguments->version) return std::puts("kiln-cached " KILN_VERSION) < 0 ? 3 : 0;
    const auto config = configure(*arguments);
    if (!config.ok()) return fail(config.error());
    if (arguments->check) {
        const auto access = load_access(*config);
        return access.ok() ? 0 : fail(access.error());
    }
    // Large bodies go back to the system when they are done with: left alone, malloc keeps blocks of up to 32 MiB for each arena.
    ::mallopt(M_MMAP_THRESHOLD, 1 << 20);
    // Blocked in every thread, and taken by the main one; a client that goes away must not end the server.
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGPIPE}) sigaddset(&blocked, signal);
    ::pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
    return serve(*config);
}
