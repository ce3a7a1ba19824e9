// A long computation in slices: it stops when the work it was given is used up, and goes on from there. One text serves
// the whole at once and bit by bit, so both give the same bytes.
//
// Such a function is a coroutine that returns `Sliced`. Before each piece it says what that costs (`co_yield units`);
// other such functions are parts of it (`co_await part(...)`). Arguments by reference must outlive it.
#pragma once

#include <algorithm>
#include <coroutine>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/purse.hpp>

namespace grapeshot {

/// No piece costs more than this, work units: a slice of at least as many gets something done.
inline constexpr std::uint64_t mostSlicedPiece = 8;

/// The coroutine. Does nothing before it is awaited or run.
class [[nodiscard]] Sliced {
  public:
    struct promise_type;
    using Handle = std::coroutine_handle<promise_type>;

    explicit Sliced(Handle handle) : m_handle(handle) {}
    Sliced(Sliced&& other) noexcept : m_handle(std::exchange(other.m_handle, {})) {}
    Sliced& operator=(Sliced&& other) noexcept {
        std::swap(m_handle, other.m_handle);
        return *this;
    }
    ~Sliced() {
        if (m_handle) {
            m_handle.destroy();
        }
    }

    /// Does up to budget.work units (a limit of time is looked at before each piece). Returns how many; ends early only
    /// if it is done, or if the next piece is too large for what is left. Throws what the computation throws; it is
    /// done then.
    std::uint64_t run(const Budget& budget = {});
    [[nodiscard]] bool isDone() const { return m_handle.done(); }
    /// Units of the last `run`, also if it threw.
    [[nodiscard]] std::uint64_t spent() const;

    // What co_await wants.
    [[nodiscard]] bool await_ready() const noexcept { return false; }
    void await_suspend(Handle caller) noexcept;
    void await_resume();

  private:
    struct Meter {
        Purse purse{Budget{}};
        std::uint64_t asked = 0;  ///< by the piece that waits
        bool waits = false;       ///< for it to be paid
        std::coroutine_handle<> innermost;

        [[nodiscard]] bool affords() const {
            const Budget left = purse.left();
            return left.work >= asked && left.time > std::chrono::nanoseconds(0);
        }
    };
    struct Back {
        [[nodiscard]] bool await_ready() const noexcept { return false; }
        void await_suspend(Handle done) const noexcept;
        void await_resume() const noexcept {}
    };
    struct Payment {
        bool paid;
        [[nodiscard]] bool await_ready() const noexcept { return paid; }
        void await_suspend(std::coroutine_handle<>) const noexcept {}
        void await_resume() const noexcept {}
    };

    Handle m_handle;
};

struct Sliced::promise_type {
    Meter own;  ///< of the outermost
    Meter* meter = nullptr;
    std::coroutine_handle<> caller;
    std::exception_ptr error;

    Sliced get_return_object() { return Sliced(Handle::from_promise(*this)); }
    std::suspend_always initial_suspend() noexcept { return {}; }
    Back final_suspend() noexcept { return {}; }
    void return_void() noexcept {}
    void unhandled_exception() noexcept { error = std::current_exception(); }
    Payment yield_value(std::uint64_t work) noexcept {
        meter->asked = std::min(work, mostSlicedPiece);
        if (!meter->affords()) {
            meter->waits = true;
            return {false};
        }
        meter->purse.pay(meter->asked);
        meter->asked = 0;
        return {true};
    }
};

// Both only say who goes on, and `run` resumes it: a compiler that does not optimise makes a call of each transfer from
// one coroutine to another, and the stack ends.
inline void Sliced::Back::await_suspend(Handle done) const noexcept {
    done.promise().meter->innermost = done.promise().caller;
}

inline void Sliced::await_suspend(Handle caller) noexcept {
    promise_type& promise = m_handle.promise();
    promise.meter = caller.promise().meter;
    promise.caller = caller;
    promise.meter->innermost = m_handle;
}

inline void Sliced::await_resume() {
    if (m_handle.promise().error) {
        std::rethrow_exception(m_handle.promise().error);
    }
}

inline std::uint64_t Sliced::run(const Budget& budget) {
    promise_type& promise = m_handle.promise();
    if (promise.meter == nullptr) {
        promise.meter = &promise.own;
        promise.own.innermost = m_handle;
    }
    Meter& meter = promise.own;
    meter.purse = Purse(budget);
    if (!m_handle.done() && meter.affords()) {
        meter.purse.pay(std::exchange(meter.asked, 0));
        meter.waits = false;
        while (!m_handle.done() && !meter.waits) {
            meter.innermost.resume();
        }
    }
    await_resume();
    return spent();
}

inline std::uint64_t Sliced::spent() const {
    return m_handle.promise().own.purse.spent();
}

/// Calls body(begin, end) for ranges that together are [begin, end), in order: `perUnit` of them cost one unit.
template <class Body>
Sliced inPieces(std::size_t begin, std::size_t end, std::size_t perUnit, Body& body) {
    while (begin < end) {
        const std::size_t next = std::min(end, begin + mostSlicedPiece * perUnit);
        co_yield (next - begin + perUnit - 1) / perUnit;
        body(begin, next);
        begin = next;
    }
}

}  // namespace grapeshot
