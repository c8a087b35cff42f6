// The transfer thread against a server of a few lines on loopback: many callers at once, ends of time, limits, servers that are
// not there. What hostile servers answer is tests/cache/hostile.py.
#include "cache/client/http_transfer.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

namespace kiln {
namespace {

using Method = HttpRequest::Method;
using std::chrono::milliseconds;

// Answers each request by what `answer` makes of its first line and body; an empty answer is silence.
class Server {
public:
    using Answer = std::function<std::string(const std::string& line, const std::string& head, const std::string& body)>;
    explicit Server(Answer answer) : answer_(std::move(answer)) {
        listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
        EXPECT_EQ(::listen(listener_, 64), 0);
        EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
        url = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
        acceptor_ = std::thread([this] { accept(); });
    }
    ~Server() {
        stop_ = true;
        ::shutdown(listener_, SHUT_RDWR);
        acceptor_.join();
        for (const int fd : connections_) ::shutdown(fd, SHUT_RDWR);
        for (std::thread& thread : threads_) thread.join();
        for (const int fd : connections_) ::close(fd);
        ::close(listener_);
    }
    std::string url;
    std::atomic<int> requests{0}, opened{0};

private:
    void accept() {
        while (!stop_) {
            const int fd = ::accept(listener_, nullptr, nullptr);
            if (fd < 0) break;
            ++opened;
            connections_.push_back(fd);
            threads_.emplace_back([this, fd] { serve(fd); });
        }
    }
    void serve(int fd) {
        std::string in;
        char buffer[65536];
        for (;;) {
            size_t end = in.find("\r\n\r\n");
            size_t length = 0;
            if (end != std::string::npos) {
                const size_t at = in.find("Content-Length: ");
                if (at < end) length = std::stoul(in.substr(at + 16));
            }
            if (end == std::string::npos || in.size() < end + 4 + length) {
                const ssize_t got = ::recv(fd, buffer, sizeof buffer, 0);
                if (got <= 0) return;
                in.append(buffer, static_cast<size_t>(got));
                continue;
            }
            ++requests;
            const std::string out = answer_(in.substr(0, in.find("\r\n")), in.substr(0, end), in.substr(end + 4, length));
            in.erase(0, end + 4 + length);
            if (::send(fd, out.data(), out.size(), MSG_NOSIGNAL) < 0) return;
        }
    }
    const Answer answer_;
    int listener_ = -1;
    std::atomic<bool> stop_{false};
    std::vector<int> connections_;
    std::vector<std::thread> threads_;
    std::thread acceptor_;
};

std::string reply(const std::string& body, const std::string& status = "200 OK") {
    return "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::unique_ptr<HttpTransfer> open(milliseconds timeout = milliseconds(5000), const std::string& token = {}) {
    for (const char* name : {"http_proxy", "all_proxy", "HTTP_PROXY", "ALL_PROXY"}) ::unsetenv(name);
    HttpOptions options;
    options.timeout = timeout;
    options.token = token;
    auto opened = HttpTransfer::open(options);
    EXPECT_TRUE(opened.ok()) << opened.error().message;
    return std::move(*opened);
}

std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

TEST(HttpTransfer, ManyCallersGetTheirOwnAnswersOverKeptConnections) {
    Server server([](const std::string& line, const std::string&, const std::string& body) {
        return line.rfind("PUT", 0) == 0 ? reply("", body.size() == 1000 ? "201 Created" : "400 Bad")
                                         : reply(line.substr(0, line.rfind(' ')));
    });
    const auto transfer = open();
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int round = 0; round < 5; ++round) {
                const Bytes body(1000, static_cast<uint8_t>(t));
                std::vector<HttpRequest> requests;
                for (int i = 0; i < 40; ++i) {
                    const std::string url = server.url + "/" + std::to_string(t) + "/" + std::to_string(i);
                    requests.push_back(i % 4 == 3 ? HttpRequest{Method::put, url, body, 0}
                                                  : HttpRequest{Method::get, url, {}, 100});
                }
                const auto replies = transfer->run(requests, 8);
                ASSERT_EQ(replies.size(), 40u);
                for (int i = 0; i < 40; ++i) {
                    const HttpReply& got = replies[static_cast<size_t>(i)];
                    ASSERT_EQ(got.status, i % 4 == 3 ? 201 : 200) << got.problem;
                    const std::string echo = "GET /" + std::to_string(t) + "/" + std::to_string(i);
                    ASSERT_EQ(text(got.body), i % 4 == 3 ? "" : echo);
                }
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(server.requests, 800);
    EXPECT_LE(server.opened, 20);
}

TEST(HttpTransfer, SendsTheTokenAndNothingIsCompressed) {
    std::string head;
    Server server([&](const std::string&, const std::string& all, const std::string&) {
        head = all;
        return reply("x");
    });
    const HttpRequest request{Method::get, server.url + "/a", {}, 10};
    EXPECT_EQ(open(milliseconds(5000), "secret-token")->run({&request, 1}, 8).front().status, 200);
    EXPECT_NE(head.find("Authorization: Bearer secret-token"), std::string::npos);
    EXPECT_EQ(head.find("Accept-Encoding"), std::string::npos);
    open()->run({&request, 1}, 8);
    EXPECT_EQ(head.find("Authorization"), std::string::npos);
}

TEST(HttpTransfer, LimitsAreExact) {
    Server server([](const std::string&, const std::string&, const std::string&) { return reply(std::string(1000, 'x')); });
    const auto transfer = open();
    for (const uint64_t limit : {uint64_t{0}, uint64_t{1}, uint64_t{999}, uint64_t{1000}, uint64_t{5000}}) {
        const HttpRequest request{Method::get, server.url + "/a", {}, limit};
        const HttpReply got = transfer->run({&request, 1}, 8).front();
        EXPECT_EQ(got.status, limit >= 1000 ? 200 : 0) << limit;
        EXPECT_EQ(got.body.size(), limit >= 1000 ? 1000u : 0u);
        EXPECT_EQ(got.problem.empty(), limit >= 1000);
    }
}

TEST(HttpTransfer, SilenceEndsByTheDeadlineAndTheRestIsGivenUp) {
    Server server([](const std::string&, const std::string&, const std::string&) { return std::string(); });
    const auto transfer = open(milliseconds(100));
    std::vector<HttpRequest> requests(500, HttpRequest{Method::head, server.url + "/a", {}, 0});
    const auto replies = transfer->run(requests, 8);
    EXPECT_TRUE(replies.front().timed_out) << replies.front().problem;
    EXPECT_EQ(replies.back().problem, "given up after others had failed");
    EXPECT_LE(server.requests, 40);
}

TEST(HttpTransfer, EndsWhenItIsTold) {
    Server server([](const std::string&, const std::string&, const std::string&) { return std::string(); });
    const auto transfer = open(milliseconds(60'000));
    std::thread ender([&] {
        while (server.requests == 0) std::this_thread::yield();
        transfer->end_at(std::chrono::steady_clock::now());
    });
    const HttpRequest request{Method::get, server.url + "/a", {}, 10};
    EXPECT_EQ(transfer->run({&request, 1}, 8).front().problem, "out of time");
    EXPECT_EQ(transfer->run({&request, 1}, 8).front().problem, "out of time");
    ender.join();
}

TEST(HttpTransfer, NobodyThereIsAFailureAtOnce) {
    std::string gone;
    {
        Server server([](const std::string&, const std::string&, const std::string&) { return reply(""); });
        gone = server.url;
    }
    const auto transfer = open();
    std::vector<HttpRequest> requests(100, HttpRequest{Method::get, gone + "/a", {}, 10});
    for (const HttpReply& got : transfer->run(requests, 8)) {
        EXPECT_EQ(got.status, 0);
        EXPECT_FALSE(got.timed_out);
        EXPECT_FALSE(got.problem.empty());
    }
    EXPECT_TRUE(transfer->run({}, 8).empty());
}

TEST(HttpTransfer, AServerThatClosesKeptConnectionsIsAskedAnew) {
    std::atomic<int> count{0};
    Server server([&](const std::string&, const std::string&, const std::string&) {
        ++count;
        std::string out = reply("x");
        out.insert(out.find("\r\n") + 2, "Connection: close\r\n");
        return out;
    });
    const auto transfer = open();
    for (int i = 0; i < 20; ++i) {
        const HttpRequest request{Method::get, server.url + "/a", {}, 10};
        EXPECT_EQ(transfer->run({&request, 1}, 8).front().status, 200);
    }
    EXPECT_EQ(count, 20);
}

}  // namespace
}  // namespace kiln
