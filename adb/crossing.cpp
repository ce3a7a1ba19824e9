#include <grapeshot/adb/crossing.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <grapeshot/adb/detail/crossing_cut.hpp>
#include <grapeshot/adb/detail/leaf_corners.hpp>
#include <grapeshot/adb/detail/spending.hpp>
#include <grapeshot/adb/detail/stack_storage.hpp>
#include <grapeshot/core/detail/leaf_triangles.hpp>
#include <grapeshot/core/detail/triangle_cut.hpp>

namespace grapeshot {

using detail::CrossingEnd;
using detail::DescentEnd;
using detail::TriangleD;

namespace {

TriangleD cornersOf(const LeafBlock& leaf, int lane) {
    return {detail::cornerOf(leaf, 0, lane), detail::cornerOf(leaf, 1, lane), detail::cornerOf(leaf, 2, lane)};
}

Eigen::Vector3d normalOf(const TriangleD& t) {
    return (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
}

/// Tangent of half the angle inside both surfaces, from the cosine of that between their normals, times `flatness`.
float slopeOf(float flatness, float cosine) {
    constexpr float steepest = 30;
    return std::min(std::sqrt(std::max(flatness + cosine, 0.0F) / std::max(flatness - cosine, 1e-9F)), steepest);
}

/// Two triangles that intersect: their piece of the curve.
CurvePiece pieceOf(const TriangleD& a, const TriangleD& b, TrianglePair pair) {
    CurvePiece piece;
    piece.pair = pair;
    piece.rate = std::numeric_limits<float>::infinity();
    const Eigen::Vector3d normalA = normalOf(a);
    const Eigen::Vector3d normalB = normalOf(b);
    piece.direction = (normalB - normalA).cast<float>();
    piece.slope = slopeOf(1, static_cast<float>(normalA.dot(normalB)));
    if (const auto segment = detail::cut(a, b)) {
        const double length = (segment->to - segment->from).norm();
        piece.position = (0.5 * (segment->from + segment->to)).cast<float>();
        piece.length = static_cast<float>(length);
        piece.extent = static_cast<float>(length / std::sqrt(12.0));
        return piece;
    }
    // They touch or lie in one plane; between their middles is near enough.
    piece.position = ((a[0] + a[1] + a[2] + b[0] + b[1] + b[2]) / 6).cast<float>();
    piece.extent = static_cast<float>(0.5 * ((a[0] + a[1] + a[2]) - (b[0] + b[1] + b[2])).norm() / 3);
    return piece;
}

}  // namespace

struct CrossingQuery::State {
    State(const Tree& treeA, const Tree& treeB) : a(&treeA), b(&treeB) { storage.lendTo(descent); }
    static std::unique_ptr<State> copyOf(const State& other) {
        std::unique_ptr<State> copy(new State(other));
        copy->storage.lendTo(copy->descent);
        return copy;
    }
    State& operator=(const State&) = delete;
    ~State() = default;

    void start(const Pose& bInA, const CrossingSettings& wanted, bool toTheEnd);
    bool goOn(std::uint64_t units);
    void addProven();
    void report(const Budget& budget, Crossing& out);

    const Tree* a;
    const Tree* b;
    detail::Descent descent;  ///< its stack holds what is left of an entry that is refined to its end
    detail::StackStorage storage;
    detail::CrossingCut cut;
    CrossingSettings settings;
    std::vector<CurvePiece> proven;
    float provenLength = 0;  ///< m
    bool started = false;
    bool finished = false;

