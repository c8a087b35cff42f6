#pragma once
// A shader's classes made by hand: one axis per flag, one class per text.

#include <memory>
#include <string>
#include <vector>

#include "compiler/modules/modules.h"

namespace kiln {

// A shader with one axis `which` whose digits are the classes of each stage, and a Split per stage.
struct World {
    explicit World(std::string name, uint32_t values) {
        shader.name = space.shader = std::move(name);
        Axis axis;
        axis.name = "which";
        axis.macro = "WHICH";
        axis.kind = AxisKind::integer;
        for (uint32_t v = 0; v < values; ++v) axis.values.push_back({std::to_string(v), static_cast<int32_t>(v)});
        space.axes = {axis};
        space.diagram = std::make_unique<Diagram>(std::vector<uint32_t>{values}, std::vector<uint32_t>{0});
        space.legal = space.needed = Diagram::all();
    }
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    // One class a text; digit i has the i-th. Every line's place is line n * 10, column n of "<stage>.glsl".
    void add(Stage stage, const std::vector<std::string>& texts) {
        auto split = std::make_unique<Split>();
        split->files = {std::string(name_of(stage)) + ".glsl"};
        for (uint32_t digit = 0; digit < texts.size(); ++digit) {
            Class c;
            c.variants = space.diagram->where(0, digit);
            c.text = texts[digit];
            uint32_t line = 0;
            for (const char ch : c.text) {
                if (ch == '\n') {
                    ++line;
                    c.places.push_back({0, line * 10, line});
                }
            }
            split->classes.push_back(std::move(c));
        }
        splits.push_back(std::move(split));
        stages.push_back({&shader, &space, stage, splits.back().get()});
    }

    Shader shader;
    Space space;
    std::vector<std::unique_ptr<Split>> splits;
    std::vector<StageClasses> stages;
};

// A store that counts, and fails on request.
class TestStore final : public Store {
public:
    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override {
        if (broken_gets) return environment_error("no disk");
        return inner.get(space, key);
    }
    Status put(Keyspace space, const Digest& key, ByteView bytes) override {
        if (broken_puts) return environment_error("disk full");
        const std::lock_guard lock(mutex);
        keys.emplace_back(space, key);
        return inner.put(space, key, bytes);
    }
    MemoryStore inner;
    bool broken_gets = false, broken_puts = false;
    std::mutex mutex;
    std::vector<std::pair<Keyspace, Digest>> keys;
};

// Gives back every entry with its last bit flipped, or drops all blobs.
class DamagedStore final : public Store {
public:
    explicit DamagedStore(Store& good) : good_(good) {}
    Result<std::optional<Bytes>> get(Keyspace space, const Digest& key) override {
        if (space == Keyspace::blob && drop_blobs) return std::optional<Bytes>();
        Result<std::optional<Bytes>> got = good_.get(space, key);
        if (space == flip && got.ok() && got->has_value()) (*got)->back() = static_cast<uint8_t>((*got)->back() ^ 1);
        return got;
    }
    Status put(Keyspace, const Digest&, ByteView) override { return {}; }
    Keyspace flip = Keyspace::blob;
    bool drop_blobs = false;

private:
    Store& good_;
};

}  // namespace kiln
