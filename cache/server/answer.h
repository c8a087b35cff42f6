#pragma once
// What the service answers: a value, or why not. Each front turns a Refusal into its protocol's own code.

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace kiln {

enum class Refusal {
    bad_request,       // malformed, or bytes that do not match their digest
    unauthenticated,   // no token or an unknown one, where a token would help
    forbidden,         // a known caller without the role
    unknown_instance,  // no such instance
    too_large,         // over a limit of the server
    busy,              // more bodies in flight than the server holds; later it may work
    full,              // no room on disk
    failed,            // the disk or the server failed
};

// snake_case, for logs, metrics and error bodies.
const char* name_of(Refusal refusal);

struct Refused {
    Refusal why = Refusal::failed;
    std::string message;  // for the person behind the client; holds no secret and no path of the server
};

template <class T>
class [[nodiscard]] Answer {
public:
    Answer(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Answer(Refused refused) : state_(std::in_place_index<1>, std::move(refused)) {}
    bool ok() const { return state_.index() == 0; }
    T& operator*() {
        assert(ok());
        return std::get<0>(state_);
    }
    const T& operator*() const {
        assert(ok());
        return std::get<0>(state_);
    }
    T* operator->() { return &**this; }
    const T* operator->() const { return &**this; }
    const Refused& refused() const {
        assert(!ok());
        return std::get<1>(state_);
    }

private:
    std::variant<T, Refused> state_;
};

}  // namespace kiln