  private:
    State(const State&) = default;  // the copy still borrows from the original
};

/// `toTheEnd`: nobody will stop it, so there is no need to be good before the end.
void CrossingQuery::State::start(const Pose& bInA, const CrossingSettings& wanted, bool toTheEnd) {
    proven.clear();
    provenLength = 0;
    started = wanted.leaveOut >= 0 && wanted.leaveOut <= 1;
    if (!started) {
        return;
    }
    settings = wanted;
    descent.depth = 0;
    descent.work = 0;
    const detail::PoseVerdict verdict = detail::prepare(bInA, a->radius, b->radius, 0, descent.prepared);
    started = verdict != detail::PoseVerdict::invalid;
    finished = verdict == detail::PoseVerdict::apart || a->nodes.empty() || b->nodes.empty();
    descent.pose = bInA;
    detail::setTrees(descent, *a, *b);
    detail::startCrossing(cut);
    if (toTheEnd) {
        cut.count = 0;
        detail::push(descent, detail::sidePair(0, 0));
    }
}

/// The triangles found at Descent::found.
void CrossingQuery::State::addProven() {
    const LeafBlock& blockA = detail::blockA(descent, descent.found);
    const LeafBlock& blockB = detail::blockB(descent, descent.found);
    const Eigen::Matrix3d rotation = descent.pose.rotation.cast<double>();
    const Eigen::Vector3d translation = descent.pose.translation.cast<double>();
    for (std::uint32_t rest = descent.lanes; rest != 0; rest &= rest - 1) {
        const int lane = std::countr_zero(rest);
        const TrianglePair pair{blockA.triangle[lane / 4], blockB.triangle[lane % 4]};
        if (pair.triangleA == noTriangle || pair.triangleB == noTriangle) {
            continue;
        }
        TriangleD cornersB = cornersOf(blockB, lane % 4);
        for (Eigen::Vector3d& corner : cornersB) {
            corner = rotation * corner + translation;
        }
        proven.push_back(pieceOf(cornersOf(blockA, lane / 4), cornersB, pair));
        provenLength += proven.back().length;
    }
}

/// True when nothing is left.
bool CrossingQuery::State::goOn(std::uint64_t units) {
    const std::uint64_t limit = units > unlimited - descent.work ? unlimited : descent.work + units;
    const RateFormula& formula =
        (settings.calibration != nullptr ? *settings.calibration : defaultCalibration()).formula;
    for (;;) {
        if (descent.depth > 0) {
            const DescentEnd end = detail::toOverlap(descent, limit - descent.work);
            if (end == DescentEnd::budget) {
                return false;
            }
            if (end == DescentEnd::found) {
                addProven();
            }
            continue;
        }
        switch (detail::refineCrossing(descent, cut, formula, limit - descent.work)) {
            case CrossingEnd::exhausted:
                return true;
            case CrossingEnd::budget:
                return false;
            case CrossingEnd::found:
                addProven();
                break;
            case CrossingEnd::full:
                break;
        }
    }
}

void CrossingQuery::State::report(const Budget& budget, Crossing& out) {
    out.pieces.clear();
    out.rate = 0;
    out.certain = false;
    out.stop = StopReason::invalidInput;
    out.work = 0;
    if (!started) {
        return;
    }
    if (!finished) {
        finished = detail::spend(
            budget, [this] { return descent.work; }, [this](std::uint64_t units) { return goOn(units); });
        if (finished) {
            std::ranges::sort(proven, {}, &CurvePiece::pair);  // the end does not depend on the way
        }
    }
    out.work = descent.work;
    out.certain = finished;
    out.stop = finished ? StopReason::certain : StopReason::budget;
    out.pieces.assign(proven.begin(), proven.end());
    if (finished || descent.work == 0) {
        return;
    }
    std::uint32_t places[16 * detail::crossingBlocks];
    const auto [count, rate] = detail::summarise(cut, provenLength, settings.leaveOut, places);
    out.rate = rate;
    out.pieces.resize(proven.size() + count);
    for (std::size_t k = 0; k < count; ++k) {
        const detail::CrossingBlock& block = cut.block[places[k] / 16];
        const std::uint32_t lane = places[k] % 16;
        CurvePiece& piece = out.pieces[proven.size() + k];
        piece.pair = {};
        for (int axis = 0; axis < 3; ++axis) {
            piece.position[axis] = block.position[axis][lane];
            piece.direction[axis] = block.direction[axis][lane];
        }
        piece.length = block.length[lane];
        piece.extent = block.extent[lane];
        piece.slope = slopeOf(block.flatness[lane], block.cosine[lane]);
        piece.rate = block.rate[lane];
    }
}

CrossingQuery::CrossingQuery(const Tree& a, const Tree& b) : m_state(std::make_unique<State>(a, b)) {}
CrossingQuery::CrossingQuery(const CrossingQuery& other)
    : m_state(other.m_state ? State::copyOf(*other.m_state) : nullptr) {}
CrossingQuery& CrossingQuery::operator=(const CrossingQuery& other) {
    if (this != &other) {
        m_state = other.m_state ? State::copyOf(*other.m_state) : nullptr;
    }
    return *this;
}
CrossingQuery::CrossingQuery(CrossingQuery&&) noexcept = default;
CrossingQuery& CrossingQuery::operator=(CrossingQuery&&) noexcept = default;
CrossingQuery::~CrossingQuery() = default;

void CrossingQuery::find(const Pose& bInA, const CrossingSettings& settings, Budget budget, Crossing& out) {
    m_state->start(bInA, settings, budget.work == unlimited && budget.time == never);
    m_state->report(budget, out);
}

void CrossingQuery::forget() {
    m_state->started = false;
}

void CrossingQuery::resume(Budget budget, Crossing& out) {
    m_state->report(budget, out);
}

}  // namespace grapeshot
