#pragma once
// One connection of the HTTP front, over plain TCP or TLS. Belongs to http_server.cpp; a header since the connection is a
// template over its stream. Everything runs on the thread of the connection's loop but HttpFace::answer() of work that may block,
// which runs in the pool.

#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>

#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <exception>

#include "cache/server/http_head.h"
#include "cache/server/http_loop.h"
#include "cache/server/patience.h"
#include "cache/server/tls_stream.h"

namespace kiln {

template <class Stream>
class Connection final : public ConnectionBase, public std::enable_shared_from_this<Connection<Stream>> {
    static constexpr bool secure = !std::is_same_v<Stream, beast::tcp_stream>;
    static constexpr size_t piece = 64 * 1024, at_once = size_t{1} << 20;

public:
    template <class... Arguments>
    Connection(HttpShared& shared, HttpLoop& loop, std::string peer, net::ip::tcp::socket socket, Arguments&&... arguments)
        : ConnectionBase(shared, loop),
          stream_(std::move(socket), std::forward<Arguments>(arguments)...),
          peer_(std::move(peer)) {}

    void run() {
        if constexpr (secure) {
            deadline(shared_.options.head_timeout);
            stream_.async_handshake([self = this->shared_from_this()](beast::error_code failed) {
                if (failed)
                    ++self->shared_.handshakes_failed;
                else
                    self->next_request();
            });
        } else {
            stream_.socket().native_non_blocking(true, ignored_);  // sendfile has no flag for it
            next_request();
        }
    }

    void end() override { beast::get_lowest_layer(stream_).socket().close(ignored_); }

private:
    using Clock = std::chrono::steady_clock;

    void deadline(std::chrono::milliseconds after) { beast::get_lowest_layer(stream_).expires_after(after); }
    // Of a piece, and no later than that of the whole, which whole() sets.
    void deadline_of_piece(std::chrono::milliseconds after) {
        beast::get_lowest_layer(stream_).expires_at(std::min(Clock::now() + after, whole_until_));
    }
    void whole(uint64_t bytes) {
        whole_until_ = Clock::now() + whole_time(shared_.options.patience, bytes, shared_.options.slowest);
    }

    // `what` failed: a deadline in the middle of a request is counted, a client that went away is nothing.
    void gone(beast::error_code failed, bool under_way) {
        if (failed == beast::error::timeout && under_way) ++shared_.timeouts;
    }

    // --- the head ---
    void next_request() {
        if (shared_.draining) return finish();
        parser_.emplace();
        parser_->header_limit(shared_.options.header_bytes);
        parser_->body_limit(UINT64_MAX);  // ours is by role and instance; "none" is less than every length
        body_ = Bytes();
        filled_ = 0;
        received_ = 0;
        lease_ = Service::Lease();
        response_ = HttpResponse();
        work_ = HttpWork();
        unread_ = false;
        idle_ = buffer_.size() == 0;
        began_ = Clock::now();
        idle_until_ = began_ + shared_.options.idle_timeout;
        if (idle_)
            beast::get_lowest_layer(stream_).expires_never();
        else
            deadline(shared_.options.head_timeout);
        parse_head();
    }

    void parse_head() {
        if (buffer_.size() != 0) {
            beast::error_code failed;
            const size_t used = parser_->put(buffer_.data(), failed);
            // Beast joins folded lines; another server might see another field.
            const bool folded = has_folded_line({static_cast<const char*>(buffer_.data().data()), used});
            buffer_.consume(used);
            if (parser_->is_header_done() && !folded) return on_head();
            if (folded || (failed && failed != http::error::need_more)) {
                ++shared_.malformed;
                unread_ = true;
                return respond(plain(failed == http::error::header_limit ? 431 : 400));
            }
        }
        // A head that passes its limit is found by the parser, which sees all of it.
        const size_t room = shared_.options.header_bytes + 1 - std::min<size_t>(buffer_.size(), shared_.options.header_bytes);
        stream_.async_read_some(buffer_.prepare(std::min<size_t>(room, 4096)),
                                [self = this->shared_from_this()](beast::error_code failed, size_t n) {
                                    if (failed) return self->gone(failed, !self->idle_);
                                    self->buffer_.commit(n);
                                    if (self->idle_) {
                                        self->idle_ = false;
                                        self->began_ = Clock::now();
                                        self->deadline(self->shared_.options.head_timeout);
                                    }
                                    self->parse_head();
                                });
    }

