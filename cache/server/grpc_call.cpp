#include "cache/server/grpc_call.h"

#include <ctime>
#include <exception>

#include "cache/server/http_face.h"

namespace kiln {

namespace {

// Of "ipv4:127.0.0.1:1234" or "ipv6:%5B::1%5D:1234".
std::string address_of(std::string peer) {
    peer.erase(0, peer.find(':') + 1);
    for (const auto& [code, plain] : {std::pair("%5B", "["), std::pair("%5D", "]")})
        if (const size_t at = peer.find(code); at != std::string::npos) peer.replace(at, 3, plain);
    return peer;
}

}  // namespace

std::shared_ptr<const Caller> CallContext::caller(const grpc::ServerContext& context) const {
    std::shared_ptr<const Access> tokens = access();
    const auto one = [&]() -> const Caller& {
        const auto [field, end] = context.client_metadata().equal_range("authorization");
        if (field == end) return tokens->anonymous();
        auto token = token_of({field->second.data(), field->second.size()});
        if (std::next(field) != end) token.reset();
        return tokens->caller(token ? *token : " ", std::time(nullptr));  // no token holds a space
    };
    const Caller& found = one();
    return {std::move(tokens), &found};
}

grpc::Status CallContext::enter(const Caller& caller, const std::string& instance, Role role) const {
    const auto entered = service.enter(caller, instance, role);
    return entered.ok() ? grpc::Status::OK : status_of(entered.refused());
}

grpc::Status Call::hold_answer(uint64_t bytes, uint64_t timed) {
    answer_ = Service::Lease();
    auto lease = shared_.service.lease_response(bytes);
    if (!lease.ok()) return status_of(lease.refused());
    answer_ = std::move(*lease);
    deadline_.set(shared_.time_for(timed));
    return grpc::Status::OK;
}

template <class Step>
void Call::guarded(Step step) {
    try {
        step();
    } catch (const std::exception& thrown) {  // memory
        shared_.log.event(std::move(LogLine("failed").text("message", thrown.what())));
        end({grpc::StatusCode::RESOURCE_EXHAUSTED, "the server is out of memory"});
    }
}

template <class Step>
void Call::post(Step step) {
    shared_.work.post([this, step] {
        if (shared_.ending) return end(stopping());
        guarded(step);
    });
}

void Call::on_event(bool ok) {
    if (state_ == State::ends || (state_ == State::waits && !ok)) {
        delete this;
        return;
    }
    bool done = true;
    if (state_ == State::runs) {
        guarded([&] { done = go_on_at_once(ok); });
        return done ? void() : post([this, ok] { go_on(ok); });
    }
    state_ = State::runs;
    wait_for_next();
    began_ = std::chrono::steady_clock::now();
    caller_ = shared_.caller(context_);
    guarded([&] { done = begin_at_once(); });
    if (!done) post([this] { begin(); });
}

const grpc::Status& Call::ended(const grpc::Status& status) {
    state_ = State::ends;
    if (!deadline_.is_set()) deadline_.set(shared_.options.patience);
    if (!shared_.log.wants_requests()) return status;
    const auto taken = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - began_).count();
    shared_.log.request(std::move(LogLine("request")
                                      .text("peer", address_of(context_.peer()))
                                      .text("caller", caller_->name())
                                      .text("method", method_)
                                      .text("path", subject())
                                      .number("grpc_status", static_cast<uint64_t>(status.error_code()))
                                      .number("in", in_)
                                      .number("out", out_)
                                      .number("us", static_cast<uint64_t>(taken))));
    return status;
}

grpc::Status status_of(const Refused& refused) {
    const auto code = [&] {
        switch (refused.why) {
            case Refusal::bad_request:
            case Refusal::unknown_instance:
                return grpc::StatusCode::INVALID_ARGUMENT;
            case Refusal::unauthenticated:
                return grpc::StatusCode::UNAUTHENTICATED;
            case Refusal::forbidden:
                return grpc::StatusCode::PERMISSION_DENIED;
            case Refusal::busy:
                return grpc::StatusCode::UNAVAILABLE;
            case Refusal::too_large:
            case Refusal::full:
                return grpc::StatusCode::RESOURCE_EXHAUSTED;
            case Refusal::failed:
                break;
        }
        return grpc::StatusCode::INTERNAL;
    };
    return {code(), refused.message};
}

grpc::Status invalid(const std::string& what) { return {grpc::StatusCode::INVALID_ARGUMENT, what}; }

grpc::Status stopping() { return {grpc::StatusCode::UNAVAILABLE, "the server is stopping"}; }

grpc::Status check_function(int digest_function) {
    if (digest_function == reapi::DigestFunction::UNKNOWN || digest_function == reapi::DigestFunction::SHA256)
        return grpc::Status::OK;
    return invalid("this server speaks SHA-256 alone");
}

std::optional<BlobName> name_of(const reapi::Digest& digest) { return blob_name(digest.hash(), digest.size_bytes()); }

}  // namespace kiln
