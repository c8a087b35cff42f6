// The rules of the service, with a made-up action format: "<64 hex> <size>\n" lines, and "tree <64 hex> <size>\n".
#include "cache/server/service.h"

#include <gtest/gtest.h>

#include <charconv>
#include <thread>

#include "tests/unit/cache/folder.h"

namespace kiln {
namespace {

std::optional<BlobName> parse_blob(std::string_view line) {
    if (line.size() < 66 || line[64] != ' ') return std::nullopt;
    const auto digest = Digest::from_hex(line.substr(0, 64));
    BlobName blob;
    const char* end = line.data() + line.size();
    if (!digest || std::from_chars(line.data() + 65, end, blob.size).ptr != end) return std::nullopt;
    blob.digest = *digest;
    return blob;
}

std::optional<ActionNeeds> read_action(ByteView bytes) {
    ActionNeeds needs;
    std::string_view text = as_text(bytes);
    while (!text.empty()) {
        const size_t end = text.find('\n');
        if (end == std::string_view::npos) return std::nullopt;
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end + 1);
        const bool tree = line.substr(0, 5) == "tree ";
        if (line.substr(0, 5) == "note ") continue;
        if (tree) line.remove_prefix(5);
        const auto blob = parse_blob(line);
        if (!blob) return std::nullopt;
        (tree ? needs.trees : needs.blobs).push_back(*blob);
    }
    return needs;
}

std::optional<std::vector<BlobName>> read_tree(ByteView bytes) {
    auto needs = read_action(bytes);
    if (!needs || !needs->trees.empty()) return std::nullopt;
    return needs->blobs;
}

BlobName blob_of(std::string_view text) { return {name_of(text), text.size()}; }
std::string naming(std::string_view blob) { return name_of(blob).hex() + " " + std::to_string(blob.size()) + "\n"; }

const Caller writer("ci", {{"*", {Role::read, Role::cas_write, Role::ac_write}}}, true);
const Caller reader("dev", {{"*", {Role::read}}}, true);
const Caller admin("ops", {{"*", {Role::admin}}}, true);
const Caller stranger("anonymous", {}, false);
const Caller pull("pr", {{"pr/*", {Role::read, Role::cas_write, Role::ac_write}}, {"", {Role::read}}}, true);

struct Served {
    TestFolder folder;
    std::unique_ptr<DiskStore> store;
    std::unique_ptr<Service> service;