    void on_head() {
        ++shared_.requests;
        const HeadCheck check = check_head(*parser_);
        keep_alive_ = check.keep_alive;
        if (check.status != 0) {
            ++shared_.malformed;
            unread_ = true;
            return respond(plain(check.status));
        }
        auto refused = shared_.face.plan(check.head, work_);
        length_ = check.head.length;
        unread_ = !length_ || *length_ != 0;
        if (refused) return respond(std::move(*refused));
        whole(length_ ? *length_ : work_.most);
        deadline_of_piece(shared_.options.body_timeout);
        renewed_at_ = 0;
        if (!unread_) return on_body();
        if (!check.expects_continue || buffer_.size() != 0) return read_body();
        static constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
        net::async_write(stream_, net::buffer(go_on), [self = this->shared_from_this()](beast::error_code failed, size_t) {
            if (failed) return self->gone(failed, true);
            self->read_body();
        });
    }

    // --- the body ---
    // Room for more of it, at most what may come; false after having refused.
    bool make_room() {
        if (filled_ < body_.size()) return true;
        const uint64_t most = length_ ? *length_ : work_.most + 1;
        const uint64_t wanted = std::min<uint64_t>(most, std::max<uint64_t>(piece, uint64_t{2} * filled_));
        if (wanted <= filled_) return true;
        lease_ = Service::Lease();
        auto lease = shared_.face.service().lease(wanted);
        if (!lease.ok()) {
            const Target& target = work_.target;
            respond(shared_.face.refused(
                shared_.face.service().refuse(target.instance, work_.caller, lease.refused().why, lease.refused().message)));
            return false;
        }
        lease_ = std::move(*lease);
        body_.resize(static_cast<size_t>(wanted));
        return true;
    }

    void renew_deadline() {
        if (filled_ - renewed_at_ < piece) return;
        renewed_at_ = filled_;
        deadline_of_piece(shared_.options.body_timeout);
    }

    void read_body() {
        renew_deadline();
        if (!length_) return read_chunks();
        if (!make_room()) return;
        const size_t here = std::min(buffer_.size(), body_.size() - filled_);
        net::buffer_copy(net::buffer(body_.data() + filled_, here), buffer_.data());
        buffer_.consume(here);
        filled_ += here;
        if (filled_ == *length_) {
            unread_ = false;
            return on_body();
        }
        if (filled_ == body_.size()) return read_body();
        stream_.async_read_some(net::buffer(body_.data() + filled_, body_.size() - filled_),
                                [self = this->shared_from_this()](beast::error_code failed, size_t n) {
                                    if (failed) return self->gone(failed, true);
                                    self->filled_ += n;
                                    self->read_body();
                                });
    }

    void read_chunks() {
        while (true) {
            if (parser_->is_done()) {
                unread_ = false;
                return on_body();
            }
            if (!make_room()) return;
            auto& into = parser_->get().body();
            into.data = body_.data() + filled_;
            into.size = body_.size() - filled_;
            into.more = true;
            beast::error_code failed;
            const size_t used = buffer_.size() == 0 ? 0 : parser_->put(buffer_.data(), failed);
            buffer_.consume(used);
            filled_ = body_.size() - into.size;
            if (filled_ > work_.most) {
                const Refused why{Refusal::too_large, "the body is larger than the server takes"};
                return respond(shared_.face.refused(
                    shared_.face.service().refuse(work_.target.instance, work_.caller, why.why, why.message)));
            }
            if (failed && failed != http::error::need_more && failed != http::error::need_buffer) {
                ++shared_.malformed;
                return respond(plain(400));
            }
            if (used == 0 && failed != http::error::need_buffer) break;
        }
        renew_deadline();
        if (buffer_.size() > piece) {  // a chunk's head without end
            ++shared_.malformed;
            return respond(plain(400));
        }
        stream_.async_read_some(buffer_.prepare(16 * 1024),
                                [self = this->shared_from_this()](beast::error_code failed, size_t n) {
                                    if (failed) return self->gone(failed, true);
                                    self->buffer_.commit(n);
                                    self->read_chunks();
                                });
    }

