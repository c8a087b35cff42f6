#include "cache/client/http_remote.h"

#include <algorithm>

namespace kiln {

namespace {

// So many requests in a row without an answer end a batch: what is under way at once, or a few refused connections.
constexpr unsigned patience = 8;

RemoteAnswer answer_of(HttpRequest::Method method, HttpReply&& reply) {
    using Kind = RemoteAnswer::Kind;
    const bool puts = method == HttpRequest::Method::put;
    const int status = reply.status;
    if (status == 0) return {Kind::failed, {}, std::move(reply.problem), reply.timed_out};
    if (puts && reply.kept_first) return {Kind::absent, {}, {}, false};
    if (status == 200 || (puts && (status == 201 || status == 202 || status == 204)))
        return {Kind::found, std::move(reply.body), {}, false};
    if (puts ? status == 409 : status == 404 || status == 410) return {Kind::absent, {}, {}, false};
    const std::string said = "it answered " + std::to_string(status);
    if (status == 401 || status == 403 || status == 407 || (puts && status == 405)) return {Kind::denied, {}, said, false};
    // Where a server cannot tell whether a blob is there, it is sent.
    if (method == HttpRequest::Method::head && (status == 405 || status == 501)) return {Kind::absent, {}, {}, false};
    if (status >= 300 && status < 400) return {Kind::failed, {}, said + ", a redirect, which is not followed", false};
    return {Kind::failed, {}, said, false};
}

}  // namespace

Result<std::unique_ptr<RemoteStore>> HttpRemote::open(const RemoteUrl& url, const HttpOptions& options,
                                                      const RemoteLimits& limits) {
    auto transfer = HttpTransfer::open(options);
    KILN_TRY(transfer);
    return std::unique_ptr<RemoteStore>(new HttpRemote(url.text(), limits, std::move(*transfer)));
}

std::vector<RemoteAnswer> HttpRemote::run(const std::vector<HttpRequest>& requests) {
    std::vector<HttpReply> replies = transfer_->run(requests, patience);
    std::vector<RemoteAnswer> answers;
    for (size_t i = 0; i < requests.size(); ++i) answers.push_back(answer_of(requests[i].method, std::move(replies[i])));
    return answers;
}

std::vector<RemoteAnswer> HttpRemote::get_actions(std::span<const Digest> keys) {
    std::vector<HttpRequest> requests;
    for (const Digest& key : keys) requests.push_back({HttpRequest::Method::get, base_ + "/ac/" + key.hex(), {}, limits_.action});
    return run(requests);
}

std::vector<RemoteAnswer> HttpRemote::get_blobs(std::span<const RemoteBlob> blobs) {
    std::vector<HttpRequest> requests;
    for (const RemoteBlob& blob : blobs) {
        const uint64_t limit = blob.size == RemoteBlob::unknown ? limits_.unknown_blob : std::min(blob.size, limits_.blob);
        requests.push_back({HttpRequest::Method::get, base_ + "/cas/" + blob.digest.hex(), {}, limit});
    }
    return run(requests);
}

std::vector<RemoteAnswer> HttpRemote::find_blobs(std::span<const RemoteBlob> blobs) {
    std::vector<HttpRequest> requests;
    for (const RemoteBlob& blob : blobs)
        requests.push_back({HttpRequest::Method::head, base_ + "/cas/" + blob.digest.hex(), {}, 0});
    return run(requests);
}

std::vector<RemoteAnswer> HttpRemote::put(const char* space, std::span<const RemoteUpload> uploads) {
    std::vector<HttpRequest> requests;
    for (const RemoteUpload& upload : uploads)
        requests.push_back({HttpRequest::Method::put, base_ + space + upload.key.hex(), upload.bytes, 0});
    return run(requests);
}

std::vector<RemoteAnswer> HttpRemote::put_blobs(std::span<const RemoteUpload> blobs) { return put("/cas/", blobs); }

std::vector<RemoteAnswer> HttpRemote::put_actions(std::span<const RemoteUpload> actions) { return put("/ac/", actions); }

}  // namespace kiln
