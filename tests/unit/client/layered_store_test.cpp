#include "cache/client/layered_store.h"

#include <gtest/gtest.h>

#include "tests/unit/client/fake_remote.h"

namespace kiln {
namespace {

using Kind = RemoteAnswer::Kind;

Digest key_of(const std::string& text) { return sha256(as_bytes(text)); }
Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

// A build: a local store, a server that several builds may share.
struct Machine {
    std::shared_ptr<FakeRemote::Shared> server;
    std::unique_ptr<Store> local = std::make_unique<MemoryStore>();
    std::unique_ptr<LayeredStore> store;

    explicit Machine(std::shared_ptr<FakeRemote::Shared> shared = std::make_shared<FakeRemote::Shared>(),
                     LayeredOptions options = {}, std::unique_ptr<Store> own = std::make_unique<MemoryStore>())
        : server(std::move(shared)), local(std::move(own)) {
        auto cache = std::make_unique<RemoteCache>(std::make_unique<FakeRemote>(server), Breaker::Rules(), RemoteLimits(),
                                                   nullptr, nullptr);
        const auto has = [this](Keyspace space, const Digest& key) {
            const auto got = local->get(space, key);
            return got.ok() && got->has_value();
        };
        store = std::make_unique<LayeredStore>(*local, has, std::move(cache), options);
    }
    std::optional<Bytes> get(Keyspace space, const Digest& key) {
        auto got = store->get(space, key);
        EXPECT_TRUE(got.ok());
        return got.ok() ? std::move(*got) : std::nullopt;
    }
    RemoteCounters counters() const { return store->remote().counters(); }
};

// A record that names one blob, as a build puts it.
struct Entry {
    Bytes text, record;
    Digest blob, action;
    explicit Entry(const std::string& what)
        : text(bytes_of("text of " + what)), record(bytes_of("record of " + what)), blob(sha256(text)), action(key_of(what)) {}
    void put(Store& store) const {
        EXPECT_TRUE(store.put(Keyspace::blob, blob, text).ok());
        EXPECT_TRUE(store.put_record(action, record, {&blob, 1}).ok());
    }
};

TEST(LayeredStore, AnotherMachineFindsWhatOneMade) {
    Machine one;
    const Entry entry("a");
    entry.put(*one.store);
    one.store->finish();
    EXPECT_EQ(one.counters().sent, 2u);
    EXPECT_EQ(one.counters().not_sent, 0u);

    Machine two(one.server);
    EXPECT_EQ(two.get(Keyspace::action, entry.action), entry.record);
    EXPECT_EQ(two.get(Keyspace::blob, entry.blob), entry.text);
    EXPECT_EQ(two.counters().hits, 2u);
    // Hits are kept: the server is not asked again.
    const size_t calls = two.server->calls.size();
    EXPECT_EQ(two.get(Keyspace::action, entry.action), entry.record);
    EXPECT_EQ(two.get(Keyspace::blob, entry.blob), entry.text);
    EXPECT_EQ(two.server->calls.size(), calls);
    EXPECT_EQ(static_cast<MemoryStore&>(*two.local).size(), 2u);
}

TEST(LayeredStore, ExpectFetchesRecordsAndTheirBlobsInBatches) {
    Machine one;
    std::vector<Digest> actions;
    std::vector<Entry> entries;
    for (int i = 0; i < 100; ++i) entries.emplace_back("entry " + std::to_string(i));
    for (const Entry& entry : entries) {
        entry.put(*one.store);
        actions.push_back(entry.action);
    }
    one.store->finish();
    one.server->calls.clear();
    actions.push_back(key_of("nowhere"));

    Machine two(one.server);
    two.store->expect(actions);
    EXPECT_EQ(two.server->calls, (std::vector<std::string>{"get_actions 101", "get_blobs 100"}));
    for (const Entry& entry : entries) {
        EXPECT_EQ(two.get(Keyspace::action, entry.action), entry.record);
        EXPECT_EQ(two.get(Keyspace::blob, entry.blob), entry.text);
    }
    EXPECT_EQ(two.get(Keyspace::action, key_of("nowhere")), std::nullopt);
    EXPECT_EQ(two.server->calls.size(), 2u) << "something was asked twice";
    EXPECT_EQ(two.counters().hits, 200u);
    EXPECT_EQ(two.counters().misses, 1u);
    // All of it is here now: nothing is asked.
    two.store->expect(actions);
    EXPECT_EQ(two.server->calls.size(), 2u);
}

TEST(LayeredStore, WorksWithoutALocalStore) {
    Machine one(std::make_shared<FakeRemote::Shared>(), {}, std::make_unique<NoStore>());
    EXPECT_TRUE(one.store->keeps());
    const Entry entry("a");
    entry.put(*one.store);
    one.store->finish();
    Machine two(one.server, {}, std::make_unique<NoStore>());
    two.store->expect({&entry.action, 1});
    EXPECT_EQ(two.get(Keyspace::action, entry.action), entry.record);
    EXPECT_EQ(two.get(Keyspace::blob, entry.blob), entry.text);
    EXPECT_EQ(two.server->calls.back(), "get_blobs 1") << "what was fetched was asked again";
}

TEST(LayeredStore, ABlobThatIsThereIsNotSentAgain) {
    Machine one;
    Entry("a").put(*one.store);
    one.store->finish();
    Machine two(one.server);
    Entry("a").put(*two.store);
    two.store->finish();
    EXPECT_EQ(two.counters().already_there, 1u);
    EXPECT_EQ(two.counters().sent, 1u);  // the action
}

TEST(LayeredStore, ReadOnlySendsNothing) {
    LayeredOptions options;
    options.write = false;
    Machine one(std::make_shared<FakeRemote::Shared>(), options);
    Entry("a").put(*one.store);
    one.store->finish();
    EXPECT_TRUE(one.server->calls.empty());
    EXPECT_EQ(one.counters().sent + one.counters().not_sent, 0u);
    EXPECT_EQ(one.get(Keyspace::action, Entry("a").action), Entry("a").record);
}

TEST(LayeredStore, AnActionGoesOnlyAfterAllOfItsBlobs) {
    Machine one;
    one.server->meddle = [](const char* call, const Digest& key, RemoteAnswer& answer) {
        if (std::string(call) == "put_blobs" && key == Entry("bad").blob) answer = {Kind::failed, {}, "no", false};
    };
    Entry("bad").put(*one.store);
    Entry("good").put(*one.store);
    one.store->finish();
    EXPECT_EQ(one.server->actions.count(Entry("good").action), 1u);
    EXPECT_EQ(one.server->actions.count(Entry("bad").action), 0u);
    EXPECT_EQ(one.counters().sent, 2u);
    EXPECT_EQ(one.counters().not_sent, 2u);
}

// A record of now may name a blob of an earlier build, which the local store alone has.
TEST(LayeredStore, ABlobOfAnEarlierBuildGoesWithTheRecordThatNamesIt) {
    Machine one;
    const Entry entry("a");
    ASSERT_TRUE(one.local->put(Keyspace::blob, entry.blob, entry.text).ok());
    ASSERT_TRUE(one.store->put_record(entry.action, entry.record, {&entry.blob, 1}).ok());
    const Digest gone = key_of("never made");
    ASSERT_TRUE(one.store->put_record(key_of("b"), entry.record, {&gone, 1}).ok());
    one.store->finish();
    EXPECT_EQ(one.server->blobs.count(entry.blob), 1u);
    EXPECT_EQ(one.server->actions.count(entry.action), 1u);
    EXPECT_EQ(one.server->actions.count(key_of("b")), 0u);
}

TEST(LayeredStore, WrongAnswersAreMissesAndCounted) {
    Machine one;
    const Entry entry("a"), other("b");
    entry.put(*one.store);
    other.put(*one.store);
    one.store->finish();
    const std::map<Digest, Bytes> actions = one.server->actions, blobs = one.server->blobs;

    const struct {
        const char* name;
        std::function<void(FakeRemote::Shared&)> hurt;
        uint64_t hits;
    } cases[] = {
        {"honest", [](FakeRemote::Shared&) {}, 2},
        {"another action's value", [&](FakeRemote::Shared& s) { s.actions[entry.action] = actions.at(other.action); }, 1},
        {"another blob's bytes", [&](FakeRemote::Shared& s) { s.blobs[entry.blob] = blobs.at(other.blob); }, 1},
        {"an empty action", [&](FakeRemote::Shared& s) { s.actions[entry.action].clear(); }, 1},
        {"an empty blob", [&](FakeRemote::Shared& s) { s.blobs[entry.blob].clear(); }, 1},
        {"a blob for an action", [&](FakeRemote::Shared& s) { s.actions[entry.action] = blobs.at(entry.blob); }, 1},
        {"a huge action", [&](FakeRemote::Shared& s) { s.actions[entry.action].assign(2 << 20, 'a'); }, 1},
        {"a byte too many", [&](FakeRemote::Shared& s) { s.blobs[entry.blob].push_back(0); }, 1},
        {"a byte too few", [&](FakeRemote::Shared& s) { s.blobs[entry.blob].pop_back(); }, 1},
    };
    for (const auto& c : cases) {
        one.server->actions = actions;
        one.server->blobs = blobs;
        c.hurt(*one.server);
        Machine two(one.server);
        const auto record = two.get(Keyspace::action, entry.action);
        const auto text = two.get(Keyspace::blob, entry.blob);
        EXPECT_TRUE(!record || *record == entry.record) << c.name;
        EXPECT_TRUE(!text || *text == entry.text) << c.name;
        EXPECT_EQ(two.counters().hits, c.hits) << c.name;
        EXPECT_EQ(two.counters().corrupt, 2 - c.hits) << c.name;
        EXPECT_EQ(two.counters().problem.empty(), c.hits == 2) << c.name;
    }
}

// Each answer arrives whole and in time, and none is what was asked for.
TEST(LayeredStore, AServerThatOnlyLiesIsLeftAlone) {
    const auto server = std::make_shared<FakeRemote::Shared>();
    Machine one(server);
    const auto asked_of = [&](Machine& machine, const std::string& prefix) {
        const size_t before = server->calls.size();
        for (int i = 0; i < 30; ++i) machine.get(Keyspace::blob, key_of(prefix + std::to_string(i)));
        return server->calls.size() - before;
    };
    EXPECT_EQ(asked_of(one, "miss"), 30u);  // misses are no lies
    server->meddle = [](const char*, const Digest&, RemoteAnswer& answer) {
        answer = {Kind::found, bytes_of("something else"), {}, false};
    };
    EXPECT_EQ(asked_of(one, "lie"), Breaker::Rules().failures);
    EXPECT_EQ(one.counters().corrupt, Breaker::Rules().failures);
    EXPECT_GT(one.counters().not_asked, 0u);
}

// Records of 1 MiB, which are blobs of their own.
struct LargeRecords {
    std::shared_ptr<FakeRemote::Shared> server = std::make_shared<FakeRemote::Shared>();
    std::vector<Digest> actions;

