// Questions to two trees: do the surfaces intersect; which triangles are closer than a distance?
//
// This work is based on:
// Jan Klein, Gabriel Zachmann. ADB-Trees: Controlling the Error of Time-Critical Collision Detection. VMV 2003, fig. 4
// (the queue of node pairs, taken up best first, which may be stopped at any time)
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <grapeshot/adb/calibration.hpp>
#include <grapeshot/adb/tree.hpp>
#include <grapeshot/core/budget.hpp>
#include <grapeshot/core/pose.hpp>
#include <grapeshot/core/random.hpp>
#include <grapeshot/core/triangle_pair.hpp>

namespace grapeshot {

class ByteReader;
class ByteWriter;

/// How node pairs are taken up.
enum class Order {
    depthFirst,  ///< nearest child first; fastest to the end
    bestFirst,   ///< deepest box overlap of all first; best when the budget may end it
};

/// How sure is sure enough. An estimate comes first, then the exact traversal goes on from what it left: by default
/// only where the estimate is not sure. Wrong by 0.05 % or less on poses such as those of the calibration, and exact in
/// doubt.
struct DecideSettings {
    /// Best-first steps, one unit each, that the estimate may take; 0: exact from the start. The probability says the
    /// more the more steps; with `unlimited` it never hands over to the exact traversal, which is for queries that will
    /// be stopped anyway.
    std::uint64_t estimateSteps = 16;
    float acceptAt = 0.9972F;   ///< stop with yes when P(they collide) is at least this, 0.5..1; 1: only when proven
    float rejectAt = 0.00049F;  ///< stop with no when P(they collide) is at most this, 0..0.5; 0: only when proven
    /// Null: the default one. Must stay where it is as long as the query is used.
    const Calibration* calibration = nullptr;
    Order order = Order::depthFirst;  ///< of the exact traversal if there is no estimate before it; else depth first
    bool tryWitness = true;  ///< take up the pair that the last decision found first: one unit, good for smooth motion

    /// After eight estimates in a row that came to no limit, as with bodies that rest on each other, only every
    /// sixteenth decision is estimated, until that settles one; the others are exact. Which ones belongs to the query,
    /// so an answer may depend on the decisions before it; false: never on them. Only without a limited budget.
    bool adaptive = true;

