#pragma once
// A value or the reason why there is none. kiln throws nothing of its own; a library's exception is
// turned into an Error in the one file that includes that library.

#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace kiln {

// What went wrong, by who can mend it. The command line's exit codes are these numbers.
enum class Fault : int {
    input = 1,        // the user's manifest, shader, scene or table is wrong
    usage = 2,        // the command line is wrong
    environment = 3,  // disk, memory, driver, an interrupt
    mismatch = 4,     // a check compared two things and they differ
};

struct Error {
    Fault fault = Fault::environment;
    std::string message;
};

template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return state_.index() == 0; }
    explicit operator bool() const { return ok(); }
    T& value() {
        assert(ok());
        return std::get<0>(state_);
    }
    const T& value() const {
        assert(ok());
        return std::get<0>(state_);
    }
    T& operator*() { return value(); }
    const T& operator*() const { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }
    const Error& error() const {
        assert(!ok());
        return std::get<1>(state_);
    }

private:
    std::variant<T, Error> state_;
};

// Success, or an Error.
class [[nodiscard]] Status {
public:
    Status() = default;
    Status(Error error) : error_(std::move(error)) {}
    bool ok() const { return !error_.has_value(); }
    explicit operator bool() const { return ok(); }
    const Error& error() const {
        assert(!ok());
        return *error_;
    }

private:
    std::optional<Error> error_;
};

inline Error input_error(std::string message) { return {Fault::input, std::move(message)}; }
inline Error environment_error(std::string message) { return {Fault::environment, std::move(message)}; }

}  // namespace kiln

// Returns the error of `status_or_result` from the enclosing function.
#define KILN_TRY(status_or_result)                     \
    do {                                               \
        auto&& kiln_try_ = (status_or_result);         \
        if (!kiln_try_.ok()) return kiln_try_.error(); \
    } while (false)