    explicit LargeRecords(int count) {
        Machine one(server);
        for (int i = 0; i < count; ++i) {
            actions.push_back(key_of("large " + std::to_string(i)));
            EXPECT_TRUE(one.store->put_record(actions.back(), Bytes(1 << 20, static_cast<uint8_t>(i)), {}).ok());
        }
        one.store->finish();
        EXPECT_EQ(server->blobs.size(), actions.size());
    }
    // The records that a client of these limits gets in one call, and its counters.
    std::pair<size_t, RemoteCounters> read(const RemoteLimits& limits) const {
        RemoteCache cache(std::make_unique<FakeRemote>(server), Breaker::Rules(), limits, nullptr, nullptr);
        const auto got = cache.get_actions(actions);
        return {static_cast<size_t>(std::count_if(got.begin(), got.end(), [](const auto& a) { return a.has_value(); })),
                cache.counters()};
    }
};

TEST(RemoteCache, HoldsNoMoreOfRecordsThanItsLimits) {
    const LargeRecords large(12);
    EXPECT_EQ(large.read(RemoteLimits()).first, 12u);

    RemoteLimits few;
    few.group = few.held = uint64_t{3} << 20;
    const auto [got, counters] = large.read(few);
    EXPECT_TRUE(got >= 2 && got <= 5) << got;
    EXPECT_EQ(counters.hits, got);
    EXPECT_EQ(counters.misses, 12 - got);
    EXPECT_EQ(counters.corrupt, 0u);

    RemoteLimits small;
    small.record = 1 << 20;  // a frame has a head as well
    const size_t before = large.server->calls.size();
    EXPECT_EQ(large.read(small).first, 0u);
    EXPECT_EQ(large.server->calls.size(), before + 1) << "blobs of such a size were asked for";
}

TEST(RemoteCache, AWrongRecordIsCorrupt) {
    const LargeRecords large(4);
    large.server->blobs.begin()->second.back() ^= 1;
    const auto [got, counters] = large.read(RemoteLimits());
    EXPECT_EQ(got, 3u);
    EXPECT_EQ(counters.corrupt, 1u);
    EXPECT_FALSE(counters.problem.empty());
}

TEST(LayeredStore, EveryFlippedBitOfAnActionIsAMissOrTheSame) {
    Machine one;
    const Entry entry("a");
    entry.put(*one.store);
    one.store->finish();
    const Bytes good = one.server->actions.at(entry.action);
    size_t misses = 0;
    for (size_t bit = 0; bit < good.size() * 8; ++bit) {
        one.server->actions[entry.action][bit / 8] ^= static_cast<uint8_t>(1u << (bit % 8));
        Machine two(one.server);
        const auto record = two.get(Keyspace::action, entry.action);
        // A flip may turn a field into one that is skipped, and the record itself is opaque to this layer, whose readers
        // check it; here it must be of the same key.
        if (!record) ++misses;
        one.server->actions[entry.action] = good;
    }
    EXPECT_GT(misses, good.size() * 4);
}

TEST(LayeredStore, FailuresAreNoMissesAndEndTheAsking) {
    Machine one;
    one.server->meddle = [](const char*, const Digest&, RemoteAnswer& answer) {
        answer = {Kind::failed, {}, "it answered 500", false};
    };
    for (int i = 0; i < 100; ++i) EXPECT_EQ(one.get(Keyspace::action, key_of(std::to_string(i))), std::nullopt);
    EXPECT_EQ(one.server->calls.size(), 5u);
    EXPECT_EQ(one.counters().failures, 5u);
    EXPECT_EQ(one.counters().not_asked, 95u);
    EXPECT_EQ(one.counters().problem, "it answered 500");
    Entry("a").put(*one.store);
    one.store->finish();
    EXPECT_EQ(one.server->calls.size(), 5u);
    EXPECT_EQ(one.counters().not_sent, 2u);
}

TEST(LayeredStore, ATokenThatMayNotWriteStillReads) {
    Machine one;
    Entry("a").put(*one.store);
    one.store->finish();
    one.server->meddle = [](const char* call, const Digest&, RemoteAnswer& answer) {
        if (std::string(call).rfind("put_", 0) == 0) answer = {Kind::denied, {}, "it answered 403", false};
    };
    Machine two(one.server);
    for (int i = 0; i < 20; ++i) Entry("more " + std::to_string(i)).put(*two.store);
    EXPECT_EQ(two.get(Keyspace::action, Entry("a").action), Entry("a").record);
    two.store->finish();
    EXPECT_TRUE(two.counters().may_not_write);
    EXPECT_FALSE(two.counters().may_not_read);
    EXPECT_EQ(two.counters().failures, 0u);
    EXPECT_EQ(two.counters().sent, 0u);
    EXPECT_EQ(two.counters().not_sent, 40u);
}

TEST(LayeredStore, ATokenThatMayNotReadIsNotAskedAgain) {
    Machine one;
    one.server->meddle = [](const char*, const Digest&, RemoteAnswer& answer) {
        answer = {Kind::denied, {}, "it answered 401", false};
    };
    for (int i = 0; i < 10; ++i) EXPECT_EQ(one.get(Keyspace::blob, key_of(std::to_string(i))), std::nullopt);
    EXPECT_EQ(one.server->calls.size(), 1u);
    EXPECT_TRUE(one.counters().may_not_read);
    EXPECT_EQ(one.counters().problem, "it answered 401");
}

TEST(LayeredStore, ARecordThatTheServerHasOtherwiseIsCounted) {
    Machine one;
    one.server->meddle = [](const char* call, const Digest&, RemoteAnswer& answer) {
        if (std::string(call) == "put_actions") answer = {Kind::absent, {}, {}, false};
    };
    Entry("a").put(*one.store);
    one.store->finish();
    EXPECT_EQ(one.counters().kept_first, 1u);
    EXPECT_EQ(one.counters().sent, 1u);
    EXPECT_EQ(one.counters().not_sent, 0u);
    EXPECT_EQ(one.counters().failures, 0u);
}

TEST(LayeredStore, TheQueueIsBounded) {
    LayeredOptions options;
    options.queue.bytes = 1000;
    Machine one(std::make_shared<FakeRemote::Shared>(), options, std::make_unique<NoStore>());
    std::mutex gate;
    std::unique_lock closed(gate);
    one.server->meddle = [&](const char*, const Digest&, RemoteAnswer&) { const std::lock_guard wait(gate); };
    for (int i = 0; i < 100; ++i) {
        const Bytes text(100, static_cast<uint8_t>(i));
        EXPECT_TRUE(one.store->put(Keyspace::blob, sha256(text), text).ok());
    }
    EXPECT_GE(one.counters().not_sent, 70u);
    closed.unlock();
    one.store->finish();
    EXPECT_EQ(one.counters().sent + one.counters().not_sent, 100u);
    EXPECT_GE(one.counters().sent, 8u);
}

TEST(LayeredStore, PastItsBytesTheQueueReadsTheLocalStore) {
    LayeredOptions options;
    options.queue.bytes = 1000;
    Machine one(std::make_shared<FakeRemote::Shared>(), options);
    for (int i = 0; i < 100; ++i) {
        const Bytes text(100, static_cast<uint8_t>(i));
        EXPECT_TRUE(one.store->put(Keyspace::blob, sha256(text), text).ok());
    }
    one.store->finish();
    EXPECT_EQ(one.counters().sent, 100u);
}

TEST(LayeredStore, DrainingHasAnEnd) {
    LayeredOptions options;
    options.drain = std::chrono::milliseconds(50);
    Machine one(std::make_shared<FakeRemote::Shared>(), options);
    one.server->meddle = [](const char*, const Digest&, RemoteAnswer&) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    };
    for (int i = 0; i < 3000; ++i) Entry(std::to_string(i)).put(*one.store);
    one.store->finish();
    EXPECT_GT(one.counters().not_sent, 0u);
    EXPECT_GT(one.counters().sent, 0u);
}

}  // namespace
}  // namespace kiln
