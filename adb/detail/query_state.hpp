// What a query keeps from call to call.
#pragma once

#include <array>
#include <vector>

#include <grapeshot/adb/detail/descent.hpp>
#include <grapeshot/adb/detail/estimate.hpp>
#include <grapeshot/adb/detail/pair_queue.hpp>
#include <grapeshot/adb/detail/spending.hpp>
#include <grapeshot/adb/query.hpp>

namespace grapeshot {

struct Query::State {
    enum class Task { none, decide, contacts, leafPairs };

    State(const Tree& treeA, const Tree& treeB) : a(&treeA), b(&treeB), storageA(512), storageB(512) { lend(); }
    State(const State& other);
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
    void handOver();
    [[nodiscard]] float collisionProbability() const;
    Decision goOn(const Budget& budget);

    // query_lists.cpp
    bool contactsGoOn(std::uint64_t units, Contacts& out);
    void append(const LeafBlock& blockA, const LeafBlock& blockB, Contacts& out) const;
    template <typename Result, typename Run>
    void goOn(Task which, const Budget& budget, Result& out, const Run& run);

    /// The descent and the cut work on borrowed memory, because code compiled per instruction set calls nothing of the
    /// standard library.
    void lend();

    const Tree* a;
    const Tree* b;
    detail::Descent descent;
    std::vector<detail::Side> storageA, storageB;
    detail::PairQueue queue;
    Task task = Task::none;
    Order order = Order::depthFirst;
    float maxDistance = 0;
    bool finished = false;     ///< the answer is certain
    bool leafPending = false;  ///< descent.found is a leaf pair still to be tested
    detail::SidePair witness = 0;
    bool hasWitness = false;
    Decision decision;

    DecideSettings settings;
    bool estimating = false;      ///< the cut holds what is left, not the stack or the queue
    bool ignoreLimits = false;    ///< it was sure enough once
    std::uint64_t exactFrom = 0;  ///< work when the estimate handed over
    detail::RateLimits limits{};  ///< of `settings`
    const Calibration* limitsOf = nullptr;
    detail::Cut cut;
    alignas(64) std::array<float, detail::cutCapacity> cutRates{};
    std::array<detail::Side, detail::cutCapacity> cutSidesA{}, cutSidesB{};
};

}  // namespace grapeshot