    explicit Served(ServiceLimits limits = {}, DiskOptions options = unflushed()) {
        store = std::move(*DiskStore::open(folder.path(), options));
        auto instances = Instances::make({{"pr/*", false, false, ""}, {"ccache", true, true, std::nullopt}});
        service = std::make_unique<Service>(*store, std::move(*instances), limits, ActionReader{read_action, read_tree});
    }
    Service* operator->() { return service.get(); }
    void put(std::string_view blob) { ASSERT_TRUE(service->put_blob(writer, "", blob_of(blob), as_bytes(blob)).ok()); }
    std::string get(const Caller& caller, std::string_view instance, std::string_view key) {
        const auto got = service->action(caller, instance, name_of(key));
        return !got.ok() ? name_of(got.refused().why) : *got ? std::string(as_text(**got)) : "absent";
    }
    std::string set(const Caller& caller, std::string_view instance, std::string_view key, std::string_view value) {
        const auto put = service->put_action(caller, instance, name_of(key), as_bytes(value));
        if (!put.ok()) return name_of(put.refused().why);
        constexpr const char* names[] = {"now", "already_there", "replaced", "kept_first"};
        return names[static_cast<size_t>(*put)];
    }
    // Puts a name of the real enumeration beside the made-up ones.
    using Why = Refusal;
    static std::string name_of(Why why) { return kiln::name_of(why); }
    static Digest name_of(std::string_view text) { return kiln::name_of(text); }
};

TEST(Service, BlobsComeBackAndWrongOnesAreRefused) {
    Served s;
    EXPECT_FALSE(s->blob(reader, "", name_of("abc"))->has_value());
    EXPECT_EQ(*s->put_blob(writer, "", blob_of("abc"), as_bytes("abc")), Written::now);
    EXPECT_EQ(*s->put_blob(writer, "", blob_of("abc"), as_bytes("abc")), Written::already_there);
    EXPECT_EQ(as_text(*(**s->blob(reader, "", name_of("abc"))).all()), "abc");
    EXPECT_EQ(s->put_blob(writer, "", blob_of("abd"), as_bytes("abx")).refused().why, Refusal::bad_request);
    EXPECT_FALSE(s->blob(reader, "", name_of("abd"))->has_value());
    // A wrong size is wrong for a blob that is there, too.
    EXPECT_EQ(s->put_blob(writer, "", {name_of("abc"), 4}, as_bytes("abc")).refused().why, Refusal::bad_request);
    EXPECT_TRUE(*s->has_blob(reader, "", blob_of("abc")));
    EXPECT_FALSE(*s->has_blob(reader, "", {name_of("abc"), 4}));
    const Counts counts = s->counters().total();
    EXPECT_EQ(counts.mismatches, 2u);
    EXPECT_EQ(counts.blobs_written, 1u);
    EXPECT_EQ(counts.blobs_already_there, 1u);
}

TEST(Service, TheEmptyBlobIsAlwaysThere) {
    Served s;
    EXPECT_EQ((*s->blob(reader, "", name_of("")))->size(), 0u);
    EXPECT_TRUE((*s->blob(reader, "", name_of("")))->all()->empty());
    EXPECT_TRUE(*s->has_blob(reader, "", blob_of("")));
    EXPECT_EQ(*s->put_blob(writer, "", blob_of(""), {}), Written::already_there);
    EXPECT_FALSE(*s->has_blob(reader, "", blob_of("other")));
}

TEST(Service, LargeBlobsAreReadInParts) {
    Served s;
    std::string big(3'000'000, 'x');
    for (size_t i = 0; i < big.size(); i += 997) big[i] = static_cast<char>('a' + i % 23);
    s.put(big);
    const auto file = s->blob(reader, "", name_of(big));
    ASSERT_TRUE(file.ok() && file->has_value());
    Bytes part(1000);
    ASSERT_TRUE((*file)->read(2'999'000, part).ok());
    EXPECT_EQ(as_text(part), std::string_view(big).substr(2'999'000));
    EXPECT_FALSE((*file)->read(2'999'001, part).ok());
    EXPECT_FALSE((*file)->read(UINT64_MAX, part).ok());
    // One that is not known is not hashed where that would hold others up.
    big[0] = '!';
    s.put(big);
    bool slow = false;
    const auto put_off = s->blob(reader, "", name_of(big), &slow);
    EXPECT_TRUE(put_off.ok() && !put_off->has_value() && slow);
    ASSERT_TRUE(s->blob(reader, "", name_of(big))->has_value()) << "the control";
}

TEST(Service, ADamagedBlobIsAMissWhetherItWasTrustedOrNot) {
    Served s;
    for (const std::string& blob : {std::string("short one"), std::string(300'000, 'l')}) {
        s.put(blob);
        ASSERT_TRUE(s->blob(reader, "", name_of(blob))->has_value());
        std::this_thread::sleep_for(std::chrono::milliseconds(120));  // past the kernel's tick, so that it is trusted
        ASSERT_TRUE(s->blob(reader, "", name_of(blob))->has_value());
        const std::string path = path_of(s.folder.path(), Keyspace::blob, name_of(blob));
        std::string bytes = read_file(path);
        bytes[bytes.size() / 2] ^= 1;
        write_file(path, bytes);
        EXPECT_FALSE(s->blob(reader, "", name_of(blob))->has_value());
        EXPECT_FALSE(std::filesystem::exists(path)) << "not set aside";
        s.put(blob);
        EXPECT_TRUE(s->blob(reader, "", name_of(blob))->has_value());
    }
    EXPECT_EQ(s.store->counters().corrupt, 2u);
}

TEST(BlobReader, WhatIsKeptInMemoryIsBoundedAndFollowsTheFile) {
    Served s;
    BlobReader reads(*s.store, 600);
    const std::string blob(10'000, 'k');
    s.put(blob);
    std::this_thread::sleep_for(std::chrono::milliseconds(120));  // past the kernel's tick, so that it is trusted
    for (const uint64_t kept : {0u, 10'000u, 10'000u}) {
        EXPECT_EQ(as_text(*(**reads.open(name_of(blob))).all()), blob);
        EXPECT_EQ(reads.kept(), kept);
    }
    EXPECT_EQ(reads.hashed(), 1u);
    const std::string path = path_of(s.folder.path(), Keyspace::blob, name_of(blob));
    std::filesystem::remove(path);
    EXPECT_FALSE(reads.open(name_of(blob))->has_value()) << "removed";
    s.put(blob);
    EXPECT_TRUE(reads.open(name_of(blob))->has_value());
    EXPECT_EQ(reads.hashed(), 2u) << "another file of the same name";
    std::filesystem::remove(path);
    std::filesystem::create_symlink("/etc/hostname", path);
    EXPECT_FALSE(reads.open(name_of(blob))->has_value()) << "a link";
    std::vector<std::string> many;
    for (int i = 0; i < 900; ++i) many.push_back(std::to_string(i) + std::string(30'000, 'm'));
    for (const std::string& one : many) s.put(one);
    std::this_thread::sleep_for(std::chrono::milliseconds(120));
    for (int round = 0; round < 3; ++round)
        for (const std::string& one : many) ASSERT_TRUE(reads.open(name_of(one))->has_value());
    EXPECT_LE(reads.kept(), BlobReader::most_kept);
    EXPECT_GE(reads.kept(), BlobReader::most_kept / 8);
}

TEST(Service, AnActionIsAHitOnlyWithAllItsBlobs) {
    Served s;
    s.put("one");
    const std::string tree = naming("leaf");
    s.put(tree);
    const std::string value = naming("one") + "tree " + naming(tree);
    EXPECT_EQ(s.set(writer, "", "key", value), "now");
    EXPECT_EQ(s.get(reader, "", "key"), "absent");
    EXPECT_EQ(s->counters().total().actions_incomplete, 1u);
    s.put("leaf");
    EXPECT_EQ(s.get(reader, "", "key"), value);
    for (const std::string blob : {"one", "leaf"}) {
        std::filesystem::remove(path_of(s.folder.path(), Keyspace::blob, name_of(blob)));
        EXPECT_EQ(s.get(reader, "", "key"), "absent") << blob;
        s.put(blob);
        EXPECT_EQ(s.get(reader, "", "key"), value);
    }
    EXPECT_EQ(s.set(writer, "", "bad", "no action"), "bad_request");
    EXPECT_EQ(s.set(writer, "", "bad", ""), "bad_request");
    EXPECT_EQ(s.get(reader, "", "bad"), "absent");
    // A wrong size is a missing blob.
    EXPECT_EQ(s.set(writer, "", "sized", name_of("one").hex() + " 4\n"), "now");
    EXPECT_EQ(s.get(reader, "", "sized"), "absent");
}

TEST(Service, TheFirstWholeValueStays) {
    Served s;
    s.put("one");
    s.put("two");
    EXPECT_EQ(s.set(writer, "", "key", naming("one")), "now");
    EXPECT_EQ(s.set(writer, "", "key", naming("one")), "already_there");
    EXPECT_EQ(s.set(writer, "", "key", naming("two")), "kept_first");
    EXPECT_EQ(s.get(reader, "", "key"), naming("one"));
    EXPECT_EQ(s->counters().total().conflicts, 1u);
    EXPECT_EQ(s->counters().recent().at(0).kind, "conflict");
    EXPECT_EQ(s.set(admin, "", "key", naming("two")), "replaced");
    EXPECT_EQ(s.get(reader, "", "key"), naming("two"));
    // One whose blob is gone is no value.
    std::filesystem::remove(path_of(s.folder.path(), Keyspace::blob, name_of("two")));
    EXPECT_EQ(s.set(writer, "", "key", naming("one")), "now");
    EXPECT_EQ(s.get(reader, "", "key"), naming("one"));
}

TEST(Service, ChaosHurtsEveryCallFromItsSeed) {
    const auto outcome = [](const std::string& spec) {
        Served s;
        std::vector<Event> seen;
        s->on_event = [&](const Event& event) { seen.push_back(event); };
        s->hurt(*Chaos::parse(spec), spec);
        EXPECT_EQ(seen.at(0).kind, "chaos");
        std::string all;
        for (int i = 0; i < 200; ++i) {
            const std::string text = std::to_string(i);
            const auto put = s->put_blob(writer, "", blob_of(text), as_bytes(text));
            const auto found = s->has_blob(reader, "", blob_of(text));
            const auto blob = s->blob(reader, "", name_of(text));
            all += !put.ok() ? "p" : !found.ok() ? "f" : !*found ? "a" : !blob.ok() ? "b" : !*blob ? "l" : ".";
            if (blob.ok() && *blob && as_text(*(*blob)->all()) != text) all += "x";
            const std::string set = s.set(writer, "ccache", text, text), got = s.get(reader, "ccache", text);
            all += set == "failed" ? "s" : got == "failed" ? "g" : got == "absent" ? "n" : got != text ? "y" : ".";
        }
        const auto c = s->mishaps().counters();
        EXPECT_EQ(c.lost != 0, spec.find("loss=0.") != std::string::npos) << spec;
        EXPECT_EQ(c.failed != 0, spec.find("error=0.") != std::string::npos) << spec;
        EXPECT_EQ(c.flipped != 0, spec.find("flip=0.") != std::string::npos) << spec;
        EXPECT_EQ(s.store->counters().corrupt != 0, c.flipped != 0) << "some bits flip below the check";
        return all;
    };
    EXPECT_EQ(outcome("seed=1").find_first_not_of('.'), std::string::npos) << "the control";
    const std::string some = outcome("seed=1,loss=0.2,error=0.1,flip=0.3");
    for (const char kind : std::string("pfablxsgny.")) EXPECT_NE(some.find(kind), std::string::npos) << kind << " of " << some;
    EXPECT_EQ(outcome("seed=1,loss=0.2,error=0.1,flip=0.3"), some);
    EXPECT_NE(outcome("seed=2,loss=0.2,error=0.1,flip=0.3"), some);
}

TEST(Service, DamageIsAnEvent) {
    Served s;
    std::vector<Event> seen;
    s->on_event = [&](const Event& event) { seen.push_back(event); };
    s.put("a blob");
    EXPECT_EQ(s.set(writer, "ccache", "key", "value"), "now");
    EXPECT_TRUE(s->blob(reader, "", name_of("a blob"))->has_value());
    EXPECT_TRUE(seen.empty()) << "the control";
    const std::string paths[] = {s.store->path_of(Keyspace::blob, name_of("a blob")),
                                 s.store->path_of(Keyspace::action, action_name("ccache", name_of("key")))};
    for (const std::string& path : paths) write_file(path, read_file(path) + "more");
    EXPECT_FALSE(s->blob(reader, "", name_of("a blob"))->has_value());
    EXPECT_EQ(s.get(reader, "ccache", "key"), "absent");
    ASSERT_EQ(seen.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(seen[i].kind, "damage");
        EXPECT_NE(seen[i].message.find(paths[i] + ": "), std::string::npos) << seen[i].message;
        EXPECT_NE(seen[i].message.find("/quarantine/"), std::string::npos) << seen[i].message;
    }
    EXPECT_EQ(s->counters().recent().size(), 2u);
    EXPECT_FALSE(s->blob(reader, "", name_of("a blob"))->has_value());
    EXPECT_EQ(seen.size(), 2u) << "once for each";
}

TEST(Service, ReadingAnActionRenewsItsBlobs) {
    Served s;
    s.put("one");
    s.put("leaf");
    const std::string tree = naming("leaf"), value = naming("one") + "tree " + naming(tree);
    s.put(tree);
    s.put("not named");
    EXPECT_EQ(s.set(writer, "", "key", value), "now");
    const auto age = [&](std::string_view blob) {
        std::filesystem::last_write_time(s.store->path_of(Keyspace::blob, name_of(blob)),
                                         std::filesystem::file_time_type::clock::now() - std::chrono::hours(9));
    };
    const auto is_old = [&](std::string_view blob) {
        return std::filesystem::file_time_type::clock::now() -
                   std::filesystem::last_write_time(s.store->path_of(Keyspace::blob, name_of(blob))) >
               std::chrono::hours(8);
    };
    const std::string_view blobs[] = {"one", "leaf", tree, "not named"};
    for (const std::string_view blob : blobs) age(blob);
    EXPECT_EQ(s.get(reader, "", "another key"), "absent");
    for (const std::string_view blob : blobs) EXPECT_TRUE(is_old(blob)) << blob << ", the control";
    EXPECT_EQ(s.get(reader, "", "key"), value);
    for (const std::string_view blob : blobs) EXPECT_EQ(is_old(blob), blob == "not named") << blob;
}

TEST(Service, OpaqueInstancesTakeAnythingAndTheLastWins) {
    Served s;
    EXPECT_EQ(s.set(writer, "ccache", "key", "\x01 no action"), "now");
    EXPECT_EQ(s.set(writer, "ccache", "key", "later"), "replaced");
    EXPECT_EQ(s.get(reader, "ccache", "key"), "later");
    EXPECT_EQ(s.get(reader, "", "key"), "absent");
}

TEST(Service, APullRequestReadsMainAndNeverWritesIt) {
    Served s;
    s.put("good");
    s.put("evil");
    EXPECT_EQ(s.set(pull, "", "key", naming("evil")), "forbidden");
    EXPECT_EQ(s.set(pull, "pr/7", "key", naming("evil")), "now");
    EXPECT_EQ(s.get(pull, "pr/7", "key"), naming("evil"));
    for (const char* elsewhere : {"", "pr/8"}) EXPECT_EQ(s.get(reader, elsewhere, "key"), "absent");
    EXPECT_EQ(s.set(writer, "", "key", naming("good")), "now");
    EXPECT_EQ(s.get(reader, "", "key"), naming("good"));
    EXPECT_EQ(s.get(pull, "pr/7", "key"), naming("good")) << "main first";
    EXPECT_EQ(s.set(pull, "pr/9", "key", naming("evil")), "kept_first");
    EXPECT_EQ(s.get(pull, "pr/9", "key"), naming("good"));
}

TEST(Service, EveryCallNeedsItsRole) {
    Served s;
    s.put("blob");
    const auto why = [](const auto& answer) { return answer.ok() ? std::string("ok") : name_of(answer.refused().why); };
    const Caller cas("cas", {{"*", {Role::cas_write}}}, true), ac("ac", {{"*", {Role::ac_write}}}, true);
    const struct {
        const Caller& caller;
        std::string read, cas_write, ac_write;
    } rows[] = {{writer, "ok", "ok", "ok"},
                {reader, "ok", "forbidden", "forbidden"},
                {cas, "forbidden", "ok", "forbidden"},
                {ac, "forbidden", "forbidden", "ok"},
                {admin, "ok", "ok", "ok"},
                {Caller::trusted(), "ok", "ok", "ok"},
                {stranger, "unauthenticated", "unauthenticated", "unauthenticated"}};
    for (const auto& row : rows) {
        SCOPED_TRACE(row.caller.name());
        EXPECT_EQ(why(s->blob(row.caller, "", name_of("blob"))), row.read);
        EXPECT_EQ(why(s->has_blob(row.caller, "", blob_of("blob"))), row.read);
        EXPECT_EQ(why(s->action(row.caller, "", name_of("key"))), row.read);
        EXPECT_EQ(why(s->file(row.caller, "", "a/b")), row.read);
        EXPECT_EQ(why(s->put_blob(row.caller, "", blob_of("blob"), as_bytes("blob"))), row.cas_write);
        EXPECT_EQ(why(s->put_action(row.caller, "", name_of("key"), as_bytes(naming("blob")))), row.ac_write);
        EXPECT_EQ(why(s->put_file(row.caller, "", "a/b", as_bytes("file"))), row.ac_write);
    }
    EXPECT_EQ(why(s->blob(writer, "nowhere", name_of("blob"))), "unknown_instance");
    EXPECT_EQ(why(s->blob(pull, "nowhere", name_of("blob"))), "forbidden");
}

TEST(Service, LimitsAndLeases) {
    ServiceLimits limits;
    limits.blob = 10;
    limits.action = 100;
    limits.opaque_action = 20;
    limits.in_flight = 100;
    Served s(limits);
    const std::string ten(10, 'a'), eleven(11, 'a');
    s.put(ten);
    EXPECT_EQ(s->put_blob(writer, "", blob_of(eleven), as_bytes(eleven)).refused().why, Refusal::too_large);
    EXPECT_EQ(s.set(writer, "", "key", "note " + std::string(95, 'x') + "\n"), "too_large");
    EXPECT_EQ(s.set(writer, "", "key", "note " + std::string(94, 'x') + "\n"), "now");
    EXPECT_EQ(s.set(writer, "ccache", "key", std::string(21, 'x')), "too_large");
    EXPECT_EQ(s.set(writer, "ccache", "key", std::string(20, 'x')), "now");
    auto lease = s->lease(60);
    ASSERT_TRUE(lease.ok());
    EXPECT_EQ(s->lease(60).refused().why, Refusal::busy);
    EXPECT_EQ(s->lease(101).refused().why, Refusal::too_large);
    EXPECT_EQ(s->in_flight(), 60u);
    *lease = Service::Lease();
    EXPECT_TRUE(s->lease(100).ok());
    EXPECT_EQ(s->in_flight(), 0u);
}

TEST(Service, AFullDiskAndABrokenOneAreToldApart) {
    int code = 0;
    DiskOptions options = unflushed();
    options.before = [&code](DiskStep step) { return step == DiskStep::write ? code : 0; };
    Served s({}, options);
    for (const auto& [error, refusal] : {std::pair{ENOSPC, Refusal::full}, {EDQUOT, Refusal::full}, {EIO, Refusal::failed}}) {
        code = error;
        const auto put = s->put_blob(writer, "", blob_of("abc"), as_bytes("abc"));
        ASSERT_FALSE(put.ok());
        EXPECT_EQ(put.refused().why, refusal);
        EXPECT_EQ(put.refused().message.find('/'), std::string::npos) << "a path of the server goes to a client";
        EXPECT_EQ(s->counters().recent().at(0).kind, name_of(refusal));
    }
    code = 0;
    EXPECT_EQ(*s->put_blob(writer, "", blob_of("abc"), as_bytes("abc")), Written::now);
}

TEST(Service, SixtyFourWritersOfOneActionWithReaders) {
    Served s;
    for (int w = 0; w < 64; ++w) s.put("blob " + std::to_string(w));
    std::atomic<int> now{0}, kept{0}, wrong{0};
    std::atomic<bool> done{false};
    std::vector<std::thread> threads;
    for (int r = 0; r < 3; ++r) {
        threads.emplace_back([&] {
            std::string seen;
            while (!done) {
                const std::string got = s.get(reader, "", "key");
                if (!seen.empty()) wrong += got != seen;
                if (got != "absent") seen = got;
            }
        });
    }
    std::vector<std::thread> writers;
    for (int w = 0; w < 64; ++w) {
        writers.emplace_back([&, w] {
            const std::string put = s.set(writer, "", "key", naming("blob " + std::to_string(w)));
            now += put == "now";
            kept += put == "kept_first";
        });
    }
    for (std::thread& t : writers) t.join();
    EXPECT_NE(s.get(reader, "", "key"), "absent");
    done = true;
    for (std::thread& t : threads) t.join();
    EXPECT_EQ(now, 1);
    EXPECT_EQ(kept, 63);
    EXPECT_EQ(wrong, 0);
    EXPECT_EQ(s->counters().total().conflicts, 63u);
}

TEST(Counters, NamesAreBounded) {
    Counters counters;
    for (int i = 0; i < 2000; ++i) {
        Counts counts;
        counts.blob_hits = 1;
        counters.add("pr/" + std::to_string(i), counts);
        counters.event({i, "kind", "", "", ""});
    }
    EXPECT_EQ(counters.total().blob_hits, 2000u);
    EXPECT_EQ(counters.by_instance().size(), Counters::most_instances + 1);
    ASSERT_EQ(counters.recent().size(), Counters::most_events);
    EXPECT_EQ(counters.recent().front().time, 1999);
    EXPECT_EQ(counters.recent().back().time, 2000 - static_cast<int64_t>(Counters::most_events));
}

}  // namespace
}  // namespace kiln
