#ifndef KILN_HPP
#define KILN_HPP
// C++17 over kiln.h: the same reader with views for texts, words and lists. Header only, no allocation, no exceptions; what
// kiln.h says about lifetimes and hostile tables holds here too.
#include <cstdint>
#include <string_view>

#include "kiln.h"

namespace kiln_runtime {

inline std::string_view view(kiln_text text) { return {text.data, text.size}; }

// A run of values inside the table.
template <class T>
class List {
public:
    List() = default;
    List(const T* data, std::uint32_t size) : data_(data), size_(size) {}
    const T* begin() const { return data_; }
    const T* end() const { return data_ + size_; }
    const T* data() const { return data_; }
    std::uint32_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const T& operator[](std::uint32_t i) const { return data_[i]; }

private:
    const T* data_ = nullptr;
    std::uint32_t size_ = 0;
};

class Shader {
public:
    Shader() = default;
    explicit Shader(const kiln_shader& shader) : shader_(shader) {}
    explicit operator bool() const { return shader_.table != nullptr; }
    std::string_view name() const { return view(shader_.name); }
    std::uint32_t key_words() const { return shader_.key_words; }
    std::uint32_t stages() const { return shader_.stage_count; }

    // By name; false when the axis or the value does not exist. `key` has key_words() words.
    bool set(std::uint64_t* key, const char* axis, const char* value) const {
        const std::uint32_t a = kiln_find_axis(&shader_, axis);
        if (a == KILN_NONE) return false;
        const std::uint32_t digit = kiln_find_value(&shader_, a, value);
        return digit != KILN_NONE && kiln_key_set(&shader_, key, a, digit) == KILN_OK;
    }
    kiln_status check(const std::uint64_t* key) const { return kiln_check(&shader_, key); }
    // `modules` takes one number a stage.
    kiln_status find(const std::uint64_t* key, std::uint32_t* modules) const { return kiln_find(&shader_, key, modules); }
    // The module of one kind of stage; KILN_ABSENT when the shader has none.
    kiln_status find(const std::uint64_t* key, kiln_stage stage, std::uint32_t& module) const {
        for (std::uint32_t i = 0; i < shader_.stage_count; ++i)
            if (shader_.stage[i] == static_cast<std::uint32_t>(stage)) return kiln_find_stage(&shader_, key, i, &module);
        return KILN_ABSENT;
    }
    // Why a key misses; the view is into `buffer`.
    std::string_view why(const std::uint64_t* key, char* buffer, std::size_t capacity) const {
        const std::size_t size = kiln_why(&shader_, key, buffer, capacity);
        if (capacity == 0) return {};
        return {buffer, size < capacity ? size : capacity - 1};
    }
    const kiln_shader* raw() const { return &shader_; }

private:
    kiln_shader shader_{};
};

class Table {
public:
    kiln_status open(const void* bytes, std::size_t size) { return kiln_open(&table_, bytes, size); }
    kiln_status verify(const char** what = nullptr) const { return kiln_verify(&table_, what); }
    // An empty Shader when there is none. It points to this Table, which must stay where it is.
    Shader shader(const char* name) const {
        kiln_shader s;
        return kiln_find_shader(&table_, name, &s) == KILN_OK ? Shader(s) : Shader();
    }
    // SPIR-V in place; empty when there is no such module.
    List<std::uint32_t> words(std::uint32_t module) const {
        kiln_module m;
        if (kiln_get_module(&table_, module, &m) != KILN_OK) return {};
        return {m.words, m.word_count};
    }
    // A module in another language, decoded into `buffer`; kiln_find_artifact tells the size that it needs.
    kiln_status text(const Shader& shader, std::uint32_t module, kiln_target target, char* buffer, std::size_t capacity,
                     std::string_view& out) const {
        kiln_artifact artifact;
        kiln_status status = kiln_find_artifact(shader.raw(), module, static_cast<std::uint32_t>(target), &artifact);
        if (status != KILN_OK) return status;
        status = kiln_decode(&table_, artifact.index, buffer, capacity);
        if (status == KILN_OK) out = {buffer, artifact.size};
        return status;
    }
    const kiln_table* raw() const { return &table_; }

private:
    kiln_table table_{};
};

}  // namespace kiln_runtime

#endif
