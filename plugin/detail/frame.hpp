// One frame of a dispatcher: what is left of its budget, and how its dispatches share it.
#pragma once

#include <chrono>
#include <cstdint>

#include <grapeshot/core/budget.hpp>
#include <grapeshot/plugin/precision.hpp>

namespace grapeshot {
inline namespace GRAPESHOT_PRECISION {
namespace detail {

/// Work units of a dispatch that go into trees, if there are some to be built, whatever the budget.
inline constexpr std::uint64_t buildingSlice = 64;

/// Nothing of Bullet in it: pair caches are mere names.
///
/// When a frame begins: with `begin`, or by itself with each dispatch of the main cache. That is the first cache that
/// comes by; a world dispatches its own once in each substep, before its ghosts. When others have come by 16 times
/// without it (a controller does so 5 times at most in a substep), the next one becomes the main one: the world has
/// gone. After a `begin` frames only begin so.
class Frame {
  public:
    /// A frame of so many dispatches of the main cache (substeps of one stepSimulation): each may take its equal share
    /// of what is left.
    void begin(int dispatches, const Budget& budget);
    /// A dispatch begins. True if a frame begins with it.
    bool enterDispatch(const void* cache, const Budget& budget);

    [[nodiscard]] bool isInMain() const { return m_inMain; }  ///< the last dispatch was of the main cache
    [[nodiscard]] std::uint64_t number() const { return m_number; }
    /// Work units that the dispatch may deal out ahead of Bullet's pass: its share, less what pairs within compounds
    /// and later dispatches are likely to need, going by the last frame.
    [[nodiscard]] std::uint64_t dispatchShare() const;
    /// Of what is left, for one more pair that only turned up in Bullet's pass; its mandatory slice included.
    [[nodiscard]] Budget latecomerSlice(std::uint64_t mandatory) const;

    void payDispatch(std::uint64_t work, std::uint64_t mandatory);
    void payLatecomer(std::uint64_t work, std::uint64_t mandatory);
    /// For trees that are being built, and what stands in for them.
    void payBuilding(std::uint64_t work, std::uint64_t mandatory);

    [[nodiscard]] bool isLimited() const { return m_budget.work != unlimited || m_budget.time != never; }
    [[nodiscard]] const Budget& budget() const { return m_budget; }
    [[nodiscard]] std::uint64_t spent() const { return m_spent; }
    [[nodiscard]] std::uint64_t mandatory() const { return m_mandatory; }
    [[nodiscard]] std::uint64_t building() const { return m_building; }  ///< of what was spent
    [[nodiscard]] int dispatches() const { return m_dispatches; }
    /// Until the frame's time is up; `never` without a limit of time.
    [[nodiscard]] std::chrono::nanoseconds timeLeft() const;

  private:
    struct Tally {
        std::uint64_t work = 0;
        std::uint64_t mandatory = 0;
        std::uint64_t count = 0;
    };
    void start(const Budget& budget);
    [[nodiscard]] std::uint64_t left() const;

    Budget m_budget;
    std::chrono::nanoseconds m_startTime{0};
    std::uint64_t m_number = 0;
    std::uint64_t m_spent = 0;
    std::uint64_t m_mandatory = 0;
    std::uint64_t m_building = 0;
    int m_dispatches = 0;      // in this frame
    int m_mainDispatches = 0;  // of these, of the main cache
    int m_expected = 1;        // main dispatches of the frame
    bool m_explicit = false;
    const void* m_main = nullptr;
    int m_sinceMain = 0;  // dispatches of others
    bool m_inMain = true;
    // Per main dispatch: latecomers, and the dispatches of other caches.
    Tally m_late, m_later, m_lastLate, m_lastLater;
};

}  // namespace detail
}  // namespace GRAPESHOT_PRECISION
}  // namespace grapeshot