    void on_body() {
        beast::get_lowest_layer(stream_).expires_never();
        body_.resize(filled_);
        received_ = filled_;
        if (!work_.blocks) {
            if (auto response = answer()) return respond(std::move(*response));
            work_.blocks = true;
        }
        if (shared_.options.work_threads == 0) return respond(answer().value());
        // The pool's handler gives its share of the connection away, so that the last one is dropped on the loop's thread.
        net::post(shared_.pool, [self = this->shared_from_this()]() mutable {
            auto response = std::make_shared<HttpResponse>(self->answer().value());
            const auto executor = self->stream_.get_executor();
            net::post(executor, [self = std::move(self), response] { self->respond(std::move(*response)); });
        });
    }

    std::optional<HttpResponse> answer() {
        try {
            return shared_.face.answer(work_, body_);
        } catch (const std::exception& thrown) {  // memory
            shared_.log.event(std::move(LogLine("failed").text("message", thrown.what())));
            return plain(500);
        }
    }

    // --- the response ---
    HttpResponse plain(unsigned status) {
        HttpResponse response;
        response.status = status;
        response.type = "text/plain; charset=utf-8";
        const std::string_view reason = reason_of(status);
        response.body.assign(reason.begin(), reason.end());
        response.body.push_back('\n');
        return response;
    }

    void respond(HttpResponse response) {
        body_ = Bytes();
        lease_ = Service::Lease();
        response_ = std::move(response);
        close_ = unread_ || !keep_alive_ || shared_.draining;
        head_ = response_head(response_, close_);
        sent_ = 0;
        to_send_ = work_.method == Method::head ? 0 : response_.length();
        if (!send_at_once()) {
            whole(to_send_);
            return write_some(true);
        }
        // What stands in the buffer already is answered from the loop, not from here, or many small requests would nest.
        if (buffer_.size() == 0) return on_sent();
        net::post(stream_.get_executor(), [self = this->shared_from_this()] { self->on_sent(); });
    }

    // Plain TCP: gives the kernel what it takes without waiting, mostly a whole response, from the file itself where it is in
    // one. False: the rest goes by write_some(), with a deadline.
    bool send_at_once() {
        if constexpr (secure) return false;
        const int socket = beast::get_lowest_layer(stream_).socket().native_handle();
        const int file = response_.file && to_send_ != 0 ? response_.file->descriptor() : -1;
        const ByteView memory = response_.file ? response_.file->memory() : ByteView(response_.body);
        iovec parts[] = {{head_.data(), head_.size()},
                         {const_cast<uint8_t*>(memory.data()), to_send_ == 0 ? 0 : std::min(memory.size(), at_once)}};
        msghdr message{};
        message.msg_iov = parts;
        message.msg_iovlen = 2;
        const ssize_t n = ::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL | (file >= 0 ? MSG_MORE : 0));
        if (n < 0) return false;  // full, or gone, which write_some() will find
        const auto taken = static_cast<size_t>(n);
        if (taken < head_.size()) {
            head_.erase(0, taken);
            return false;
        }
        sent_ = taken - head_.size();
        head_.clear();
        while (file >= 0 && sent_ < std::min<uint64_t>(to_send_, at_once)) {
            off_t offset = static_cast<off_t>(sent_);
            const ssize_t moved = ::sendfile(socket, file, &offset, static_cast<size_t>(to_send_ - sent_));
            if (moved <= 0) return false;
            sent_ += static_cast<uint64_t>(moved);
        }
        return sent_ == to_send_;
    }

