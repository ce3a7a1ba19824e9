// What a query keeps from call to call.
#pragma once

#include <array>
#include <memory>

#include <grapeshot/adb/detail/descent.hpp>
#include <grapeshot/adb/detail/estimate.hpp>
#include <grapeshot/adb/detail/pair_queue.hpp>
#include <grapeshot/adb/detail/spending.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>
#include <grapeshot/adb/query.hpp>

namespace grapeshot {

struct Query::State {
    enum class Task { none, decide, contacts, leafPairs };

    State(const Tree& treeA, const Tree& treeB) : a(&treeA), b(&treeB) { lend(); }
    static std::unique_ptr<State> copyOf(const State& other);
    State& operator=(const State&) = delete;
    ~State() = default;

    /// False if the input is invalid: then there is nothing to go on with. The root is not put anywhere yet.
    bool start(Task newTask, const Pose& bInA, Order newOrder, float distance);
    void put(detail::SidePair pair, float margin);
    /// DescentEnd::found: the pair is descent.found.
    detail::DescentEnd nextLeafPair(std::uint64_t units);

    // query.cpp
    bool useSettings(const DecideSettings& wanted);
    void recallWitness();
    detail::DescentEnd testPending(std::uint64_t units);
    detail::DescentEnd nextOverlap(std::uint64_t units);
    [[nodiscard]] bool leavesEstimateOut(const Budget& budget) const;
    bool lookAtWholes();
    /// From the cut to the stack.
    void handOver();
    [[nodiscard]] float collisionProbability() const;
    Decision goOn(const Budget& budget);

    // query_lists.cpp
    bool contactsGoOn(std::uint64_t units, Contacts& out);
    void append(const LeafBlock& blockA, const LeafBlock& blockB, Contacts& out) const;
    template <typename Result, typename Run>
    void goOn(Task which, const Budget& budget, Result& out, const Run& run);

    /// The descent and the cut work on borrowed memory: that of this object.
    void lend();

    const Tree* a;
    const Tree* b;
    detail::Descent descent;
    detail::StackStorage storage;
    detail::PairQueue queue;
    Task task = Task::none;
    Order order = Order::depthFirst;
    float maxDistance = 0;
    bool finished = false;     ///< the answer is certain
    bool leafPending = false;  ///< descent.found is a leaf pair still to be tested
    detail::SidePair witness = 0;
    bool hasWitness = false;
    bool hit = false;  ///< finished with an intersecting pair
    TrianglePair hitTriangles;

    DecideSettings settings;
    std::uint32_t fruitless = 0;  ///< estimates in a row that came to no limit, or were left out for that
    bool estimating = false;      ///< the cut holds what is left, not the stack or the queue
    bool looking = false;         ///< the whole surfaces are still to be looked at
    bool inside = false;          ///< one may lie inside the other: no estimated yes
    float wholeProbability = 0;   ///< by the whole surfaces, if that was enough; else 0.5
    bool ignoreLimits = false;    ///< it was sure enough once
    std::uint64_t exactFrom = 0;  ///< work when the estimate handed over
    /// Of `settings`, in rates; of those that they were worked out for last, if `settings` needs none.
    struct Limits {
        const Calibration* calibration = nullptr;
        float acceptAt = 0;
        float rejectAt = 0;
        float wholeYes = 0;  ///< D^2 of the whole surfaces: yes up to here
        float wholeNo = 0;   ///< no from here on
        detail::RateLimits rates = detail::noLimits;
        detail::RateLimits onlyNo = detail::noLimits;  ///< rates without the limits for yes
        void workOut();
    } limits;
    detail::Cut cut;
    alignas(64) std::array<float, detail::cutCapacity> cutRates{};
    std::array<detail::Side, detail::cutCapacity> cutSidesA{}, cutSidesB{};

  private:
    State(const State&) = default;  // the copy still borrows from the original
};

}  // namespace grapeshot
