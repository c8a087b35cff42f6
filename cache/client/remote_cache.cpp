#include "cache/client/remote_cache.h"

#include <algorithm>

namespace kiln {

RemoteCache::RemoteCache(std::unique_ptr<RemoteStore> remote, Breaker::Rules rules, const RemoteLimits& limits,
                         std::unique_ptr<Signer> signer, std::unique_ptr<Verifier> verifier)
    : remote_(std::move(remote)),
      limits_(limits),
      signer_(std::move(signer)),
      verifier_(std::move(verifier)),
      breaker_(std::move(rules)) {}

bool RemoteCache::may_ask(size_t requests, Doing doing) {
    const bool denied = doing == Doing::reading ? may_not_read_ : may_not_write_;
    if (!denied && breaker_.may_ask()) return true;
    const std::lock_guard lock(mutex_);
    (doing == Doing::reading ? counters_.not_asked : counters_.not_sent) += requests;
    return false;
}

bool RemoteCache::judge(const RemoteAnswer& answer, Doing doing) {
    using Kind = RemoteAnswer::Kind;
    if (answer.kind == Kind::found || answer.kind == Kind::absent) {
        // What was read has yet to prove right: a server that gives wrong bytes for ever would never be left alone otherwise.
        if (answer.kind == Kind::absent || doing == Doing::writing) breaker_.succeeded();
        return answer.kind == Kind::found;
    }
    if (answer.kind == Kind::denied) {
        // The server is well; it is this token that will not do.
        breaker_.succeeded();
        (doing == Doing::reading ? may_not_read_ : may_not_write_) = true;
    } else {
        breaker_.failed(answer.waited);
    }
    const std::lock_guard lock(mutex_);
    if (answer.kind == Kind::failed) ++counters_.failures;
    if (counters_.problem.empty() && (answer.kind == Kind::failed || doing == Doing::reading)) counters_.problem = answer.problem;
    return false;
}

// A server that gives wrong bytes is no better than one that gives none.
void RemoteCache::corrupt(const Digest& key, const char* what) {
    breaker_.failed(false);
    const std::lock_guard lock(mutex_);
    ++counters_.corrupt;
    if (counters_.problem.empty()) counters_.problem = std::string("it gave ") + what + " for " + key.hex();
}

std::optional<RemoteCache::Action> RemoteCache::read_action(const Digest& key, RemoteAnswer& answer,
                                                            std::optional<RemoteBlob>& frame_blob) {
    if (!judge(answer, Doing::reading)) return std::nullopt;
    std::optional<ActionValue> value;
    if (answer.bytes.size() <= limits_.action) value = read_action_value(answer.bytes);
    if (!value) {
        corrupt(key, "no action result of kiln's");
        return std::nullopt;
    }
    Action action;
    if (value->frame) {
        action.record = std::move(*value->frame);
    } else {
        if (value->frame_blob.size > limits_.record) {
            corrupt(key, "a record of a size that none of kiln's has");
            return std::nullopt;
        }
        frame_blob = value->frame_blob;
    }
    action.blobs = std::move(value->blobs);
    const std::lock_guard lock(mutex_);
    counters_.bytes_in += answer.bytes.size();
    return action;
}

std::vector<std::optional<RemoteCache::Action>> RemoteCache::get_actions(std::span<const Digest> keys) {
    std::vector<std::optional<Action>> actions(keys.size());
    if (!may_ask(keys.size(), Doing::reading)) return actions;
    std::vector<RemoteAnswer> answers = remote_->get_actions(keys);
    std::vector<size_t> elsewhere;  // whose frame is a blob
    std::vector<RemoteBlob> frames;
    for (size_t i = 0; i < keys.size(); ++i) {
        std::optional<RemoteBlob> frame;
        actions[i] = read_action(keys[i], answers[i], frame);
        if (!frame) continue;
        elsewhere.push_back(i);
        frames.push_back(*frame);
    }
    uint64_t held = 0;
    for (size_t f = 0; f < frames.size();) {
        std::vector<RemoteBlob> group;
        for (uint64_t bytes = 0; f + group.size() < frames.size(); group.push_back(frames[f + group.size()])) {
            bytes += frames[f + group.size()].size;
            if (!group.empty() && bytes > limits_.group) break;
        }
        std::vector<RemoteAnswer> got;
        if (held < limits_.held && (f == 0 || may_ask(group.size(), Doing::reading))) got = remote_->get_blobs(group);
        for (size_t g = 0; g < group.size(); ++g) {
            std::optional<Action>& action = actions[elsewhere[f + g]];
            if (g < got.size() && judge(got[g], Doing::reading)) {
                if (sha256(got[g].bytes) == group[g].digest) {
                    held += got[g].bytes.size();
                    action->record = std::move(got[g].bytes);
                    continue;
                }
                corrupt(group[g].digest, "other bytes than those asked");
            }
            action.reset();
        }
        f += group.size();
    }
    for (size_t i = 0; i < keys.size(); ++i) {
        if (!actions[i]) continue;
        Bytes record;
        const FrameCheck check = read_frame(keys[i], actions[i]->record, verifier_.get(), record);
        actions[i]->record = std::move(record);
        if (check != FrameCheck::damaged) breaker_.succeeded();
        if (check == FrameCheck::good) continue;
        actions[i].reset();
        if (check == FrameCheck::damaged) {
            corrupt(keys[i], "a record of something else");
            continue;
        }
        const std::lock_guard lock(mutex_);
        ++counters_.untrusted;
    }
    const std::lock_guard lock(mutex_);
    for (const auto& action : actions) {
        ++(action ? counters_.hits : counters_.misses);
        if (!action) continue;
        for (const RemoteBlob& blob : action->blobs) sizes_[blob.digest] = blob.size;
    }
    return actions;
}

std::vector<std::optional<Bytes>> RemoteCache::get_blobs(std::span<const Digest> names) {
    std::vector<std::optional<Bytes>> blobs(names.size());
    if (!may_ask(names.size(), Doing::reading)) return blobs;
    std::vector<RemoteBlob> asked;
    {
        const std::lock_guard lock(mutex_);
        for (const Digest& name : names) {
            const auto size = sizes_.find(name);
            asked.push_back({name, size == sizes_.end() ? RemoteBlob::unknown : size->second});
        }
    }
    std::vector<RemoteAnswer> answers = remote_->get_blobs(asked);
    for (size_t i = 0; i < names.size(); ++i) {
        if (!judge(answers[i], Doing::reading)) continue;
        if (sha256(answers[i].bytes) != names[i]) {
            corrupt(names[i], "other bytes than those asked");
            continue;
        }
        breaker_.succeeded();
        blobs[i] = std::move(answers[i].bytes);
    }
    const std::lock_guard lock(mutex_);
    for (const auto& blob : blobs) {
        ++(blob ? counters_.hits : counters_.misses);
        if (blob) counters_.bytes_in += blob->size();
    }
    return blobs;
}

std::vector<bool> RemoteCache::put_blobs(std::span<const Sending> blobs) {
    std::vector<bool> there(blobs.size());
    if (!may_ask(blobs.size(), Doing::writing)) return there;
    std::vector<RemoteBlob> doubtful;
    std::vector<size_t> places, missing;
    for (size_t i = 0; i < blobs.size(); ++i) {
        if (blobs[i].surely_missing) {
            missing.push_back(i);
        } else {
            doubtful.push_back({blobs[i].key, blobs[i].bytes.size()});
            places.push_back(i);
        }
    }
    uint64_t found = 0, lost = 0;
    const std::vector<RemoteAnswer> looked = doubtful.empty() ? std::vector<RemoteAnswer>() : remote_->find_blobs(doubtful);
    for (size_t d = 0; d < looked.size(); ++d) {
        there[places[d]] = judge(looked[d], Doing::writing);
        found += there[places[d]] ? 1 : 0;
        if (looked[d].kind == RemoteAnswer::Kind::absent)
            missing.push_back(places[d]);
        else if (!there[places[d]])
            ++lost;
    }
    std::vector<RemoteUpload> uploads;
    for (const size_t i : missing) uploads.push_back({blobs[i].key, blobs[i].bytes});
    uint64_t sent = 0, bytes = 0;
    const bool go_on = uploads.empty() || may_write();
    const std::vector<RemoteAnswer> answers =
        uploads.empty() || !go_on ? std::vector<RemoteAnswer>() : remote_->put_blobs(uploads);
    for (size_t u = 0; u < answers.size(); ++u) {
        there[missing[u]] = judge(answers[u], Doing::writing);
        sent += there[missing[u]] ? 1 : 0;
        bytes += there[missing[u]] ? uploads[u].bytes.size() : 0;
    }
    const std::lock_guard lock(mutex_);
    counters_.already_there += found;
    counters_.sent += sent;
    counters_.bytes_out += bytes;
    counters_.not_sent += lost + uploads.size() - sent;
    return there;
}

void RemoteCache::put_actions(std::span<const ActionSending> actions) {
    if (actions.empty() || !may_ask(actions.size(), Doing::writing)) return;
    std::vector<Bytes> values;
    std::vector<RemoteUpload> uploads;
    uint64_t lost = 0;
    for (const ActionSending& action : actions) {
        const Bytes frame = write_frame(action.key, action.record, signer_.get());
        std::optional<RemoteBlob> frame_blob;
        if (frame.size() > most_inline_frame) {
            frame_blob = RemoteBlob{sha256(frame), frame.size()};
            const Sending sending{frame_blob->digest, frame};
            if (!put_blobs({&sending, 1}).front()) {
                ++lost;
                continue;
            }
        }
        values.push_back(write_action_value(frame, action.blobs, frame_blob));
        uploads.push_back({action.key, {}});
    }
    for (size_t i = 0; i < values.size(); ++i) uploads[i].bytes = values[i];
    const std::vector<RemoteAnswer> answers = remote_->put_actions(uploads);
    uint64_t sent = 0, kept = 0, bytes = 0;
    for (size_t i = 0; i < answers.size(); ++i) {
        const bool done = judge(answers[i], Doing::writing);
        sent += done ? 1 : 0;
        bytes += done ? values[i].size() : 0;
        kept += answers[i].kind == RemoteAnswer::Kind::absent ? 1 : 0;
    }
    const std::lock_guard lock(mutex_);
    counters_.sent += sent;
    counters_.bytes_out += bytes;
    counters_.kept_first += kept;
    counters_.not_sent += lost + answers.size() - sent - kept;
}

void RemoteCache::count_not_sent(uint64_t n) {
    const std::lock_guard lock(mutex_);
    counters_.not_sent += n;
}

RemoteCounters RemoteCache::counters() const {
    const std::lock_guard lock(mutex_);
    RemoteCounters counters = counters_;
    counters.may_not_read = may_not_read_;
    counters.may_not_write = may_not_write_;
    return counters;
}

}  // namespace kiln