    // The next 64 KiB: of the body, of what a file has in memory, or read from it.
    void write_some(bool first) {
        const size_t n = static_cast<size_t>(std::min<uint64_t>(piece, to_send_ - sent_));
        const ByteView memory = response_.file ? response_.file->memory() : ByteView(response_.body);
        const uint8_t* from = memory.data() + sent_;
        if (n != 0 && memory.size() < to_send_) {
            part_.resize(piece);
            if (!response_.file->read(sent_, {part_.data(), n}).ok()) {
                // The length has been announced: the client must see that it is not reached.
                shared_.log.event(std::move(LogLine("failed").text("message", "a blob became unreadable while it was sent")));
                return;
            }
            from = part_.data();
        }
        deadline_of_piece(shared_.options.write_timeout);
        const auto written = [self = this->shared_from_this(), n](beast::error_code failed, size_t) {
            if (failed) return self->gone(failed, true);
            self->sent_ += n;
            if (self->sent_ < self->to_send_) return self->write_some(false);
            self->on_sent();
        };
        if constexpr (secure) {
            // One buffer, so that a small response is one record.
            if (first) head_.append(reinterpret_cast<const char*>(from), n);
            net::async_write(stream_, first ? net::const_buffer(net::buffer(head_)) : net::buffer(from, n), written);
        } else {
            const std::array<net::const_buffer, 2> out{first ? net::buffer(head_) : net::const_buffer(), net::buffer(from, n)};
            net::async_write(stream_, out, written);
        }
    }

    void on_sent() {
        if (shared_.log.wants_requests()) {
            const auto taken = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - began_).count();
            const auto method = parser_->get().method_string();
            const auto target = parser_->get().target();
            const std::string_view path(target.data(), std::min<size_t>(target.size(), target.find('?')));
            shared_.log.request(std::move(LogLine("request")
                                              .text("peer", peer_)
                                              .text("caller", work_.caller.name())
                                              .text("method", {method.data(), method.size()})
                                              .text("path", path)
                                              .number("status", response_.status)
                                              .number("in", received_)
                                              .number("out", sent_)
                                              .number("us", static_cast<uint64_t>(taken))));
        }
        response_ = HttpResponse();
        part_ = Bytes();
        if (secure) head_ = std::string();
        if (!close_) return next_request();
        finish();
    }

    // Ends the connection so that the client sees the response: what it still sends is read and dropped for a while, since
    // closing over unread bytes resets the connection under the response.
    void finish() {
        idle_ = true;
        idle_until_ = Clock::time_point::max();
        deadline(std::chrono::seconds(2));
        if constexpr (secure) {
            if (!unread_) {
                stream_.async_shutdown([self = this->shared_from_this()](beast::error_code) {});
                return;
            }
        } else {
            stream_.socket().shutdown(net::ip::tcp::socket::shutdown_send, ignored_);
        }
        buffer_.consume(buffer_.size());
        drop_rest(0);
    }

    void drop_rest(size_t dropped) {
        if (dropped > size_t{4} << 20) return;
        stream_.async_read_some(buffer_.prepare(16 * 1024),
                                [self = this->shared_from_this(), dropped](beast::error_code failed, size_t n) {
                                    if (!failed) self->drop_rest(dropped + n);
                                });
    }

    Stream stream_;
    const std::string peer_;
    beast::flat_buffer buffer_;
    std::optional<http::request_parser<http::buffer_body>> parser_;
    HttpWork work_;
    std::optional<uint64_t> length_;
    Bytes body_;  // its first filled_ bytes
    size_t filled_ = 0, renewed_at_ = 0, received_ = 0;
    Service::Lease lease_;
    HttpResponse response_;
    std::string head_;
    Bytes part_;
    uint64_t sent_ = 0, to_send_ = 0;
    bool unread_ = false;  // bytes of this request may still come
    bool keep_alive_ = false, close_ = false;
    Clock::time_point began_{}, whole_until_{};
    beast::error_code ignored_;
};

}  // namespace kiln
