#pragma once
// A RemoteStore over Bazel's HTTP cache protocol: GET, HEAD and PUT of <base>/cas/<sha256> and <base>/ac/<sha256>. Any server
// of that protocol will do, and any that keeps files by PUT (nginx with WebDAV).

#include "cache/client/http_transfer.h"
#include "cache/client/remote_store.h"
#include "cache/client/remote_url.h"

namespace kiln {

class HttpRemote final : public RemoteStore {
public:
    static Result<std::unique_ptr<RemoteStore>> open(const RemoteUrl& url, const HttpOptions& options,
                                                     const RemoteLimits& limits);

    std::string name() const override { return base_; }
    std::vector<RemoteAnswer> get_actions(std::span<const Digest> keys) override;
    std::vector<RemoteAnswer> get_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> find_blobs(std::span<const RemoteBlob> blobs) override;
    std::vector<RemoteAnswer> put_blobs(std::span<const RemoteUpload> blobs) override;
    std::vector<RemoteAnswer> put_actions(std::span<const RemoteUpload> actions) override;
    void end_at(std::chrono::steady_clock::time_point when) override { transfer_->end_at(when); }

private:
    HttpRemote(std::string base, const RemoteLimits& limits, std::unique_ptr<HttpTransfer> transfer)
        : base_(std::move(base)), limits_(limits), transfer_(std::move(transfer)) {}
    std::vector<RemoteAnswer> run(const std::vector<HttpRequest>& requests);
    std::vector<RemoteAnswer> put(const char* space, std::span<const RemoteUpload> uploads);

    const std::string base_;
    const RemoteLimits limits_;
    const std::unique_ptr<HttpTransfer> transfer_;
};

}  // namespace kiln