    [[nodiscard]] static DecideSettings exact(Order order = Order::depthFirst) {
        return {.estimateSteps = 0, .acceptAt = 1, .rejectAt = 0, .calibration = nullptr, .order = order};
    }
};

/// Do the surfaces intersect? (A mesh wholly inside another does not: see `contains` in point_query.hpp.)
struct Decision {
    bool collides = false;
    /// P(the answer `collides` is true), by the calibration: 0.5 to 1, and 1 only when certain. When the budget ended
    /// it before the first step, or an exact traversal without an estimate: 0.5, nothing known, and `collides` is true.
    float probability = 0.5F;
    bool certain = false;
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;  ///< work units since `decide`, resumed parts included
    TrianglePair witness;    ///< an intersecting pair, if certain and colliding
};

/// How an answer that is not certain is taken.
enum class Answer {
    mostLikely,  ///< as Decision has it
    sample,      ///< drawn from its probability: over many seeds each outcome comes as often as it should
};

/// Do they collide? A certain decision is what it is. Else the draw belongs to the key: take as its `step` the one in
/// which the two came so near that they could not be told apart, and keep it until the answer is certain again; then
/// the answer does not flicker from step to step, and only turns when the probability has moved across the draw.
[[nodiscard]] bool answerOf(const Decision& decision, Answer answer, const RandomKey& episode) noexcept;

/// Two leaf blocks, by index.
struct LeafPair {
    std::uint32_t leafA = 0;
    std::uint32_t leafB = 0;
    friend bool operator==(const LeafPair&, const LeafPair&) = default;
    friend auto operator<=>(const LeafPair&, const LeafPair&) = default;
};

struct ContactSettings {
    float maxDistance = 0;  ///< m, >= 0: pairs farther apart are not reported
    Order order = Order::depthFirst;
};

/// Two triangles within the distance. Everything in A's frame, in metres.
struct TriangleContact {
    TrianglePair pair;
    Eigen::Vector3f onA =
        Eigen::Vector3f::Zero();  ///< closest point of A's triangle; middle of the intersection if overlapping
    Eigen::Vector3f onB = Eigen::Vector3f::Zero();
    float signedDistance = 0;   ///< minus the translation that parts the two triangles if overlapping
    std::uint8_t featureA = 6;  ///< 0..2 corner, 3..5 edge, 6 face (see DistanceBatch)
    std::uint8_t featureB = 6;
    bool overlapping = false;
};

struct Contacts {
    std::vector<TriangleContact>
        pairs;             ///< in the order of the traversal: deterministic, the same on every instruction set
    bool certain = false;  ///< all pairs within the distance are listed
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;
};

/// Leaf pairs whose boxes are within a distance.
struct LeafPairs {
    std::vector<LeafPair> pairs;
    bool certain = false;
    StopReason stop = StopReason::invalidInput;
    std::uint64_t work = 0;
};

/// A query between two trees that can be stopped and resumed. Copyable: a copy resumes on its own; one that was moved
/// from may only be copied, assigned to or destroyed. Keeps references to both trees, which must stay where they are
/// and unchanged while it is resumed. Not for two threads at once; make two. Queries never throw (but for memory); bad
/// poses and settings give StopReason::invalidInput.
class Query {
  public:
    Query(const Tree& a, const Tree& b);
    Query(const Query&);
    Query& operator=(const Query&);
    Query(Query&&) noexcept;
    Query& operator=(Query&&) noexcept;
    ~Query();

    /// Estimate, then exact, as the settings say; ends when sure enough, or certainly at the first intersecting pair.
    Decision decide(const Pose& bInA, const DecideSettings& settings = {}, Budget budget = {});
    /// Goes on where the last `decide` stopped. The end does not depend on where it was stopped by its budget. If it
    /// had stopped because it was sure enough, it goes on until it is certain. StopReason::invalidInput if there is
    /// nothing to resume (no decide before).
    Decision resume(Budget budget);

    /// All triangle pairs with signedDistance <= maxDistance. `out` is cleared and its memory kept.
    void contacts(const Pose& bInA, const ContactSettings& settings, Budget budget, Contacts& out);
    [[nodiscard]] Contacts contacts(const Pose& bInA, const ContactSettings& settings, Budget budget = {});
    /// Goes on where the last `contacts` stopped, appending to `out`, which must be the one it left.
    void resumeContacts(Budget budget, Contacts& out);

    /// Only the traversal: leaf pairs with boxes within `maxDistance`, a superset of the leaves of `contacts`. For
    /// callers that keep the list while the bodies move little.
    void leafPairs(const Pose& bInA, const ContactSettings& settings, Budget budget, LeafPairs& out);
    void resumeLeafPairs(Budget budget, LeafPairs& out);

    /// Only the triangle tests of given leaf pairs, one unit each. `out` is cleared; if the budget ends it, `out.work`
    /// says how many were done, from the front. Leaf indices out of range give invalidInput.
    void contactsOf(std::span<const LeafPair> pairs, const Pose& bInA, float maxDistance, Budget budget, Contacts& out);

    /// Where a `contacts` or `leafPairs` is, so that it can be resumed after `load`, with the same bytes. Of a `decide`
    /// nothing is written: then there is nothing to resume.
    void save(ByteWriter& out) const;
    /// The trees must be the ones that the saved query had, byte by byte; others give other answers, but whatever the
    /// bytes are, nothing outside of the trees is touched. @throws Error badFile
    [[nodiscard]] static Query load(const Tree& a, const Tree& b, ByteReader& in);

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace grapeshot
